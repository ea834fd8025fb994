# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove check``: Cycles against the NumPy reference, row by row."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from ..addon.library.files import check_writable, write_text
from .environment import start_blender, versions
from .terminal import out, progress

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ..lab.check.rows import Row

JsonOption = Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Write every row as JSON")]
QuickOption = Annotated[bool, typer.Option(help="One row of each kind: a test of the instrument")]


def check(*, json_file: JsonOption = None, quick: QuickOption = False) -> None:
    """Compare Cycles with the NumPy reference: every model x estimator x backend. Exits 1 if a row fails."""
    if json_file is not None:
        check_writable(json_file)
    start_blender()
    from ..lab.check import plan as check_plan

    plan = check_plan.quick_plan() if quick else check_plan.plan()
    rows = [measure() for measure in progress(plan, "measuring", len(plan))]
    out.print(_table(rows))
    failed = sum(not row.passed for row in rows)
    out.print(f"{len(rows) - failed} rows passed, {failed} failed; Blender {versions()['blender']}", highlight=False)
    if json_file is not None:
        content = {"versions": versions(), "rows": [row.as_json() for row in rows]}
        write_text(json_file, json.dumps(content, indent=1))
    if failed:
        raise typer.Exit(1)


def _table(rows: Iterable[Row]) -> Table:
    table = Table("model", "estimator", "run as", "variant", "at", "worst", "bar", "resolves", "")
    for row in rows:
        worst, bar = (f"{row.error:.2%}", f"{row.bar:.2%}") if row.is_noisy else (f"{row.error:.1e}", f"{row.bar:.1e}")
        passed = "ok" if row.passed else "FAILED"
        at = ", ".join(f"{name} {value:.4g}" for name, value in row.at.items())
        measured = worst, bar, f"{row.resolves:.1e}", passed
        table.add_row(row.model, row.test, str(row.setup), row.variant, at, *measured)
    return table
