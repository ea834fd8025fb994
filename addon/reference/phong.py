# SPDX-License-Identifier: GPL-3.0-or-later
"""Phong's and Blinn's cosine lobes over Lambert, scaled so that the lobe's albedo head-on is 1.

Sources:
    Lafortune & Willems 1994, Using the Modified Phong Reflectance Model for Physically Based Rendering, report CW 197
    Blinn 1977, Models of Light Reflection for Computer Synthesized Pictures, doi:10.1145/563858.563893
    Mallett & Yuksel 2020, Constant-Time Energy-Normalization for the Phong Specular BRDFs,
    doi:10.1007/s00371-020-01954-x
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from . import phong_fit
from .directions import above, as_pair, as_range, dot, half_vector, norm, reflect
from .oren_nayar import Lambert
from .over_lambert import OverLambert
from .quadrature import panels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .model import Brdf

HIGHEST = 1e6  # exponent
SPREAD = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5, 7.0])  # of a lobe, in standard deviations of its angle


@dataclass(frozen=True)
class _CosineLobe(OverLambert):
    """A cosine lobe of albedo 1 head-on, over Lambert."""

    name: ClassVar[str]  # of the model, in the table of ``phong_fit``

    def __post_init__(self) -> None:
        as_range(self.n, "exponent", 0.0, HIGHEST)
        super().__post_init__()

    @property
    def n(self) -> float:
        """The exponent."""
        raise NotImplementedError

    def rendered(self, estimator: str, _bound: float) -> Brdf:
        """See ``estimators.rendered``. ``closure``, also in place of ``fit``: Lambert and a lobe of Cycles' own."""
        if estimator not in {"closure", "fit"}:
            return self.evaluate
        albedo, specular, table, m = self.albedo, np.asarray(self.specular), phong_fit.tables()[self.name], self.slope
        return lambda wi, wo: Lambert(albedo).evaluate(wi, wo) + specular * phong_fit.closure(wi, wo, m, table)

    @property
    def slope(self) -> float:
        """m of the Beckmann lobe that is as wide near its peak, head-on."""
        raise NotImplementedError


@dataclass(frozen=True)
class Phong(_CosineLobe):
    """f = albedo/pi + specular (n + 2)/(2 pi) cos^n a; a from wi to the mirror image of wo, n = ``exponent`` >= 0.

    Source: Lafortune & Willems 1994.
    """

    exponent: float
    name = "phong"

    @property
    def n(self) -> float:
        return self.exponent

    @property
    def slope(self) -> float:
        """As a mirrored ray turns by twice its facet's angle: cos^n(2t) and exp(-t^2/m^2) curve alike."""
        return float((2.0 * self.n + 1.0) ** -0.5)

    def lobe(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        wi, wo = as_pair(wi, wo)
        power = cosine_power(wi, wo * [-1.0, -1.0, 1.0], self.n)
        return np.where(above(wi, wo), (self.n + 2.0) / (2.0 * np.pi) * power, 0.0)

    def _draw(self, wo: Floats, u: Floats) -> Floats:
        tan, phi = _tangent(u[..., 0], self.n + 1.0), 2.0 * np.pi * u[..., 1]
        R = wo * [-1.0, -1.0, 1.0]
        T = np.cross(R, np.where(R[..., 2:] ** 2 < 0.8, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
        T = T / norm(T)[..., None]
        wi = R + (tan * np.cos(phi))[..., None] * T + (tan * np.sin(phi))[..., None] * np.cross(R, T)
        return wi / norm(wi)[..., None]

    def _density(self, wi: Floats, wo: Floats) -> Floats:
        return (self.n + 1.0) / (2.0 * np.pi) * cosine_power(wi, wo * [-1.0, -1.0, 1.0], self.n)

    def lobe_albedo(self, wo: Floats) -> Floats:
        """Over a and the azimuth p about the mirror direction: n.l = cos a c + sin a s cos p, which p integrates."""
        c, s = _view(wo)
        wide = np.minimum(SPREAD / np.sqrt(self.n + 1.0), np.pi / 2)
        edges = [np.broadcast_to(edge, c.shape) for edge in (*wide, np.pi / 2)] + [np.arctan2(c, s)]
        a, weight = panels(np.sort(np.concatenate(edges, axis=-1), axis=-1), 24)
        up, aside = np.cos(a) * c, np.sin(a) * s
        p = np.arccos(np.clip(-up / np.maximum(aside, 1e-300), -1.0, 1.0))
        lit = 2.0 * (up * p + aside * np.sin(p))
        lobe = (self.n + 2.0) / (2.0 * np.pi) * np.exp(self.n * np.log(np.cos(a)))
        return np.asarray(np.sum(lobe * np.maximum(lit, 0.0) * np.sin(a) * weight, axis=-1))


@dataclass(frozen=True)
class BlinnPhong(_CosineLobe):
    """f = albedo/pi + specular (n + 2)(n + 4)/(8 pi (2^(-n/2) + n)) (n.h)^n, n = ``shininess`` >= 0.

    Scaled by (n + 8)/(8 pi) or (n + 2)/(2 pi), as is often printed, it would send back up to 1.075 or 4 times as much.
    Source: Blinn 1977; scaled as Mallett & Yuksel 2020.
    """

    shininess: float
    name = "blinn_phong"

    @property
    def n(self) -> float:
        return self.shininess

    @property
    def slope(self) -> float:
        """(n.h)^n and exp(-tan^2/m^2) / cos^4 curve alike."""
        return float((2.0 / (self.n + 2.0)) ** 0.5)

    @property
    def scale(self) -> float:
        """The lobe's peak, in 1/sr."""
        n = self.n
        return float((n + 2.0) * (n + 4.0) / (8.0 * np.pi * (2.0 ** (-n / 2.0) + n)))

    def lobe(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        wi, wo = as_pair(wi, wo)
        power = cosine_power(half_vector(wi, wo), np.array([0.0, 0.0, 1.0]), self.n)
        return np.where(above(wi, wo), self.scale * power, 0.0)

    def _draw(self, wo: Floats, u: Floats) -> Floats:
        """A mirror about a facet that is drawn as the view sees it (``cook_torrance.visible_facet``)."""
        tan, phi = _tangent(u[..., 0], self.n + 2.0), 2.0 * np.pi * u[..., 1]
        h = np.stack([tan * np.cos(phi), tan * np.sin(phi), np.ones_like(tan)], axis=-1)
        h = h / norm(h)[..., None]
        dual = h * [-1.0, -1.0, 1.0]
        seen, dual_seen = np.maximum(dot(wo, h), 0.0), np.maximum(dot(wo, dual), 0.0)
        return reflect(wo, np.where((u[..., 2] * (seen + dual_seen) < seen)[..., None], h, dual))

    def _density(self, wi: Floats, wo: Floats) -> Floats:
        """G1 (n + 2)/(2 pi) (n.h)^n / (4 n.v), G1 = min(1, 2 (n.h)(n.v)/(v.h))."""
        h = half_vector(wi, wo)
        no, vh = np.maximum(wo[..., 2], 1e-300), np.maximum(dot(wo, h), 1e-300)
        G1 = np.minimum(1.0, 2.0 * h[..., 2] * no / vh)
        power = cosine_power(h, np.array([0.0, 0.0, 1.0]), self.n)
        return G1 * (self.n + 2.0) / (2.0 * np.pi) * power / (4.0 * no)

    def lobe_albedo(self, wo: Floats) -> Floats:
        """Over facets at t and azimuth p: dl = 4 (v.h) dh, v.h = A + B cos p and n.l = 2 (n.h)(v.h) - c."""
        c, s = _view(wo)
        theta = np.arctan2(s, c)
        kinks = [(np.pi / 2 - theta) / 2.0, (np.pi / 2 + theta) / 2.0]  # facets that light only part of, and none
        wide = SPREAD * self.slope
        edges = np.concatenate([*(np.broadcast_to(edge, c.shape) for edge in wide), *kinks], axis=-1)
        t, weight = panels(np.sort(np.minimum(edges, kinks[1]), axis=-1), 24)
        nh, A, B = np.cos(t), np.cos(t) * c, np.sin(t) * s
        p = np.arccos(np.clip((c / (2.0 * nh) - A) / np.maximum(B, 1e-300), -1.0, 1.0))
        low, high = 2.0 * nh * A - c, 2.0 * nh * B  # n.l = low + high cos p
        lit = 2.0 * (A * low * p + (A * high + B * low) * np.sin(p) + B * high * (p / 2.0 + np.sin(2.0 * p) / 4.0))
        lobe = self.scale * np.exp(self.n * np.log(nh))
        return np.asarray(np.sum(4.0 * lobe * np.maximum(lit, 0.0) * np.sin(t) * weight, axis=-1))


def _view(wo: Floats) -> tuple[Floats, Floats]:
    """cos and sin of the views' angles, (..., 1)."""
    cosine = np.minimum(wo[..., 2:], 1.0)
    return cosine, np.sqrt((1.0 - cosine) * (1.0 + cosine))


def cosine_power(a: Floats, b: Floats, n: float) -> Floats:
    """max(a . b, 0)^n of unit vectors, (...): exp(-n/2 log(1 + tan^2)), as cos rounds away what high powers tell."""
    cos = dot(*np.broadcast_arrays(a, b))
    ahead = cos > 0
    across = a - np.where(ahead, cos, 0.0)[..., None] * b
    tan2 = np.square(norm(across) / np.where(ahead, cos, 1.0))
    with np.errstate(under="ignore", over="ignore"):
        return np.where(ahead, np.exp(-0.5 * n * np.log1p(tan2)), 0.0)


def _tangent(u: Floats, power: float) -> Floats:
    """tan of the angle whose density over solid angle is cos^(power - 1) power/(2 pi): cos = (1 - u)^(1/power)."""
    return np.sqrt(np.expm1(-2.0 * np.log1p(-u) / power))
