# SPDX-License-Identifier: GPL-3.0-or-later
"""Glass: the facets of a V-groove surface reflect and refract, by the exact Fresnel term of each facet.

Sources:
    Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces, EGSR
    Heitz & d'Eon 2014, Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals, EGSR
    Born & Wolf, Principles of Optics, 7th ed., sections 1.5.2 (Fresnel) and 7.6.1 (plates)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import quadrature
from .cook_torrance import CookTorrance, as_samples, visible_facet
from .directions import TANGENT, add_product, as_directions, as_pair, as_positive, as_rgb, dot, norm, reflect, through
from .distributions import beckmann_d, vgroove_g1
from .fresnel import Dielectric

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats

ETA_RANGE = (1e-3, 1e3)
NORMAL = np.array([0.0, 0.0, 1.0])


def refract(wo: Floats, h: Floats, eta: ArrayLike) -> Floats:
    """Direction on the other side of facet ``h`` to which light from ``wo`` is refracted, by Snell's law.

    l = ((c - g) h - wo) / eta with c = v.h and g^2 = eta^2 + c^2 - 1, which is eta |l.h|. Where g^2 <= 0 there is
    none: what is returned is wo turned over.

    wo, h: unit vectors (..., 3) with v.h > 0. eta: index over there / index on wo's side. Returns (..., 3).
    Source: Walter et al. 2007, eq. 40.
    """
    c = np.maximum(dot(wo, h), 0.0)
    g = refracted_cosine(c, eta)
    bend = np.where(g > 0, -_beyond(eta) / np.where(g > 0, c + g, 1.0), 0.0)  # c - g itself would cancel
    there = bend[..., None] * h - wo
    return there / norm(there)[..., None]


def refracted_cosine(c: Floats, eta: ArrayLike) -> Floats:
    """g = eta |l.h| for c = v.h, (...): 0 in total reflection."""
    return np.sqrt(np.maximum(add_product(_beyond(eta), c, c), 0.0))


def refraction_facet(wi: Floats, wo: Floats, eta: ArrayLike) -> tuple[Floats, Floats]:
    """The facet h that refracts between ``wi`` below and ``wo`` above, (..., 3), and |wo + eta wi|, (...).

    h is along +-(wo + eta wi), on the side of wo: for eta > 1 the sum points down. The normal and 0 where no facet
    does: wi not below or wo not above, eta = 1 (which bends nothing), v.h <= 0 or l.h >= 0.
    Source: Walter et al. 2007, eq. 16.
    """
    eta = np.asarray(eta, dtype=np.float64)
    both = add_product(wo, eta[..., None], wi) * np.sign(1.0 - eta)[..., None]
    length = norm(both)
    h = np.where((length > 0)[..., None], both / np.where(length > 0, length, 1.0)[..., None], NORMAL)
    found = through(wi, wo) & (length > 0) & (dot(wo, h) > 0) & (dot(wi, h) < 0)
    return np.where(found[..., None], h, NORMAL), np.where(found, length, 0.0)


def fresnel_transmittance(c: Floats, g: Floats, eta: ArrayLike) -> Floats:
    """1 - F of one facet without cancelling, from c = v.h > 0 and g = eta |l.h| > 0, (...).

    2 c g (1 / (c + g)^2 + eta^2 / (eta^2 c + g)^2), the mean over both polarisations.
    Source: Born & Wolf 1.5.2, eq. 37.

    >>> round(float(fresnel_transmittance(1.0, 1.5, 1.5)), 15)
    0.96
    """
    eta = np.asarray(eta, dtype=np.float64)
    return 2.0 * c * g * (1.0 / np.square(c + g) + np.square(eta / (eta * eta * c + g)))


def glass_btdf(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, eta: ArrayLike, G: ArrayLike | None = None) -> Floats:
    """The BTDF of a rough interface, in 1/sr, (...).

    f = (1 - F) D G2t (v.h) |l.h| / ((n.v) |n.l|) * eta^2 / ((v.h) + eta (l.h))^2,
    G2t = max(G1(v) + G1(l) - 1, 0): a groove hides its foot from above and its crest from below.

    This is Walter's value times eta^2, as radiance over the square of the index is what an interface conserves: R + T
    is then the share of a uniform sky that arrives. Cycles leaves that factor out too.

    wi: unit vectors (..., 3) to the light below, wo: to the viewer above. m: RMS slope > 0. eta: index below over
    above, > 0. G: shadowing to use in place of ``transmitted_g``.
    Returns float64 (...); 0 where no facet refracts one into the other, and for eta = 1, a delta.
    Source: Walter et al. 2007, eqs. 16, 17 and 21; G2t: Heitz & d'Eon 2014, supplemental material (V-cavity model).
    """
    wi, wo = as_pair(wi, wo)
    eta = as_positive(eta, "eta", *ETA_RANGE)
    h, length = refraction_facet(wi, wo, eta)
    found = length > 0
    c, ct = np.where(found, dot(wo, h), 1.0), np.where(found, -dot(wi, h), 1.0)
    ni, no = np.where(found, -wi[..., 2], 1.0), np.where(found, wo[..., 2], 1.0)
    T = fresnel_transmittance(c, eta * ct, eta)
    G = transmitted_g(wi, wo, h) if G is None else np.asarray(G)
    jacobian = np.square(eta / np.where(found, length, 1.0))
    return np.where(found, T * beckmann_d(h, m) * (G * (c / no)) * (ct / ni) * jacobian, 0.0)


def transmitted_g(wi: Floats, wo: Floats, h: Floats) -> Floats:
    """G2t = max(G1(v) + G1(l) - 1, 0), (...): the share of facet ``h`` that wo sees from above and wi from below."""
    seen, lit = vgroove_g1(wo, h), vgroove_g1(-wi, h)
    return np.maximum(np.minimum(seen, lit) - (1.0 - np.maximum(seen, lit)), 0.0)  # a G1 next to 0 keeps its digits


def pane(F: Floats) -> Floats:
    """Reflectance of a thin loss-less sheet whose faces reflect ``F``: F + (1-F)^2 F + (1-F)^2 F^3 ... = 2F/(1+F)."""
    return 2.0 * F / (1.0 + F)


@dataclass(frozen=True)
class Pane:
    """F of a thin sheet of index ``eta`` in air: both its faces, with all reflections between them."""

    eta: float

    def __call__(self, cos: ArrayLike) -> Floats:
        return pane(Dielectric(self.eta)(cos))

    @property
    def kinks(self) -> tuple[float, ...]:
        return Dielectric(self.eta).kinks


@dataclass(frozen=True)
class Glass:
    """A transparent medium: ``m`` RMS slope >= 0 (0: smooth), ``eta`` index inside over outside.

    Seen from inside it is ``Glass(m, 1 / eta)``, normal and all turned over. ``tint`` in [0, 1], one number or linear
    RGB, multiplies what is transmitted. ``thin``: a sheet in place of an interface, every facet a pane that lets
    light through without turning it.

    ``wi`` may lie below the surface, ``wo`` lies above. What goes one way only (m = 0, a sheet's straight light, all
    refraction at eta = 1) is a Dirac delta: f and pdf give it as 0, ``sample`` draws it.
    """

    m: float
    eta: float
    tint: ArrayLike = 1.0
    thin: bool = False

    def __post_init__(self) -> None:
        for value, name in ((self.m, "m"), (self.eta, "eta")):
            if np.ndim(value):
                message = f"{name} must be one number, got shape {np.shape(value)}"
                raise ValueError(message)
        if self.m != 0:
            as_positive(self.m, "m")
        as_positive(self.eta, "eta", *ETA_RANGE)
        as_rgb(self.tint, "tint", 0.0, 1.0)

    @property
    def fresnel(self) -> Dielectric | Pane:
        """F of one facet."""
        return Pane(self.eta) if self.thin else Dielectric(self.eta)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3): Cook-Torrance for wi above, ``glass_btdf`` below."""
        wi, wo = as_pair(wi, wo)
        if self.m == 0:
            return np.zeros(wi.shape)
        reflected = CookTorrance(self.m, self.fresnel).evaluate(wi, wo)
        if self.thin:
            return reflected
        return reflected + self._tint() * glass_btdf(wi, wo, self.m, self.eta)[..., None]

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi for each ``wo``: a facet by ``visible_facet``, which reflects with probability F, else refracts.

        wo: (..., 3); u: (..., 4) in [0, 1): reflection or refraction, two for the facet, its dual.
        Returns wi (..., 3) and weight = f |cos| / pdf (..., 3): G2/G1, or tint G2t/G1; of a sheet's straight light
        the tint alone. 0 where light leaves on the wrong side.
        Source: Heitz & d'Eon 2014, eq. 19 with the V-cavity's G; Walter et al. 2007, section 5.3.
        """
        wo, u = as_samples(wo, u)
        h = visible_facet(wo, self.m, u[..., 1:]) if self.m > 0 else np.broadcast_to(NORMAL, wo.shape)
        seen = wo[..., 2] > TANGENT
        mirrored = u[..., 0] < self.fresnel(np.maximum(dot(wo, h), 0.0))[..., 0]
        up, down = reflect(wo, h), -wo if self.thin else refract(wo, h, self.eta)
        G1 = np.where(seen, vgroove_g1(wo, h), 1.0)
        G2 = np.where(up[..., 2] > TANGENT, np.minimum(G1, vgroove_g1(up, h)), 0.0)
        G2t = G1 if self.thin else np.where(down[..., 2] < -TANGENT, transmitted_g(down, wo, h), 0.0)
        share = np.where(mirrored, G2, G2t) * seen / np.where(G1 > 0, G1, 1.0)
        tint = np.where(mirrored[..., None], 1.0, self._tint())
        return np.where(mirrored[..., None], up, down), tint * share[..., None]

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...), without deltas.

        Above: F G1 D / (4 (n.v)). Below: (1 - F) G1 D (v.h) |l.h| / (n.v) eta^2 / ((v.h) + eta (l.h))^2.
        """
        wi, wo = as_pair(wi, wo)
        if self.m == 0:
            return np.zeros(wi.shape[:-1])
        half = wi + wo
        cosine = np.clip(0.5 * norm(half), 0.0, 1.0)  # v.h of the facet that mirrors
        reflected = self.fresnel(cosine)[..., 0] * CookTorrance(self.m, self.fresnel).pdf(wi, wo)
        if self.thin:
            return reflected
        h, length = refraction_facet(wi, wo, self.eta)
        found = length > 0
        c, ct = np.where(found, dot(wo, h), 1.0), np.where(found, -dot(wi, h), 1.0)
        T = fresnel_transmittance(c, self.eta * ct, self.eta)
        jacobian = np.square(self.eta / np.where(found, length, 1.0))
        seen = vgroove_g1(wo, h) * beckmann_d(h, self.m) / np.where(found, wo[..., 2], 1.0)
        return reflected + np.where(found, T * seen * c * ct * jacobian, 0.0)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Share of a uniform world that reaches ``wo``, (..., 3): ``reflectance`` + ``transmittance``."""
        return self.reflectance(wo) + self.transmittance(wo)

    def reflectance(self, wo: ArrayLike) -> Floats:
        """Share of a uniform sky above that reaches ``wo``, (..., 3), good to 1e-6."""
        wo = as_directions(wo, "wo")
        if self.m == 0:
            return self.fresnel(np.maximum(wo[..., 2], 0.0)) * (wo[..., 2:] > TANGENT)
        return quadrature.vgroove_albedo(wo, self.m, self.fresnel)

    def transmittance(self, wo: ArrayLike) -> Floats:
        """Share of a uniform world below that reaches ``wo``, (..., 3), good to 1e-6."""
        wo = as_directions(wo, "wo")
        if self.m == 0:
            return self._tint() * (1.0 - self.fresnel(np.maximum(wo[..., 2], 0.0))) * (wo[..., 2:] > TANGENT)
        if self.thin:
            return self._tint() * quadrature.vgroove_mean(wo, self.m, self.eta, lambda F, _R, _T: 1.0 - pane(F))
        return self._tint() * quadrature.vgroove_mean(wo, self.m, self.eta, lambda F, _R, T: (1.0 - F) * T)

    def _tint(self) -> Floats:
        return np.asarray(self.tint, dtype=np.float64) * np.ones(3)


def _beyond(eta: ArrayLike) -> Floats:
    """eta^2 - 1, to the last digit also next to eta = 1."""
    eta = np.asarray(eta, dtype=np.float64)
    return (eta - 1.0) * (eta + 1.0)
