# SPDX-License-Identifier: GPL-3.0-or-later
"""A table of measured values as a model: interpolated, and drawn from by facets that follow it.

The least value of each channel is Lambert. From the rest comes a distribution of facets, D at each theta_h:
4 f (n.l)(n.v) over the V-groove's G, averaged over theta_d and phi_d, and not less than ``SHARE`` of its largest.
Facets are drawn by it as of the microfacet generator; what is drawn weighs f cos over its density, however well D fits.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..reference.cook_torrance import cook_torrance
from ..reference.directions import above, as_directions, norm
from ..reference.distributions import smith_g, vgroove_g
from ..reference.facet_distribution import POINTS, Distribution, Term
from ..reference.fresnel import Schlick
from ..reference.generator import Generator
from ..reference.oren_nayar import Lambert
from .merl import PHI_D, Merl, rows, tabulate
from .summary import reflected

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..reference.directions import Floats
    from ..reference.model import Brdf
    from .table import Table

SHARE = 0.3  # of the largest value over theta_d and phi_d that D has at least
LOWEST = 1e-4  # share of the largest D, so that facets are drawn wherever the table may have light
KEPT = 0.99  # of the least value that is Lambert: half floats round, and f less Lambert must not fall below 0
SIDE = 0.02  # least cosine of entries that D is taken from
DRAWN = 64  # points of D
FINE = 192, 192  # theta_h and phi_h of the albedo's quadrature
LEANING, BESIDE = np.radians(45.0), np.radians(30.0)  # angles by which ``closure`` is made


@dataclass(frozen=True)
class Measured(Generator):
    """f by trilinear interpolation in ``table``. The other fields say how ``sample`` draws, and what is Lambert."""

    table: Merl
    digest: str  # a short name of its own for each table

    @classmethod
    def of(cls, table: Table, digest: str) -> Measured:
        """Of any isotropic table; what is no MERL table is taken at the centres of MERL's cells."""
        if not table.contents.isotropic:
            message = "is anisotropic: its table of four angles does not fit the image that materials look up"
            raise ValueError(message)
        merl = table if isinstance(table, Merl) else Merl(tabulate(table.evaluate))
        albedo = np.minimum(KEPT * np.pi * merl.table.min(axis=(1, 2, 3)), 1.0)
        return cls(albedo, 1.0, Distribution((Term(POINTS, _facets(merl, albedo)),)), Schlick(1.0), merl, digest)

    def evaluate(self, wi: ArrayLike, wo: ArrayLike) -> Floats:
        """f(wi, wo) in 1/sr, (..., 3); 0 unless both leave the upper side."""
        return self.table.evaluate(wi, wo)

    def directional_albedo(self, wo: ArrayLike) -> Floats:
        """Directional albedo, (..., 3), by quadrature over half vectors: to about 1e-4, as the table has kinks."""
        wo = as_directions(wo, "wo")
        found = np.zeros((*wo.shape[:-1], 3))
        for place in np.ndindex(wo.shape[:-1]):
            if wo[place][2] > 0:
                wi, weight = reflected(wo[place], FINE)
                found[place] = weight @ self.table.evaluate(wo[place], wi)
        return found

    @cached_property
    def closure(self) -> tuple[tuple[float, ...], tuple[float, ...], float]:
        """RGB of a Lambert part and of a Beckmann lobe, and its slope m: what Cycles' own closures show of the table.

        Lambert has the value beside the peak, where light and view are at the same 30 degrees; the lobe has the slope
        of the facets, and such a colour that both together reflect what the table does at 45 degrees.
        """
        side = np.array([np.sin(BESIDE), 0.0, np.cos(BESIDE)])
        beside = np.pi * self.table.evaluate(side, side)
        view = np.array([np.sin(LEANING), 0.0, np.cos(LEANING)])
        total = self.directional_albedo(view)
        diffuse = np.minimum(beside, total)
        m = min(1.0, self.distribution.slope)
        wi, weight = reflected(view, FINE)
        lobe = float(np.max(weight @ cook_torrance(view, wi, m, Schlick(1.0), smith_g(view, wi, m))))
        color = np.clip((total - diffuse) / lobe, 0.0, 1.0)
        return tuple(np.minimum(diffuse, 1.0).tolist()), tuple(color.tolist()), m

    def rendered(self, estimator: str, _bound: float) -> Brdf:
        """See ``estimators.rendered``."""
        if estimator != "closure":
            return self.evaluate
        albedo, color, m = self.closure
        return lambda wi, wo: (
            Lambert(albedo).evaluate(wi, wo) + color * cook_torrance(wi, wo, m, Schlick(1.0), smith_g(wi, wo, m))
        )


def _facets(merl: Merl, albedo: Floats) -> tuple[float, ...]:
    """D at ``DRAWN`` points, in any unit."""
    found = np.zeros(len(merl.whole))
    for index, (wi, wo) in enumerate(rows(merl.table.shape[3])):
        seen = above(wi, wo) & (np.minimum(wi[..., 2], wo[..., 2]) > SIDE)
        if not seen.any():
            continue
        wi, wo = wi[seen], wo[seen]  # noqa: PLW2901
        rest = np.maximum(merl.table[:, index, seen].mean(axis=0) - albedo.mean() / np.pi, 0.0)
        D = rest * 4.0 * wi[:, 2] * wo[:, 2] / np.maximum(vgroove_g(wi, wo), SIDE)
        cos_d, sin_d = norm(wi + wo) / 2.0, norm(wi - wo) / 2.0
        found[index] = max(np.average(D, weights=cos_d * sin_d), SHARE * float(np.max(D)))
    place = (np.arange(len(found)) + 0.5) / len(found)  # square roots of theta_h over 90 degrees
    D = np.interp(np.linspace(0.0, 1.0, DRAWN), place, np.maximum(found, LOWEST * float(np.max(found))))
    return tuple(np.maximum(D, 1e-30).tolist())


def atlas(merl: Merl) -> Floats:
    """The table as an image (828, 10 (phi_d + 2), 3), row 0 at the bottom: tiles of one theta_h, 10 in a row.

    A tile has phi_d along its rows and theta_d upward, with a texel more on each side: phi_d's neighbours around the
    circle, and the last theta_d again.
    """
    tiles = np.pad(np.moveaxis(merl.table, 0, -1), ((0, 0), (1, 1), (0, 0), (0, 0)), mode="edge")
    tiles = np.pad(tiles, ((0, 0), (0, 0), (1, 1), (0, 0)), mode="wrap")
    _, high, wide, _ = tiles.shape
    return tiles.reshape(ROWS, COLUMNS, high, wide, 3).transpose(0, 2, 1, 3, 4).reshape(ROWS * high, COLUMNS * wide, 3)


COLUMNS, ROWS = 10, 9
RECIPROCAL = PHI_D[0]
