# SPDX-License-Identifier: GPL-3.0-or-later
"""Every row of ``vgroove check``, of all models."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from ...addon.blender.material import ESTIMATORS

if TYPE_CHECKING:
    from functools import partial

    from .rows import Plan, Row

MODULES = ("cook_torrance", "oren_nayar", "sum", "time", "glass")  # files of this folder that have a ``plan``


def plan() -> Plan:
    """Every row: calls that measure one each."""
    return [row for name in MODULES for row in import_module(f".{name}", __package__).plan()]


def quick_plan() -> Plan:
    """One row of each kind and estimator, but for those under a sun with an angle, which take long."""
    first: dict[tuple[str, ...], partial[Row]] = {}
    for row in plan():
        estimator = [part for part in row.args if part in ESTIMATORS]
        if row.args[-1] == 0.3 and "sun" not in row.func.__name__:
            first.setdefault((row.func.__module__, row.func.__name__, *estimator), row)
    return list(first.values())
