# SPDX-License-Identifier: GPL-3.0-or-later
"""What the ``hybrid`` of every model shares: the bound of its wrong part, and the share of ``fit`` that keeps it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .directions import as_range

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats

BOUNDS = (0.001, 0.05)  # of the part that may be wrong, as a share of the directional albedo
DEFAULT_BOUND = 0.005


def share(coefficients: Floats, y: Floats, n: Floats, bound: ArrayLike) -> Floats:
    """min(max(sum of c[j, k, l] y^j n^k b^l, 0), 1) with b of ``bound_coordinate``; y, n and bound (...), broadcast.

    Raises ValueError for a bound outside ``BOUNDS``.
    """
    b = bound_coordinate(as_range(bound, "bound", *BOUNDS))
    powers = (v[..., None] ** np.arange(degree) for v, degree in zip((y, n, b), coefficients.shape, strict=True))
    return np.clip(np.einsum("...j,...k,...l,jkl->...", *powers, coefficients), 0.0, 1.0)


def bound_coordinate(bound: Floats) -> Floats:
    """-1 at the lowest bound, 1 at the highest, linear in the logarithm."""
    low, high = np.log(BOUNDS)
    return np.asarray((2.0 * np.log(bound) - low - high) / (high - low))
