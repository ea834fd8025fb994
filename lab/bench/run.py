# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what a report lacks, one cell after the other; a run that was stopped is resumed."""

from __future__ import annotations

import time
from importlib import import_module
from subprocess import SubprocessError
from typing import TYPE_CHECKING

from .cells import PARTS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from .record import Cell, Record


def cells(*, quick: bool, more: Sequence[Cell] = ()) -> list[Cell]:
    """Everything a report measures, the same in each run. more: cells of what the laboratory may not import."""
    parts = (import_module(f".{name}", __package__) for name in PARTS)
    return [*(cell for part in parts for cell in part.cells(quick=quick)), *more]


def missing(record: Record, wanted: Sequence[Cell]) -> list[Cell]:
    return [cell for cell in wanted if cell.key not in record.run.cells]


def measure(record: Record, wanted: Sequence[Cell], folder: Path) -> Iterator[tuple[Cell, str]]:
    """Measure each cell and record it before the next starts; with each the reason why it failed, or ""."""
    for cell in wanted:
        start = time.perf_counter()
        try:
            measured = cell.measure(folder)
        except (RuntimeError, ValueError, ArithmeticError, SubprocessError) as error:
            yield cell, " ".join(f"{type(error).__name__}: {error}".split())
        else:
            record.add(cell.key, measured, time.perf_counter() - start)
            yield cell, ""
