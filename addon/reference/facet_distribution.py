# SPDX-License-Identifier: GPL-3.0-or-later
"""Any isotropic distribution of facets: formulas, drawn points, and weighted sums of both, scaled to unit area.

Each D(t), t between facet and normal, is scaled so that its integral of D cos(t) over the hemisphere is 1.

    beckmann     exp(-tan^2/m^2) / (pi m^2 cos^4)
    ggx          1 / (pi m^2 cos^4 (1 + tan^2/m^2)^2)
    exponential  3 exp(-sqrt(6) tan/m) / (pi m^2 cos^4); m is the RMS slope here, too
    abc          ~ (1 + B (1 - cos))^-C
    points       straight lines between values of D at (k/(N - 1))^2 90 degrees, k from 0 to N - 1

Sources:
    Ashikhmin, Premoze & Shirley 2000, A Microfacet-based BRDF Generator, doi:10.1145/344779.344814
    Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces, EGSR (Beckmann, GGX)
    Church, Takacs & Leonard 1989, The prediction of BRDFs from surface profile measurements, Proc. SPIE 1165 (ABC)
    Low et al. 2012, BRDF Models for Accurate and Efficient Rendering of Glossy Surfaces, doi:10.1145/2077341.2077350
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import TYPE_CHECKING

import numpy as np

from .directions import as_directions, as_range

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats

FEWEST, MOST = 2, 64  # points
MOST_TERMS = 6
# Of each formula the names of its numbers and their ranges. Beyond, float32 would lose them.
SLOPE = ("m", 1e-4, 10.0)
FORMULAS = {
    "beckmann": (SLOPE,),
    "ggx": (SLOPE,),
    "exponential": (SLOPE,),
    "abc": (("B", 1.0, 1e7), ("C", 0.01, 20.0)),
}
POINTS = "points"
BINS = 256  # of equal probability, to draw facets from
SPREAD = 0.2  # of the draws that go evenly over the logarithm of sin^2, so that no facet is drawn far too rarely
LOWEST_SIN2 = 1e-20
STEPS = 6001  # over which projected area is summed up
SQRT_6 = 6.0**0.5


@dataclass(frozen=True)
class Term:
    """One D of a sum. kind: of ``FORMULAS``, or "points". numbers: the formula's, or D at the points, in any unit.

    weight: its share of the facets' projected area, over that of all terms.
    """

    kind: str
    numbers: tuple[float, ...]
    weight: float = 1.0

    def __post_init__(self) -> None:
        as_range(self.weight, "weight", 0.0, 1e6)
        if self.kind == POINTS:
            if not FEWEST <= len(self.numbers) <= MOST:
                message = f"points must be {FEWEST} to {MOST} numbers, got {len(self.numbers)}"
                raise ValueError(message)
            if not max(as_range(self.numbers, "points", 0.0, 1e12)[:-1]) > 0.0:  # the last faces the horizon
                message = "points must not all be 0"
                raise ValueError(message)
            return
        if self.kind not in FORMULAS:
            message = f'distribution must be one of {", ".join([*FORMULAS, POINTS])}, got "{self.kind}"'
            raise ValueError(message)
        named = FORMULAS[self.kind]
        if len(self.numbers) != len(named):
            message = f"{self.kind} needs {len(named)} numbers ({', '.join(name for name, *_ in named)})"
            raise ValueError(message)
        for number, (name, low, high) in zip(self.numbers, named, strict=True):
            as_range(number, f"{name} of {self.kind}", low, high)

    def density(self, sin2: Floats, cos: Floats) -> Floats:
        """D in 1/sr from sin^2 t, which narrow lobes need to the last digit, and cos t; 0 where cos is not above 0."""
        up = cos > 1e-8
        c = np.where(up, cos, 1.0)
        return np.where(up, self._shape(sin2, c) * self.scale, 0.0)

    def _shape(self, sin2: Floats, c: Floats) -> Floats:
        if self.kind == POINTS:
            return np.interp(coordinate(sin2, c), np.linspace(0.0, 1.0, len(self.numbers)), self.numbers)
        if self.kind == "abc":
            B, C = self.numbers
            return np.exp(-C * np.log1p(B * sin2 / (1.0 + c)))
        (m,), tan2 = self.numbers, sin2 / (c * c)
        with np.errstate(under="ignore"):
            if self.kind == "beckmann":
                return np.exp(-tan2 / m**2) / c**4
            if self.kind == "ggx":
                return 1.0 / (c * c + sin2 / m**2) ** 2
            return np.exp(-SQRT_6 * np.sqrt(tan2) / m) / c**4

    @cached_property
    def scale(self) -> float:
        """What gives D unit projected area."""
        if self.kind == POINTS:
            return 1.0 / _area_below(self.numbers)
        if self.kind == "abc":
            return 1.0 / _abc_area(*self.numbers)
        return (3.0 if self.kind == "exponential" else 1.0) / (np.pi * self.numbers[0] ** 2)


@dataclass(frozen=True)
class Distribution:
    """D = sum of weight D_k over its terms, their weights scaled to add up to 1."""

    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        if not 1 <= len(self.terms) <= MOST_TERMS:
            message = f"a distribution has 1 to {MOST_TERMS} terms, got {len(self.terms)}"
            raise ValueError(message)
        if not sum(term.weight for term in self.terms) > 0.0:
            message = "the weights of a distribution must not all be 0"
            raise ValueError(message)

    @cached_property
    def shares(self) -> tuple[float, ...]:
        """The weights, which add up to 1."""
        total = sum(term.weight for term in self.terms)
        return tuple(term.weight / total for term in self.terms)

    def __call__(self, h: ArrayLike) -> Floats:
        """D(h) in 1/sr, (...), of unit vectors (..., 3); 0 below the surface."""
        h = as_directions(h, "h")
        return self.density(np.square(h[..., 0]) + np.square(h[..., 1]), h[..., 2])

    def density(self, sin2: Floats, cos: Floats) -> Floats:
        """As ``Term.density``."""
        parts = (share * term.density(sin2, cos) for share, term in zip(self.shares, self.terms, strict=True))
        return np.asarray(sum(parts))

    @cached_property
    def bins(self) -> Floats:
        """Edges of sin^2 t (BINS + 1,), float32 as shaders hold them; ``draw`` takes each bin equally often.

        The projected area is pi D d(sin^2 t), so that facets are drawn about as they project, and a few elsewhere.
        """
        sin2 = np.geomspace(LOWEST_SIN2, 1.0, STEPS)
        area = self._areas(sin2)
        begins = np.interp(1e-4, area, sin2)
        spread = np.clip(np.log(sin2 / begins) / -np.log(begins), 0.0, 1.0)
        drawn = (1.0 - SPREAD) * area + SPREAD * spread
        inner = np.exp(np.interp(np.arange(1, BINS) / BINS, drawn, np.log(sin2)))
        return np.array([0.0, *inner, 1.0], dtype=np.float32).astype(np.float64)

    def _areas(self, sin2: Floats) -> Floats:
        """Projected area of all facets up to each sin^2, 0 to 1: by trapezoids, as it only says where to draw."""
        D = self.density(sin2, np.sqrt(1.0 - sin2))
        steps = np.diff(sin2) * (D[1:] + D[:-1]) / 2.0
        area = np.concatenate([[D[0] * sin2[0]], steps]).cumsum()
        return area / area[-1]

    def draw(self, u: Floats) -> tuple[Floats, Floats]:
        """sin^2 t of a facet for each u in [0, 1), evenly within its bin, and what D would be to draw so, in 1/sr."""
        place = u * BINS
        k = np.minimum(place.astype(np.intp), BINS - 1)
        low, width = self.bins[k], self.bins[k + 1] - self.bins[k]
        return low + (place - k) * width, 1.0 / (np.pi * BINS * width)

    def drawn_density(self, h: Floats) -> Floats:
        """The D by which ``draw`` draws, at h (..., 3), in 1/sr."""
        sin2 = np.square(h[..., 0]) + np.square(h[..., 1])
        k = np.clip(np.searchsorted(self.bins, sin2, side="right") - 1, 0, BINS - 1)
        return 1.0 / (np.pi * BINS * (self.bins[k + 1] - self.bins[k]))

    @cached_property
    def slope(self) -> float:
        """m of the Beckmann distribution half of whose projected area leans as little."""
        sin2 = np.geomspace(LOWEST_SIN2, 1.0, STEPS)
        half = float(np.interp(0.5, self._areas(sin2), sin2))
        return float(np.sqrt(half / (1.0 - half) / np.log(2.0)))


def coordinate(sin2: Floats, cos: Floats) -> Floats:
    """(t / 90 degrees)^(1/2), which spreads the points near the normal: 0 there, 1 at the horizon."""
    return np.sqrt(np.arctan2(np.sqrt(sin2), cos) * 2.0 / np.pi)


@cache
def _area_below(points: tuple[float, ...]) -> float:
    """Integral of D cos over the hemisphere, by Gauss's rule between points: t = x^2 pi/2, dt = pi x dx."""
    z, weight = np.polynomial.legendre.leggauss(32)
    edges = np.linspace(0.0, 1.0, len(points))
    x = edges[:-1, None] + np.diff(edges)[:, None] * (z + 1.0) / 2.0
    t = x * x * np.pi / 2.0
    D = np.interp(x, edges, points)
    inner = D * np.cos(t) * np.sin(t) * x * weight
    return float(2.0 * np.pi * np.pi * inner.sum() * 0.5 * edges[1])


def _abc_area(B: float, C: float) -> float:
    """The same of (1 + B y)^-C, y = 1 - cos: 2 pi/B^2 ((1 + B) P(1 - C) - P(2 - C)), P(a) = ((1 + B)^a - 1)/a."""
    length = np.log1p(B)

    def power(a: float) -> float:
        return float(np.expm1(a * length) / a) if abs(a) > 1e-12 else float(length)

    return 2.0 * np.pi / B**2 * ((1.0 + B) * power(1.0 - C) - power(2.0 - C))
