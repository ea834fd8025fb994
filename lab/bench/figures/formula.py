# SPDX-License-Identifier: GPL-3.0-or-later
"""How near Cycles comes to the formulas it is given, for docs/testing.md: the rows of ``vgroove check`` without noise.

The largest difference as a share of the view's largest value, of all views and Fresnel terms.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ....addon.models import fresnel
from ...check import cook_torrance, oren_nayar
from ..cells import Table

if TYPE_CHECKING:
    from ...check.rows import Plan, Row

SHOWN = ("direct", "closure")


def tables() -> dict[str, Table]:
    """By estimator, setup and slope or sigma. Rows with an approximate Fresnel term are left out: F is not D or G."""
    microfacets = {cook_torrance.direct_row, cook_torrance.closure_row}
    return {
        "cook_torrance": worst([row for row in cook_torrance.plan() if row.func in microfacets]),
        "oren_nayar": worst(
            [row for row in oren_nayar.plan() if row.func is oren_nayar.exact_row and row.args[0] in SHOWN]
        ),
    }


def worst(plan: Plan) -> Table:
    found: dict[tuple[str, str, float], list[Row]] = {}
    for measure in plan:
        row = measure()
        ((number, value),) = row.at.items()
        approximate = row.variant in fresnel.KINDS and cook_torrance.fresnel_approximation(row.setup, row.variant)
        if not approximate or row.test == "direct":
            found.setdefault((row.test, str(row.setup), value), []).append(row)
    return Table(
        ["estimator", "setup", number, "worst", "bar"],
        [[*key, max(row.error for row in rows), max(row.bar for row in rows)] for key, rows in found.items()],
    )
