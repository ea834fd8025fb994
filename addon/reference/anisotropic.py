# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance on a brushed surface: Beckmann's facets with one slope along a tangent and another across it.

The V-groove's G stays as it is: it knows no azimuth but the half vector's plane.

Source of the distribution: Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2), eq. 80.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import quadrature
from .cook_torrance import as_samples, cook_torrance, reflected_by, visible_density, visible_facet
from .directions import as_directions, as_finite, as_pair, as_positive
from .distributions import smith_g

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel
    from .model import Brdf


def turned(w: ArrayLike, azimuth: float) -> Floats:
    """``w`` (..., 3) as seen from a frame that is turned by ``azimuth`` about z; radians."""
    w = as_directions(w, "w")
    cos, sin = np.cos(azimuth), np.sin(azimuth)
    x, y, z = np.moveaxis(w, -1, 0)
    return np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=-1)


@dataclass(frozen=True)
class Anisotropic:
    """Rough reflection with RMS slopes ``m_x`` along the tangent and ``m_y`` across it, both > 0.

    azimuth: of the tangent in the local frame, in radians. fresnel: as of ``CookTorrance``.
    """

    m_x: float
    m_y: float
    fresnel: Fresnel
    azimuth: float = 0.0

    def __post_init__(self) -> None:
        as_positive(self.m_x, "m_x")
        as_positive(self.m_y, "m_y")
        as_finite(self.azimuth, "azimuth")

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); see ``cook_torrance``, whose numbers these are where both slopes are equal."""
        return cook_torrance(*self._turned(wi, wo), self.m_x, self.fresnel, m_y=self.m_y)

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi for each ``wo``, as ``CookTorrance.sample`` does; the weight is F G2 / G1 <= 1, (..., 3)."""
        wo, u = as_samples(wo, u)
        wo = turned(wo, self.azimuth)
        wi, weight = reflected_by(visible_facet(wo, self.m_x, u[..., 1:], self.m_y), wo, self.fresnel)
        return turned(wi, -self.azimuth), weight

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...): G1(v, h) D(h) / (4 (n.v)); 0 below the surface."""
        return visible_density(*self._turned(wi, wo), self.m_x, self.m_y)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): integral of f cos over wi, by quadrature over facet slopes."""
        return quadrature.vgroove_albedo(turned(wo, self.azimuth), self.m_x, self.fresnel, m_y=self.m_y)

    def seen_slope(self, wo: ArrayLike) -> Floats:
        """m of the isotropic surface that has nearly this one's directional albedo at each ``wo``, (...).

        E of Fresnel's F for an index of 1.5 is within .007 up to a wider slope of 0.3, .03 at 0.6 and .06 at 1.
        """
        from .anisotropic_fit import round_slope

        return round_slope(turned(wo, self.azimuth), self.m_x, self.m_y)

    def rendered(self, estimator: str, _bound: float) -> Brdf:
        """See ``estimators.rendered``."""
        from .anisotropic_fit import anisotropic_fit  # which needs this module

        if estimator == "fit":
            return lambda wi, wo: anisotropic_fit(*self._turned(wi, wo), self.m_x, self.m_y, self.fresnel)
        if estimator == "closure":
            return self._smith
        return self.evaluate

    def _smith(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """With Smith's G in place of the V-groove's."""
        wi, wo = self._turned(wi, wo)
        return cook_torrance(wi, wo, self.m_x, self.fresnel, smith_g(wi, wo, self.m_x, self.m_y), m_y=self.m_y)

    def _turned(self, wi: ArrayLike, wo: ArrayLike) -> tuple[Floats, Floats]:
        wi, wo = as_pair(wi, wo)
        return turned(wi, self.azimuth), turned(wo, self.azimuth)
