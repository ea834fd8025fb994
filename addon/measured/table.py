# SPDX-License-Identifier: GPL-3.0-or-later
"""What every measured BRDF offers, whatever its file's format: f(wi, wo), and what is known of its entries."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reference.directions import above, as_pair

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from ..reference.directions import Floats

CHUNK = 2**14  # pairs that are looked up at once, so that a lookup's memory is bounded
LARGEST = 1e8  # 1/sr; a white surface would have to reflect into a cone of 1e-4 rad to exceed it


@dataclass(frozen=True)
class Contents:
    """What a file holds. Counts are of entries, each with all its channels."""

    format: str
    text: str  # the file's own description
    size: str  # the grid
    isotropic: bool
    entries: int
    below: int  # entries for directions below the horizon, which no surface has
    holes: int  # other entries that hold no reflectance: negative, not finite, or above LARGEST
    filled: str  # what stands in place of holes, and beyond the grid

    @property
    def coverage(self) -> float:
        """Share of the entries above the horizon that hold a reflectance."""
        return 1.0 - self.holes / max(self.entries - self.below, 1)


class Table(ABC):
    """A measured BRDF."""

    contents: Contents

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, linear Rec.709 RGB (..., 3), without the cosine; 0 unless both leave the upper side.

        wi, wo: unit vectors (..., 3) to the light and to the viewer, which broadcast. Raises ValueError otherwise.
        """
        wi, wo = as_pair(wi, wo)
        f = np.zeros(wi.shape)
        lit = np.flatnonzero(above(wi, wo))
        flat, light, view = f.reshape(-1, 3), wi.reshape(-1, 3), wo.reshape(-1, 3)
        for start in range(0, lit.size, CHUNK):
            some = lit[start : start + CHUNK]
            flat[some] = self.look_up(light[some], view[some])
        return f

    @abstractmethod
    def look_up(self, wi: Floats, wo: Floats) -> Floats:
        """f of pairs (n, 3) above the horizon, (n, 3)."""


def is_reflectance(values: NDArray[Any]) -> NDArray[np.bool_]:
    """Where a value can be a BRDF's: NaN, negative ones and those above ``LARGEST`` cannot."""
    return (values >= 0) & (values <= LARGEST)  # a comparison with NaN is false


def between(position: Floats, count: int) -> tuple[NDArray[np.intp], Floats]:
    """The node before each position among nodes 0 .. count - 1, and the share of the next; clamped at both ends."""
    held = np.clip(position, 0.0, count - 1.0)
    before = np.minimum(held.astype(np.intp), max(count - 2, 0))
    return before, held - before


def between_angles(angle: Floats, nodes: NDArray[Any]) -> tuple[NDArray[np.intp], Floats]:
    """``between`` for nodes at the angles ``nodes``, which rise."""
    return between(np.interp(angle, nodes, np.arange(nodes.size, dtype=np.float64)), nodes.size)
