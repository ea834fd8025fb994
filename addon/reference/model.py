# SPDX-License-Identifier: GPL-3.0-or-later
"""What every model offers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

    from numpy.typing import ArrayLike

    from .directions import Floats

    Brdf = Callable[[Any, Any], Floats]  # f(wi, wo) in 1/sr, (..., 3)


class Model(Protocol):
    """A reflectance model. Directions (..., 3) broadcast; results are float64."""

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, RGB (..., 3), without the cosine; 0 unless both leave the upper side."""
        ...

    def sample(self, wo: ArrayLike, u: ArrayLike) -> tuple[Floats, Floats]:
        """wi (..., 3) and weight f cos / pdf (..., 3) for u (..., 4) in [0, 1): lobe, two for the facet, its dual."""
        ...

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """Density of ``sample`` in 1/sr, (...)."""
        ...

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Integral of f cos over wi, RGB (..., 3)."""
        ...


def albedo(model: Model, wo: ArrayLike) -> Floats:
    """Directional albedo E(wo) = integral over wi of f(wi, wo) cos(theta_i), RGB (..., 3), good to 1e-6 relative.

    Equals the share of a uniform white sky that the surface sends toward ``wo``; 0 below the surface.
    wo: unit vectors (..., 3). Raises ValueError if a vector is not of unit length.

    >>> from vgroove.addon.reference import Lambert
    >>> albedo(Lambert(0.5), [0, 0, 1]).tolist()
    [0.5, 0.5, 0.5]
    """
    return model.directional_albedo(wo)
