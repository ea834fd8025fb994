# SPDX-License-Identifier: GPL-3.0-or-later
"""Phong's and Blinn's lobes as Cycles' own closures: what their estimator ``closure`` renders.

One Beckmann lobe with Smith's G, and for broad lobes of Blinn's some Lambert. Beckmann's f cos lacks the n.l that the
cosine lobes have; this moves them toward the normal, and narrows them in the plane of view. With s the lobe's slope,
t the tangent of the view's angle and p the slope of a facet, exp(-p^2/s^2) (1 + 2 p t) has its peak at
p = 2 s^2 t / (1 + (1 + 8 s^2 t^2)^(1/2)): by that the lobe leans toward the viewer. The peak is as narrow as that of a
slope s / (1 + 2 s^2 t^2/(1 + 2 p t)^2)^(1/2): that is the lobe's within the plane of view. Phong's lobe is round about
the mirror direction: across that plane its facets are 1/(v.n) times as steep. ``tools/fit_phong.py`` finds what has no
formula, and prints how near all this comes.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance_fit import Lobes, weighted_lobes
from .directions import above, as_pair

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats

PATH = Path(__file__).with_suffix(".toml")
KNEE = 2.0  # of q = (c + (c^2 + KNEE m^2)^(1/2)) / 2, which bends where the lobe meets the horizon


@dataclass(frozen=True)
class Table:
    """What of a cosine lobe has no formula.

    narrower: s = m (1 - narrower m). lambert: times m^3, the share of the lobe's light that Lambert carries.
    round: whether the lobe is round about the mirror direction, else about the normal.
    weight, energy: of the Beckmann lobe, and the lobe's albedo: coefficients [j][k] of q^j m^k.
    """

    narrower: float
    lambert: float
    round: bool
    weight: tuple[tuple[float, ...], ...]
    energy: tuple[tuple[float, ...], ...]


@cache
def tables() -> dict[str, Table]:
    """By model."""
    found = tomllib.loads(PATH.read_text(encoding="utf-8"))
    return {
        name: Table(**of | {key: tuple(map(tuple, of[key])) for key in ("weight", "energy")})
        for name, of in found.items()
    }


def lobes(wo: Floats, m: float, of: Table) -> Lobes:
    """Cycles' lobe as seen from each wo (..., 3), of weight 1; its tilt is negative: it leans toward the viewer."""
    c, s = np.maximum(wo[..., 2], 0.0), np.hypot(wo[..., 0], wo[..., 1])
    slope = m * (1.0 - of.narrower * m)
    lean = 2.0 * slope**2 / (c + np.sqrt(c * c + 8.0 * (slope * s) ** 2))  # p = lean s
    within = slope / np.sqrt(1.0 + 2.0 * (slope * s / (c + 2.0 * lean * s * s)) ** 2)
    across = slope * np.ones_like(c)
    if of.round:
        across = np.minimum(slope * np.sqrt(1.0 + (lean * s) ** 2) / (c + lean * s * s), 1.0)
    return Lobes(*(part[..., None] for part in (np.ones_like(c), across, within, -lean * s)))


def polynomial(rows: tuple[tuple[float, ...], ...], c: Floats, m: float) -> Floats:
    """Sum of rows[j][k] q^j m^k at c = n.v, at least 0, (...)."""
    c = np.maximum(c, 0.0)
    q = 0.5 * (c + np.sqrt(c * c + KNEE * m * m))
    return np.maximum(sum(q**j * np.polynomial.polynomial.polyval(m, row) for j, row in enumerate(rows)), 0.0)


def closure(wi: ArrayLike, wo: ArrayLike, m: float, of: Table) -> Floats:
    """f of Cycles' closures in place of a cosine lobe, in 1/sr, (..., 1); 0 unless both leave the upper side.

    m: ``slope`` of the model. Not reciprocal.
    """
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    weight = polynomial(of.weight, wo[..., 2], m)
    f = weight * np.sum(weighted_lobes(wi, wo, lobes(wo, m, of)), axis=-1) / np.where(lit, wi[..., 2], 1.0)
    f = f + of.lambert * m**3 * polynomial(of.energy, wo[..., 2], m) / np.pi
    return np.where(lit, f, 0.0)[..., None]
