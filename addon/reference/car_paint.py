# SPDX-License-Identifier: GPL-3.0-or-later
"""Car paint: a diffuse base under several Cook-Torrance lobes, as measured paints are fitted.

Source: Günther, Chen, Goesele, Wald & Seidel 2005, a Lambert base and three lobes of Cook & Torrance 1982.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .cook_torrance import as_samples
from .directions import as_range
from .estimators import rendered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .model import Brdf, Model


@dataclass(frozen=True)
class CarPaint:
    """f = f_base + sum of s_k f_k over the ``lobes``, with weights ``s`` in [0, 1].

    Each lobe is scaled as ``CookTorrance`` is, F D G / (4 (n.l)(n.v)). Raises ValueError if there are not as many
    weights as lobes, or one is out of range.
    """

    base: Model
    lobes: tuple[Model, ...]
    s: tuple[float, ...]

    def __post_init__(self) -> None:
        if len(self.lobes) != len(self.s):
            message = f"s must hold a weight for each of the {len(self.lobes)} lobes, got {len(self.s)}"
            raise ValueError(message)
        as_range(self.s, "s", 0.0, 1.0)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3)."""
        return self.base.evaluate(wi, wo) + sum(
            s * one.evaluate(wi, wo) for s, one in zip(self.s, self.lobes, strict=True)
        )

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """Draw from one part, chosen by u[..., 0] among equals; weight = f cos / pdf of the mixture.

        wo (..., 3), u (..., 4) in [0, 1).
        """
        wo, u = as_samples(wo, u)
        parts = (self.base, *self.lobes)
        chosen = np.minimum((u[..., 0] * len(parts)).astype(int), len(parts) - 1)
        drawn = np.stack([part.sample(wo, u)[0] for part in parts])
        wi = np.take_along_axis(drawn, chosen[None, ..., None], axis=0)[0]
        density = self.pdf(wi, wo)
        share = np.maximum(wi[..., 2], 0.0) / np.where(density > 0, density, 1.0)
        return wi, self.evaluate(wi, wo) * share[..., None]

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...)."""
        parts = (self.base, *self.lobes)
        return np.mean([part.pdf(wi, wo) for part in parts], axis=0)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3): the weighted sum of all parts'."""
        lobes = (s * one.directional_albedo(wo) for s, one in zip(self.s, self.lobes, strict=True))
        return self.base.directional_albedo(wo) + sum(lobes)

    def rendered(self, estimator: str, bound: float) -> Brdf:
        """See ``estimators.rendered``."""
        base, *lobes = (rendered(part, estimator, bound) for part in (self.base, *self.lobes))
        return lambda wi, wo: base(wi, wo) + sum(s * lobe(wi, wo) for s, lobe in zip(self.s, lobes, strict=True))
