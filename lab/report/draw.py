# SPDX-License-Identifier: GPL-3.0-or-later
"""A report.json drawn without a render: plots, report.md, and one page that needs nothing else.

The page has figures, tables, and pictures to swap with their reference; only these pictures need Blender.
"""

from __future__ import annotations

import base64
from dataclasses import dataclass
from importlib.resources import files
from io import BytesIO
from typing import TYPE_CHECKING

import jinja2
import numpy as np
from matplotlib import image

from ...addon.library.files import replacing
from ..bench.record import ReportError
from . import claims, plots, published, summary, tables
from .findings import runs

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from ..bench.cells import Pictures
    from ..bench.record import Machine, Report
    from .findings import Run

PAGE = "report.html"
AMPLIFIED = 16  # the difference of two pictures as shown, by so much


def draw(report: Report, pictures: Path | None, folder: Path) -> list[Path]:
    """Write report.html, report.md and plots/ to ``folder`` once all are drawn; what was written.

    pictures: where the pictures that the report names are; None for a page without them. ReportError if there is
    nothing to draw.
    """
    found = [run for run in runs(report) if run.contests or run.cases or run.left_out or run.everyday]
    if not found:
        message = "the report holds no measurements yet; give `vgroove report -o DIR` more time"
        raise ReportError(message)
    drawn = {name: content for run in found for name, content in plots.draw(run).items()}
    text = _page(found, report.machine, drawn, pictures)
    drawn |= {PAGE: text.encode(), summary.FILE: summary.markdown(published.publish(report)).encode()}
    _write(folder, drawn)
    return [folder / PAGE, folder / summary.FILE, folder / "plots"]


def plot(report: Report, folder: Path) -> None:
    """Write the plots alone, as PNG, to ``folder``/plots."""
    for run in runs(report):
        _write(folder, {name: content for name, content in plots.draw(run).items() if name.endswith(".png")})


def _write(folder: Path, contents: dict[str, bytes]) -> None:
    for name, content in contents.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        with replacing(folder / name) as temporary:
            temporary.write_bytes(content)


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


def _page(found: list[Run], machine: Machine, plots: dict[str, bytes], pictures: Path | None) -> str:
    """plots: by file name; pictures: as in ``draw``."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    template = environment.from_string(files(__package__).joinpath("page.jinja").read_text(encoding="utf-8"))
    shown = {
        (run.blender, contest.title): looks(contest.cell.pictures, pictures)
        for run in found
        for contest in run.contests
        if pictures is not None and contest.cell.pictures
    }
    return template.render(
        runs=found, machine=machine, texts={kind: text for kind, (_, text) in summary.KINDS.items()},
        vectors={name: _url("svg+xml", content) for name, content in plots.items()},
        pictures=shown, title=summary.title, claims=claims, tables=tables, amplified=AMPLIFIED,
    )  # fmt: skip


def looks(kept: Pictures, folder: Path) -> Looks | None:
    """The pictures of a contest as they are shown; None without the reference, and without those that are gone.

    A report names its pictures: those outside its folder, which another report may name, are not shown.
    """
    from ...addon.blender.images import load, srgb

    root = folder.resolve()
    found = ((name, folder / file) for name, file in kept.files.items())
    there = {name: path for name, path in found if path.is_file() and path.resolve().is_relative_to(root)}
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
