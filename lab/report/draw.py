# SPDX-License-Identifier: GPL-3.0-or-later
"""A report.json drawn without a render: plots, report.md, and one page with every number that needs nothing else."""

from __future__ import annotations

import base64
from importlib.resources import files
from typing import TYPE_CHECKING

import jinja2

from ...addon.library.files import replacing
from ..bench.record import ReportError
from . import claims, plots, published, summary, tables
from .findings import runs

if TYPE_CHECKING:
    from pathlib import Path

    from ..bench.record import Report
    from .findings import Run
    from .published import Published

PAGE = "report.html"


def draw(report: Report, folder: Path) -> list[Path]:
    """Write report.html, report.md and plots/ to ``folder`` once all are drawn; what was written.

    ReportError if there is nothing to draw.
    """
    found = [run for run in runs(report) if run.contests or run.cases or run.left_out or run.everyday]
    if not found:
        message = "the report holds no measurements yet; give `vgroove report -o DIR` more time"
        raise ReportError(message)
    drawn = {name: content for run in found for name, content in plots.draw(run).items()}
    figures = published.publish(report)
    text = _page(found, figures, drawn)
    drawn |= {PAGE: text.encode(), summary.FILE: summary.markdown(figures).encode()}
    _write(folder, drawn)
    return [folder / PAGE, folder / summary.FILE, folder / "plots"]


def plot(report: Report, folder: Path) -> None:
    """Write the plots alone to ``folder``/plots."""
    for run in runs(report):
        _write(folder, plots.draw(run))


def _write(folder: Path, contents: dict[str, bytes]) -> None:
    for name, content in contents.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        with replacing(folder / name) as temporary:
            temporary.write_bytes(content)


def _page(found: list[Run], figures: Published, drawn: dict[str, bytes]) -> str:
    """drawn: plots by file name."""
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined, trim_blocks=True)
    template = environment.from_string(files(__package__).joinpath("page.jinja").read_text(encoding="utf-8"))
    urls = {name: f"data:image/png;base64,{base64.b64encode(content).decode()}" for name, content in drawn.items()}
    return template.render(
        runs=found, figures=figures.runs, machine=figures.machine, urls=urls, summary=summary, tables=tables,
        broken=claims.BROKEN,
    )  # fmt: skip
