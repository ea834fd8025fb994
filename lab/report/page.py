# SPDX-License-Identifier: GPL-3.0-or-later
"""A report as one page that needs nothing else: figures, tables, and pictures to swap with their reference."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING

import jinja2
import numpy as np
from matplotlib import image

from ...addon.library.files import write_text
from . import claims, tables
from .summary import KINDS, title

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from ..bench.cells import Pictures
    from ..bench.record import Machine
    from .findings import Run

FILE = "report.html"
AMPLIFIED = 16  # the difference of two pictures as shown, by so much


@dataclass(frozen=True)
class Swap:
    """A render and by what it differs from the reference, as data URLs."""

    name: str
    render: str
    difference: str


@dataclass(frozen=True)
class Looks:
    """The pictures of one scene and subject, as data URLs."""

    reference: str
    swaps: list[Swap]


def write(path: Path, found: list[Run], machine: Machine, plots: Path, pictures: Path | None) -> None:
    """plots: the folder of the figures; pictures: as in ``draw``."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    template = environment.from_string(files(__package__).joinpath("page.jinja").read_text(encoding="utf-8"))
    shown = {
        (run.blender, contest.title): looks(contest.cell.pictures, pictures)
        for run in found
        for contest in run.contests
        if pictures is not None and contest.cell.pictures
    }
    vectors = {one.stem: _url("svg+xml", one.read_bytes()) for one in plots.glob("*.svg")}
    text = template.render(
        runs=found, machine=machine, vectors=vectors, texts={kind: text for kind, (_, text) in KINDS.items()},
        pictures=shown, title=title, claims=claims, tables=tables, amplified=AMPLIFIED,
    )  # fmt: skip
    write_text(path, text)


def looks(kept: Pictures, folder: Path) -> Looks | None:
    """The pictures of a contest as they are shown; None without the reference, and without those that are gone."""
    from ...addon.blender.images import load, srgb

    there = {name: folder / file for name, file in kept.files.items() if (folder / file).is_file()}
    if "reference" not in there:
        return None
    reference = srgb(load(there.pop("reference")))
    swaps = []
    for name, path in there.items():
        render = srgb(load(path))
        swaps.append(Swap(name, _png(render), _png(AMPLIFIED * np.abs(render - reference))))
    return Looks(_png(reference), swaps)


def _png(picture: NDArray[np.floating]) -> str:
    """(H, W, 3) of 0..1 in a data URL; brighter is clipped."""
    buffer = BytesIO()
    image.imsave(buffer, np.uint8(np.rint(255.0 * np.clip(picture, 0.0, 1.0))), format="png")
    return _url("png", buffer.getvalue())


def _url(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
