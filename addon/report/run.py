# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what a report lacks, one cell after the other; a run that was stopped goes on where it was."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import accuracy, left_out, stability

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .record import Cell, Record

PARTS = (accuracy, stability, left_out)


def cells(*, quick: bool) -> list[Cell]:
    """All that a report measures, the same in each run."""
    return [cell for part in PARTS for cell in part.cells(quick=quick)]


def missing(record: Record, wanted: list[Cell]) -> list[Cell]:
    return [cell for cell in wanted if cell.key not in record.cells]


def measured(record: Record, wanted: list[Cell], folder: Path) -> Iterator[Cell]:
    """Measure each cell, and keep it before the next is begun."""
    for cell in wanted:
        record.keep(cell.key, cell.measure(folder))
        yield cell
