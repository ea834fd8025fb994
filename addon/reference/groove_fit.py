# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that bounces within a V-groove as Cycles can have it: one lobe of its own that fills what one bounce leaves.

The further bounces of ``groove`` gather about the mirror image of the view, nearer than the first does: an upright
Beckmann lobe of half the facets' slope, at most 1/4, has the least L1 distance from them that one lobe without lean
has. Its weight is (1 - E) / E', E' its own albedo and E that of what an estimator renders of the first bounce, all with
F = 1: so a perfect mirror sends back all light. Its colour is that of two bounces or, of a share q, three, which meet
facets at the cosine ``COSINE`` (n.v): F^2 (1 - q + q F).

``tools/fit_groove.py`` computes weights and q, and writes ``groove_fit.toml``.
"""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance import cook_torrance
from .cook_torrance_fit import interpolated, view_coordinate
from .directions import as_pair, as_positive
from .distributions import smith_g
from .groove import WHITE

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel

TABLE = Path(__file__).with_suffix(".toml")
NAMES = ("formula", "fit", "closure", "third")  # weights beside the V-groove model, its mixture, Cycles' closure; and q
COSINE = 0.55
WIDEST = 0.25


def of_estimator(estimator: str) -> str:
    """Which of ``NAMES`` goes with the first bounce as an estimator has it."""
    return {"fit": "fit", "corrected": "fit", "closure": "closure"}.get(estimator, "formula")


@cache
def tables() -> Floats:
    """``NAMES`` by m^(1/2) and by view, each evenly spaced from 0 to 1, as ``cook_torrance_fit.tables`` has them."""
    with TABLE.open("rb") as file:
        numbers = tomllib.load(file)
    return np.array([numbers[name] for name in NAMES]).astype(np.float32).astype(np.float64)


def slope(m: ArrayLike) -> Floats:
    """Slope of the lobe: m / 2, at most 1/4."""
    return np.minimum(0.5 * np.asarray(m, dtype=np.float64), WIDEST)


def colour(wo: Floats, third: Floats, fresnel: Fresnel) -> Floats:
    """F^2 (1 - q + q F), RGB (..., 3)."""
    F, q = fresnel(COSINE * np.clip(wo[..., 2], 0.0, 1.0)), np.asarray(third)[..., None]
    return F * F * (1.0 - q + q * F)


def bounced(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, estimator: str) -> Floats:
    """The BRDF of the lobe that an estimator gets for the light of further bounces, in 1/sr, RGB (..., 3).

    Arguments, zeros and errors as ``cook_torrance``; m > 1 gives what m = 1 gives. Not reciprocal.
    """
    wi, wo = as_pair(wi, wo)
    m = np.minimum(as_positive(m, "m"), 1.0)
    u, root = np.broadcast_arrays(view_coordinate(wo, m), np.sqrt(m))
    numbers = interpolated(tables(), u, root)
    weight, q = numbers[..., NAMES.index(of_estimator(estimator))], numbers[..., NAMES.index("third")]
    narrow = slope(m)
    lobe = cook_torrance(wi, wo, narrow, WHITE, smith_g(wi, wo, narrow))
    return lobe * weight[..., None] * colour(wo, q, fresnel)
