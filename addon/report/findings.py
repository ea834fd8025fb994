# SPDX-License-Identifier: GPL-3.0-or-later
"""What the numbers of a report say: slopes, bias floors, times to an error, winners, Automatic's choices.

Whatever is drawn or told of a report comes from here, so that no figure is worked out twice. Imports no bpy. Errors
are shares of the truth's root mean square, times are seconds; winners are judged by the processor's, which other work
on the machine changes little. Between two sample counts a curve is a straight line in log error and log time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from .record import ReportError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

TARGETS = (0.02, 0.01)  # errors, the time to which is told
SLOPE_RANGE = (2**6, 2**12)  # samples
TOLD = 3.0  # standard errors by which a bias must exceed 0 to be told from it
CLOSE = 1.1  # Automatic's error over the winner's that still counts as good a choice
NUMBERS = ("rmse", "bias2", "bias2_error", "noise", "wall", "cpu")  # of a contender, one a sample count
AGAINST = ("closure", "mirror")  # what a winner is held against


@dataclass(frozen=True)
class Slope:
    """Of log noise over log samples, and its standard error; -1/2 for independent samples."""

    value: float
    error: float


@dataclass(frozen=True)
class Reached:
    """The time to an error. seconds: None if it is not reached; limit: "floor" or "time", what it then is, or else "".

    within: reached by the first render already, in so many seconds or less.
    """

    seconds: float | None
    limit: str = ""
    value: float = 0.0
    within: bool = False


@dataclass(frozen=True)
class Curve:
    """One contender in one scene, an array element a sample count.

    peer: "" if it is ours. bias2 is an unbiased estimate, below 0 where there is next to none.
    """

    name: str
    estimator: str
    backend: str
    peer: str
    differs: str
    samples: NDArray[np.float64]
    rmse: NDArray[np.float64]
    bias2: NDArray[np.float64]
    bias2_error: NDArray[np.float64]
    noise: NDArray[np.float64]
    flip: NDArray[np.float64] | None
    wall: NDArray[np.float64]
    cpu: NDArray[np.float64]

    @property
    def competes(self) -> bool:
        """Whether it may win: peers show other models, and OSL the same pictures in other times."""
        return not self.peer and self.backend == "nodes"

    @cached_property
    def slope(self) -> Slope | None:
        """By least squares within ``SLOPE_RANGE``; None where three noisy counts are not to be had."""
        x, y = np.log(self.samples), np.log(np.maximum(self.noise, np.finfo(np.float64).tiny))
        used = (self.samples >= SLOPE_RANGE[0]) & (self.samples <= SLOPE_RANGE[1]) & (self.noise > 0.0)
        if np.count_nonzero(used) < 3:
            return None
        x, y = x[used] - x[used].mean(), y[used]
        slope = float(x @ y / (x @ x))
        residual = y - y.mean() - slope * x
        return Slope(slope, float(np.sqrt(residual @ residual / (len(x) - 2) / (x @ x))))

    @property
    def floor(self) -> float:
        """The bias that is left at the most samples, where noise hides least of it."""
        return float(np.sqrt(max(self.bias2[-1], 0.0)))

    @property
    def told_at(self) -> NDArray[np.bool_]:
        """Whether the bias can be told from 0, by sample count."""
        return self.bias2 > TOLD * self.bias2_error

    @property
    def told(self) -> bool:
        """Whether the floor can be told from 0."""
        return bool(self.told_at[-1])

    @property
    def at_most(self) -> float:
        """What the bias does not exceed, by as many standard errors as ``TOLD``."""
        return float(np.sqrt(max(self.bias2[-1], 0.0) + TOLD * self.bias2_error[-1]))

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

    def time_to(self, target: float, clock: str) -> Reached:
        """Seconds, by "wall" or "cpu", after which the error is ``target``."""
        times = _rising(getattr(self, clock))
        below = np.flatnonzero(self.rmse <= target)
        if not len(below):
            return Reached(None, "floor", self.floor) if self.told and self.floor > target else Reached(
                None, "time", float(times[-1])
            )  # fmt: skip
        first = below[0]
        if first == 0:
            return Reached(float(times[0]), within=True)
        span = slice(first - 1, first + 1)
        x, y = np.log(_positive(self.rmse[span])), np.log(times[span])
        share = (np.log(target) - x[0]) / (x[1] - x[0])
        return Reached(float(np.exp(y[0] + share * (y[1] - y[0]))))

    def error_at(self, seconds: float) -> float:
        """The error after so many processor seconds; infinite before the first render ends.

        After the last the bias stays, and the noise falls on as 1/sqrt(N).
        """
        times = _rising(self.cpu)
        if seconds < times[0]:
            return float("inf")
        if seconds > times[-1]:
            return float(np.sqrt(max(self.bias2[-1], 0.0) + self.noise[-1] ** 2 * times[-1] / seconds))
        return float(np.exp(np.interp(np.log(seconds), np.log(times), np.log(_positive(self.rmse)))))


@dataclass(frozen=True)
class Win:
    """Who errs least at a time; over: by how much more the others of ``AGAINST`` err then."""

    seconds: float
    winner: str
    error: float
    over: dict[str, float]


@dataclass(frozen=True)
class Pick:
    """What Automatic takes at a sample count, and its error over the winner's.

    by: "time" if both had equal processor time, "samples" if equal samples: where a render starts for longer than it
    samples, times differ by the machine's whims alone.
    """

    samples: int
    estimator: str
    winner: str
    ratio: float
    by: str

    @property
    def close(self) -> bool:
        return self.ratio <= CLOSE


@dataclass(frozen=True)
class Contest:
    """One scene and subject."""

    scene: str
    subject: str
    m: float | None
    seeds: NDArray[np.int_]  # by sample count
    truth: str
    curves: dict[str, Curve]
    picked: tuple[str, ...]
    pictures: dict[str, str]  # by contender, and the "reference"
    picture_samples: int

    @property
    def title(self) -> str:
        return f"{self.scene}, {self.subject}"

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

    def best_at(self, seconds: float) -> tuple[str, float]:
        return min(((curve.estimator, curve.error_at(seconds)) for curve in self.rivals), key=lambda one: one[1])

    @cached_property
    def wins(self) -> list[Win]:
        """At each of 1, 2, 5, 10, ... seconds and their parts that every rival was measured at."""
        if not self.rivals:
            return []
        last = min(float(np.max(curve.cpu)) for curve in self.rivals)
        return [self._win(seconds) for seconds in _round_times(self.judged_from, last)]

    def _win(self, seconds: float) -> Win:
        winner, error = self.best_at(seconds)
        others = {curve.estimator: curve.error_at(seconds) / error for curve in self.rivals if error > 0.0}
        return Win(seconds, winner, error, {name: others[name] for name in AGAINST if name in others})

    @cached_property
    def picks(self) -> list[Pick]:
        """Automatic's choice at each sample count."""
        found = []
        by_estimator = {curve.estimator: curve for curve in self.rivals}
        for index, name in enumerate(self.picked):
            if (own := by_estimator.get(name)) is None:
                continue
            seconds = float(_rising(own.cpu)[index])
            by = "time" if seconds >= self.judged_from else "samples"
            errors = {
                curve.estimator: curve.error_at(seconds) if by == "time" else float(curve.rmse[index])
                for curve in self.rivals
            } | {name: float(own.rmse[index])}
            winner = min(errors, key=lambda one: errors[one])
            ratio = errors[name] / errors[winner] if errors[winner] > 0.0 else 1.0
            found.append(Pick(int(own.samples[index]), name, winner, ratio, by))
        return found


@dataclass(frozen=True)
class Dropped:
    """A thing that a material does without. time: with it, over the time without; same: the picture is."""

    what: str
    nodes: int
    time: float
    same: bool


@dataclass(frozen=True)
class LeftOut:
    """A material as built against the universal one. time: the universal one's over its own, and its rounds' spread.

    Pairs are of the material as built and of the universal one; first: the ratio of first renders, which compile.
    """

    case: str
    preset: str
    scene: str
    backend: str
    time: float
    spread: tuple[float, float]
    first: float
    nodes: tuple[int, int]
    instructions: tuple[int, int]  # 0 for plain nodes, whose count Cycles keeps to itself
    memory_mb: tuple[float, float] | None
    same: bool  # the picture is
    dropped: tuple[Dropped, ...]

    @property
    def title(self) -> str:
        return f"{self.case}, {self.scene}, {self.backend}"


@dataclass(frozen=True)
class Case:
    """An extreme case. setup: how it is rendered; limit: what is done in place of what was asked, "" if nothing."""

    group: str
    what: str
    value: str
    setup: str
    finite: bool
    lowest: float | None
    highest: float | None
    z: float | None
    limit: str
    passed: bool


@dataclass(frozen=True)
class Run:
    """All that was measured on one Blender."""

    blender: str
    vgroove: str
    quick: bool
    contests: tuple[Contest, ...]
    cases: tuple[Case, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def curves(self) -> Iterator[tuple[Contest, Curve]]:
        for contest in self.contests:
            for curve in contest.curves.values():
                yield contest, curve

    @property
    def picks(self) -> list[tuple[Contest, Pick]]:
        return [(contest, pick) for contest in self.contests for pick in contest.picks]

    @property
    def wins(self) -> list[tuple[Contest, Win]]:
        return [(contest, win) for contest in self.contests for win in contest.wins]


def runs(content: dict[str, Any]) -> list[Run]:
    """Of a report.json, the newest Blender first. ReportError if a cell is not as this vgroove writes it."""
    newest = sorted(content["runs"], key=_version, reverse=True)
    return [_run(blender, content["runs"][blender]) for blender in newest]


def _run(blender: str, run: dict[str, Any]) -> Run:
    contests, cases, left_out = [], [], []
    for key, cell in run["cells"].items():
        part, _, what = key.partition("/")
        try:
            if part == "accuracy":
                contests.append(_contest(cell))
            elif part == "stability":
                cases += [_case(what, case) for case in cell["cases"]]
            elif part == "left_out":
                left_out += [_left_out(what, cell, setup) for setup in cell["setups"]]
        except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
            message = f"{key}: not as this vgroove writes it ({type(error).__name__}: {error}); measure it anew"
            raise ReportError(message) from error
    return Run(blender, run["vgroove"], run["quick"], tuple(contests), tuple(cases), tuple(left_out))


def _contest(cell: dict[str, Any]) -> Contest:
    samples = np.asarray(cell["samples"], np.float64)
    pictures = cell.get("pictures") or {}
    return Contest(
        cell["scene"], cell["subject"], cell.get("m"), np.broadcast_to(cell["seeds"], samples.shape),
        cell.get("truth", ""),
        {name: _curve(name, samples, one) for name, one in cell["contenders"].items()},
        tuple(cell.get("auto") or ()), pictures.get("files", {}), pictures.get("samples", 0),
    )  # fmt: skip


def _curve(name: str, samples: NDArray[np.float64], one: dict[str, Any]) -> Curve:
    numbers: dict[str, Any] = {key: np.asarray(one[key], np.float64) for key in NUMBERS}
    flip = np.asarray(one["flip"], np.float64) if one.get("flip") else None
    words: dict[str, Any] = {key: one.get(key) or "" for key in ("estimator", "backend", "peer", "differs")}
    return Curve(name, samples=samples, flip=flip, **words, **numbers)


def _case(group: str, case: dict[str, Any]) -> Case:
    return Case(
        group, case["what"], _words(case["value"]), case.get("setup", ""), case["finite"], case.get("lowest"),
        case.get("highest"), case.get("z"), case.get("limit") or "", case["passed"],
    )  # fmt: skip


def _words(value: Any) -> str:
    """A number in short, a table as its names and values."""
    if isinstance(value, dict):
        return ", ".join(f"{name.replace('_', ' ')} {_words(one)}" for name, one in value.items()) or "as usual"
    if isinstance(value, list):
        return " ".join(_words(one) for one in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def _left_out(name: str, cell: dict[str, Any], setup: dict[str, Any]) -> LeftOut:
    def pair(of: dict[str, Any]) -> tuple[Any, Any]:
        return of["built"], of["universal"]

    memory, render = cell.get("memory"), setup["render"]
    measured = memory is not None and memory["scene"] == setup["scene"] and setup["backend"] == "nodes"
    return LeftOut(
        name, cell["preset"], setup["scene"], setup["backend"], render["ratio"],
        (min(render["rounds"]), max(render["rounds"])), setup["first"]["ratio"], pair(setup["nodes"]),
        pair(setup["instructions"]),
        (memory["built"]["peak"] / 2**20, memory["universal"]["peak"] / 2**20) if memory and measured else None,
        setup["same"],
        tuple(Dropped(one["what"], one["nodes"], one["time"], one["same"]) for one in setup["left_out"]),
    )  # fmt: skip


def _rising(times: NDArray[np.float64]) -> NDArray[np.float64]:
    """Times as they would be if no render had been held up: more samples never take less."""
    return np.maximum.accumulate(times)


def _positive(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.maximum(values, np.finfo(np.float64).tiny)


def _round_times(first: float, last: float) -> list[float]:
    """1, 2, 5, 10, ... and their parts, from ``first`` to ``last``."""
    found = [float(f"{digit}e{power}") for power in range(-6, 6) for digit in (1, 2, 5)]
    return [seconds for seconds in found if first <= seconds <= last]


def _version(text: str) -> tuple[int, ...]:
    return tuple(int(part) for part in text.split(".") if part.isdigit())
