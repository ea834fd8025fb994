# SPDX-License-Identifier: GPL-3.0-or-later
"""How a parameter of a material changes over time: laws in closed form, measured keys, and a clock for each point.

A law has its first value until ``begin``. It is evaluated only between the ends of its trajectory; beyond, the values
there hold. t and ``begin`` are in the trajectory's unit of time (``timeline.UNITS``: s to years, or a share of the
whole), rates in 1 over it. t has any shape (...); values are (...) for a number and (..., 3) for RGB, in the
parameter's unit.

Between keys numbers and colours (in linear light) are interpolated linearly, slopes m linearly in log m: doubling a
slope looks like the same step wherever it starts.

Source: Gu et al. 2006, "Time-varying surface appearance", for p(x, t) = p(rate(x) t - offset(x)). The laws are the
textbooks': first-order decay, its reciprocal, the logistic curve, powers (parabolic growth of films is the power 1/2).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from .directions import as_finite, as_positive, as_range

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from .directions import Floats


class Law(Protocol):
    """A parameter's value over time."""

    def __call__(self, t: ArrayLike) -> Floats:
        """Values (...) or (..., 3) at times t (...). ValueError for t that is not finite."""
        ...

    def events(self) -> Floats:
        """Times (n,) near which the law may bend sharply, for whoever samples it."""
        ...


@dataclass(frozen=True)
class Exponential:
    """p(t) = end + (start - end) sum_k share_k exp(-rate_k (t - begin)); start before ``begin``.

    start, end: a number or RGB (3,). rates: 1 / unit of time, each > 0. shares: of each rate, >= 0, sum 1; a stiff law
    has rates that differ by powers of ten. Raises ValueError otherwise.

    >>> Exponential(1.0, 0.0, rates=(2.0,))([-1.0, 0.0, 0.5]).round(6).tolist()
    [1.0, 1.0, 0.367879]
    """

    start: ArrayLike
    end: ArrayLike
    rates: tuple[float, ...]
    shares: tuple[float, ...] = (1.0,)
    begin: float = 0.0

    def __post_init__(self) -> None:
        as_positive(self.rates, "rates", high=1e100)
        shares = as_range(self.shares, "shares", 0.0, 1.0)
        if shares.shape != np.shape(self.rates) or abs(float(np.sum(shares)) - 1.0) > 1e-9:
            message = f"shares must be one for each of {len(self.rates)} rates and sum to 1, got {list(self.shares)}"
            raise ValueError(message)

    def __call__(self, t: ArrayLike) -> Floats:
        since = _since(t, self.begin)
        with np.errstate(over="ignore"):  # a product beyond float64 leaves exp(-inf) = 0
            left = np.exp(-np.multiply.outer(since, self.rates)) @ np.asarray(self.shares, float)
        return _between(self.start, self.end, 1.0 - left)

    def events(self) -> Floats:
        return _around(self.begin, self.rates)


@dataclass(frozen=True)
class Reciprocal:
    """1/p relaxes: 1/p(t) = 1/end + (1/start - 1/end) exp(-rate (t - begin)); start before ``begin``.

    The form in which Sun et al. 2007 are remembered to give the roughness of drying paint: p = start end /
    ((end - start) exp(-rate t) + start). start and end > 0.
    """

    start: ArrayLike
    end: ArrayLike
    rate: float
    begin: float = 0.0

    def __post_init__(self) -> None:
        as_positive(self.start, "start")
        as_positive(self.end, "end")
        as_positive(self.rate, "rate", high=1e100)

    def __call__(self, t: ArrayLike) -> Floats:
        with np.errstate(over="ignore"):
            left = np.exp(-self.rate * _since(t, self.begin))
        return 1.0 / _between(1.0 / np.asarray(self.start), 1.0 / np.asarray(self.end), 1.0 - left)

    def events(self) -> Floats:
        return _around(self.begin, (self.rate,))


@dataclass(frozen=True)
class Logistic:
    """An S: p(t) = start + (end - start) (S(t) - S(begin)) / (1 - S(begin)), S(t) = 1 / (1 + exp(-rate (t - middle))).

    Exactly start at ``begin`` and before, end for t to infinity. middle > begin - 30 / rate, so that S is not 1 there.
    """

    start: ArrayLike
    end: ArrayLike
    rate: float
    middle: float
    begin: float = 0.0

    def __post_init__(self) -> None:
        as_positive(self.rate, "rate", high=1e100)
        as_finite(self.middle, "middle")
        if self.rate * (self.begin - self.middle) > 30.0:
            message = f"middle must not lie more than 30 / rate before {self.begin:g}, got {self.middle:g}"
            raise ValueError(message)

    def __call__(self, t: ArrayLike) -> Floats:
        t = np.maximum(as_finite(t, "t"), self.begin)
        # (S - S0) / (1 - S0) with S = 1 / (1 + e), e = exp(-rate (t - middle)): (1 - e / e0) / (1 + e), no cancellation
        with np.errstate(over="ignore", under="ignore"):
            ratio = -np.expm1(-self.rate * (t - self.begin))
            rest = 0.5 * (1.0 + np.tanh(0.5 * np.clip(self.rate * (t - self.middle), -1e3, 1e3)))
        return _between(self.start, self.end, ratio * rest)

    def events(self) -> Floats:
        return np.concatenate([_around(self.middle, (self.rate,)), [self.begin]])


@dataclass(frozen=True)
class Power:
    """p(t) = start + (end - start) ((t - begin) / (finish - begin))^exponent.

    start before ``begin``, end from ``finish`` on. A film that grows by diffusion follows the exponent 1/2 (parabolic
    law). exponent in [0.1, 10].
    """

    start: ArrayLike
    end: ArrayLike
    exponent: float
    begin: float = 0.0
    finish: float = 1.0

    def __post_init__(self) -> None:
        as_range(self.exponent, "exponent", 0.1, 10.0)
        if not self.finish > self.begin:
            message = f"finish must be later than {self.begin:g}, got {self.finish:g}"
            raise ValueError(message)

    def __call__(self, t: ArrayLike) -> Floats:
        length = self.finish - self.begin
        part = np.minimum(_since(t, self.begin), length) / length
        return _between(self.start, self.end, part**self.exponent)

    def events(self) -> Floats:
        return np.concatenate([_around(self.begin, (1.0 / (self.finish - self.begin),)), [self.finish]])


@dataclass(frozen=True)
class Polynomial:
    """p(t) = sum_k coefficients_k t^k; coefficients of t^0 first, (n,) or (n, 3)."""

    coefficients: ArrayLike

    def __post_init__(self) -> None:
        if as_finite(self.coefficients, "coefficients").size == 0:
            message = "coefficients must hold at least one"
            raise ValueError(message)

    def __call__(self, t: ArrayLike) -> Floats:
        c, t = np.asarray(self.coefficients, float), as_finite(t, "t")
        t = t[..., None] if c.ndim == 2 else t
        value = np.zeros(np.broadcast_shapes(t.shape, c.shape[1:]))
        for coefficient in c[::-1]:
            value = value * t + coefficient
        return value

    def events(self) -> Floats:
        return np.empty(0)


@dataclass(frozen=True)
class Keys:
    """Values at given times, held beyond the first and last; between them straight, or straight in log p.

    times (n,), ascending. values (n,) or (n, 3); > 0 where ``geometric``. Raises ValueError otherwise.

    >>> Keys((0.0, 1.0), (0.1, 0.4), geometric=True)(0.5).round(12).tolist()
    0.2
    """

    times: ArrayLike
    values: ArrayLike
    geometric: bool = False

    def __post_init__(self) -> None:
        times, values = as_finite(self.times, "times"), as_finite(self.values, "values")
        if times.ndim != 1 or times.size == 0 or len(values) != times.size:
            message = f"values must be one for each of {times.size} times, got {len(np.atleast_1d(values))}"
            raise ValueError(message)
        if not (np.diff(times) > 0.0).all():
            message = f"times must ascend, got {times.tolist()}"
            raise ValueError(message)
        if self.geometric:
            as_positive(values, "values")

    def __call__(self, t: ArrayLike) -> Floats:
        t, times, values = as_finite(t, "t"), np.asarray(self.times, float), np.asarray(self.values, float)
        if times.size == 1:
            return np.broadcast_to(values[0], t.shape + values.shape[1:]).copy()
        t = np.clip(t, times[0], times[-1])
        k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, times.size - 2)
        part = (t - times[k]) / (times[k + 1] - times[k])
        part = part[..., None] if values.ndim == 2 else part
        before, after = values[k], values[k + 1]
        if self.geometric:
            return before ** (1.0 - part) * after**part
        return before * (1.0 - part) + after * part  # exact at both ends

    def events(self) -> Floats:
        return np.asarray(self.times, float)


@dataclass(frozen=True)
class Trajectory:
    """The parameters of a material that change, each by its law, from time ``start`` to ``end``.

    Values are held to ``ranges`` (a weight stays within 0 and 1, whatever its law says), and beyond start and end to
    what they are there.
    """

    laws: Mapping[str, Law]
    start: float = 0.0
    end: float = 1.0
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not (np.isfinite([self.start, self.end]).all() and self.end > self.start):
            message = f"end must be later than start, got {self.start:g} to {self.end:g}"
            raise ValueError(message)

    def at(self, t: ArrayLike) -> dict[str, Floats]:
        """Values at times t (...), by parameter."""
        return {name: self.value(name, t) for name in self.laws}

    def value(self, name: str, t: ArrayLike) -> Floats:
        """The same of one parameter; KeyError for one that does not change."""
        low, high = self.ranges.get(name, (-np.inf, np.inf))
        return np.clip(self.laws[name](np.clip(as_finite(t, "t"), self.start, self.end)), low, high)

    def age(self, t: ArrayLike) -> Floats:
        """0 at start, 1 at end: (t - start) / (end - start), held between."""
        return np.clip((as_finite(t, "t") - self.start) / (self.end - self.start), 0.0, 1.0)

    def time(self, age: ArrayLike) -> Floats:
        """The time of an age, which is held to 0..1."""
        return self.start + np.clip(as_finite(age, "age"), 0.0, 1.0) * (self.end - self.start)


def local_age(age: ArrayLike, rate: ArrayLike = 1.0, offset: ArrayLike = 0.0) -> Floats:
    """The age of a point that runs on a clock of its own: rate age - offset, held to 0..1. All (...), broadcast.

    Source: Gu et al. 2006, p(x, t) = p(rate(x) t - offset(x)), with time as a share of the trajectory.
    """
    return np.clip(as_finite(rate, "rate") * as_finite(age, "age") - as_finite(offset, "offset"), 0.0, 1.0)


def _since(t: ArrayLike, begin: float) -> Floats:
    return np.maximum(as_finite(t, "t") - begin, 0.0)


def _between(start: ArrayLike, end: ArrayLike, part: Floats) -> Floats:
    """Start for part 0, end for part 1, exactly."""
    start, end = as_finite(start, "start"), as_finite(end, "end")
    part = part[..., None] if start.ndim or end.ndim else part
    return start * (1.0 - part) + end * part


def _around(time: float, rates: tuple[float, ...]) -> Floats:
    """``time``, and times before and after it by powers of two of each rate's own time."""
    steps = np.concatenate([np.exp2(np.arange(-8.0, 7.0)) / rate for rate in rates])
    return np.concatenate([[time], time + steps, time - steps])
