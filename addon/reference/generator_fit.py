# SPDX-License-Identifier: GPL-3.0-or-later
"""A distribution of facets as a few of Beckmann's, for each of which Cycles has lobes: what ``fit`` is made of.

Over x = tan^2 Beckmann's distribution is an exponential: D cos^4 = w exp(-x/m^2) / (pi m^2). Weights and slopes are
those of the least L1 distance, by damped Gauss-Newton steps on their logarithms, each residual weighted by 1/|r|.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from .facet_distribution import LOWEST_SIN2
from .fresnel import F82, F82_COSINE, schlick

if TYPE_CHECKING:
    from .directions import Floats
    from .facet_distribution import Distribution, Term
    from .fresnel import Fresnel

MOST_TERMS = 6
ENOUGH = 0.01  # L1 distance below which no more terms are taken
LOWEST, HIGHEST = 1e-3, 1.0  # slopes: narrower lobes are mirrors to the eye, and wider ones Cycles does not have
ROUNDS, DAMPING = 40, 1e-2
Terms = tuple[tuple[float, float], ...]


@cache
def beckmann_terms(of: Distribution) -> Terms:
    """(weight, m) of each term; as few as come within ``ENOUGH``, at most ``MOST_TERMS``.

    Of slopes below ``LOWEST`` those of that slope: the nearest wider lobes by L1 are nearly black.
    """
    of = replace(of, terms=tuple(_widened(term) for term in of.terms))
    best: Terms = ()
    for count in range(1, MOST_TERMS + 1):
        found = least_l1(of, count)
        if not best or distance(of, found) < distance(of, best):
            best = found
        if distance(of, best) < ENOUGH:
            break
    return best


def _widened(term: Term) -> Term:
    return replace(term, numbers=(max(term.numbers[0], LOWEST),)) if len(term.numbers) == 1 else term


@cache
def distance(of: Distribution, terms: Terms) -> float:
    """L1 distance of the terms' D from ``of``, as a share of the light that facets mirror head-on: 0.02 is 2 %."""
    x, D, seen = _nodes(of)
    return float(np.abs(_parts(x, *np.array(terms).T).sum(axis=1) - D) @ seen)


@cache
def least_l1(of: Distribution, count: int) -> Terms:
    """(weight, m) of the best ``count`` terms from two starts: slopes at even shares of the light, and evenly apart."""
    x, D, seen = _nodes(of)
    share = np.cumsum(D * seen)
    ends = np.log(np.interp([0.03, 0.97], share, x))
    middle = (np.arange(count) + 0.5) / count
    starts = (np.interp((np.arange(count) + 0.6) / count, share, x), np.exp(np.interp(middle, [0.0, 1.0], ends)))
    low = np.repeat([-12.0, np.log(LOWEST)], count)
    high = np.repeat([0.0, np.log(HIGHEST)], count)
    best = np.inf, low
    for start in starts:
        slopes = np.clip(0.5 * np.log(start), low[count:], high[count:]) + 0.01 * np.arange(count)
        at, soft = np.concatenate([np.full(count, -np.log(count)), slopes]), 0.3
        for _ in range(ROUNDS):
            at, soft = np.clip(at, low, high), max(1e-3, 0.8 * soft)
            m2 = np.exp(2.0 * at[count:])
            parts = _parts(x, np.exp(at[:count]), np.exp(at[count:]))
            residual = parts.sum(axis=1) - D
            best = min(best, (float(np.abs(residual) @ seen), at), key=lambda one: one[0])
            robust = seen / np.hypot(residual, soft * (D + 1e-3 / seen.sum()))
            slope = np.concatenate([parts, parts * (2.0 * x[:, None] / m2 - 2.0)], axis=1)  # by the logarithms
            curvature = slope.T @ (robust[:, None] * slope)
            curvature += np.diag(DAMPING * np.diag(curvature) + 1e-12)
            at = at - np.clip(np.linalg.solve(curvature, slope.T @ (robust * residual)), -0.5, 0.5)
    weight, m = np.exp(best[1]).reshape(2, count)
    return tuple(zip(weight.tolist(), m.tolist(), strict=True))


def _nodes(of: Distribution) -> tuple[Floats, Floats, Floats]:
    """tan^2 of facets, pi D cos^4 there, and what a unit of that weighs: the weights of all of D add up to 1.

    Head-on a facet sends on 4 cos^2 - 2 of what it gets where the V-groove's G clips, beyond 30 degrees; a little is
    kept of steeper ones, which other views see.
    """
    narrow = max(float(of.bins[1]) / 20.0, LOWEST_SIN2)
    sin2 = np.unique(np.concatenate([of.bins[1:-1:2], np.geomspace(narrow, 0.9999, 300)]))
    cos2 = 1.0 - sin2
    D = np.pi * of.density(sin2, np.sqrt(cos2)) * cos2**2
    area = np.gradient(sin2) / cos2**2 * np.clip(4.0 * cos2 - 2.0, 0.05, 1.0)
    return sin2 / cos2, D, area / (D @ area)


def _parts(x: Floats, weight: Floats, m: Floats) -> Floats:
    """pi D cos^4 of each term, (nodes, terms)."""
    with np.errstate(under="ignore"):
        return np.exp(-x[:, None] / m**2) * (weight / m**2)


def native_fresnel(fresnel: Fresnel, specular: Floats) -> tuple[float, F82]:
    """``specular`` F as Cycles' closures have it: the largest channel as their weight, and F82 for the colour and F.

    Equal to it head-on and at 82 degrees (F82 cannot be more than Schlick's formula there).
    """
    specular = np.broadcast_to(np.asarray(specular, dtype=np.float64), (3,))
    weight = float(np.max(specular))
    color = specular / weight if weight > 0.0 else specular
    f0, edge = color * fresnel(np.float64(1.0)), color * fresnel(np.float64(F82_COSINE))
    return weight, F82(f0, np.minimum(edge / schlick(F82_COSINE, f0), 1.0))
