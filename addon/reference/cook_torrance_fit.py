# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance as a fixed mixture of the lobes that Cycles itself has: what estimator ``fit`` renders.

``hybrid`` takes a share of that mixture and adds what is missing.

Each lobe is a Beckmann microfacet lobe with Smith's G, slopes of its own across and in the plane of view, and a
normal tilted within that plane. Where the V-groove's G clips no facet, one round lobe of slope m is the model itself;
weights, slopes and tilts leave that lobe by polynomials in (2x - 1, 2m - 1), as far as ``clipped_share`` says. They
are sums of Chebyshev's, as float32 shaders would lose three digits in powers; ``tools/fit_cook_torrance.py``
finds them by the least L1 distance from the V-groove model and writes ``cook_torrance_fit.toml``. F depends on v.h
alone, so that one mixture serves every Fresnel term.

Source of the lobe: Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2), eqs. 85 to 99.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import hybrid
from .cook_torrance import cook_torrance
from .directions import above, as_directions, as_pair, as_positive, dot, facet_cosine, half_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .directions import Floats
    from .fresnel import Fresnel

TABLE = Path(__file__).with_suffix(".toml")
FUNCTIONS = ("weight", "anisotropy", "tilt", "across")
ALONE = 0.9998  # weight of the one lobe where nothing is clipped; below 1, for a furnace must not exceed 1
HALF_CLIPPED = 0.2  # of facets that are clipped, at which half of the polynomials counts
MOST_LEAN = 0.95  # of the tilt at which the view would pass below a lobe's own horizon
NARROWEST = 0.1  # within over across: what Cycles' Metallic BSDF offers


@dataclass(frozen=True)
class Lobes:
    """The mixture seen from each wo; arrays (..., lobes). ``across``, ``within``: slopes to the plane of view.

    ``tilt`` is the tangent of the angle by which the normal leans away from the viewer.
    """

    weight: Floats
    across: Floats
    within: Floats
    tilt: Floats


@cache
def table() -> dict[str, Floats]:
    """Coefficients c[lobe, j, k] of T_j(2x - 1) T_k(2m - 1), Chebyshev's, for each of ``FUNCTIONS``."""
    with TABLE.open("rb") as file:
        return {name: np.array(numbers) for name, numbers in tomllib.load(file).items()}


def polynomial(coefficients: Floats, x: Floats, m: Floats) -> Floats:
    """Sum of c[..., j, k] T_j(2x - 1) T_k(2m - 1); x and m (...), the result (..., lobes)."""
    sizes = coefficients.shape[-2:]
    of_x, of_m = (
        np.polynomial.chebyshev.chebvander(2.0 * v - 1.0, n - 1).reshape(*v.shape, n)
        for v, n in zip((x, m), sizes, strict=True)
    )
    products = np.einsum("...j,...k->...jk", of_x, of_m)
    return np.einsum("...jk,ljk->...l", products, coefficients)


def lobes(wo: ArrayLike, m: ArrayLike, coefficients: dict[str, Floats] | None = None) -> Lobes:
    """The mixture for views ``wo`` and slopes ``m``, which are held to Cycles' limit of 1.

    With x = m s / (c + m s), c = n.v, s = sin: 0 head-on, 1 at grazing, and alike for all m where m is small; with g =
    ``clipped_share`` and polynomials w, r, t of each lobe and a of all:
    weight = min(max(w0 + g w, 0), 1), w0 = ``ALONE`` for the first lobe and 0 for the others;
    across = min(1, m (1 + g a)), the same for all;  within = across (1 - 0.9 min(max(x g r, 0), 1));
    tilt = m (1 - x) s min(g t, ``MOST_LEAN`` / (x s)).
    Head-on every lobe is round and upright, as it must be to stay continuous there.

    wo: unit vectors (..., 3); m: RMS slope > 0. Raises ValueError outside these ranges.
    """
    wo, m = as_directions(wo, "wo"), np.minimum(as_positive(m, "m"), 1.0)
    s, x, g, m = np.broadcast_arrays(np.hypot(wo[..., 0], wo[..., 1]), grazing(wo, m), clipped_share(wo, m), m)
    of = coefficients or table()
    alone = starts(len(of["weight"]))
    values = (start + g[..., None] * polynomial(of[name], x, m) for name, start in zip(FUNCTIONS, alone, strict=True))
    return shaped(m[..., None], x[..., None], s[..., None], *values)


def starts(count: int) -> tuple[Floats, Floats, Floats, Floats]:
    """What each of ``FUNCTIONS`` is where nothing is clipped: of ``count`` lobes one, upright and round, of slope m."""
    return ALONE * (np.arange(count) == 0), np.zeros(count), np.zeros(count), np.ones(1)


def clipped_share(wo: Floats, m: ArrayLike) -> Floats:
    """g = q / (q + ``HALF_CLIPPED``) (...), q the share of facets steeper than the first that the V-groove's G clips.

    q = exp(-(t / m)^2), t = c / (3^(1/2) + (3 - 3^(1/2)) s) with c = n.v, s = sin: within 0.6 % of tan(e / 3), e the
    view's elevation. A facet that leans away from the viewer by e / 3 sends light to e / 3 above the horizon, where
    2 (n.h)(n.l) = v.h.
    """
    c, s = np.maximum(wo[..., 2], 0.0), np.hypot(wo[..., 0], wo[..., 1])
    with np.errstate(under="ignore"):
        q = np.exp(-np.square(c / (np.sqrt(3.0) + (3.0 - np.sqrt(3.0)) * s) / m))
    return np.asarray(q / (q + HALF_CLIPPED), dtype=np.float64)


def grazing(wo: Floats, m: ArrayLike) -> Floats:
    """x = m s / (c + m s), (...): 0 head-on, 1 at grazing."""
    c, s = np.maximum(wo[..., 2], 0.0), np.hypot(wo[..., 0], wo[..., 1])
    return np.asarray(m * s / np.maximum(c + m * s, 1e-300), dtype=np.float64)


def shaped(m: Floats, x: Floats, s: Floats, weight: Floats, anisotropy: Floats, tilt: Floats, across: Floats) -> Lobes:
    """Lobes from the values of the polynomials, as ``lobes`` says."""
    across = np.minimum(m * across, 1.0) * np.ones_like(weight)
    within = across * (1.0 - (1.0 - NARROWEST) * np.clip(x * anisotropy, 0.0, 1.0))
    return Lobes(
        np.clip(weight, 0.0, 1.0),
        across,
        within,
        m * (1.0 - x) * s * np.minimum(tilt, MOST_LEAN / np.maximum(x * s, 0.01)),
    )


def mixture(wi: ArrayLike, wo: ArrayLike, m: ArrayLike) -> Floats:
    """f cos(theta_i) of the mixture with F = 1: the sum of weight D G / (4 v.n') over its lobes, in 1/sr, (...).

    n' is a lobe's own normal, against which its D and G are taken. 0 unless both directions leave the upper side.

    wi, wo: unit vectors (..., 3), broadcast; m: RMS slope > 0. Raises ValueError outside these ranges.
    """
    wi, wo = as_pair(wi, wo)
    return np.where(above(wi, wo), np.sum(weighted_lobes(wi, wo, lobes(wo, m)), axis=-1), 0.0)


def weighted_lobes(wi: Floats, wo: Floats, of: Lobes) -> Floats:
    """weight D G / (4 v.n') of each lobe, (..., lobes)."""
    h = half_vector(wi, wo)
    sin = np.hypot(wo[..., 0], wo[..., 1])
    aside = sin > 0  # head-on any plane will do: lobes are round
    X = np.where(aside[..., None], wo[..., :2] / np.where(aside, sin, 1.0)[..., None], [1.0, 0.0])  # to the viewer

    def parts(w: Floats) -> tuple[Floats, Floats, Floats]:
        across, toward = w[..., 1] * X[..., 0] - w[..., 0] * X[..., 1], dot(w[..., :2], X)
        return across[..., None], toward[..., None], w[..., 2:]

    turned_wi, turned_wo, turned_h = (turned(*parts(w), of.tilt) for w in (wi, wo, h))
    return of.weight * smith_lobe(turned_wi, turned_wo, turned_h, of.across, of.within)


def turned(across: Floats, toward: Floats, up: Floats, tilt: Floats) -> tuple[Floats, Floats, Floats]:
    """Components across the plane of view, within it and along a normal that leans away from the viewer by ``tilt``."""
    cos_tilt = 1.0 / np.sqrt(1.0 + tilt * tilt)
    return across, (toward + tilt * up) * cos_tilt, (up - tilt * toward) * cos_tilt


def smith_lobe(wi: tuple[Floats, ...], wo: tuple[Floats, ...], h: tuple[Floats, ...], ax: Floats, ay: Floats) -> Floats:
    """D G / (4 v.n) of an anisotropic Beckmann lobe in its own frame; vectors as their three components."""
    lit = (wi[2] > 0) & (wo[2] > 0) & (h[2] > 1e-8)
    hz, no = np.where(lit, h[2], 1.0), np.where(lit, wo[2], 1.0)
    with np.errstate(under="ignore"):
        D = np.exp(-np.square(h[0] / hz / ax) - np.square(h[1] / hz / ay)) / (np.pi * ax * ay * hz**4)
    G = 1.0 / (1.0 + _lambda(wi, lit, ax, ay) + _lambda(wo, lit, ax, ay))
    return np.where(lit, D * G / (4.0 * no), 0.0)


def _lambda(w: tuple[Floats, ...], lit: NDArray[np.bool_], ax: Floats, ay: Floats) -> Floats:
    """Smith's Lambda as ``distributions.smith_lambda``, for two slopes."""
    slope = np.sqrt(np.square(w[0] * ax) + np.square(w[1] * ay)) / np.where(lit, w[2], 1.0)
    rough = slope * 1.6 > 1.0
    a = 1.0 / np.where(rough, slope, 1.0)
    return np.where(rough, (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)


def cook_torrance_fit(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel) -> Floats:
    """The BRDF that ``fit`` renders, F(v.h) mixture / (n.l), in 1/sr, RGB (..., 3). Not reciprocal.

    Arguments, zeros and errors as ``cook_torrance``; m > 1 gives what m = 1 gives.
    """
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    F = fresnel(np.where(lit, facet_cosine(wi, wo, half_vector(wi, wo)), 1.0))
    return F * np.where(lit, mixture(wi, wo, m) / np.where(lit, wi[..., 2], 1.0), 0.0)[..., None]


def hybrid_share(wo: ArrayLike, m: ArrayLike, bound: ArrayLike) -> Floats:
    """c, the share of the mixture that ``hybrid`` leaves to Cycles' own lobes, (...), from 0 to 1.

    The largest c for which what c times the mixture has too much of, the integral of F (c mixture - f cos)+ over wi,
    is at most ``bound`` times that of F f cos: for Schlick's F with F0 from 0.02 to 1 and for water's. A polynomial in
    (2x - 1), (2m - 1) and the logarithm of the bound that lies below all of these (tools/fit_cook_torrance.py).

    wo: unit vectors (..., 3); m: RMS slope > 0; bound: 0.001 to 0.05. Raises ValueError outside these ranges.
    """
    wo, m = as_directions(wo, "wo"), np.minimum(as_positive(m, "m"), 1.0)
    return hybrid.share(table()["share"], 2.0 * grazing(wo, m) - 1.0, 2.0 * m - 1.0, bound)


def cook_torrance_hybrid(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, bound: ArrayLike) -> Floats:
    """The BRDF that ``hybrid`` renders, max(f, c f_fit) with c = ``hybrid_share``, in 1/sr, RGB (..., 3).

    Arguments, zeros and errors as ``cook_torrance_fit``.
    """
    wi, wo = as_pair(wi, wo)
    c = hybrid_share(wo, m, bound)[..., None]
    true = cook_torrance(wi, wo, np.minimum(m, 1.0), fresnel)
    return np.maximum(true, c * cook_torrance_fit(wi, wo, m, fresnel))
