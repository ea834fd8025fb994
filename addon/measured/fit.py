# SPDX-License-Identifier: GPL-3.0-or-later
"""Models fitted to measured BRDFs: a diffuse part and N lobes, by least squares under bounds. NumPy alone.

Metrics, over RGB at pairs of directions up to 80 degrees (``lobes.Pairs``):
    log    sum of (ln(1 + f cos theta_i) - ln(1 + g cos theta_i))^2, each cell of MERL's grid counted alike
    l1     sum of |f - g| cos theta_i cos theta_o dwi dwo: the light that goes elsewhere

Sources:
    Ngan, Durand & Matusik 2005, Experimental Analysis of BRDF Models, EGSR (lobes fitted; no grazing angles)
    Löw, Kronander, Ynnerman & Unger 2012, BRDF Models for Accurate and Efficient Rendering of Glossy Surfaces,
    ACM TOG 31(1), doi:10.1145/2077341.2077350 (the logarithm of f cos)
    Marquardt 1963, An Algorithm for Least-Squares Estimation of Nonlinear Parameters, doi:10.1137/0111030
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from ..library.files import FileError
from ..library.preset import check_form
from ..models import DEFAULT
from ..reference.directions import spherical
from .lobes import KINDS, Pairs
from .summary import reflected

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..library.preset import Preset
    from ..reference.directions import Floats
    from ..reference.model import Brdf
    from .lobes import Lobes
    from .table import Table

METRICS = {
    "log": "squared difference of ln(1 + f cos theta_i) over MERL's cells",
    "l1": "difference of f cos theta_i cos theta_o over solid angles",
}
ANGLES = (0, 15, 30, 45, 60, 75)  # degrees, of the light
TYPICAL = 45  # degrees
TRIED = (0.005, 0.015, 0.04, 0.1, 0.2, 0.4)  # slopes that a new lobe starts from
TRIAL, STEPS = 12, 120  # steps of a start, and of the two best
SOFT = 1e-3  # of the mean f: below, l1 is smooth
EXCESS = 1e3  # cost of reflecting more than arrives, for each square of the excess
FULL = 1.0 - 1e-5  # what all parts may reflect, so that rounding lifts it to 1 at most


@dataclass(frozen=True)
class Fit:
    """A preset fitted to a table. residual: share of the reflected light that differs, at each of ``ANGLES``."""

    preset: Preset
    lobes: int
    metric: str
    residual: tuple[float, ...]

    @property
    def mean(self) -> float:
        """The residual, averaged over ``ANGLES``."""
        return float(np.mean(self.residual))

    @property
    def says(self) -> str:
        """The residual in a few words, at ``TYPICAL`` and where it is largest."""
        share = dict(zip(ANGLES, self.residual, strict=True))
        most = max(share, key=share.__getitem__)
        text = f"differs by {100.0 * share[TYPICAL]:.2g} % of the light at {TYPICAL} degrees"
        return text if most == TYPICAL else f"{text}, {100.0 * share[most]:.2g} % at {most}"


def fit(table: Table, name: str, data: str, lobes: int = 2, kind: str = DEFAULT, metric: str = "l1") -> Fit:
    """The last of ``fits``."""
    *_, last = fits(table, name, data, lobes, kind, metric)
    return last


def fits(table: Table, name: str, data: str, lobes: int = 2, kind: str = DEFAULT, metric: str = "l1") -> Iterator[Fit]:
    """The best fits of one lobe, two, and so on, to isotropic data. name: of the presets; data: where f comes from.

    Each starts from the one before, with a lobe more of several slopes. FileError for anisotropic or black data.
    """
    if not table.contents.isotropic:
        message = "is anisotropic, and its lobes are round; fit an isotropic measurement"
        raise FileError(message)
    pairs, model = Pairs(), KINDS[kind]
    of = _Problem(pairs, table.evaluate(pairs.wi, pairs.wo), metric)
    p = model.start(np.clip(np.pi * np.median(of.f, axis=0), 1e-3, 0.9))
    for count in range(1, lobes + 1):
        tried = [_descend(of, model, count, model.with_lobe(p, slope), TRIAL) for slope in TRIED]
        tried.sort(key=lambda one: one[0])
        _, p = min((_descend(of, model, count, start, STEPS) for _, start in tried[:2]), key=lambda one: one[0])
        preset = model.preset(model.within(p, FULL), name, {"data": data})
        found = residual(table, preset.reference().evaluate)
        says = f"{kind} of {count} lobes, fitted by metric {metric}: {METRICS[metric]}, up to 80 degrees"
        off = f"{', '.join(f'{100.0 * one:.2g}' for one in found)} % of the reflected light differ"
        trust = f"{says}; {off} with the light at {', '.join(map(str, ANGLES))} degrees"
        source = {"data": data, "trust": trust, "colour": "measured", "roughness": "measured"}
        check_form(name, preset)
        yield Fit(replace(preset, source=source), count, metric, found)


def residual(table: Table, g: Brdf) -> tuple[float, ...]:
    """Integral of |f - g| cos theta_o over that of f cos theta_o, all channels together, at each of ``ANGLES``."""
    found = []
    for angle in ANGLES:
        wi = spherical(np.radians(angle))
        wo, weight = reflected(wi)
        f = table.evaluate(wi, wo)
        found.append(float((weight @ np.abs(f - g(wi, wo))).sum() / max((weight @ f).sum(), 1e-300)))
    return tuple(found)


class _Problem:
    """What a metric makes of f at the pairs: values to compare, and the weight of each difference."""

    def __init__(self, pairs: Pairs, f: Floats, metric: str) -> None:
        self.pairs, self.f, self.is_log = pairs, f, metric == "log"
        self.wanted = self.values(f)
        if not self.wanted.any():
            message = "is black up to 80 degrees; there is nothing to fit"
            raise FileError(message)
        if self.is_log:
            self.weight: Floats = np.full(f.shape, 1.0 / float(np.square(self.wanted).sum()))
            self.soft = 0.0
        else:
            mean = float((pairs.weight @ f).mean())
            self.weight = np.repeat(pairs.weight[:, None], 3, axis=1) / mean
            self.soft = SOFT * mean

    def values(self, f: Floats) -> Floats:
        return np.log1p(f * self.pairs.wi[:, 2:]) if self.is_log else f

    def cost(self, off: Floats) -> float:
        size = np.square(off) if self.is_log else np.hypot(off, self.soft) - self.soft
        return float((self.weight * size).sum())

    def curvature(self, off: Floats) -> Floats:
        """Weights of squares whose sum, up to a constant, touches the cost from above."""
        return self.weight if self.is_log else self.weight / (2.0 * np.hypot(off, self.soft))


def _descend(of: _Problem, kind: Lobes, lobes: int, p: Floats, steps: int) -> tuple[float, Floats]:
    """Marquardt's steps from ``p`` within the parts' ranges: the cost and the numbers there."""
    parts = kind.parts(lobes)
    low, high = (np.concatenate([getattr(part, end) for part in parts]) for end in ("low", "high"))
    ends = np.cumsum([0, *(len(part.low) for part in parts)])
    slots = [slice(a, b) for a, b in pairwise(ends)]

    def excess(p: Floats) -> Floats:
        total = sum(part.reflects(p[slot]) for part, slot in zip(parts, slots, strict=True))
        return np.maximum(total - FULL, 0.0)

    def evaluated(p: Floats) -> tuple[list[Floats], Floats, float]:
        each = [part.evaluate(of.pairs, p[slot]) for part, slot in zip(parts, slots, strict=True)]
        off = of.values(sum(each, np.zeros_like(of.f))) - of.wanted
        return each, off, of.cost(off) + EXCESS * float(np.square(excess(p)).sum())

    p = np.clip(p, low, high)
    damping, (each, off, cost) = 1e-3, evaluated(p)
    for _ in range(steps):
        J = np.empty((off.size + 3, p.size))
        total, over = sum(each, np.zeros_like(of.f)), excess(p)
        for part, slot, now in zip(parts, slots, each, strict=True):
            for index in range(slot.start, slot.stop):
                there = p.copy()
                there[index] += 1e-6 if p[index] + 1e-6 <= high[index] else -1e-6
                step = there[index] - p[index]
                moved = of.values(total - now + part.evaluate(of.pairs, there[slot])) - of.wanted
                J[:-3, index] = ((moved - off) / step).ravel()
                J[-3:, index] = (excess(there) - over) / step
        weight = np.append(of.curvature(off).ravel(), np.full(3, EXCESS))
        weighted = J * weight[:, None]
        slope, square = weighted.T @ np.append(off.ravel(), over), weighted.T @ J
        free = ~((p <= low) & (slope > 0) | (p >= high) & (slope < 0))
        before = cost
        while damping < 1e8:
            within = square[np.ix_(free, free)]
            there = p.copy()
            damped = within + damping * np.diag(np.diag(within) + 1e-12)
            there[free] -= np.linalg.solve(damped, slope[free])
            there = np.clip(there, low, high)
            found = evaluated(there)
            if found[2] < cost:
                p, (each, off, cost), damping = there, found, max(damping / 5.0, 1e-12)
                break
            damping *= 4.0
        if before - cost <= 1e-9 * before:
            break
    return cost, p
