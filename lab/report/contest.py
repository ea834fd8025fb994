# SPDX-License-Identifier: GPL-3.0-or-later
"""One scene and subject: which contender has the smallest error, and what Automatic's choice costs. Imports no bpy.

Winners are judged by the processor's time, which other work on the machine changes little.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..bench.scene_table import SCENES
from .curve import TINY, Curve

if TYPE_CHECKING:
    from ..bench.cells import Accuracy, Numbers, Picks

CLOSE = 1.1  # Automatic's error over the winner's that still counts as good a choice
CHANCE = 2.0  # standard errors by which it must be more to be a poor one
AGAINST = ("closure", "mirror")  # what a winner is compared with


@dataclass(frozen=True)
class Win:
    """The estimator with the smallest error at so many seconds; over: the errors of ``AGAINST`` over its.

    An estimator whose error is unknown neither wins nor is in ``over``; nor is one that rarely hits the light.
    """

    at: float
    winner: str
    error: float
    over: dict[str, float]


class Pick(NamedTuple):
    """What Automatic picks at a sample count; ratio: its error over the winner's at equal processor time of samples.

    A render's start is left out: it does not grow with the picture, and those of a report are small. doubt: standard
    error of the ratio's logarithm. of_all: its error over that of ``best_of_all``, the best of all estimators, also of
    those that Automatic never picks.
    """

    samples: int
    estimator: str
    winner: str
    ratio: float
    doubt: float
    of_all: float
    best_of_all: str

    @property
    def close(self) -> bool:
        return self.ratio <= CLOSE

    @property
    def poor(self) -> bool:
        """Whether it is not close, and chance does not explain it: where rare events make noise, errors scatter."""
        return float(np.log(self.ratio / CLOSE)) > CHANCE * self.doubt


@dataclass(frozen=True)
class Contest:
    """A cell of accuracy, beside what Automatic picks there."""

    cell: Accuracy
    auto: Picks

    @property
    def key(self) -> str:
        return f"{self.cell.scene}/{self.cell.subject}"

    @property
    def title(self) -> str:
        return f"{SCENES[self.cell.scene].title}, {self.cell.subject}"

    @cached_property
    def curves(self) -> dict[str, Curve]:
        return {name: Curve.of(name, one, self.cell) for name, one in self.cell.contenders.items()}

    @cached_property
    def rivals(self) -> list[Curve]:
        return [curve for curve in self.curves.values() if curve.competes]

    @property
    def osl_over_nodes(self) -> dict[str, float]:
        """How much longer a sample takes as OSL, by estimator."""
        osl = {curve.estimator: curve.per_sample for curve in self.curves.values() if curve.backend == "osl"}
        return {
            curve.estimator: osl[curve.estimator] / curve.per_sample
            for curve in self.rivals
            if curve.estimator in osl and curve.per_sample > 0.0
        }

    @cached_property
    def judged_from(self) -> float:
        """Processor seconds from which on every rival samples for longer than it starts."""
        return max((max(2.0 * curve.start, curve.cpu[0]) for curve in self.rivals), default=0.0)

    @cached_property
    def wins(self) -> list[Win]:
        """At each of 1, 2, 5, 10, ... seconds, and tenths of them, at which every rival was measured.

        None where an error is unknown that might be the smallest.
        """
        last = min((float(np.max(curve.cpu)) for curve in self.rivals), default=0.0)
        times = [float(f"{digit}e{power}") for power in range(-6, 6) for digit in (1, 2, 5)]
        may_win = {curve.estimator for curve in self.rivals if curve.last is not None and not curve.rarely_hit}
        found = []
        for at in (seconds for seconds in times if self.judged_from <= seconds <= last):
            errors = {curve.estimator: curve.error_at(at) for curve in self.rivals}
            known = {name: error for name, error in errors.items() if np.isfinite(error)}
            if known and may_win <= known.keys():
                winner, error = min(known.items(), key=lambda one: one[1])
                against = [name for name in AGAINST if name in known and name not in self.rarely_hit and error > 0.0]
                found.append(Win(at, winner, error, {name: known[name] / error for name in against}))
        return found

    @cached_property
    def rarely_hit(self) -> set[str]:
        """Estimators whose errors here come from a handful of hits."""
        return {curve.estimator for curve in self.rivals if curve.rarely_hit}

    @cached_property
    def picks(self) -> list[Pick]:
        """Automatic's choice at each sample count at which its error is known."""
        by_estimator = {curve.estimator: curve for curve in self.rivals}
        return [
            self._pick(index, by_estimator[name], by_estimator)
            for index, name in enumerate(self.auto.estimators)
            if name in by_estimator and by_estimator[name].resolved[index]
        ]

    def _pick(self, index: int, own: Curve, rivals: dict[str, Curve]) -> Pick:
        seconds = own.samples[index] * own.per_sample
        of_all = {
            name: curve.error_of(seconds / curve.per_sample) for name, curve in rivals.items() if curve.per_sample > 0.0
        }
        of_all[own.estimator] = float(own.rmse[index])
        winner = min((name for name in of_all if name not in self.auto.refused), key=of_all.__getitem__)
        best_of_all = min(of_all, key=of_all.__getitem__)
        ratio, beside_all = (
            of_all[own.estimator] / of_all[name] if of_all[name] > 0.0 else 1.0 for name in (winner, best_of_all)
        )
        best = rivals[winner]
        there = int(np.searchsorted(best.samples[1:], seconds / best.per_sample, side="right"))
        doubt = float(np.hypot(_doubt(own)[index], _doubt(best)[there]))
        return Pick(int(own.samples[index]), own.estimator, winner, ratio, doubt, beside_all, best_of_all)


def _doubt(curve: Curve) -> Numbers:
    """Standard error of the logarithm of an error."""
    return curve.rmse_error / np.maximum(curve.rmse, TINY)
