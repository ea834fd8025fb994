# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of stills as one page: thumbnails, what each shows, and a filter. Needs no server and no network."""

from __future__ import annotations

import base64
import math
import os
import tempfile
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import jinja2

from ..addon.blender.images import attribute, tile, write
from ..addon.library.files import write_text
from .outcome import RECORD, read_record

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

FILE = "gallery.html"
WIDTH = 192  # of a thumbnail, pixels
ENDINGS = (".png", ".exr")  # the first that there is shows what a still looks like
MOST_CHOICES = 200  # of a filter; beyond, words find better


def stills(folder: Path) -> list[dict[str, Any]]:
    """What the pictures in a folder say of themselves, each task once, in the order of their labels.

    A picture that says nothing is not a task's. Keys: those of a picture's record, ``pictures``, names by ending, and
    ``links``, the names in URLs.
    """
    found: dict[str, dict[str, Any]] = {}
    for path in sorted(folder.iterdir()):
        if path.suffix not in ENDINGS or path.name.startswith("."):
            continue
        if (read := read_record(attribute(path, RECORD))) is not None:
            record = found.setdefault(path.stem, read | {"pictures": {}, "links": {}})
            record["pictures"][path.suffix] = path.name
            record["links"][path.suffix[1:]] = quote(os.fsencode(path.name))
    return sorted(found.values(), key=lambda record: [_number(value) for value in record["labels"].values()])


def write_page(path: Path, folder: Path, records: Iterable[dict[str, Any]], count: int) -> None:
    """The page of ``count`` ``stills`` of a folder, to which its links point from ``path``."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    environment.filters["percent"] = lambda value: "" if math.isnan(value) else f"{value:.2%}"
    template = environment.from_string(files(__package__).joinpath("gallery.jinja").read_text(encoding="utf-8"))
    shown = [record | {"thumbnail": _thumbnail(folder, record["pictures"])} for record in records]
    # A relative link begins with ./ so that no name is taken for a scheme, as javascript: is.
    away = folder.absolute().as_uri() + "/" if folder.absolute() != path.absolute().parent else "./"
    page = template.render(
        title=folder.absolute().name, stills=shown, count=count, filters=filters(shown), away=away, width=WIDTH
    )
    write_text(path, page)


def filters(records: Sequence[dict[str, Any]]) -> dict[str, list[str]]:
    """The labels by which stills differ, each with its values."""
    found: dict[str, dict[str, None]] = {}
    for record in records:
        for name, value in record["labels"].items():
            found.setdefault(name, {})[value] = None
    return {
        name: sorted(values, key=_number) for name, values in found.items() if 1 < len(values) <= MOST_CHOICES
    }  # fmt: skip


def _number(text: str) -> tuple[float, str]:
    """Numbers by size, then words by the alphabet."""
    try:
        return float(text), ""
    except ValueError:
        return math.inf, text


def _thumbnail(folder: Path, pictures: Mapping[str, str]) -> str:
    """As a WebP in the page itself."""
    path = folder / next(pictures[ending] for ending in ENDINGS if ending in pictures)
    with tempfile.TemporaryDirectory(prefix="vgroove-") as place:
        picture = Path(place) / "thumbnail.webp"
        try:
            write(picture, tile(path, WIDTH), {"compression": "webp:85"})
        except (RuntimeError, ZeroDivisionError):  # it was cut short: its links say so
            return ""
        return "data:image/webp;base64," + base64.b64encode(picture.read_bytes()).decode()
