# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove report``: error against run time, stability, and what materials leave out."""

from __future__ import annotations

import warnings
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.markup import escape
from rich.table import Table

from ..addon.library.errors import InputError
from .environment import make_folder_of, require_packages, start_blender, versions
from .terminal import out, progress, say

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ..lab.bench.record import Cell, Record


class Part(StrEnum):
    """A part of a report."""

    ACCURACY = "accuracy"
    PICKS = "picks"
    STABILITY = "stability"
    LEFT_OUT = "left_out"
    EVERYDAY = "everyday"
    FIGURES = "figures"


OutputOption = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="DIR", help="Folder of the report; created if missing, resumed if not"),
]
QuickOption = Annotated[bool, typer.Option("--quick", help="Measure less of everything: minutes instead of an hour")]
AgainOption = Annotated[list[Part] | None, typer.Option("--again", help="Re-measure this part (repeatable)")]
SourceOption = Annotated[
    Path | None, typer.Option("--from", metavar="REPORT.json", help="Redraw a report; render nothing")
]
DocumentsOption = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="With --from: write its figures into README.md and docs/*.md of this checkout"),
]
CompareOption = Annotated[
    tuple[Path, Path] | None,
    typer.Option(
        metavar="A.json B.json", help="Print where B is better or worse than A. Exits 1 if anything is worse or missing"
    ),
]


def report(
    output: OutputOption = None,
    *,
    quick: QuickOption = False,
    again: AgainOption = None,
    source: SourceOption = None,
    documents: DocumentsOption = None,
    compare: CompareOption = None,
) -> None:
    """Measure error against run time, stability, and what was left out; draw plots and a page. Resumes.

    Exits 1 if a full report does not show what it must.
    """
    if compare is not None:
        if output or source or quick or again:
            message = "--compare reads two reports and writes none; leave -o, --from, --quick and --again out"
            raise InputError(message)
        _compare(*compare)
    elif source is not None:
        if quick or again:
            message = "--from only redraws; leave out --quick and --again, which say what to measure"
            raise InputError(message)
        require_packages("matplotlib")
        if documents:
            _write_documents(source, documents)
        _draw(source, output or source.absolute().parent)
    elif documents:
        message = "--documents writes what --from names; give --from REPORT.json"
        raise InputError(message)
    elif output is None:
        message = "give -o DIR to measure, --from REPORT.json to redraw, or --compare A.json B.json"
        raise InputError(message)
    else:
        _measure(output, again or [], quick=quick)


def _measure(output: Path, again: list[Part], *, quick: bool) -> None:
    """Measure what a report lacks, and draw it."""
    require_packages("matplotlib", "mitsuba")
    from ..lab.bench import record

    file = output / record.FILE
    make_folder_of(file)
    kept = record.open_or_create(file, versions()["blender"], quick=quick, again=[str(part) for part in again])
    failed = _measure_missing(kept, quick=quick)
    _draw(file, output, failed)


def _measure_missing(kept: Record, *, quick: bool) -> list[str]:
    """Measure the cells that a record lacks; returns the keys of those that failed."""
    start_blender()
    from ..lab.bench import record

    failed = []
    wanted = record.cells(quick=quick, more=_cost_of_batch(quick=quick))
    missing = kept.missing(wanted)
    kept.run.wanted = len(wanted)
    if done := len(wanted) - len(missing):
        say(f"{done} of {len(wanted)} measurements are there already")
    try:
        for cell, reason in progress(kept.measure(missing), "measuring", len(missing)):
            if reason:
                failed.append(cell.key)
                say(f"vgroove: {cell.key}: {reason}")
    except KeyboardInterrupt:
        done = len(wanted) - len(kept.missing(wanted))
        say(f"{done} of {len(wanted)} measurements are kept in {kept.path}")
        raise
    return failed


def _cost_of_batch(*, quick: bool) -> list[Cell]:
    """What ``vgroove batch`` costs, for docs/batch.md: the laboratory does not know it."""
    from ..batch import cost
    from ..lab.bench.cells import Table as Figures
    from ..lab.bench.record import Cell

    cell = Cell("figures/batch", lambda: {"cost": Figures(["what", "value"], cost.rows())})
    return [] if quick else [cell]


def _write_documents(source: Path, folder: Path) -> None:
    """Write a report's figures between their marks in the documents."""
    from ..lab.bench import record
    from ..lab.report import documents, draw, published

    with _damage_named(source):
        report = record.read(source)
        for path in documents.write(folder, published.publish(report)):
            say(f"wrote {path}")
        draw.plot(report, folder / "docs")


def _draw(source: Path, folder: Path, failed: Sequence[str] = ()) -> None:
    """Draw the plots, page and text of a report.json. Exits 1 if a claim of a full report does not hold.

    failed: keys of measurements that failed; RuntimeError if there are any, once all is drawn.
    """
    from ..lab.bench import record
    from ..lab.report import claims, draw, findings, summary

    with _damage_named(source):
        report = record.read(source)
        found = findings.runs(report)
        broken = [(run, claim) for run in found for claim in claims.of(run) if not claim.holds]
        make_folder_of(folder / record.FILE)
        for path in draw.draw(report, folder):
            say(f"wrote {path}")
        for run, claim in broken:
            say(f"{summary.title(run.blender, quick=run.quick, lacks=run.lacks)}: {claim.text}")
    if failed:
        message = f"{len(failed)} measurements failed, {failed[0]} first; give the command again"
        raise RuntimeError(message)
    if not all(run.quick for run, _ in broken):
        raise typer.Exit(1)


def _compare(before: Path, after: Path) -> None:
    """Print the figures that two reports differ in. Exits 1 if one is worse or gone."""
    from ..lab.bench import record
    from ..lab.report import compare, findings

    with _damage_named(before, after):
        found, count = compare.changes(*(findings.runs(record.read(path)) for path in (before, after)))
    verdicts = {True: "WORSE", False: "better", None: "new"}
    table = Table("Blender", "where", "what", "figure", "before", "after", "")
    for one in found:
        words = [one.blender, one.where, one.who, one.what, one.before, one.after]
        table.add_row(*(escape(word) for word in words), verdicts[one.worse])
    if found:
        out.print(table)
    worse, better = (sum(one.worse is verdict for one in found) for verdict in (True, False))
    out.print(f"{worse} worse, {better} better, of {count} figures that both have", highlight=False)
    if worse:
        raise typer.Exit(1)


@contextmanager
def _damage_named(*sources: Path) -> Iterator[None]:
    """ReportError for whatever a damaged report leads to: its numbers are used in a hundred places."""
    from ..lab.bench.record import ReportError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)  # a square root of -1, or a mean of nothing
            yield
    except (OSError, MemoryError, InputError):
        raise
    except Exception as error:
        message = f"{' or '.join(map(str, sources))}: not as this vgroove writes it"
        message += f" ({type(error).__name__}: {error}); measure again"
        raise ReportError(message) from error
