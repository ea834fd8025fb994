# SPDX-License-Identifier: GPL-3.0-or-later
"""Every row of ``vgroove check``, of all models."""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from ...addon.models import MODELS, estimators

if TYPE_CHECKING:
    from functools import partial

    from .rows import Plan, Row

OTHERS = ("time",)  # files of this folder with rows that are not one model's


def plan() -> Plan:
    """Every row, of each model that has a file here: calls that measure one each."""
    names = [name for name in MODELS if find_spec(f".{name}", __package__)]
    return [row for name in (*names, *OTHERS) for row in import_module(f".{name}", __package__).plan()]


def model_of(row: partial[Row]) -> str:
    """Whose row it is: the file's of its function, or its first argument, where models share a file."""
    return row.args[0] if row.args[0] in MODELS else row.func.__module__.rpartition(".")[2]


def quick_plan() -> Plan:
    """One row of each kind and estimator, but for those under a sun with an angle, which take long."""
    first: dict[tuple[str, ...], partial[Row]] = {}
    for row in plan():
        estimator = [part for part in row.args if part in estimators.ALL]
        if row.args[-1] == 0.3 and "sun" not in row.func.__name__:
            first.setdefault((model_of(row), row.func.__name__, *estimator), row)
    return list(first.values())
