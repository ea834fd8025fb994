# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that bounces within a V-groove: Cook-Torrance with every bounce, not the first alone.

A groove has two facets, h and its dual h' = (-h_x, -h_y, h_z), which enclose the angle g = pi - 2t, t the angle between
h and n. Grooves of azimuth phi and slope lie on the surface by D(h) (n.h), and light enters one anywhere across its
opening. A mirror keeps the part of a ray along the groove's axis; what is left is a ray in the groove's cross-section,
which unfolds into a straight line through copies of the groove, one a bounce, side by side around its bottom. So a
facet's point alone says after how many bounces the ray leaves: at a distance s from the bottom (of 1), leaving at the
angle d from the facet, it meets a further facet j times if s <= sin(d - j g) / sin d and d > j g. Nothing else is
random, there are at most pi / g + 1 bounces, and the first one is Cook & Torrance's G to the digit.

Sources:
    Zipin 1966, The apparent thermal radiation properties of an isothermal vee-groove with specular walls, doi:10.6028/jres.070C.026
    Lee, Adrian, Andrew & Basu 2018, Practical multiple scattering for rough surfaces, doi:10.1145/3272127.3275016
"""  # noqa: E501

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance import as_samples, cook_torrance, visible_facet
from .directions import above, as_directions, as_pair, as_positive, dot
from .distributions import beckmann_d, vgroove_g1
from .fresnel import Schlick
from .quadrature import REACH, gauss_legendre, vgroove_albedo

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel

WHITE = Schlick(1.0)  # perfect mirrors
MOST = 64  # bounces: facets of slope 40 make more, 1e-6 of them at m = 10


@dataclass(frozen=True)
class Exit:
    """What leaves a groove after ``bounces``: toward wi (..., 3), a ``share`` (...) of what the first facet gets.

    cosines: of the angles at which each facet was met, (bounces, ...).
    """

    bounces: int
    wi: Floats
    share: Floats
    cosines: Floats

    def mirrored(self, fresnel: Fresnel) -> Floats:
        """What all facets leave of the light: the product of F over the bounces, RGB (..., 3)."""
        return np.prod([fresnel(cosine) for cosine in self.cosines], axis=0)


def exits(wo: Floats, h: Floats) -> Iterator[Exit]:
    """All ways out of the groove whose facet ``h`` is seen first from ``wo``, by number of bounces.

    wo, h: unit vectors (..., 3), of one shape, with v.h > 0. Shares add up to 1.
    """
    e, along, up = _cross_section(h)
    t = np.arctan2(np.hypot(h[..., 0], h[..., 1]), h[..., 2])
    g = np.pi - 2.0 * t
    axis = dot(wo, along)
    radius = np.hypot(dot(wo, h), dot(wo, up))
    d = np.arctan2(dot(wo, h), -dot(wo, up))  # from the facet's upward direction, once mirrored
    hidden = 1.0 - vgroove_g1(wo, h)  # the lower part of the facet
    left, cosines = np.ones(d.shape), []
    for j in range(MOST):
        cosines.append(np.clip(radius * np.sin(np.maximum(d - j * g, 0.0)), 0.0, 1.0))
        onward = d - (j + 1) * g
        reach = np.where(onward > 0.0, np.sin(np.maximum(onward, 0.0)) / np.sin(d), 0.0)
        more = np.clip((reach - hidden) / (1.0 - hidden), 0.0, left) * (j + 1 < MOST)
        angle = d - j * g if j % 2 == 0 else (j + 1) * g - d
        from_n = 0.5 * g - angle
        across = (radius * np.sin(from_n))[..., None] * -e + (radius * np.cos(from_n))[..., None] * [0.0, 0.0, 1.0]
        yield Exit(j + 1, across - axis[..., None] * along, left - more, np.array(cosines))
        if not more.any():
            return
        left = more


def _cross_section(h: Floats) -> tuple[Floats, Floats, Floats]:
    """Unit vectors of a facet's groove: where h leans, the groove's axis, and up along the facet."""
    phi = np.arctan2(h[..., 1], h[..., 0])
    cos, sin, none = np.cos(phi), np.sin(phi), np.zeros(phi.shape)
    e, along = np.stack([cos, sin, none], axis=-1), np.stack([-sin, cos, none], axis=-1)
    aside = np.hypot(h[..., 0], h[..., 1])[..., None]
    return e, along, aside * [0.0, 0.0, 1.0] - h[..., 2:] * e


def further(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, bounces: int) -> Floats:
    """The BRDF of the light that leaves after just so many bounces, at least 1, in 1/sr, RGB (..., 3).

    In the cross-section, with angles p of v and q of l from n toward the first facet's top and a = pi/2 - t: an odd
    number k of bounces has 2 k a = pi + p + q, an even one 2 k a = pi + p - q; either facet may be the first. So
    f = share D(h) (v.h) G1 sin t / (2 k (n.v) (n.l) |l + v|), the last term without the part along n.

    Arguments, zeros and errors as ``cook_torrance``. Infinite where l is the mirror image of v about n, for k > 1.
    """
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    both = wi[..., :2] + wo[..., :2]
    length = np.hypot(both[..., 0], both[..., 1])
    aside = both / np.where(length > 0.0, length, 1.0)[..., None]
    p, q = (np.arctan2(dot(w[..., :2], aside), w[..., 2]) for w in (wo, wi))
    total = np.zeros(wi.shape)
    for side in (1.0, -1.0):
        a = (np.pi + side * (p + q if bounces % 2 else p - q)) / (2.0 * bounces)
        there = lit & (a < 0.5 * np.pi) & (a > 0.0)
        a = np.where(there, a, 0.25 * np.pi)
        h = np.concatenate([-side * np.cos(a)[..., None] * aside, np.sin(a)[..., None]], axis=-1)
        h = np.where((length > 0.0)[..., None], h, [0.0, 0.0, 1.0])
        there &= dot(wo, h) > 0.0
        seen = np.where(there[..., None], wo, h)
        of = next((one for one in exits(seen, h) if one.bounces == bounces), None)
        if of is None:
            continue
        weight = beckmann_d(h, m) * dot(seen, h) * vgroove_g1(seen, h) * np.cos(a) * of.share
        scale = 2.0 * bounces * np.where(lit, wo[..., 2] * wi[..., 2], 1.0) * length
        with np.errstate(divide="ignore"):
            total += of.mirrored(fresnel) * np.where(there, weight / scale, 0.0)[..., None]
    return total


def bounce_albedos(wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, *, nodes: int = 96) -> Floats:
    """What leaves toward wo after 1, 2, ... bounces under a uniform white sky, RGB (..., MOST, 3).

    The mean of F ... F share over the grooves that wo sees; to about 1e-5 by Gauss-Legendre rules over the facets'
    slope tan t and azimuth. With F = 1 the sum is 1.
    wo: unit vectors (..., 3); m: RMS slope > 0. Raises ValueError outside these ranges.
    """
    wo, m = np.broadcast_arrays(as_directions(wo, "wo"), np.asarray(as_positive(m, "m"))[..., None])
    flat, slopes = wo.reshape(-1, 3), m[..., 0].ravel()
    found = np.zeros((len(flat), MOST, 3))
    for index, (direction, slope) in enumerate(zip(flat, slopes, strict=True)):
        if direction[2] > 0.0:
            found[index] = _bounce_albedos(direction, slope, fresnel, nodes)
    return found.reshape(*wo.shape[:-1], MOST, 3)


def _bounce_albedos(wo: Floats, m: float, fresnel: Fresnel, nodes: int) -> Floats:
    s, weight = gauss_legendre(nodes)
    tan, of_tan = (REACH * m * s)[:, None], (REACH * m * weight)[:, None]
    phi0, limit = np.arctan2(wo[1], wo[0]), np.hypot(wo[0], wo[1])
    # Facets seen: cos(phi) > -1 / (tan t tan theta_o)
    end = np.arccos(np.clip(-wo[2] / np.maximum(tan * limit, 1e-300), -1.0, 1.0))
    phi, of_phi = end * s, 2.0 * end * weight
    h = np.stack(np.broadcast_arrays(tan * np.cos(phi0 + phi), tan * np.sin(phi0 + phi), 1.0), axis=-1)
    h /= np.sqrt(1.0 + tan * tan)[..., None]
    density = np.exp(-np.square(tan / m)) / (np.pi * m * m) * tan * of_tan * of_phi
    cosine = np.maximum(dot(wo, h), 1e-300)
    seen = density * cosine / h[..., 2] * vgroove_g1(wo, h) / wo[2]
    found = np.zeros((MOST, 3))
    for one in exits(np.broadcast_to(wo, h.shape), h):
        found[one.bounces - 1] = np.einsum("ij,ijc->c", seen * one.share, one.mirrored(fresnel))
    return found


@dataclass(frozen=True)
class Groove:
    """Cook-Torrance with every bounce; ``m`` and ``fresnel`` as of ``CookTorrance``, which is its first bounce."""

    m: ArrayLike
    fresnel: Fresnel

    def __post_init__(self) -> None:
        as_positive(self.m, "m")

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3): the sum over all bounces."""
        total = cook_torrance(wi, wo, self.m, self.fresnel)
        for bounces in range(2, MOST + 1):
            more = further(wi, wo, self.m, self.fresnel, bounces)
            total = total + more
            if not more.any():
                break
        return total

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw a groove as ``wo`` sees it, and where its first facet is hit, which says the rest.

        wo: (..., 3); u: (..., 4) in [0, 1): place on the facet, two for the facet, its dual.
        Returns wi (..., 3) and the product of F over the bounces, RGB (..., 3): the walk loses no light by itself.
        """
        wo, u = as_samples(wo, u)
        h = visible_facet(wo, self.m, u[..., 1:])
        wi, weight, before = np.zeros(wo.shape), np.zeros(wo.shape), np.zeros(wo.shape[:-1])
        for one in exits(wo, h):
            here = ((u[..., 0] >= before) & (one.share > 0.0))[..., None]  # the last that fits
            wi, weight = np.where(here, one.wi, wi), np.where(here, one.mirrored(self.fresnel), weight)
            before = before + one.share
        return wi, weight * (wo[..., 2:] > 0.0)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...): f cos of perfect mirrors."""
        return Groove(self.m, WHITE).evaluate(wi, wo)[..., 0] * np.maximum(as_directions(wi, "wi")[..., 2], 0.0)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): the first bounce by ``vgroove_albedo``, others by ``bounce_albedos``."""
        more = bounce_albedos(wo, self.m, self.fresnel)[..., 1:, :].sum(axis=-2)
        return vgroove_albedo(wo, self.m, self.fresnel) + more
