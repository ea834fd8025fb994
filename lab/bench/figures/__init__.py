# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables that documents show beside the report's own parts: a module for each document, computed or measured."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..cells import Table

COMPUTED = ("errata", "oren_nayar", "fit", "keys")  # by NumPy alone
RENDERED = ("formula",)


def names(*, quick: bool) -> list[str]:
    return [*COMPUTED, *(() if quick else RENDERED)]


def measure(name: str, **_quick: bool) -> dict[str, Table]:
    """The tables of the module of that name."""
    tables: dict[str, Table] = import_module(f".{name}", __name__).tables()
    return tables
