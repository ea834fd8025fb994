# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin & Shirley's model as Cycles' own closures: what ``closure`` and ``fit`` render.

Cycles' Glossy BSDF has the highlight itself, without F. ``closure`` gives it the mean of F over the highlight, over
Lambert. ``fit`` has what F adds, (1 - Rs)(1 - v.h)^5, on a Beckmann lobe of Metallic BSDF, which is narrower within the
plane of view and dimmer than the highlight; the Glossy BSDF sends what that lacks. The lobe's weight has no colour, but
its Fresnel term has: with a coloured Rs it also sends some of what is above the least channel, and less is left to it
where that outweighs the rise of F. Of a coloured amplitude the lobe has the least channel; what the others have more
gets the mean of F. The diffuse part is Lambert and a Toon BSDF, or Lambert where the model's is.
``tools/fit_ashikhmin.py`` finds the numbers, and prints how near all this comes.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance_fit import NARROWEST, smith_lobe
from .directions import above, facet_cosine, half_vector
from .fresnel import schlick

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .ashikhmin_shirley import AshikhminShirley
    from .directions import Floats

PATH = Path(__file__).with_suffix(".toml")
NAMES = "within", "weight", "more", "flat", "mean"
COLORED = 0.3  # of a Specular Color's range of channels: the rise of F beside which the lobe sends half of it
# c a(c) is within 2.2 % (L1) of Lambert's c, this share of it, and a Toon BSDF of these
LAMBERT, TOON_SIZE, TOON_SMOOTH = 0.413, 0.3018, 0.571
EDGES = TOON_SIZE * np.pi / 2, TOON_SMOOTH * np.pi / 2  # radians: even up to the first, then falling to 0 within these
# What the fall sends in all, over pi of a Lambertian: 2 pi times 1 - (sin(e + s) - sin e) / s
TOON_AREA = 2.0 * np.pi * (1.0 - (np.sin(sum(EDGES)) - np.sin(EDGES[0])) / EDGES[1])


@dataclass(frozen=True)
class Shape:
    """The Beckmann lobe as each wo sees it, arrays (...): slope ``wide`` along ``axis`` (..., 2), ``narrow`` across.

    weight: of the lobe; more: what the Glossy BSDF has for it, times 1 - Rs. flat: the share of the highlight without F
    that the lobe sends. rise, mean: (1 - v.h)^5 at the normal, and its mean over the highlight.
    """

    weight: Floats
    more: Floats
    flat: Floats
    rise: Floats
    mean: Floats
    wide: Floats
    narrow: Floats
    axis: Floats


@cache
def table() -> dict[str, Floats]:
    """Coefficients [j][k] of x^j m^k by name."""
    return {name: np.array(rows) for name, rows in tomllib.loads(PATH.read_text(encoding="utf-8")).items()}


def polynomial(rows: Floats, x: Floats, m: Floats) -> Floats:
    """Sum of rows[j][k] x^j m^k."""
    return np.asarray(np.polynomial.polynomial.polyval2d(x, m, rows))


def slopes(n_u: float, n_v: float) -> tuple[float, float]:
    """Cycles' slopes of exponents: n = 2/m^2 - 2."""
    return (2.0 / (n_u + 2.0)) ** 0.5, (2.0 / (n_v + 2.0)) ** 0.5


def shape(wo: Floats, m_u: float, m_v: float, of: dict[str, Floats] | None = None) -> Shape:
    """``fit`` as seen from wo (..., 3), in the tangent's frame.

    Of a view (x, y, z) coordinates are w / (w + z), w^2 = (m_u x)^2 + (m_v y)^2, and m, m^2 = w^2 + m_u m_v z^2. The
    lobe's covariance is diag(m_u^2, m_v^2) - (1 - k^2) g g^T, g = (m_u^2 x, m_v^2 y) / w: along g it is k times as
    wide.
    of: numbers in place of the committed table's.
    """
    of = of or table()
    x, y, z = wo[..., 0], wo[..., 1], np.maximum(wo[..., 2], 1e-7)
    U, V, unit = m_u / m_v, m_v / m_u, m_u * m_v
    d2 = np.maximum(U * x * x + V * y * y, 1e-14)
    w = np.sqrt(unit * d2)
    at, m = w / (w + z), np.sqrt(unit * (d2 + z * z))
    k, weight, more, flat, mean = (polynomial(of[name], at, m) for name in NAMES)
    k, weight, flat = (
        np.clip(1.0 + at * k, 0.1, 1.0),
        np.maximum(1.0 + at * weight, 0.0),
        np.clip(1.0 + at * flat, 0.0, 1.0),
    )
    fallen = 1.0 - np.minimum(z, 1.0)
    rise, mean = fallen**5, np.clip(fallen + m * mean, 0.0, 1.0) ** 5
    more = np.clip(rise * at * more, 0.0, 1.0)
    lost = (1.0 - k * k) / d2
    xx, yy, xy = U - lost * (U * x) ** 2, V - lost * (V * y) ** 2, -lost * x * y
    half = 0.5 * (xx - yy)
    root = np.hypot(half, xy)
    turn = 0.5 * np.arctan2(xy, half)
    ratio = np.maximum(k / (0.5 * (xx + yy) + root), NARROWEST) ** 0.5
    size = np.sqrt(unit * k)
    axis = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return Shape(weight, more, flat, rise, mean, np.minimum(size / ratio, 1.0), np.minimum(size * ratio, 1.0), axis)


def beckmann(wi: Floats, wo: Floats, of: Shape) -> Floats:
    """f cos of the lobe with F = 1 and weight 1, in 1/sr, (...)."""

    def parts(w: Floats) -> tuple[Floats, Floats, Floats]:
        cos, sin = of.axis[..., 0], of.axis[..., 1]
        return cos * w[..., 0] + sin * w[..., 1], cos * w[..., 1] - sin * w[..., 0], w[..., 2]

    return smith_lobe(parts(wi), parts(wo), parts(half_vector(wi, wo)), of.wide, of.narrow)


def toon(z: Floats) -> Floats:
    """f cos of the diffuse Toon BSDF, scaled to an albedo of 1, at n.l = z."""
    even, smooth = EDGES
    fall = np.clip(1.0 - (np.arccos(np.clip(z, 0.0, 1.0)) - even) / smooth, 0.0, 1.0)
    return fall / TOON_AREA


def closures(of: AshikhminShirley, wi: Floats, wo: Floats, *, fitted: bool) -> Floats:
    """f of Cycles' closures, in 1/sr, (..., 3), for directions in the tangent's frame. Not reciprocal."""
    m_u, m_v = slopes(of.n_u, of.n_v)
    lit: NDArray[np.bool_] = above(wi, wo)
    seen = shape(wo, m_u, m_v)
    h = half_vector(wi, wo)
    vh, ni = np.where(lit, facet_cosine(wi, wo, h), 1.0), np.where(lit, wi[..., 2], 1.0)
    glossy = of.density(h) / (4.0 * vh * np.maximum(ni, wo[..., 2]))
    color, f0, strength = split(of.specular, of.amplitude, seen, fitted=fitted)
    lobe = (strength * beckmann(wi, wo, seen) / ni)[..., None] * schlick(vh, f0)
    diffuse = np.full(ni.shape, 1.0 / np.pi)
    if fitted and not of.over_lambert:
        diffuse = LAMBERT * diffuse + (1.0 - LAMBERT) * toon(ni) / ni
    below = (of.entered(wo) * diffuse)[..., None] * of.deep
    return np.where(lit[..., None], glossy[..., None] * color + lobe + below, 0.0)


def split(specular: ArrayLike, amplitude: ArrayLike, seen: Shape, *, fitted: bool) -> tuple[Floats, Floats, Floats]:
    """Color of the Glossy BSDF (..., 3), F0 of the Beckmann lobe (3,) and its weight (...), 0 of ``closure``."""
    rgb, scale = (np.broadcast_to(np.asarray(one, dtype=np.float64), (3,)) for one in (specular, amplitude))
    even = np.min(scale)
    rest, above_least = 1.0 - rgb, rgb - np.min(rgb)
    most = max(float(np.max(rest)), 1e-7)
    share = fitted * seen.rise / (seen.rise + COLORED * np.max(above_least) + 1e-6)
    added = share * seen.more + (1.0 - share) * seen.mean
    color = rgb - (share * seen.flat)[..., None] * above_least + added[..., None] * rest
    color = even * color + (scale - even) * (rgb + seen.mean[..., None] * rest)
    return color, 1.0 - rest / most, even * most * share * seen.weight
