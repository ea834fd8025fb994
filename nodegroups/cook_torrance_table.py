# SPDX-License-Identifier: GPL-3.0-or-later
"""The share that ``hybrid`` takes of the mixture, as the shaders take it. Needs no Blender."""

from __future__ import annotations

from ..addon.reference.cook_torrance_fit import LOBES, control_points
from .polynomial import share_text


def share() -> list[list[list[float]]]:
    """Coefficients [j][k][l] of (2x - 1)^j (2m - 1)^k b^l of ``hybrid``'s share; b by ``polynomial.bound_line``."""
    return [[[float(c) for c in powers] for powers in row] for row in control_points()["share"]]


def header() -> str:
    """OSL text: the share as function ``fit_share_at(y, n, bound)``."""
    return "\n".join([f"#define FIT_LOBES {LOBES}", "", share_text("fit_share_at", share())])
