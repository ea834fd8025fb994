# SPDX-License-Identifier: GPL-3.0-or-later
"""Ward's lobe as two of Cycles' own Beckmann lobes, with Smith's G: what estimator ``fit`` renders.

With facet slopes p and q and s = (v.h)/((n.v)(n.h)), what mirrors light to the viewer weighs 2 - (1 + p^2 + q^2)/s in
the bounded form, times Beckmann's Gaussian. At s = 1, which facets are near unless the view grazes, that is
1 - p^2 - q^2: the Gaussian is as narrow as one of slopes m/(1 + k m^2)^(1/2), k = 1, along each axis. Toward grazing
views k falls to 0. In the form of 1992 it is n.v times about 1 - 3 (p^2 + q^2), and k is 3. The first lobe is upright
and has these slopes. The second leans and is narrower. Five polynomials in u = m (1 - c)/(c + m), c = n.v, and in m
give both weights, and the second lobe's roughness, anisotropy and lean, for round surfaces of such a slope m
(``tools/fit_ward.py``). All else depends on s alone, which stretches with the slopes, as ``anisotropic_fit`` says.

L1 of the bounded form, for ratios of the slopes to 10:1 at any azimuth: with the wider slope up to 0.6 within 5 % to 75
degrees and 8 % at 85, up to 1 within 12 %. Of 1992: up to 0.45 within 7 %, up to 0.6 within 11 %.
"""

from __future__ import annotations

import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import anisotropic_fit
from .cook_torrance_fit import NARROWEST, Lobes, view_coordinate
from .directions import above, as_pair

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats

PATH = Path(__file__).with_suffix(".toml")
# Weights of both lobes; of the second the roughness over m^(1/2), anisotropy, and how its normal leans from the view
LOW, HIGH = np.array([0.0, 0.0, 0.4, 0.0, -1.0]), np.array([5.0, 5.0, 1.5, 1.0, 2.0])


NARROWING_1992 = 3.0


@cache
def coefficients() -> dict[str, Floats]:
    """By kind: [value][j][k] of u^j m^k."""
    return {kind: np.array(rows) for kind, rows in tomllib.loads(PATH.read_text(encoding="utf-8")).items()}


def effective(m: float, narrowing: Floats) -> Floats:
    """The slope of the lobe itself, where Ward's is m."""
    return np.asarray(m / np.sqrt(1.0 + narrowing * np.square(m)))


def narrowing(kind: str, wo: Floats, m: Floats) -> Floats:
    """k for views ``wo`` of surfaces that look as round as those of slope m, (...)."""
    return np.asarray(1.0 - view_coordinate(wo, m) if kind == "bounded" else np.full(m.shape, NARROWING_1992))


def scale(kind: str, c: ArrayLike, m: ArrayLike) -> Floats:
    """What multiplies both weights: the form of 1992 darkens with the view's cosine c, until the lobe is wider."""
    c, m = np.broadcast_arrays(c, m)
    return np.asarray(c + 0.5 * m if kind == "ward_1992" else np.ones(c.shape))


def most_lean(c: Floats, m: Floats) -> Floats:
    """Beyond it the view would be below the second lobe's own horizon, or nearly: slopes are to 0.9 of that."""
    return np.asarray(0.9 * c / (m * (1.0 - 0.1 * np.square(c))))


def round_lobes(wo: Floats, m: Floats, kind: str) -> Lobes:
    """Both lobes for views ``wo`` (..., 3) of surfaces of one slope ``m``, (...), that of the lobe itself."""
    u, c = view_coordinate(wo, m), np.maximum(wo[..., 2], 0.0)
    s = np.hypot(wo[..., 0], wo[..., 1])
    values = [np.polynomial.polynomial.polyval2d(u, m, of) for of in coefficients()[kind]]
    first, second, roughness, anisotropy, lean = (np.clip(*of) for of in zip(values, LOW, HIGH, strict=True))
    lean = np.minimum(lean, most_lean(c, m))
    square, aspect = m * roughness**2, np.sqrt(1.0 - (1.0 - NARROWEST) * anisotropy)
    tilt = m * lean
    pairs = (
        (first * scale(kind, c, m), second * scale(kind, c, m)),
        (m, np.minimum(square / aspect, 1.0)),
        (m, np.minimum(square * aspect, 1.0)),
        (np.zeros_like(c), tilt * s / (1.0 - tilt * c)),
    )
    return Lobes(*(np.stack(pair, axis=-1) for pair in pairs))


def lobes(wo: Floats, m_x: float, m_y: float, kind: str) -> anisotropic_fit.Lobes:
    """Both lobes for views ``wo`` (..., 3), stretched."""
    k = narrowing(kind, wo, anisotropic_fit.round_slope(wo, m_x, m_y))
    x, y = (effective(m, k) for m in (m_x, m_y))
    m = np.minimum(anisotropic_fit.round_slope(wo, x, y), 1.0)
    found = anisotropic_fit.stretched(round_lobes(wo, m, kind), wo, x, y, m)
    return replace(found, weight=found.weight * (x * y / (m_x * m_y))[..., None])


def fit(wi: ArrayLike, wo: ArrayLike, m_x: float, m_y: float, kind: str) -> Floats:
    """f of both lobes, in 1/sr, (...); 0 unless both directions leave the upper side. Not reciprocal."""
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    sent = anisotropic_fit.sent(wi, wo, lobes(wo, m_x, m_y, kind))
    return np.where(lit, sent / np.where(lit, wi[..., 2], 1.0), 0.0)
