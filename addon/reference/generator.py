# SPDX-License-Identifier: GPL-3.0-or-later
"""A microfacet BRDF of any isotropic distribution of facets, over Lambert.

Sources:
    Ashikhmin, Premoze & Shirley 2000, A Microfacet-based BRDF Generator, doi:10.1145/344779.344814
    Cook & Torrance 1982, doi:10.1145/357290.357293 (the V-groove's G)
    Heitz & d'Eon 2014, Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals, EGSR
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance import as_samples, cook_torrance
from .cook_torrance_fit import cook_torrance_fit
from .directions import above, as_directions, as_pair, as_rgb, dot, facet_cosine, half_vector, norm, reflect
from .distributions import smith_g, vgroove_g, vgroove_g1
from .facet_distribution import POINTS
from .generator_fit import beckmann_terms, native_fresnel
from .oren_nayar import Lambert
from .quadrature import panels

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .facet_distribution import Distribution
    from .fresnel import Fresnel
    from .model import Brdf

# Panels of facet angles, in degrees, beside those that the distribution and the view ask for
LADDER = np.radians([0.0, 0.5, 2.0, 5.0, 10.0, 18.0, 27.0, 36.0, 45.0, 54.0, 63.0, 72.0, 81.0, 90.0])
NODES = 16


@dataclass(frozen=True)
class Generator:
    """f = albedo/pi + specular F(v.h) D(h) G / (4 (n.l)(n.v)), G the V-groove's.

    albedo, specular: RGB in [0, 1]. distribution: D, scaled to unit projected area. fresnel: as ``CookTorrance``.
    """

    albedo: ArrayLike
    specular: ArrayLike
    distribution: Distribution
    fresnel: Fresnel

    def __post_init__(self) -> None:
        as_rgb(self.albedo, "albedo", 0.0, 1.0)
        as_rgb(self.specular, "specular", 0.0, 1.0)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); 0 unless both leave the upper side."""
        return Lambert(self.albedo).evaluate(wi, wo) + self.lobe(wi, wo)

    def lobe(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """The specular part of f in 1/sr, (..., 3)."""
        wi, wo = as_pair(wi, wo)
        lit = above(wi, wo)
        h = half_vector(wi, wo)
        ni, no = np.where(lit, wi[..., 2], 1.0), np.where(lit, wo[..., 2], 1.0)
        F = self.fresnel(np.where(lit, facet_cosine(wi, wo, h), 1.0)) * np.asarray(self.specular)
        return F * np.where(lit, self.distribution(h) * (vgroove_g(wi, wo) / ni) / (4.0 * no), 0.0)[..., None]

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi as a facet mirrors it or by the cosine, chosen by u[..., 0]; weight f cos over both densities."""
        wo, u = as_samples(wo, u)
        below, _ = Lambert(1.0).sample(wo, u)
        mirrored = reflect(wo, self.visible_facet(wo, u[..., 1:]))
        wi = np.where(u[..., :1] < self._share, mirrored, below)
        density = self.pdf(wi, wo)[..., None]
        f_cos = self.evaluate(wi, wo) * np.maximum(wi[..., 2:], 0.0)
        return wi, f_cos / np.where(density > 0, density, 1.0)

    def visible_facet(self, wo: Floats, u: Floats) -> Floats:
        """A facet as ``Distribution.draw`` draws it, or its dual, whichever wo rather sees (``cook_torrance``)."""
        sin2, _ = self.distribution.draw(u[..., 0])
        sin, phi = np.sqrt(sin2), 2.0 * np.pi * u[..., 1]
        h = np.stack([sin * np.cos(phi), sin * np.sin(phi), np.sqrt(1.0 - sin2)], axis=-1)
        h = h / norm(h)[..., None]
        dual = h * [-1.0, -1.0, 1.0]
        seen, dual_seen = np.maximum(dot(wo, h), 0.0), np.maximum(dot(wo, dual), 0.0)
        return np.where((u[..., 2] * (seen + dual_seen) < seen)[..., None], h, dual)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...); 0 below the surface, where what is drawn weighs 0."""
        wi, wo = as_pair(wi, wo)
        lit, h = above(wi, wo), half_vector(wi, wo)
        no = np.where(lit, wo[..., 2], 1.0)
        facets = vgroove_g1(wo, h) * self.distribution.drawn_density(h) / (4.0 * no)
        return self._share * np.where(lit, facets, 0.0) + (1.0 - self._share) * Lambert(1.0).pdf(wi, wo)

    @property
    def _share(self) -> float:
        """Of samples that are drawn as facets mirror them: at least a half."""
        albedo, lobe = float(np.mean(np.asarray(self.albedo))), float(np.mean(np.asarray(self.specular)))
        return max(0.5, lobe / (lobe + albedo)) if albedo > 0.0 else 1.0

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): integral of f cos over wi, by quadrature over facets."""
        wo = as_directions(wo, "wo")
        flat = wo.reshape(-1, 3)
        lobe = np.array([self._lobe_albedo(min(float(z), 1.0)) if z > 0 else np.zeros(3) for z in flat[:, 2]])
        return Lambert(self.albedo).directional_albedo(wo) + lobe.reshape(wo.shape) * np.asarray(self.specular)

    def _lobe_albedo(self, no: float) -> Floats:
        """Integral of F D G (v.h)/(n.v) over facets at angle t and azimuth p: v.h = A + B cos p, dl = 4 (v.h) dh.

        n.l = 2 (n.h)(v.h) - n.v. What is lit, and G, change where v.h is n.v over 2 (n.h), or over n.h, 2 (n.h)(n.v),
        or 2 (n.h)(n.v) / (4 (n.h)^2 - 1).
        """
        side = float(np.sqrt((1.0 - no) * (1.0 + no)))
        t, t_weight = panels(self._angles(float(np.arctan2(side, no))), NODES)
        nh, A, B = np.cos(t), np.cos(t) * no, np.sin(t) * side
        steep = np.maximum(4.0 * nh * nh - 1.0, 1e-300)
        kinks = [no / (2.0 * nh), no / nh, 2.0 * nh * no, 2.0 * nh * no / steep]
        kinks += [np.full_like(nh, kink) for kink in self.fresnel.kinks]
        with np.errstate(over="ignore"):  # head-on B is 0
            cosines = np.clip((np.stack(kinks, axis=-1) - A[:, None]) / np.maximum(B, 1e-300)[:, None], -1.0, 1.0)
        lit = np.arccos(cosines[:, :1])
        ends = np.arccos(cosines)
        edges = np.sort(np.concatenate([np.zeros_like(lit), lit * 0.5, np.minimum(ends, lit)], axis=-1), axis=-1)
        p, p_weight = panels(edges, NODES)
        vh = A[:, None] + B[:, None] * np.cos(p)
        lower = np.minimum(2.0 * nh[:, None] * vh - no, no)
        G = np.clip(2.0 * nh[:, None] * lower / np.maximum(vh, 1e-300), 0.0, 1.0)
        D = self.distribution.density(np.square(np.sin(t)), nh) * np.sin(t) * t_weight
        F = self.fresnel(np.clip(vh, 0.0, 1.0))
        F = np.broadcast_to(F if F.ndim == 3 else F[..., None], (*vh.shape, 3))
        return np.asarray(2.0 / no * np.einsum("t,tp,tpc->c", D, G * vh * p_weight, F))

    def _angles(self, theta: float) -> Floats:
        """Edges of panels of facet angles: where the distribution varies, and where the view's kinks begin or end."""
        of = self.distribution
        own = np.arcsin(np.sqrt(of.bins[:: len(of.bins) // 16]))
        drawn = [np.linspace(0.0, 1.0, len(one.numbers)) for one in of.terms if one.kind == POINTS]
        points = [knots**2 * np.pi / 2 for knots in drawn]
        quarter = np.pi / 2
        view = [theta, quarter - theta, quarter / 2.0, np.pi / 3]
        view += [(quarter + sign * theta) / part for part in (2.0, 3.0) for sign in (1.0, -1.0)]
        return np.unique(np.clip(np.concatenate([LADDER, own, *points, view]), 0.0, quarter))

    def rendered(self, estimator: str, _bound: float) -> Brdf:
        """See ``estimators.rendered``. ``fit``, ``closure``: Lambert, and native lobes for each Beckmann term."""
        if estimator not in {"fit", "closure"}:
            return self.evaluate
        albedo, terms = self.albedo, beckmann_terms(self.distribution)
        share, F = native_fresnel(self.fresnel, np.asarray(self.specular))

        def lobe(wi: ArrayLike, wo: ArrayLike, m: float) -> Floats:
            if estimator == "fit":
                return cook_torrance_fit(wi, wo, m, F)
            return cook_torrance(wi, wo, m, F, smith_g(wi, wo, m))

        return lambda wi, wo: sum(
            (weight * share * lobe(wi, wo, m) for weight, m in terms), Lambert(albedo).evaluate(wi, wo)
        )
