# SPDX-License-Identifier: GPL-3.0-or-later
"""How near Cycles comes to the formulas it is given, for docs/testing.md: the rows of ``vgroove check`` without noise.

The largest difference as a share of the view's largest value, of all views and Fresnel terms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...check import oren_nayar as check_oren_nayar
from ...check import rows as check
from ..cells import Table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import Any

    from ...check.rows import Row

SHOWN = ("direct", "closure")


def tables() -> dict[str, Table]:
    """By estimator, setup and slope or sigma. Rows with an approximate Fresnel term are left out: F is not D or G."""
    cook_torrance = [row for row in check.plan() if row[0] in {check.direct_row, check.closure_row}]
    oren_nayar = [row for row in check_oren_nayar.plan() if row[0] is check_oren_nayar.exact_row and row[1][0] in SHOWN]
    return {"cook_torrance": worst(cook_torrance, "m"), "oren_nayar": worst(oren_nayar, "sigma")}


def worst(plan: Iterable[tuple[Callable[..., Row], tuple[Any, ...]]], number: str) -> Table:
    found: dict[tuple[str, str, float], list[Row]] = {}
    for measure, arguments in plan:
        row = measure(*arguments)
        if number == "sigma" or not check.fresnel_approximation(row.setup, row.fresnel) or row.test == "direct":
            found.setdefault((row.test, str(row.setup), row.m), []).append(row)
    return Table(
        ["estimator", "setup", number, "worst", "bar"],
        [[*key, max(row.error for row in rows), max(row.bar for row in rows)] for key, rows in found.items()],
    )
