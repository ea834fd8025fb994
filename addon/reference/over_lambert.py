# SPDX-License-Identifier: GPL-3.0-or-later
"""A lobe over Lambert, f = albedo/pi + specular lobe: what models of this form share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance import as_samples
from .directions import above, as_directions, as_pair, as_rgb
from .oren_nayar import Lambert

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats


@dataclass(frozen=True)
class OverLambert:
    """``albedo`` and ``specular``: RGB in [0, 1], together at most 1 in each channel."""

    albedo: ArrayLike
    specular: ArrayLike

    def __post_init__(self) -> None:
        albedo, specular = as_rgb(self.albedo, "albedo", 0.0, 1.0), as_rgb(self.specular, "specular", 0.0, 1.0)
        if np.max(albedo + specular) > 1.0 + 1e-12:
            message = f"albedo + specular must be at most 1, got {np.max(albedo + specular):.15g}"
            raise ValueError(message)

    def lobe(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """The lobe in 1/sr, (...); 0 unless both leave the upper side."""
        raise NotImplementedError

    def lobe_albedo(self, wo: Floats) -> Floats:
        """Integral of lobe cos over wi, (...), for wo (..., 3) above the surface."""
        raise NotImplementedError

    def _draw(self, wo: Floats, u: Floats) -> Floats:
        """wi for each wo, (..., 3), for u (..., 3): two for the facet or the lobe, its dual."""
        raise NotImplementedError

    def _density(self, wi: Floats, wo: Floats) -> Floats:
        """Density of ``_draw`` in 1/sr, (...)."""
        raise NotImplementedError

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); 0 unless both leave the upper side."""
        return Lambert(self.albedo).evaluate(wi, wo) + self.lobe(wi, wo)[..., None] * np.asarray(self.specular)

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw wi from the lobe or by the cosine, chosen by u[..., 0]; weight f cos over the density of both."""
        wo, u = as_samples(wo, u)
        below, _ = Lambert(1.0).sample(wo, u)
        wi = np.where(u[..., :1] < self._share(), self._draw(wo, u[..., 1:]), below)
        density = self.pdf(wi, wo)[..., None]
        f_cos = self.evaluate(wi, wo) * np.maximum(wi[..., 2:], 0.0)
        return wi, f_cos / np.where(density > 0, density, 1.0)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...); 0 below the surface, where what is drawn weighs 0."""
        wi, wo = as_pair(wi, wo)
        share, lit = self._share(), above(wi, wo)
        return np.where(lit, share * self._density(wi, wo), 0.0) + (1.0 - share) * Lambert(1.0).pdf(wi, wo)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): integral of f cos over wi."""
        wo = as_directions(wo, "wo")
        lit = wo[..., 2] > 0
        lobe = np.where(lit, self.lobe_albedo(np.where(lit[..., None], wo, [0.0, 0.0, 1.0])), 0.0)
        return Lambert(self.albedo).directional_albedo(wo) + lobe[..., None] * np.asarray(self.specular)

    def _share(self) -> float:
        """Of samples that are drawn from the lobe."""
        specular, albedo = (float(np.mean(np.asarray(color))) for color in (self.specular, self.albedo))
        return specular / (specular + albedo) if specular + albedo > 0 else 0.0
