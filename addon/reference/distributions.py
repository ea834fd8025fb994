# SPDX-License-Identifier: GPL-3.0-or-later
"""D and G: how the facets of a rough surface are turned, and how they hide each other.

Sources:
    Cook & Torrance 1982, A Reflectance Model for Computer Graphics, ACM TOG 1(1), doi:10.1145/357290.357293
    Torrance & Sparrow 1967, Theory for Off-Specular Reflection From Roughened Surfaces, JOSA 57(9)
    Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces, EGSR
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .directions import above, as_directions, as_pair, as_positive, dot, facet_cosine, half_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats


def beckmann_d(h: ArrayLike, m: ArrayLike, m_y: ArrayLike | None = None) -> Floats:
    """Density of facet normals of a Gaussian rough surface, in 1/sr.

    D(h) = exp(-tan^2(t) / m^2) / (pi m^2 cos^4(t)), t between h and the surface normal;
    0 below the surface. Scaled so that D cos(t) integrates to 1 over the hemisphere.
    With another slope along y: exp(-(h_x / m)^2 / h_z^2 - (h_y / m_y)^2 / h_z^2) / (pi m m_y cos^4(t)).

    h: facet normals, unit length, shape (..., 3), local frame.
    m: RMS facet slope, dimensionless, > 0; broadcasts against ``h[..., 0]``. m_y: along y, that of ``m`` if left out.
    Returns float64 of the broadcast shape.
    Raises ValueError if an m is not > 0 (a mirror has no density) or h does not end in 3.
    Source: Walter et al. 2007, eq. 25, with m of Cook & Torrance 1982 for their alpha; two slopes: Heitz 2014, eq. 80.

    >>> float(beckmann_d([0, 0, 1], m=0.5))
    1.2732395447351628
    """
    h = as_directions(h, "h")
    m = as_positive(m, "m")
    m_y = m if m_y is None else as_positive(m_y, "m_y")
    up = h[..., 2] > 1e-8  # nearer the horizon exp() is exactly 0 in float64 for every m < 1e6
    z = np.where(up, h[..., 2], 1.0)
    with np.errstate(under="ignore", over="ignore"):
        # 1 / z^2 - 1 would cancel for narrow lobes. One slope is scaled to the other, so that equal ones are one.
        tan2 = np.square(h[..., 0] / z) + np.square(h[..., 1] / z * (m / m_y))
        return np.where(up, np.exp(-tan2 / m / m) / (np.pi * m * m_y * z**4), 0.0)


def vgroove_g(wi: ArrayLike, wo: ArrayLike) -> Floats:
    """Share of a symmetric V-groove's facet that is both lit and seen, dimensionless.

    G = min(1, 2 (n.h)(n.v) / (v.h), 2 (n.h)(n.l) / (v.h)); 0 unless both directions leave the upper side.

    wi, wo: unit vectors (..., 3), local frame, broadcast against each other. Returns float64 (...).
    Raises ValueError if a vector is not of unit length or does not end in 3.
    Source: Cook & Torrance 1982, eq. for G after Torrance & Sparrow 1967.

    >>> float(vgroove_g([0, 0, 1], [0, 0, 1]))
    1.0
    """
    wi, wo = as_pair(wi, wo)
    h = half_vector(wi, wo)
    lower = np.minimum(wi[..., 2], wo[..., 2])
    lit_and_seen = above(wi, wo)
    vh = np.where(lit_and_seen, facet_cosine(wi, wo, h), 1.0)
    return np.where(lit_and_seen, np.minimum(1.0, 2.0 * h[..., 2] * lower / vh), 0.0)


def vgroove_g1(wo: ArrayLike, h: ArrayLike) -> Floats:
    """Share of a V-groove's facet ``h`` that ``wo`` sees: G1 = min(1, 2 (n.h)(n.v) / (v.h)), 0 for v.h <= 0.

    wo, h: unit vectors (..., 3), broadcast. Returns float64 (...). Raises ValueError as ``vgroove_g``.
    Source: Torrance & Sparrow 1967; as a masking function Heitz & d'Eon 2014, section 3.
    """
    wo, h = as_directions(wo, "wo"), as_directions(h, "h")
    vh = dot(wo, h)
    seen = (vh > 0) & (h[..., 2] > 0) & (wo[..., 2] > 0)
    return np.where(seen, np.minimum(1.0, 2.0 * h[..., 2] * wo[..., 2] / np.where(seen, vh, 1.0)), 0.0)


def smith_lambda(w: ArrayLike, m: ArrayLike, m_y: ArrayLike | None = None) -> Floats:
    """Smith's Lambda of a Beckmann surface in the rational form that renderers use, dimensionless.

    With a = 1 / (m tan t): (1 - 1.259 a + 0.396 a^2) / (3.535 a + 2.181 a^2) for a < 1.6, else 0.

    w: unit vectors (..., 3); m: RMS slope > 0, broadcasts against ``w[..., 0]``. Returns float64.
    m_y: the slope along y, if not that along x: m tan t is then hypot(m w_x, m_y w_y) / w_z.
    Source: Walter et al. 2007, eq. 15 fits G1; this is (1 - G1) / G1 of that fit.
    """
    w = as_directions(w, "w")
    m = as_positive(m, "m")
    aspect = 1.0 if m_y is None else as_positive(m_y, "m_y") / m
    m_tan = m * np.hypot(w[..., 0], w[..., 1] * aspect) / np.maximum(np.abs(w[..., 2]), 1e-100)
    rough = m_tan * 1.6 > 1.0
    a = 1.0 / np.where(rough, m_tan, 1.0)
    return np.where(rough, (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)


def smith_g(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, m_y: ArrayLike | None = None) -> Floats:
    """Height-correlated Smith masking-shadowing of Cycles' own Beckmann closure, dimensionless.

    G = 1 / (1 + Lambda(wi) + Lambda(wo)); 0 unless both directions leave the upper side.

    wi, wo: unit vectors (..., 3), broadcast; m: RMS slope > 0, m_y: along y, if another. Returns float64 (...).
    Raises ValueError as ``vgroove_g``, and if m is not > 0.
    Source: Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2), eq. 99; Lambda: ``smith_lambda``.
    """
    wi, wo = as_pair(wi, wo)
    return np.where(above(wi, wo), 1.0 / (1.0 + smith_lambda(wi, m, m_y) + smith_lambda(wo, m, m_y)), 0.0)
