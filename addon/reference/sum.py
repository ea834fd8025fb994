# SPDX-License-Identifier: GPL-3.0-or-later
"""A diffuse and a specular part side by side.

Source: Cook & Torrance 1982, R = d R_d + s R_s with d + s = 1.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .anisotropic import Anisotropic
from .cook_torrance import CookTorrance, Smooth, as_samples
from .cook_torrance_albedo import quick_albedo
from .directions import as_directions, as_range
from .estimators import rendered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .model import Brdf, Model


@dataclass(frozen=True)
class Sum:
    """f = d f_diffuse + s f_specular, with weights ``d``, ``s`` in [0, 1] and d + s <= 1.

    coupled: f = d (1 - s E_s(wo)) f_diffuse + s f_specular, E_s the specular part's directional albedo: what is
    mirrored cannot be scattered as well, so the diffuse part darkens toward grazing views, and d + s may exceed 1.
    Not reciprocal: light that arrives at grazing angles is not held back in the same way.
    """

    diffuse: Model
    specular: Model
    d: float
    s: float
    coupled: bool = False

    def __post_init__(self) -> None:
        d, s = as_range(self.d, "d", 0.0, 1.0), as_range(self.s, "s", 0.0, 1.0)
        if d + s > 1.0 + 1e-12 and not self.coupled:
            message = f"d + s must be at most 1 (more light would leave than arrives), got {d:.15g} + {s:.15g}"
            raise ValueError(message)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3)."""
        return self._diffuse_weight(wo) * self.diffuse.evaluate(wi, wo) + self.s * self.specular.evaluate(wi, wo)

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw from one lobe, chosen by u[..., 0] in proportion to d and s.

        Returns wi and weight = f cos / pdf of the mixture; a ``Smooth`` lobe's delta is weighted alone, by s F over
        its probability. wo (..., 3), u (..., 4) in [0, 1).
        """
        wo, u = as_samples(wo, u)
        share = self._specular_share()
        specular = (u[..., 0] < share)[..., None]
        wi_s, weight_s = self.specular.sample(wo, u)
        wi_d, _ = self.diffuse.sample(wo, u)
        wi = np.where(specular, wi_s, wi_d)
        density = self.pdf(wi, wo)
        cosine = np.maximum(wi[..., 2], 0.0)
        weight = self.evaluate(wi, wo) * (cosine / np.where(density > 0, density, 1.0))[..., None]
        if isinstance(self.specular, Smooth):
            weight = np.where(specular, weight_s * (self.s / max(share, 1e-300)), weight)
        return wi, weight

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...), without a ``Smooth`` lobe's delta."""
        share = self._specular_share()
        return share * self.specular.pdf(wi, wo) + (1.0 - share) * self.diffuse.pdf(wi, wo)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): the weighted sum of both parts'."""
        diffuse = self._diffuse_weight(wo) * self.diffuse.directional_albedo(wo)
        return diffuse + self.s * self.specular.directional_albedo(wo)

    def _diffuse_weight(self, wo: ArrayLike) -> Floats | float:
        """The diffuse part's weight: d, or d (1 - s E_s(wo)), (..., 3)."""
        return self.d * (1.0 - self.s * self._specular_albedo(wo)) if self.coupled else self.d

    def _specular_albedo(self, wo: ArrayLike) -> Floats:
        """E_s of each direction: a quadrature for each new cosine, where the part looks alike from all around.

        A model of which that is not known takes one for each new direction.
        """
        wo = as_directions(wo, "wo")
        if np.ndim(getattr(self.specular, "m", 0.0)):  # a slope for each direction
            return self.specular.directional_albedo(wo)
        if not isinstance(self.specular, (CookTorrance, Smooth)):
            views, place = np.unique(wo.reshape(-1, 3), axis=0, return_inverse=True)
            return self.specular.directional_albedo(views)[place.ravel()].reshape(wo.shape)
        cosines, index = np.unique(wo[..., 2], return_inverse=True)
        new = np.array([cosine for cosine in cosines.tolist() if cosine not in self._albedo_cache])
        views = np.stack([np.sqrt((1.0 - new) * (1.0 + new)), 0.0 * new, new], axis=-1)
        self._albedo_cache.update(zip(new.tolist(), self.specular.directional_albedo(views), strict=True))
        values = np.array([self._albedo_cache[cosine] for cosine in cosines.tolist()]).reshape(-1, 3)
        return values[index.reshape(wo.shape[:-1])]

    @cached_property
    def _albedo_cache(self) -> dict[float, Floats]:
        """E_s (3,) by n.v, for the cosines evaluated so far."""
        return {}

    def _specular_share(self) -> float:
        total = self.d + self.s
        return float(self.s / total) if total > 0 else 0.0

    def rendered(self, estimator: str, bound: float) -> Brdf:
        """See ``estimators.rendered``. Coupled, with E_s from three facets, as shaders have it."""
        diffuse, specular = (rendered(part, estimator, bound) for part in (self.diffuse, self.specular))
        return lambda wi, wo: quick_diffuse_share(self, wo) * diffuse(wi, wo) + self.s * specular(wi, wo)


def quick_diffuse_share(model: Sum, wo: ArrayLike) -> Floats:
    """The diffuse part's weight as shaders have it, (..., 1): d, or d (1 - s E_s), E_s that of the strongest channel.

    Raises TypeError for a coupled sum whose specular part is none of Cook-Torrance, round or not, or smooth.
    """
    if not model.coupled:
        return np.full(1, model.d)
    specular = model.specular
    if isinstance(specular, Anisotropic):
        m: ArrayLike = specular.seen_slope(wo)
    elif isinstance(specular, CookTorrance | Smooth):
        m = getattr(specular, "m", 0.0)
    else:
        message = f"a coupled Sum needs a CookTorrance or Smooth specular part, got {type(specular).__name__}"
        raise TypeError(message)
    return model.d * (1.0 - model.s * np.max(quick_albedo(wo, m, specular.fresnel), axis=-1, keepdims=True))
