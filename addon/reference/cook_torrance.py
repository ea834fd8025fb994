# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance: facets of a Beckmann distribution, cut as V-grooves, each a Fresnel mirror.

Sources:
    Cook & Torrance 1982, A Reflectance Model for Computer Graphics, doi:10.1145/357290.357293
    Heitz & d'Eon 2014, Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals, EGSR
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import quadrature
from .directions import (
    TANGENT,
    above,
    as_directions,
    as_pair,
    as_positive,
    as_range,
    dot,
    facet_cosine,
    half_vector,
    reflect,
)
from .distributions import beckmann_d, smith_g, vgroove_g, vgroove_g1

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel
    from .model import Brdf


def cook_torrance(
    wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, G: ArrayLike | None = None, *,
    m_y: ArrayLike | None = None,
) -> Floats:  # fmt: skip
    """The BRDF f = F(v.h) D(h) G(l, v, h) / (4 (n.l)(n.v)), in 1/sr, RGB.

    wi, wo: unit vectors (..., 3), broadcast. m: RMS slope > 0, broadcasts against (...).
    fresnel: ``Schlick``, ``Dielectric`` or ``Conductor``. G: shadowing to use in place of ``vgroove_g(wi, wo)``.
    m_y: the slope along y, if not that along x.
    Returns float64 (..., 3); 0 unless both directions leave the upper side of the surface.
    Raises ValueError if a vector is not of unit length or m not > 0.
    Source: Cook & Torrance 1982, with 1/4 in place of their 1/pi and D scaled to unit projected area
    (docs/errata.md); the 1/4 is Torrance & Sparrow's Jacobian of reflection.
    """
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    h = half_vector(wi, wo)
    D = beckmann_d(h, m, m_y)
    G = vgroove_g(wi, wo) if G is None else G
    ni, no = np.where(lit, wi[..., 2], 1.0), np.where(lit, wo[..., 2], 1.0)
    F = fresnel(np.where(lit, facet_cosine(wi, wo, h), 1.0))
    return F * np.where(lit, D * (G / ni) / (4.0 * no), 0.0)[..., None]


def visible_facet(wo: Floats, m: ArrayLike, u: Floats, m_y: ArrayLike | None = None) -> Floats:
    """Facet normals of a V-groove surface as ``wo`` sees them, one for each ``u``.

    Draws h by D(h) (n.h), then swaps it for the groove's other side h' = (-hx, -hy, hz) with probability
    (v.h')+ / ((v.h)+ + (v.h')+). The density is G1(v, h) D(h) (v.h)+ / (n.v).

    wo: unit vectors (..., 3); u: (..., 3) in [0, 1): two for the facet, one for its dual. Returns (..., 3).
    m_y: the slope along y, if not that along x.
    Source: Heitz & d'Eon 2014, supplemental material (V-cavity model).
    """
    radius, phi = np.sqrt(-np.log1p(-u[..., 0])), 2.0 * np.pi * u[..., 1]
    x, y = (
        as_positive(m, "m") * radius * np.cos(phi),
        as_positive(m if m_y is None else m_y, "m_y") * radius * np.sin(phi),
    )
    h = np.stack([x, y, np.ones_like(x)], axis=-1) / np.sqrt(1.0 + x**2 + y**2)[..., None]
    dual = h * [-1.0, -1.0, 1.0]
    seen, dual_seen = np.maximum(dot(wo, h), 0.0), np.maximum(dot(wo, dual), 0.0)
    keep = u[..., 2] * (seen + dual_seen) < seen
    return np.where(keep[..., None], h, dual)


def reflected_by(h: Floats, wo: Floats, fresnel: Fresnel) -> tuple[Floats, Floats]:
    """What facets drawn by ``visible_facet`` send back: wi (..., 3) and the weight F G2 / G1 (..., 3)."""
    wi = reflect(wo, h)
    G1 = vgroove_g1(wo, h)
    G2 = np.minimum(G1, vgroove_g1(wi, h))
    share = np.where(above(wi, wo) & (G1 > 0), G2 / np.where(G1 > 0, G1, 1.0), 0.0)
    return wi, fresnel(dot(wo, h)) * share[..., None]


def visible_density(wi: Floats, wo: Floats, m: ArrayLike, m_y: ArrayLike | None = None) -> Floats:
    """Density of wi in 1/sr, (...), where it is drawn so: G1(v, h) D(h) / (4 (n.v)); 0 below the surface."""
    h = half_vector(wi, wo)
    no = np.where(above(wi, wo), wo[..., 2], 1.0)
    return np.where(above(wi, wo), vgroove_g1(wo, h) * beckmann_d(h, m, m_y) / (4.0 * no), 0.0)


@dataclass(frozen=True)
class CookTorrance:
    """Rough reflection; ``m`` RMS slope > 0, ``fresnel`` one of ``Schlick``, ``Dielectric``, ``Conductor``."""

    m: ArrayLike
    fresnel: Fresnel

    def __post_init__(self) -> None:
        as_positive(self.m, "m")

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); see ``cook_torrance``."""
        return cook_torrance(wi, wo, self.m, self.fresnel)

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi for each ``wo``: a facet by ``visible_facet``, then a mirror about it.

        wo: (..., 3); u: (..., 4) in [0, 1): lobe (not used), two for the facet, its dual.
        Returns wi (..., 3) and weight = f cos / pdf = F G2 / G1 (..., 3), 0 where wi leaves below the surface.
        Source: Heitz & d'Eon 2014, eq. 19 with the V-cavity's G.
        """
        wo, u = as_samples(wo, u)
        return reflected_by(visible_facet(wo, self.m, u[..., 1:]), wo, self.fresnel)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...): G1(v, h) D(h) / (4 (n.v)); 0 below the surface.

        What is missing from 1 over the hemisphere are draws that leave below it and weigh 0.
        """
        return visible_density(*as_pair(wi, wo), self.m)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): integral of f cos over wi, by quadrature over facet slopes."""
        return quadrature.vgroove_albedo(wo, self.m, self.fresnel)

    def rendered(self, estimator: str, bound: float) -> Brdf:
        """See ``estimators.rendered``."""
        from .cook_torrance_fit import cook_torrance_fit, cook_torrance_hybrid  # which needs this module

        m, F = self.m, self.fresnel
        if estimator == "fit":
            return lambda wi, wo: cook_torrance_fit(wi, wo, m, F)
        if estimator == "closure":
            return lambda wi, wo: cook_torrance(wi, wo, m, F, smith_g(wi, wo, m))
        if estimator == "hybrid":
            return lambda wi, wo: cook_torrance_hybrid(wi, wo, m, F, bound)
        return self.evaluate


@dataclass(frozen=True)
class Smooth:
    """A plain interface, the limit m = 0: one mirror direction. f and pdf of a Dirac delta are given as 0."""

    fresnel: Fresnel

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """0 everywhere, (..., 3): all light is in ``sample``'s single direction."""
        return np.zeros(as_pair(wi, wo)[0].shape)

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """The mirror direction (..., 3) and its weight F(n.v), (..., 3)."""
        wo, _ = as_samples(wo, u)
        lit = wo[..., 2] > TANGENT
        return wo * [-1.0, -1.0, 1.0], self.fresnel(wo[..., 2]) * lit[..., None]

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """0 everywhere, (...)."""
        return np.zeros(as_pair(wi, wo)[0].shape[:-1])

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """F(n.v), (..., 3)."""
        wo = as_directions(wo, "wo")
        return self.fresnel(wo[..., 2]) * (wo[..., 2:] > TANGENT)


def as_samples(wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
    """Directions and their random numbers, broadcast to (..., 3) and (..., 4); ValueError names what is wrong."""
    wo, u = as_directions(wo, "wo"), as_range(u, "u", 0.0, 1.0)
    if (u >= 1.0).any():
        message = "u must be in [0, 1), got 1"
        raise ValueError(message)
    if u.ndim == 0 or u.shape[-1] != 4:
        message = f"u must have shape (..., 4), got {u.shape}"
        raise ValueError(message)
    try:
        shape = np.broadcast_shapes(wo.shape[:-1], u.shape[:-1])
    except ValueError as error:
        message = f"wo and u must broadcast, got shapes {wo.shape} and {u.shape}"
        raise ValueError(message) from error
    return np.broadcast_to(wo, (*shape, 3)), np.broadcast_to(u, (*shape, 4))
