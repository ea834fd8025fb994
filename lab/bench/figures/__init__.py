# SPDX-License-Identifier: GPL-3.0-or-later
"""What documents tell beside the report's own parts: tables that are computed, or measured, and published as they are.

A cell is one document's, {"tables": {NAME: {"columns": [...], "rows": [[...], ...]}}}, of plain numbers and words; the
documents say how many digits of them are told.
"""

from __future__ import annotations

from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any

from ..record import Cell

if TYPE_CHECKING:
    from pathlib import Path

Table = dict[str, list[Any]]  # columns and rows
COMPUTED = ("errata", "oren_nayar", "fit", "keys")  # by NumPy alone
RENDERED = ("formula", "batch")


def cells(*, quick: bool) -> list[Cell]:
    names = COMPUTED if quick else COMPUTED + RENDERED
    return [Cell(f"figures/{name}", partial(measure, name=name)) for name in names]


def measure(_folder: Path, name: str) -> dict[str, Any]:
    """The tables of the module of that name."""
    return {"tables": import_module(f".{name}", __name__).tables()}


def table(columns: list[str], rows: list[list[Any]]) -> Table:
    return {"columns": columns, "rows": rows}
