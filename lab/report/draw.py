# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots, page and text of a report.json, without a render. Only the pictures of the page need Blender."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...addon.library.files import replacing
from ..bench.record import ReportError
from . import page, plots, summary

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .findings import Run

PLOTS = "plots"


def told(runs: list[Run]) -> list[Run]:
    """Those that hold more than tables for documents."""
    return [run for run in runs if run.contests or run.cases or run.left_out or run.everyday]


def draw(runs: list[Run], machine: Mapping[str, Any], pictures: Path | None, folder: Path) -> list[Path]:
    """Write report.html, report.md and plots/ to ``folder``; what was written.

    pictures: where the pictures that the report names are; None for a page without them. ReportError if there is
    nothing to draw.
    """
    found = told(runs)
    if not found:
        message = "the report holds no measurements yet; give `vgroove report -o DIR` more time"
        raise ReportError(message)
    with tempfile.TemporaryDirectory(prefix="vgroove-") as place:  # nothing of a report that cannot be drawn whole
        made = Path(place)
        (made / PLOTS).mkdir()
        figures = {run.blender: plots.draw(run, made / PLOTS) for run in found}
        page.write(made / page.FILE, found, machine, figures, made / PLOTS, pictures)
        summary.write(made / summary.FILE, found, machine, figures)
        (folder / PLOTS).mkdir(parents=True, exist_ok=True)
        for path in (path for path in made.rglob("*") if path.is_file()):
            with replacing(folder / path.relative_to(made)) as temporary:
                shutil.copyfile(path, temporary)
    return [folder / page.FILE, folder / summary.FILE, folder / PLOTS]
