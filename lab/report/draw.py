# SPDX-License-Identifier: GPL-3.0-or-later
"""Plots, page and text of a report.json, without a render. Only the pictures of the page need Blender."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from ...addon.library.files import replacing, write_text
from ..bench.record import ReportError
from . import page, plots, published, summary
from .findings import runs

if TYPE_CHECKING:
    from ..bench.record import Report

PLOTS = "plots"


def draw(report: Report, pictures: Path | None, folder: Path) -> list[Path]:
    """Write report.html, report.md and plots/ to ``folder``, all of them or none; what was written.

    pictures: where the pictures that the report names are; None for a page without them. ReportError if there is
    nothing to draw.
    """
    found = [run for run in runs(report) if run.contests or run.cases or run.left_out or run.everyday]
    if not found:
        message = "the report holds no measurements yet; give `vgroove report -o DIR` more time"
        raise ReportError(message)
    with tempfile.TemporaryDirectory(prefix="vgroove-") as place:
        made = Path(place)
        (made / PLOTS).mkdir()
        for run in found:
            plots.draw(run, made / PLOTS)
        page.write(made / page.FILE, found, report.machine, made / PLOTS, pictures)
        write_text(made / summary.FILE, summary.markdown(published.publish(report)))
        (folder / PLOTS).mkdir(parents=True, exist_ok=True)
        for path in (path for path in made.rglob("*") if path.is_file()):
            with replacing(folder / path.relative_to(made)) as temporary:
                shutil.copyfile(path, temporary)
    return [folder / page.FILE, folder / summary.FILE, folder / PLOTS]


def plot(report: Report, folder: Path) -> None:
    """Write the plots alone, as PNG, to ``folder``/plots."""
    (folder / PLOTS).mkdir(parents=True, exist_ok=True)
    for run in runs(report):
        plots.draw(run, folder / PLOTS)
