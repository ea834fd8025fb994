# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what a report lacks, one cell after the other; a run that was stopped goes on where it was."""

from __future__ import annotations

import time
from subprocess import SubprocessError
from typing import TYPE_CHECKING

from . import accuracy, everyday, figures, left_out, picks, stability

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from .record import Cell, Record

PARTS = (accuracy, picks, stability, left_out, everyday, figures)  # in the order of ``record.PARTS``


def cells(*, quick: bool) -> list[Cell]:
    """All that a report measures, the same in each run."""
    return [cell for part in PARTS for cell in part.cells(quick=quick)]


def missing(record: Record, wanted: list[Cell]) -> list[Cell]:
    return [cell for cell in wanted if cell.key not in record.cells]


def measured(record: Record, wanted: list[Cell], folder: Path) -> Iterator[tuple[Cell, str]]:
    """Measure each cell, and keep it before the next is begun. With each the reason why it could not be had, or ""."""
    for cell in wanted:
        began = time.perf_counter()
        try:
            found = cell.measure(folder)
        except (RuntimeError, ValueError, ArithmeticError, SubprocessError) as error:
            yield cell, " ".join(f"{type(error).__name__}: {error}".split())
        else:
            record.keep(cell.key, found, time.perf_counter() - began)
            yield cell, ""
