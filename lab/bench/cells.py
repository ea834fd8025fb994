# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report measures, as report.json holds it: one type for each part. Imports NumPy alone.

Arrays have an element for each sample count unless said otherwise. Errors are shares of the truth's root mean square,
times are seconds. Fields at their defaults are not written.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Numbers: TypeAlias = NDArray[np.float64]
Flags: TypeAlias = NDArray[np.bool_]

LIMIT = 3.0  # standard errors by which a bias must exceed its bound to be distinguished from it
SLOWER = 1.3  # largest slowdown of the default over a native material
MAX_DOUBT = 0.025  # largest standard error of its mean


@dataclass(frozen=True, kw_only=True)
class Contender:
    """One way to show a subject in a scene: an estimator of ours as nodes or OSL, or a peer.

    peer: "" for ours, "cycles" or "mitsuba". differs: how its model differs from the preset's. bias2: an unbiased
    estimate of bias^2, below 0 by chance where there is next to none; bias2_error: its standard error. noise: of one
    picture. cpu: median seconds of a render; cpu_spread: the seeds' standard deviation of it, as a share. resolved:
    false if no seed hit the light; noise and bias are then unknown. seeds: pictures by sample count. slope_error:
    standard error of the slope of log noise, where it was measured.
    """

    estimator: str = ""
    backend: str = ""
    peer: str = ""
    differs: str = ""
    bias2: Numbers
    bias2_error: Numbers
    noise: Numbers
    cpu: Numbers
    cpu_spread: Numbers
    resolved: Flags
    seeds: Numbers
    slope_error: float | None = None


@dataclass(frozen=True, kw_only=True)
class Accuracy:
    """One scene and subject.

    size: pixels across and down. samples: per pixel. seeds: pictures whose times count, by sample count. truth: where
    it comes from; independent: whether ``mirror`` has no part in it. roughness: m and sigma, those that the preset has.
    smooth: an interface without facets, for which nothing is drawn by a hash. without: why Mitsuba is missing.
    """

    scene: str
    subject: str
    model: str
    roughness: dict[str, float]
    size: int
    samples: tuple[int, ...]
    seeds: tuple[int, ...]
    truth: str
    independent: bool
    contenders: dict[str, Contender]
    smooth: bool = False
    without: str = ""


@dataclass(frozen=True, kw_only=True)
class Picks:
    """What Automatic picks for a scene and subject at each sample count; refused: what it never picks, and why."""

    estimators: tuple[str, ...]
    refused: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Case:
    """An extreme case of ``stability.TABLE``.

    value: what is varied, a number, a text or the settings that are not as usual; held: what float32 shaders make of
    it. setup: how it is rendered, "NumPy" for the reference alone. lowest, highest: of all pixels, None if one is not
    finite; of a white sky the albedo, as the mean of pixels that should be equal. z: of a factor that scales all pixels
    together, in its standard errors; resolves: the smallest such factor, less 1, that z would have distinguished from
    chance. again: where z fails, whether another seed passes. limit: what is done in place of what was asked, "" if
    nothing. passed: all is finite, not negative, no more light than came, unbiased or limited, and the checks of its
    group hold. error, bar: of what needs no chance. noise: over what independent samples explain. numbers: different
    random numbers in a pixel; rays: as many as the panel predicts.
    """

    group: str
    what: str
    value: Any
    setup: str
    passed: bool
    held: float | None = None
    lowest: float | None = None
    highest: float | None = None
    z: float | None = None
    resolves: float | None = None
    again: bool | None = None
    limit: str = ""
    error: float | None = None
    bar: float | None = None
    noise: float | None = None
    numbers: float | None = None
    rays: float | None = None


@dataclass(frozen=True, kw_only=True)
class OmittedPart:
    """A component the builder left out, and why. Put back with a weight of 0 it adds ``nodes``.

    same: the picture does not change. None where it was not put back.
    """

    what: str
    why: str
    nodes: int | None = None
    same: bool | None = None


@dataclass(frozen=True, kw_only=True)
class LeftOut:
    """A material as built, against the universal material, in one scene and setup. Pairs: as built, universal.

    slowdown: the universal material's render time over its own, the median of rounds; spread: the rounds' smallest and
    largest. instructions: of OSL, 0 for nodes. same: both show the same
    picture.
    """

    case: str
    preset: str
    scene: str
    backend: str
    estimator: str
    slowdown: float
    spread: tuple[float, float]
    nodes: tuple[int, int]
    instructions: tuple[int, int] = (0, 0)
    same: bool = True
    omitted: tuple[OmittedPart, ...] = ()

    @property
    def title(self) -> str:
        return f"{self.case}, {self.scene}, {self.estimator}, {self.backend}"

    @property
    def all_same(self) -> bool:
        """Whether no picture differs: neither the universal material's nor one with a component put back."""
        return self.same and all(one.same is not False for one in self.omitted)


@dataclass(frozen=True, kw_only=True)
class Everyday:
    """The default material in an everyday scene, beside the nearest native one.

    mean: over the pixels that show the material, ours over the native one's, for the channel that is farthest off;
    doubt: its standard error; band: where it should be. apart: by what share of the light the pictures differ pixel by
    pixel, less noise; bar: what it may be. black, bright: pixels that are so where the native material's are not.
    slowdown: over the native material's time, None where it was not measured. warnings: those that are wrong there.
    """

    title: str
    subject: str
    estimator: str
    mean: float
    doubt: float
    band: tuple[float, float]
    apart: float
    bar: float
    black: int = 0
    bright: int = 0
    slowdown: float | None = None
    warnings: tuple[str, ...] = ()

    @property
    def right(self) -> bool:
        """Whether its picture is as it should be. A doubt that is too large to judge counts against it."""
        low, high = self.band
        near = low - LIMIT * self.doubt <= self.mean <= high + LIMIT * self.doubt
        spotless = not self.black and not self.bright
        return near and self.doubt < MAX_DOUBT and self.apart < self.bar + LIMIT * self.doubt and spotless

    @property
    def quick(self) -> bool:
        return self.slowdown is None or self.slowdown <= SLOWER

    @property
    def passed(self) -> bool:
        return self.right and self.quick and not self.warnings


@dataclass(frozen=True)
class Table:
    """Plain numbers and words, as documents show them."""

    columns: list[str]
    rows: list[list[Any]]


PARTS: dict[str, Any] = {
    "accuracy": Accuracy,
    "picks": Picks,
    "stability": tuple[Case, ...],
    "left_out": tuple[LeftOut, ...],
    "everyday": tuple[Everyday, ...],
    "figures": dict[str, Table],
}


def part_of(key: str) -> str:
    """The part of a cell's key, PART/WHAT."""
    return key.partition("/")[0]
