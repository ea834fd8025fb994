# SPDX-License-Identifier: GPL-3.0-or-later
"""One contender's error against samples and time: slope, bias, error at a time. Imports no bpy.

Between two sample counts a curve is a straight line in log error and log time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ...addon.models.estimators import RANDOM
from ..bench.cells import LIMIT, Accuracy, Contender, Numbers
from ..bench.scene_table import SCENES

if TYPE_CHECKING:
    from numpy.typing import NDArray

SLOPE_RANGE = (2**6, 2**12)  # samples
TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class Slope:
    """Of log noise over log samples; -1/2 for independent samples.

    error: its standard error, measured by leaving out seeds where the slope is judged; else by the line's residuals or
    by the uncertainty of the noise, whichever is larger; None for two counts.
    """

    value: float
    error: float | None

    def known_to(self, bar: float) -> bool:
        return self.error is not None and self.error <= bar


@dataclass(frozen=True, kw_only=True)
class Curve(Contender):
    """A contender in its scene. rarely_hit: its noise comes from a handful of hits on a light, and has no slope."""

    name: str
    samples: Numbers
    rarely_hit: bool

    @classmethod
    def of(cls, name: str, contender: Contender, cell: Accuracy) -> Curve:
        """Where rays rarely hit the light, the bias of an estimator without bias is light that no seed has met yet.

        What so many samples have not met, fewer have not.
        """
        fields = dict(vars(contender))
        rarely_hit = SCENES[cell.scene].rarely_hit and contender.estimator in RANDOM
        if rarely_hit:
            met = contender.resolved & ~(contender.bias2 > LIMIT * contender.bias2_error)
            fields["resolved"] = np.logical_and.accumulate(met[::-1])[::-1]
        return cls(name=name, samples=np.array(cell.samples, np.float64), rarely_hit=rarely_hit, **fields)

    @property
    def competes(self) -> bool:
        """Whether it may win: peers show other models, and OSL the same pictures in other times."""
        return not self.peer and self.backend == "nodes"

    @cached_property
    def rmse(self) -> Numbers:
        """Root mean square error of one picture."""
        return np.sqrt(np.maximum(self.bias2, 0.0) + self.noise**2)

    @cached_property
    def rmse_error(self) -> Numbers:
        """Standard error of ``rmse``, by the cell's own figures; rather too large than too small.

        ``statistics.error`` takes bias^2 from products of two of S seeds, so that bias^2 + noise^2 is the mean of the
        seeds' squares. Its variance is that of one seed's over S: sum (2 v^2 + 4 b^2 v) / S / P^2, with v the variance
        in a pixel; that of bias^2 is sum (2 (v / S)^2 + 4 b^2 v / S) / P^2, at least 1 / S of it. And
        dx = d(x^2) / 2x.
        """
        return self.bias2_error * np.sqrt(self.seeds) / np.maximum(2.0 * self.rmse, TINY)

    @cached_property
    def slope(self) -> Slope | None:
        """By least squares within ``SLOPE_RANGE``; None without two noisy counts, or where hits are few."""
        if self.rarely_hit:
            return None
        used = (self.samples >= SLOPE_RANGE[0]) & (self.samples <= SLOPE_RANGE[1]) & self.resolved & (self.noise > 0.0)
        if np.count_nonzero(used) < 2:
            return None
        x, y = np.log(self.samples[used]), np.log(self.noise[used])
        x -= x.mean()
        slope = float(x @ y / (x @ x))
        if self.slope_error is not None or len(x) == 2:
            return Slope(slope, self.slope_error)
        residual = y - y.mean() - slope * x
        doubt = self.rmse_error[used] / _positive(self.rmse[used])
        known = np.sqrt(x**2 @ doubt**2) / (x @ x)  # few points may lie on a line by chance
        return Slope(slope, float(max(np.sqrt(residual @ residual / (len(x) - 2) / (x @ x)), known)))

    @cached_property
    def last(self) -> int | None:
        """The index of the largest sample count at which noise and bias are known."""
        known = np.flatnonzero(self.resolved)
        return int(known[-1]) if len(known) else None

    @property
    def floor(self) -> float:
        """The bias that is left at the most samples, where noise hides least of it."""
        return 0.0 if self.last is None else float(np.sqrt(max(self.bias2[self.last], 0.0)))

    @property
    def bias_z(self) -> Numbers:
        """The square of the bias in its standard errors, by sample count; 0 where nothing is resolved."""
        return np.where(self.resolved, self.bias2 / _positive(self.bias2_error), 0.0)

    @property
    def biased_at(self) -> NDArray[np.bool_]:
        """Whether the bias can be distinguished from 0, by sample count."""
        return self.bias_z > LIMIT

    @property
    def biased(self) -> bool:
        """Whether the floor can be distinguished from 0."""
        return self.last is not None and bool(self.biased_at[self.last])

    @property
    def bias_bound(self) -> float:
        """What the bias does not exceed, within ``LIMIT`` standard errors."""
        if self.last is None:
            return float("inf")
        return float(np.sqrt(max(self.bias2[self.last], 0.0) + LIMIT * self.bias2_error[self.last]))

    @property
    def start(self) -> float:
        """Processor seconds before the first sample: a of a + b N, by least squares of relative residuals."""
        return self._line[0]

    @property
    def per_sample(self) -> float:
        """Processor seconds that a sample of every pixel takes: the b of ``start``."""
        return self._line[1]

    @cached_property
    def _line(self) -> tuple[float, float]:
        if len(self.samples) < 2:
            return 0.0, float(self.cpu[-1] / self.samples[-1])
        design = np.stack([1.0 / self.cpu, self.samples / self.cpu], axis=-1)
        start, per_sample = np.linalg.lstsq(design, np.ones(len(self.cpu)), rcond=None)[0]
        return max(float(start), 0.0), max(float(per_sample), 0.0)

    def error_of(self, samples: float) -> float:
        """The error of so many samples; infinite where it is not known, as with fewer than were measured.

        Counts that are not known are bridged between two that are. After the last as in ``error_at``.
        """
        return self._error(samples, self.samples)

    def error_at(self, seconds: float) -> float:
        """The error after so many processor seconds; infinite where it is not known, as before the first render ends.

        After the last the bias stays, and the noise keeps falling as it did, or as 1/sqrt(N) if that is faster.
        """
        return self._error(seconds, _rising(self.cpu))

    def _error(self, at: float, along: Numbers) -> float:
        if self.last is None or at < along[self.resolved][0]:
            return float("inf")
        if at > along[-1] and self.resolved[-1]:
            power = max(0.5, -self.slope.value) if self.slope else 0.5
            noise = self.noise[-1] * (at / along[-1]) ** -power
            return float(np.sqrt(max(self.bias2[-1], 0.0) + noise**2))
        if at > along[self.last]:
            return float("inf")
        known = np.log(_positive(self.rmse[self.resolved]))
        return float(np.exp(np.interp(np.log(at), np.log(along[self.resolved]), known)))


def _rising(times: Numbers) -> Numbers:
    """Times as they would be if no render had been held up: more samples never take less."""
    return np.maximum.accumulate(times)


def _positive(values: Numbers) -> Numbers:
    return np.maximum(values, TINY)
