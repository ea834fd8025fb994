# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin & Shirley's model: Blinn's highlight with two exponents, over a diffuse part that takes what is left.

With p(h) = sqrt((n_u + 1)(n_v + 1)) / (2 pi) (n.h)^(n_u cos^2 + n_v sin^2), the azimuth being that of h, a density:
f_s = p(h) F / (4 (v.h) max(n.l, n.v)), F = Rs + (1 - Rs)(1 - v.h)^5,
f_d = 28 Rd (1 - Rs) / (23 pi) a(n.l) a(n.v), a(c) = 1 - (1 - c/2)^5.
Fits of measured materials scale f_s by an amplitude and have it over Lambert's f_d = Rd / pi.

Sources:
    Ashikhmin & Shirley 2000, An Anisotropic Phong BRDF Model, JGT 5(2), doi:10.1080/10867651.2000.10487522
    Ngan, Durand & Matusik 2005, Experimental Analysis of BRDF Models, doi:10.2312/EGWR/EGSR05/117-126 (over Lambert)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .anisotropic import turned
from .cook_torrance import as_samples
from .directions import above, as_finite, as_pair, as_range, as_rgb, facet_cosine, half_vector, norm, reflect
from .fresnel import schlick
from .oren_nayar import Lambert
from .quadrature import panels, per_direction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .model import Brdf

HIGHEST = 1e8  # exponent
SPREAD = np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5, 8.5])  # of a lobe, in standard deviations of its angle
GRADED = np.array([0.01, 0.1, 0.3, 1.0, 3.0, 10.0])  # of the angle by which a facet that lights nothing leans


@dataclass(frozen=True)
class AshikhminShirley:
    """``albedo`` Rd and ``specular`` Rs, RGB in [0, 1]; exponents ``n_u`` along the tangent, ``n_v`` across it, >= 0.

    azimuth: of the tangent in the local frame, in radians. amplitude: RGB in [0, 1], of the highlight.
    over_lambert: the diffuse part is Lambert's; ``albedo`` and ``amplitude`` add up to at most 1 in each channel then.
    """

    albedo: ArrayLike
    specular: ArrayLike
    n_u: float
    n_v: float
    azimuth: float = 0.0
    amplitude: ArrayLike = 1.0
    over_lambert: bool = False

    def __post_init__(self) -> None:
        albedo, amplitude = as_rgb(self.albedo, "albedo", 0.0, 1.0), as_rgb(self.amplitude, "amplitude", 0.0, 1.0)
        as_rgb(self.specular, "specular", 0.0, 1.0)
        as_range([self.n_u, self.n_v], "exponents", 0.0, HIGHEST)
        as_finite(self.azimuth, "azimuth")
        if self.over_lambert and np.max(albedo + amplitude) > 1.0 + 1e-12:
            message = f"albedo + amplitude must be at most 1, got {np.max(albedo + amplitude):.15g}"
            raise ValueError(message)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); 0 unless both leave the upper side."""
        wi, wo = self._turned(wi, wo)
        lit, h = above(wi, wo), half_vector(wi, wo)
        vh = np.where(lit, facet_cosine(wi, wo, h), 1.0)
        nearer = np.maximum(np.where(lit, wi[..., 2], 1.0), wo[..., 2])
        lobe = np.where(lit, self.density(h) / (4.0 * vh * nearer), 0.0)
        both = 1.0 if self.over_lambert else 28.0 / 23.0 * entering(wi) * entering(wo)
        below = np.where(lit, both, 0.0) / np.pi
        return lobe[..., None] * self.reflectance(vh) + below[..., None] * self.deep

    def reflectance(self, vh: Floats) -> Floats:
        """The amplitude times F at v.h, (..., 3)."""
        return schlick(vh, np.broadcast_to(self.specular, (3,))) * np.asarray(self.amplitude)

    def density(self, h: Floats) -> Floats:
        """p(h) in 1/sr, (...), of facets above the surface, in the tangent's frame.

        The power is exp(-(n_u x^2 + n_v y^2) log(1 + t^2) / (2 t^2)) with slopes x, y and t^2 = x^2 + y^2: neither the
        cosine nor the ratio of the exponents loses digits near the normal.
        """
        x, y = h[..., 0] / h[..., 2], h[..., 1] / h[..., 2]
        t2 = np.square(np.hypot(x, y))
        with np.errstate(under="ignore", over="ignore"):
            flat = np.log1p(t2) / np.where(t2 > 0, t2, 1.0) + (t2 == 0)
            power = np.exp(-0.5 * (self.n_u * x * x + self.n_v * y * y) * flat)
        return ((self.n_u + 1.0) * (self.n_v + 1.0)) ** 0.5 / (2.0 * np.pi) * power

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi about a facet by p(h), or by the cosine, chosen by u[..., 0]; weight f cos over the density of both.

        Of the highlight alone the weight is F min(1, (n.l)/(n.v)).
        """
        wo, u = as_samples(wo, u)
        below, _ = Lambert(1.0).sample(wo, u)
        mirrored = turned(reflect(turned(wo, self.azimuth), self.facet(u[..., 1:3])), -self.azimuth)
        wi = np.where(u[..., :1] < self._share(), mirrored, below)
        density = self.pdf(wi, wo)[..., None]
        f_cos = self.evaluate(wi, wo) * np.maximum(wi[..., 2:], 0.0)
        return wi, f_cos / np.where(density > 0, density, 1.0)

    def facet(self, u: Floats) -> Floats:
        """h by p(h), in the tangent's frame, (..., 3), for u (..., 2).

        Along (a, b) = (cos / sqrt(n_u + 1), sin / sqrt(n_v + 1)) the exponent is 1/r^2 - 1, r^2 = a^2 + b^2.
        """
        phi = 2.0 * np.pi * u[..., 1]
        a, b = np.cos(phi) / (self.n_u + 1.0) ** 0.5, np.sin(phi) / (self.n_v + 1.0) ** 0.5
        r2 = a * a + b * b
        steep = np.sqrt(np.expm1(-2.0 * r2 * np.log1p(-u[..., 0])) / r2)
        h = np.stack([steep * a, steep * b, np.ones_like(a)], axis=-1)
        return h / norm(h)[..., None]

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...); 0 below the surface, where what is drawn weighs 0."""
        share, (light, view) = self._share(), self._turned(wi, wo)
        lit, h = above(light, view), half_vector(light, view)
        lobe = np.where(lit, self.density(h) / (4.0 * np.where(lit, facet_cosine(light, view, h), 1.0)), 0.0)
        return share * lobe + (1.0 - share) * Lambert(1.0).pdf(wi, wo)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): integral of f cos over wi; of the diffuse part Rd (1 - Rs) a(n.v), or Rd."""
        _, wo = as_pair(wo, wo)
        return self.moment(wo) + self.entered(wo)[..., None] * self.deep

    def moment(self, wo: Floats, power: int = 1, nodes: int = 12) -> Floats:
        """Mean of (A F min(1, (n.l)/(n.v)))^power over facets by p(h), (..., 3); the first is the highlight's albedo.

        By quadrature over the azimuth about the normal (of a circle that p(h) stretches) and the angle t of a facet.
        Toward azimuth p from the view, n.l = n.v at tan t = tan theta cos p, and 0 at tan 2t = -1/(tan theta cos p).
        """
        views = turned(wo, self.azimuth)
        azimuths = np.arctan2(views[..., 1], views[..., 0]).ravel()
        return per_direction(views, lambda cosine, index: self._moment(cosine, float(azimuths[index]), power, nodes))

    def _moment(self, c: float, azimuth: float, power: int, nodes: int) -> Floats:
        s = float(np.sqrt((1.0 - c) * (1.0 + c)))
        grazing = np.arctan2(c, s) * np.concatenate([-GRADED[::-1], [0.0], GRADED])
        sides = np.concatenate([azimuth + side * np.pi / 2 + grazing[np.abs(grazing) < 1.2] for side in (1.0, -1.0)])
        along, across = (self.n_u + 1.0) ** 0.5, (self.n_v + 1.0) ** 0.5
        circle = np.arctan2(across * np.sin(sides), along * np.cos(sides))  # a facet's azimuth before the stretch
        edges = np.unique(np.concatenate([np.arange(-4, 5) * np.pi / 4, circle]))
        psi, psi_weight = panels(np.clip(edges, -np.pi, np.pi), nodes)
        a, b = np.cos(psi) / along, np.sin(psi) / across
        r = np.hypot(a, b)[:, None]
        toward = np.cos(np.arctan2(b, a) - azimuth)[:, None]
        equal, last = np.maximum(np.arctan2(s * toward, c), 0.0), 0.5 * np.arctan2(c, -s * toward)
        spread = np.minimum(SPREAD * r, last)
        t, weight = panels(np.sort(np.concatenate([spread, np.minimum(equal, last), last], axis=-1), axis=-1), nodes)
        cos, sin = np.cos(t), np.sin(t)
        vh = np.clip(c * cos + s * toward * sin, 0.0, 1.0)
        share = np.clip(2.0 * cos * vh / c - 1.0, 0.0, 1.0)
        with np.errstate(under="ignore"):
            density = np.exp((1.0 / (r * r) - 1.0) * np.log(cos)) * sin / (r * r)
        w = self.reflectance(vh) * share[..., None]
        return np.einsum("pt,ptc,p->c", density * weight, w**power, psi_weight) / (2.0 * np.pi)

    def rendered(self, estimator: str, _bound: float) -> Brdf:
        """See ``estimators.rendered``."""
        from .ashikhmin_shirley_fit import closures  # which needs this module

        if estimator not in {"closure", "fit"}:
            return self.evaluate
        return lambda wi, wo: closures(self, *self._turned(wi, wo), fitted=estimator == "fit")

    @property
    def deep(self) -> Floats:
        """Rd (1 - Rs), or Rd, (3,)."""
        under = 1.0 if self.over_lambert else 1.0 - np.asarray(self.specular)
        return np.broadcast_to(np.asarray(self.albedo) * under, (3,))

    def entered(self, w: Floats) -> Floats:
        """``entering``, or over Lambert 1, (...); 0 below the surface."""
        return np.where(w[..., 2] > 0.0, 1.0, 0.0) if self.over_lambert else entering(w)

    def _share(self) -> float:
        """Of samples that are drawn about facets."""
        mirrored, deep = float(np.mean(self.reflectance(np.array(1.0)))), float(np.mean(self.deep))
        return mirrored / (mirrored + deep) if deep > 0 else 1.0

    def _turned(self, wi: ArrayLike, wo: ArrayLike) -> tuple[Floats, Floats]:
        wi, wo = as_pair(wi, wo)
        return turned(wi, self.azimuth), turned(wo, self.azimuth)


def entering(w: Floats) -> Floats:
    """a(c) = 1 - (1 - c/2)^5 of each direction, (...): what enters the surface there; 0 below it."""
    half = 0.5 * np.clip(w[..., 2], 0.0, 1.0)
    return half * (5.0 - half * (10.0 - half * (10.0 - half * (5.0 - half))))
