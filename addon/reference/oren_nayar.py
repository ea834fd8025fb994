# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren-Nayar: V-grooves whose facets are Lambertian, and Lambert itself.

Source: Oren & Nayar 1994, Generalization of Lambert's Reflectance Model, SIGGRAPH, doi:10.1145/192161.192213
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import quadrature
from .cook_torrance import as_samples
from .directions import TANGENT, above, as_directions, as_pair, as_range, as_rgb, dot

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .model import Brdf


def oren_nayar(
    wi: ArrayLike, wo: ArrayLike, albedo: ArrayLike, sigma: ArrayLike, *, qualitative: bool = False
) -> Floats:
    """The BRDF of a rough diffuse surface, in 1/sr, RGB.

    With a = max(theta_i, theta_o), b = min(theta_i, theta_o), p = phi_i - phi_o and s2 = sigma^2:
    f = albedo/pi [C1 + cos p C2 tan b + (1 - |cos p|) C3 tan((a + b)/2)]
        + 0.17 albedo^2/pi s2/(s2 + 0.13) [1 - cos p (2b/pi)^2]
    C1 = 1 - 0.5 s2/(s2 + 0.33)
    C2 = 0.45 s2/(s2 + 0.09) (sin a - (0 if cos p >= 0 else (2b/pi)^3))
    C3 = 0.125 s2/(s2 + 0.09) (4ab/pi^2)^2
    Qualitative: f = albedo/pi [C1 + max(0, cos p) 0.45 s2/(s2 + 0.09) sin a tan b]
    The full fit falls below 0 (to -0.018) at grazing angles opposite each other, for sigma > 0.66 and the lower
    albedos: 0 is returned there.

    wi, wo: unit vectors (..., 3), broadcast. albedo: in [0, 1], scalar or RGB. sigma: standard deviation of the
    facet angle in radians, [0, pi/2]. Returns float64 (..., 3); 0 unless both directions leave the upper side.
    Raises ValueError outside these ranges.
    Source: Oren & Nayar 1994, eqs. 27 to 30 (full and qualitative).
    """
    wi, wo = as_pair(wi, wo)
    rho = as_rgb(albedo, "albedo", 0.0, 1.0) * np.ones(3)
    s2 = np.square(as_range(sigma, "sigma", 0.0, np.pi / 2))
    lit = above(wi, wo)
    wi, wo = np.where(lit[..., None], wi, [0, 0, 1]), np.where(lit[..., None], wo, [0, 0, 1])
    low, high, tan_b, cos_p, aside = _angles(wi, wo)
    C1 = 1.0 - 0.5 * s2 / (s2 + 0.33)
    slope = 0.45 * s2 / (s2 + 0.09)
    if qualitative:
        shape = C1 + np.maximum(cos_p, 0.0) * slope * np.cos(low) * tan_b
        return rho / np.pi * np.where(lit, shape, 0.0)[..., None]
    x, y = 2.0 * low / np.pi, 2.0 * high / np.pi  # 1 - 2a/pi, 1 - 2b/pi
    behind = y * (3.0 - y * (3.0 - y)) - 2.0 * np.sin(low / 2.0) ** 2  # sin a - (2b/pi)^3 without cancelling
    C2 = slope * np.where(cos_p >= 0, np.cos(low), behind)
    C3 = 0.125 * s2 / (s2 + 0.09) * ((1.0 - x) * (1.0 - y)) ** 2
    once = C1 + cos_p * C2 * tan_b + aside * C3 / np.tan((low + high) / 2.0)
    twice = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_p * (1.0 - y) ** 2)
    once, twice = np.where(lit, once, 0.0)[..., None], np.where(lit, twice, 0.0)[..., None]
    return rho / np.pi * np.maximum(once + rho * twice, 0.0)


def _angles(wi: Floats, wo: Floats) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Elevations pi/2 - a and pi/2 - b, tan b, and of the azimuths cos p and 1 - |cos p|.

    Near grazing tan b and the brackets it multiplies live on digits that the polar angles and cos p round off.
    """
    sin_i, sin_o = np.hypot(wi[..., 0], wi[..., 1]), np.hypot(wo[..., 0], wo[..., 1])
    up_i, up_o = np.arctan2(wi[..., 2], sin_i), np.arctan2(wo[..., 2], sin_o)
    tan_b = np.minimum(sin_i / wi[..., 2], sin_o / wo[..., 2])
    # Along the normal the azimuth is undefined; b is 0 there and every factor of cos p vanishes with it.
    defined = (sin_i > 0) & (sin_o > 0)
    unit_i = wi[..., :2] / np.where(defined, sin_i, 1.0)[..., None]
    unit_o = wo[..., :2] / np.where(defined, sin_o, 1.0)[..., None]
    cos_p = np.where(defined, np.clip(dot(unit_i, unit_o), -1.0, 1.0), 0.0)
    sin_p = unit_i[..., 0] * unit_o[..., 1] - unit_i[..., 1] * unit_o[..., 0]
    aside = np.where(defined, sin_p**2 / (1.0 + np.abs(cos_p)), 1.0)
    return np.minimum(up_i, up_o), np.maximum(up_i, up_o), tan_b, cos_p, aside


class _Diffuse:
    """``sample``, ``pdf`` and quadrature of the diffuse models: wi by the cosine, pdf = cos / pi."""

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        raise NotImplementedError

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi by the cosine; u (..., 4), of which two are used. Weight f cos / pdf = pi f, (..., 3).

        Source: Malley's method, a uniform disc projected up.
        """
        wo, u = as_samples(wo, u)
        radius, phi = np.sqrt(u[..., 1]), 2.0 * np.pi * u[..., 2]
        wi = np.stack([radius * np.cos(phi), radius * np.sin(phi), np.sqrt(1.0 - u[..., 1])], axis=-1)
        return wi, np.pi * self.evaluate(wi, wo)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """cos / pi in 1/sr, (...); 0 below the surface."""
        wi, wo = as_pair(wi, wo)
        return np.where(above(wi, wo), wi[..., 2] / np.pi, 0.0)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): integral of f cos over wi, by quadrature."""
        return quadrature.diffuse_albedo(wo, self.evaluate)


@dataclass(frozen=True)
class OrenNayar(_Diffuse):
    """Rough diffuse; ``albedo`` in [0, 1], ``sigma`` in radians, ``qualitative`` for the short A + B form."""

    albedo: ArrayLike
    sigma: ArrayLike
    qualitative: bool = False

    def __post_init__(self) -> None:
        as_rgb(self.albedo, "albedo", 0.0, 1.0)
        as_range(self.sigma, "sigma", 0.0, np.pi / 2)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); see ``oren_nayar``."""
        return oren_nayar(wi, wo, self.albedo, self.sigma, qualitative=self.qualitative)

    def rendered(self, estimator: str, bound: float) -> Brdf:
        """See ``estimators.rendered``."""
        from . import oren_nayar_fit as native  # which needs this module

        rho, sigma, qualitative = self.albedo, self.sigma, self.qualitative
        if estimator == "fit":
            return lambda wi, wo: native.oren_nayar_fit(wi, wo, rho, sigma, qualitative=qualitative)
        if estimator == "closure":
            roughness = native.closure_roughness(sigma, qualitative=qualitative)
            return lambda wi, wo: native.cycles_diffuse(wi, wo, rho, roughness)
        if estimator == "hybrid":
            return lambda wi, wo: native.oren_nayar_hybrid(wi, wo, rho, sigma, bound, qualitative=qualitative)
        return self.evaluate


@dataclass(frozen=True)
class Lambert(_Diffuse):
    """f = albedo / pi, ``albedo`` in [0, 1], one number or linear RGB."""

    albedo: ArrayLike

    def __post_init__(self) -> None:
        as_rgb(self.albedo, "albedo", 0.0, 1.0)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """albedo / pi in 1/sr, (..., 3); 0 unless both directions leave the upper side."""
        lit = above(*as_pair(wi, wo))
        return np.asarray(self.albedo, dtype=np.float64) / np.pi * lit[..., None] * np.ones(3)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """``albedo`` itself, (..., 3); 0 below the surface."""
        wo = as_directions(wo, "wo")
        return np.asarray(self.albedo, dtype=np.float64) * (wo[..., 2:] > TANGENT) * np.ones(3)
