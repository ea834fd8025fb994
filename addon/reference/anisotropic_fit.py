# SPDX-License-Identifier: GPL-3.0-or-later
"""Anisotropic Cook-Torrance as a mixture of the lobes that Cycles itself has: that of ``cook_torrance_fit``, stretched.

Facets with slopes m_x along x and m_y along y are round facets of slope m, stretched by m_x/m and m_y/m. Views and G1
stretch along; the light's shadowing does not, and is taken as it is where the round surface looks like this one from
the viewer: m^2 = (m_x x)^2 + (m_y y)^2 + m_x m_y z^2 for a view (x, y, z). Each lobe's slopes and tilt stretch too.
With the wider slope up to 0.4 this is within 4.4 % (L1) of the model, where the round mixture is within 4 %; up to 0.6
within 5.8 %, and up to 1 within 16 %. There the light's shadowing, which does not stretch, counts most: what would send
back more light than arrives is taken away (``EXCESS``).

Source of the stretch: Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2), section 5.3.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from . import cook_torrance_fit as fit
from .directions import above, as_directions, as_pair, as_positive, facet_cosine, half_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel


EXCESS = 0.19  # of the light, per slope beyond ROUGH, of a surface that is smooth across its grooves and grazed
ROUGH = 0.6


@dataclass(frozen=True)
class Lobes:
    """The mixture seen from each wo; arrays (..., lobes), vectors (..., lobes, 2).

    ``wide``, ``narrow``: slopes along the ``axis`` and across it. The normal is n + ``lean``, scaled to unit length.
    """

    weight: Floats
    wide: Floats
    narrow: Floats
    axis: Floats
    lean: Floats


def round_slope(wo: Floats, m_x: ArrayLike, m_y: ArrayLike) -> Floats:
    """m of the round surface whose mixture is stretched, (...)."""
    x, y, z = np.moveaxis(wo, -1, 0)
    return np.sqrt(np.square(m_x * x) + np.square(m_y * y) + np.multiply(m_x, m_y) * z**2)


def kept(wo: Floats, m_x: float, m_y: float) -> Floats:
    """Of each lobe's weight, so that a white surface under a white sky stays below 1, (...)."""
    wide, narrow = max(m_x, m_y), min(m_x, m_y)
    excess = EXCESS * max(min(wide, 1.0) - ROUGH, 0.0) * (1.0 - narrow / wide)
    return np.asarray(1.0 - excess * (1.0 - wo[..., 2] ** 2))


def lobes(wo: ArrayLike, m_x: float, m_y: float) -> Lobes:
    """The mixture for views ``wo``.

    The round lobe has slopes k_w m and k_a m within and across the plane of view and a tilt of slope t m. With
    g = (m_x^2 x, m_y^2 y) / hypot(m_x x, m_y y) the stretched one has the covariance
    k_a^2 diag(m_x^2, m_y^2) + (k_w^2 - k_a^2) g g^T, whose axes and roots are the slopes, and leans by -t g.
    Cycles' Metallic BSDF takes slopes of up to 10:1, each at most 1.

    wo: unit vectors (..., 3); m_x, m_y: RMS slopes > 0. Raises ValueError outside these ranges.
    """
    wo = as_directions(wo, "wo")
    as_positive([m_x, m_y], "m_x and m_y")
    m = round_slope(wo, m_x, m_y)
    side = np.hypot(wo[..., 0], wo[..., 1])
    flat = np.stack([side, np.zeros_like(side), wo[..., 2]], axis=-1)
    found = stretched(fit.lobes(flat, m), wo, m_x, m_y, np.minimum(m, 1.0))
    return replace(found, weight=found.weight * kept(wo, m_x, m_y)[..., None])


def stretched(of: fit.Lobes, wo: Floats, m_x: ArrayLike, m_y: ArrayLike, m: Floats) -> Lobes:
    """Lobes of a round surface of slope ``m`` stretched to slopes m_x and m_y, (...)."""
    m, slopes = m[..., None], np.stack(np.broadcast_arrays(m_x, m_y), axis=-1)
    within, across, tilt = of.within / m, of.across / m, of.tilt / m
    seen = wo[..., :2] * slopes
    g = seen * slopes / np.maximum(np.linalg.norm(seen, axis=-1, keepdims=True), 1e-300)
    more = within**2 - across**2
    xx, yy = (across**2 * slopes[..., k, None] ** 2 + more * g[..., k, None] ** 2 for k in (0, 1))
    xy = more * (g[..., 0] * g[..., 1])[..., None]
    middle, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    wide = np.sqrt(middle + np.hypot(half, xy))
    narrow = np.prod(slopes, axis=-1)[..., None] * within * across / wide  # the difference of two roots would cancel
    turn = 0.5 * np.arctan2(xy, half)
    aspect = np.maximum(narrow / wide, fit.NARROWEST) ** 0.5
    area = wide * narrow
    wide, narrow = np.sqrt(area) / aspect, np.sqrt(area) * aspect
    return Lobes(
        of.weight, np.minimum(wide, 1.0), np.minimum(narrow, 1.0),
        np.stack([np.cos(turn), np.sin(turn)], axis=-1), -tilt[..., None] * g[..., None, :],
    )  # fmt: skip


def mixture(wi: ArrayLike, wo: ArrayLike, m_x: float, m_y: float) -> Floats:
    """f cos(theta_i) of the mixture with F = 1, in 1/sr, (...): the sum of weight D G / (4 v.n') over its lobes."""
    wi, wo = as_pair(wi, wo)
    return sent(wi, wo, lobes(wo, m_x, m_y))


def sent(wi: Floats, wo: Floats, of: Lobes) -> Floats:
    """f cos(theta_i) of the lobes that each wo sees, in 1/sr, (...)."""
    h = half_vector(wi, wo)
    up = np.ones((*of.lean.shape[:-1], 1))
    n = np.concatenate([of.lean, up], axis=-1) / np.sqrt(1.0 + np.sum(of.lean**2, axis=-1, keepdims=True))
    T = np.concatenate([of.axis, 0.0 * up], axis=-1)
    T = T - n * np.sum(T * n, axis=-1, keepdims=True)
    T = T / np.linalg.norm(T, axis=-1, keepdims=True)
    frame = np.stack([T, np.cross(n, T), n], axis=-2)
    light, view, facet = (tuple(np.moveaxis(np.einsum("...kij,...j->...ki", frame, w), -1, 0)) for w in (wi, wo, h))
    found = of.weight * fit.smith_lobe(light, view, facet, of.wide, of.narrow)
    return np.where(above(wi, wo), np.sum(found, axis=-1), 0.0)


def anisotropic_fit(wi: ArrayLike, wo: ArrayLike, m_x: float, m_y: float, fresnel: Fresnel) -> Floats:
    """The BRDF that ``fit`` renders, F(v.h) mixture / (n.l), in 1/sr, RGB (..., 3). Not reciprocal."""
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    F = fresnel(np.where(lit, facet_cosine(wi, wo, half_vector(wi, wo)), 1.0))
    return F * np.where(lit, mixture(wi, wo, m_x, m_y) / np.where(lit, wi[..., 2], 1.0), 0.0)[..., None]
