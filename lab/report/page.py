# SPDX-License-Identifier: GPL-3.0-or-later
"""A report as one page that needs nothing else: figures, tables, and pictures to swap with their reference."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING, Any

import jinja2
import numpy as np
from matplotlib import image

from ...addon.library.files import write_text
from . import claims, summary

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from .findings import Contest, Run
    from .plots import Drawn

FILE = "report.html"
AMPLIFIED = 16  # the difference of two pictures as shown, by so much


@dataclass(frozen=True)
class Swap:
    """A render and by what it differs from the reference, as data URLs."""

    name: str
    render: str
    difference: str


@dataclass(frozen=True)
class Pictures:
    """Of one scene and subject."""

    reference: str
    swaps: list[Swap]


def write(
    path: Path,
    found: list[Run],
    machine: Mapping[str, Any],
    figures: Mapping[str, Mapping[str, Drawn]],
    plots: Path,
    pictures: Path | None,
) -> None:
    """figures: by Blender and kind, what lies in ``plots``; pictures: as in ``draw``."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    template = environment.from_string(files(__package__).joinpath("page.jinja").read_text(encoding="utf-8"))
    shown = {
        (run.blender, contest.title): looks(contest, pictures)
        for run in found
        for contest in run.contests
        if pictures is not None and contest.pictures
    }
    vectors = {
        one.name: _url("svg+xml", (plots / f"{one.name}.svg").read_bytes())
        for drawn in figures.values()
        for one in drawn.values()
    }
    text = template.render(
        runs=found, machine=summary.machine_text(machine), figures=figures, vectors=vectors, pictures=shown,
        say=summary, broken=claims.BROKEN, amplified=AMPLIFIED,
    )  # fmt: skip
    write_text(path, text)


def looks(contest: Contest, folder: Path) -> Pictures | None:
    """The pictures of a contest as they are shown; None without the reference, and without those that are gone."""
    from ...addon.blender.images import load, srgb

    there = {name: folder / file for name, file in contest.pictures.items() if (folder / file).is_file()}
    if "reference" not in there:
        return None
    reference = srgb(load(there.pop("reference")))
    swaps = []
    for name, path in there.items():
        render = srgb(load(path))
        swaps.append(Swap(name, _png(render), _png(AMPLIFIED * np.abs(render - reference))))
    return Pictures(_png(reference), swaps)


def _png(picture: NDArray[np.floating]) -> str:
    """(H, W, 3) of 0..1 in a data URL; brighter is clipped."""
    buffer = BytesIO()
    image.imsave(buffer, np.uint8(np.rint(255.0 * np.clip(picture, 0.0, 1.0))), format="png")
    return _url("png", buffer.getvalue())


def _url(kind: str, content: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
