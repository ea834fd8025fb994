# SPDX-License-Identifier: GPL-3.0-or-later
"""Directional albedo of Cook-Torrance by three facets instead of an integral: what shaders can afford.

E(wo) is the mean of F(v.h) over the facets that send light on, times their share. Gauss's rule for that distribution
of v.h has three cosines and weights, whatever F is. ``tools/fit_albedo.py`` fits both by polynomials in
(2x - 1, 2m - 1), x as in ``cook_torrance_fit``, and writes ``cook_torrance_albedo.toml``; for dielectrics they are
within 0.003 of the integral, for F = 1 within 0.007 (the tool prints it by slope).

Source of the rule: Golub & Welsch 1969, Calculation of Gauss Quadrature Rules, Math. Comp. 23(106).
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance_fit import grazing
from .directions import TANGENT, as_directions, as_range

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel

TABLE = Path(__file__).with_suffix(".toml")


@cache
def table() -> dict[str, Floats]:
    """Coefficients c[facet, j, k] of (2x - 1)^j (2m - 1)^k for "cosine" and "weight"."""
    with TABLE.open("rb") as file:
        return {name: np.array(numbers) for name, numbers in tomllib.load(file).items()}


def facets(wo: ArrayLike, m: ArrayLike) -> tuple[Floats, Floats]:
    """Weights and cosines v.h of the three facets, (..., 3) each.

    cosine = min(max(n.v + m t, 0), 1), weight = max(w, 0); t and w by the table.
    wo: unit vectors (..., 3); m: RMS slope, 0 (a smooth interface) to 1. Raises ValueError outside these ranges.
    """
    wo, m = as_directions(wo, "wo"), as_range(m, "m", 0.0, 1.0)
    x, m = np.broadcast_arrays(grazing(wo, m), m)
    powers = (np.moveaxis(table()[name], 0, -1) for name in ("cosine", "weight"))
    cosine, weight = (
        np.moveaxis(np.polynomial.polynomial.polyval2d(2.0 * x - 1.0, 2.0 * m - 1.0, c), 0, -1) for c in powers
    )
    return np.maximum(weight, 0.0), np.clip(wo[..., 2:] + m[..., None] * cosine, 0.0, 1.0)


def quick_albedo(wo: ArrayLike, m: ArrayLike, fresnel: Fresnel) -> Floats:
    """E(wo), RGB (..., 3): the sum of weight F(cosine) over ``facets``, at most 1. 0 on and below the horizon.

    Arguments and errors as ``facets``.
    """
    weight, cosine = facets(wo, m)
    E = np.einsum("...k,...kc->...c", weight, fresnel(cosine))
    return np.where(np.asarray(wo)[..., 2:] > TANGENT, np.minimum(E, 1.0), 0.0)
