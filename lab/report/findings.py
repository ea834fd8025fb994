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

from ..bench import record
from ..bench.record import ReportError
from ..bench.statistics import SELDOM

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

DEFAULT = (5, 2)  # the Blender whose figures pages tell
TARGETS = (0.02, 0.01)  # errors, the time to which is told
SLOPE_RANGE = (2**6, 2**12)  # samples
SCENES = {  # of ``scenes.stage``, as they are called
    "furnace": "white furnace",
    "environment": "environment map",
    "softbox": "softbox",
    "sun": "half-degree sun",
    "outdoors": "environment map and sun",
    "checker": "checkered floor",
}
RANDOM = ("mirror", "hybrid")  # estimators that must hit it so; without bias, or next to none
TOLD = 3.0  # standard errors by which a bias must exceed 0 to be told from it
CLOSE = 1.1  # Automatic's error over the winner's that still counts as good a choice
SLOWER, DOUBT = 1.3, 0.025  # the default over a native material: times as long at most; its mean, known at least so
CHANCE = 2.0  # standard errors by which it must be more for a poor one
NUMBERS = ("rmse", "bias2", "bias2_error", "noise", "wall", "cpu")  # of a contender, one a sample count
AGAINST = ("closure", "mirror")  # what a winner is held against


@dataclass(frozen=True)
class Slope:
    """Of log noise over log samples; -1/2 for independent samples.

    error: its standard error, measured by leaving out seeds where the slope is judged; else by the line's residuals or
    by how well the noise is known, whichever is more; None of two counts.
    """

    value: float
    error: float | None

    def known_to(self, bar: float) -> bool:
        return self.error is not None and self.error <= bar


@dataclass(frozen=True)
class Reached:
    """The time to an error. seconds: None if it is not reached; limit: what it then is, "floor", "time" or "noise".

    "noise": at no sample count is the error known. within: reached by the first render already, in so many seconds or
    less.
    """

    seconds: float | None
    limit: str = ""
    value: float = 0.0
    within: bool = False


@dataclass(frozen=True)
class Curve:
    """One contender in one scene, an array element a sample count.

    peer: "" if it is ours. bias2 is an unbiased estimate, below 0 where there is next to none. cpu_spread: of the
    seeds' times, as a share. resolved: false where no seed has met the rare events that there are, so that neither
    noise nor bias is known. seldom: whether there are any, so that noise is of a handful of hits and tells no slope.
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
    cpu_spread: NDArray[np.float64]
    resolved: NDArray[np.bool_]
    seeds: NDArray[np.int_]
    seldom: bool
    slope_error: float | None = None  # where it was measured

    @property
    def competes(self) -> bool:
        """Whether it may win: peers show other models, and OSL the same pictures in other times."""
        return not self.peer and self.backend == "nodes"

    @cached_property
    def slope(self) -> Slope | None:
        """By least squares within ``SLOPE_RANGE``; None where two noisy counts are not to be had, or hits are few."""
        if self.seldom:
            return None
        x, y = np.log(self.samples), np.log(np.maximum(self.noise, np.finfo(np.float64).tiny))
        used = (self.samples >= SLOPE_RANGE[0]) & (self.samples <= SLOPE_RANGE[1])
        used &= self.resolved & (self.noise > 0.0)
        if np.count_nonzero(used) < 2:
            return None
        x, y = x[used] - x[used].mean(), y[used]
        slope = float(x @ y / (x @ x))
        if self.slope_error is not None:
            return Slope(slope, self.slope_error)
        if len(x) == 2:
            return Slope(slope, None)
        residual = y - y.mean() - slope * x
        doubt = rmse_error(self)[used] / _positive(self.rmse[used])
        known = np.sqrt(x**2 @ doubt**2) / (x @ x)  # few points may lie on a line by chance
        return Slope(slope, float(max(np.sqrt(residual @ residual / (len(x) - 2) / (x @ x)), known)))

    @cached_property
    def last(self) -> int | None:
        """The index of the most samples at which noise and bias are known."""
        known = np.flatnonzero(self.resolved)
        return int(known[-1]) if len(known) else None

    @property
    def floor(self) -> float:
        """The bias that is left at the most samples, where noise hides least of it."""
        return 0.0 if self.last is None else float(np.sqrt(max(self.bias2[self.last], 0.0)))

    @property
    def told_at(self) -> NDArray[np.bool_]:
        """Whether the bias can be told from 0, by sample count."""
        return self.bias_z > TOLD

    @property
    def bias_z(self) -> NDArray[np.float64]:
        """The square of the bias in its standard errors, by sample count; 0 where nothing is resolved."""
        return np.where(self.resolved, self.bias2 / _positive(self.bias2_error), 0.0)

    @property
    def told(self) -> bool:
        """Whether the floor can be told from 0."""
        return self.last is not None and bool(self.told_at[self.last])

    @property
    def at_most(self) -> float:
        """What the bias does not exceed, by as many standard errors as ``TOLD``."""
        if self.last is None:
            return float("inf")
        return float(np.sqrt(max(self.bias2[self.last], 0.0) + TOLD * self.bias2_error[self.last]))

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
        if self.last is None:
            return Reached(None, "noise")
        times, rmse = _rising(getattr(self, clock))[self.resolved], self.rmse[self.resolved]
        below = np.flatnonzero(rmse <= target)
        if not len(below):
            return Reached(None, "floor", self.floor) if self.told and self.floor > target else Reached(
                None, "time", float(times[-1])
            )  # fmt: skip
        first = below[0]
        if first == 0:
            return Reached(float(times[0]), within=True)
        span = slice(first - 1, first + 1)
        x, y = np.log(_positive(rmse[span])), np.log(times[span])
        share = (np.log(target) - x[0]) / (x[1] - x[0])
        return Reached(float(np.exp(y[0] + share * (y[1] - y[0]))))

    def error_of(self, samples: float) -> float:
        """The error of so many samples; infinite where it is not known, as with fewer than were measured.

        Between known counts, over those between that are not. After the last as in ``error_at``.
        """
        return self._error(samples, self.samples)

    def error_at(self, seconds: float) -> float:
        """The error after so many processor seconds; infinite where it is not known, as before the first render ends.

        After the last the bias stays, and the noise falls on as it did, or as 1/sqrt(N) if that is faster.
        """
        return self._error(seconds, _rising(self.cpu))

    def _error(self, at: float, along: NDArray[np.float64]) -> float:
        if self.last is None or at < along[self.resolved][0]:
            return float("inf")
        if at > along[-1] and self.resolved[-1]:
            return self._beyond(at / along[-1])
        if at > along[self.last]:
            return float("inf")
        known = np.log(_positive(self.rmse[self.resolved]))
        return float(np.exp(np.interp(np.log(at), np.log(along[self.resolved]), known)))

    def _beyond(self, more: float) -> float:
        """The error of ``more`` times as many samples as the last count has."""
        power = max(0.5, -self.slope.value) if self.slope else 0.5
        return float(np.sqrt(max(self.bias2[-1], 0.0) + (self.noise[-1] * more**-power) ** 2))


@dataclass(frozen=True)
class Win:
    """Who errs least at so many seconds, or samples; over: by how much more the others of ``AGAINST`` err then.

    Whose error is known nowhere neither wins nor is in ``over``, in which nothing is that seldom hits the lamp.
    """

    at: float
    winner: str
    error: float
    over: dict[str, float]


@dataclass(frozen=True)
class Pick:
    """What Automatic takes at a sample count, and its error over the winner's.

    Both are given equal processor time for their samples. What a render starts with is left out: it does not grow with
    the picture, and those that a report renders are small. doubt: the standard error of the ratio's logarithm. of_all:
    its error over that of ``best_of_all``, the best of all estimators, also those that Automatic never picks.
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
    def far(self) -> bool:
        """Whether it is not close, and chance does not explain it: where rare events make noise, errors scatter."""
        return float(np.log(self.ratio / CLOSE)) > CHANCE * self.doubt


@dataclass(frozen=True)
class Contest:
    """One scene and subject."""

    scene: str
    subject: str
    m: float | None
    seeds: NDArray[np.int_]  # by sample count, of which times were taken
    truth: str
    curves: dict[str, Curve]
    picked: tuple[str, ...]
    refused: dict[str, str]  # what Automatic never picks here, and why
    pictures: dict[str, str]  # by contender, and the "reference"
    picture_samples: int
    size: int  # pixels, across and down
    independent: bool  # whether the truth was had without ``mirror``
    smooth: bool  # an interface without facets

    @property
    def title(self) -> str:
        return f"{SCENES.get(self.scene, self.scene)}, {self.subject}"

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
        """At each of 1, 2, 5, 10, ... seconds and their parts that every rival was measured at."""
        if not self.rivals:
            return []
        last = min(float(np.max(curve.cpu)) for curve in self.rivals)
        found = [self._win(seconds, self._errors_at(seconds)) for seconds in _round_times(self.judged_from, last)]
        return [win for win in found if win]

    @cached_property
    def even(self) -> list[Win]:
        """At each sample count, all with as many: what can be said where starting dominates and ``wins`` is empty."""
        counts = self.rivals[0].samples if self.rivals else ()
        found = [self._win(float(count), self._errors_of(index)) for index, count in enumerate(counts)]
        return [win for win in found if win]

    def _win(self, at: float, errors: dict[str, float]) -> Win | None:
        if not errors:
            return None
        winner, error = min(errors.items(), key=lambda one: one[1])
        against = [name for name in AGAINST if name in errors and name not in self.seldom and error > 0.0]
        return Win(at, winner, error, {name: errors[name] / error for name in against})

    @cached_property
    def seldom(self) -> set[str]:
        """Estimators whose errors here are of a handful of hits."""
        return {curve.estimator for curve in self.rivals if curve.seldom}

    def _errors_at(self, seconds: float) -> dict[str, float]:
        """By estimator, of those whose error is known; none if another might err less."""
        return self._known({curve.estimator: curve.error_at(seconds) for curve in self.rivals})

    def _errors_of(self, index: int) -> dict[str, float]:
        """As ``_errors_at``, at a sample count."""
        return self._known(
            {curve.estimator: float(curve.rmse[index]) if curve.resolved[index] else np.inf for curve in self.rivals}
        )

    def _known(self, errors: dict[str, float]) -> dict[str, float]:
        """An error that is known at other counts might be the least here; where hits are rare it is not."""
        may_win = [curve.estimator for curve in self.rivals if curve.last is not None and not curve.seldom]
        if any(np.isinf(errors[name]) for name in may_win):
            return {}
        return {name: error for name, error in errors.items() if np.isfinite(error)}

    @cached_property
    def picks(self) -> list[Pick]:
        """Automatic's choice at each sample count at which its error is known."""
        found = []
        by_estimator = {curve.estimator: curve for curve in self.rivals}
        for index, name in enumerate(self.picked):
            own = by_estimator.get(name)
            if own is None or not own.resolved[index]:
                continue
            seconds = own.samples[index] * own.per_sample
            of_all = {
                curve.estimator: curve.error_of(seconds / curve.per_sample)
                for curve in self.rivals
                if curve.per_sample > 0.0
            }
            of_all[name] = float(own.rmse[index])
            errors = {one: error for one, error in of_all.items() if one not in self.refused}
            winner = min(errors, key=lambda one: errors[one])
            best_of_all = min(of_all, key=lambda one: of_all[one])
            ratio, beside_all = (
                errors[name] / least if least > 0.0 else 1.0 for least in (errors[winner], of_all[best_of_all])
            )
            best = by_estimator[winner]
            there = int(np.searchsorted(best.samples[1:], seconds / best.per_sample, side="right"))
            doubt = np.hypot(self._doubt(own)[index], self._doubt(best)[there])
            found.append(Pick(int(own.samples[index]), name, winner, ratio, float(doubt), beside_all, best_of_all))
        return found

    def _doubt(self, curve: Curve) -> NDArray[np.float64]:
        """Standard error of the logarithm of an error."""
        return rmse_error(curve) / _positive(curve.rmse)


def rmse_error(curve: Curve) -> NDArray[np.float64]:
    """Standard error of the root mean square of an error, by the cell's own figures; rather too large than too small.

    ``statistics.error`` takes bias^2 from products of two of S seeds, so that bias^2 + noise^2 is the mean of the
    seeds' squares. Its variance is that of one seed's over S: sum (2 v^2 + 4 b^2 v) / S / P^2, with v the variance in a
    pixel; that of bias^2 is sum (2 (v / S)^2 + 4 b^2 v / S) / P^2, at least a share 1 / S of it. And dx = d(x^2) / 2x.
    """
    total = curve.bias2_error * np.sqrt(curve.seeds)
    return total / np.maximum(2.0 * curve.rmse, np.finfo(np.float64).tiny)


@dataclass(frozen=True)
class Dropped:
    """A thing that a material does without. time: with it, over the time without; same: the picture is.

    All three are None where it was not put back.
    """

    what: str
    why: str
    nodes: int | None
    time: float | None
    same: bool | None


@dataclass(frozen=True)
class LeftOut:
    """A material as built against the universal one. time: the universal one's over its own, and its rounds' spread.

    Pairs are of the material as built and of the universal one; first: the ratio of first renders, which compile;
    memory_mb: what the material takes, beyond what Blender held before.
    """

    case: str
    preset: str
    scene: str
    backend: str
    estimator: str
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
        return f"{self.case}, {self.scene}, {self.estimator}, {self.backend}"

    @property
    def all_same(self) -> bool:
        """Whether no picture differs, neither the universal material's nor one with a thing put back."""
        return self.same and all(one.same is not False for one in self.dropped)


@dataclass(frozen=True)
class Case:
    """An extreme case. setup: how it is rendered; limit: what is done in place of what was asked, "" if nothing.

    resolves: the smallest common factor, less 1, that z would have told from chance. error, bar: of what is exact.
    again: passed by another seed. noise: over what samples explain; numbers: that differ in a pixel; rays: as foreseen.
    """

    group: str
    what: str
    value: str
    setup: str
    finite: bool
    lowest: float | None
    highest: float | None
    z: float | None
    resolves: float | None
    error: float | None
    bar: float | None
    limit: str
    passed: bool
    again: bool
    noise: float | None
    numbers: float | None
    rays: float | None


@dataclass(frozen=True)
class Everyday:
    """The default material in an everyday scene, beside the nearest native one.

    mean: over the native material's, of the channel that is farthest off; doubt: its standard error; band: where it
    should be. apart, bar: what pictures differ by, as a share of the light, and may differ by. time: over the native
    material's, None where it was not measured. said: warnings that are wrong there.
    """

    scene: str
    title: str
    subject: str
    estimator: str
    mean: float
    doubt: float
    band: tuple[float, float]
    apart: float
    bar: float
    black: int
    bright: int
    time: float | None
    said: tuple[str, ...]

    @property
    def right(self) -> bool:
        """Whether its picture is as it should be. A doubt that is too large to tell counts against it."""
        low, high = self.band
        near = low - TOLD * self.doubt <= self.mean <= high + TOLD * self.doubt
        return (
            near
            and self.doubt < DOUBT
            and self.apart < self.bar + TOLD * self.doubt
            and not self.black
            and not self.bright
        )

    @property
    def quick(self) -> bool:
        return self.time is None or self.time <= SLOWER


@dataclass(frozen=True)
class Run:
    """All that was measured on one Blender. lacks: how many measurements are still to be had; seconds: by the clock."""

    blender: str
    vgroove: str
    quick: bool
    contests: tuple[Contest, ...]
    cases: tuple[Case, ...]
    left_out: tuple[LeftOut, ...]
    everyday: tuple[Everyday, ...]
    tables: dict[str, dict[str, dict[str, Any]]]  # that documents tell, by cell and name
    lacks: int
    seconds: float  # 0 where a report does not say it of all

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


def read(path: Path) -> list[Run]:
    """As ``runs``, of a file, which an error names."""
    content = record.read(path)
    try:
        return runs(content)
    except ReportError as error:
        message = f"{path}: {error}"
        raise ReportError(message) from error


def runs(content: dict[str, Any]) -> list[Run]:
    """Of a report.json, the default Blender first, then the newest. ReportError if a cell is not as it should be."""
    names = sorted(content["runs"], key=lambda name: (_version(name)[:2] == DEFAULT, _version(name)), reverse=True)
    return [_run(blender, content["runs"][blender]) for blender in names]


def _run(blender: str, run: dict[str, Any]) -> Run:
    contests, cases, left_out, everyday, tables = [], [], [], [], {}
    picks = {key.partition("/")[2]: cell for key, cell in run["cells"].items() if record.part_of(key) == "picks"}
    for key, cell in run["cells"].items():
        part, _, what = key.partition("/")
        try:
            if part == "accuracy":
                contests.append(_contest(cell, picks.get(what, {})))
            elif part == "stability":
                cases += [_case(what, case) for case in cell["cases"]]
            elif part == "left_out":
                left_out += [_left_out(what, cell, setup) for setup in cell["setups"]]
            elif part == "everyday":
                everyday += [_everyday(cell, one) for one in cell["subjects"]]
            elif part == "figures":
                tables[what] = {
                    name: {"columns": one["columns"], "rows": one["rows"]} for name, one in cell["tables"].items()
                }
        except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
            message = f"{key}: not as this vgroove writes it ({type(error).__name__}: {error}); measure again"
            raise ReportError(message) from error
    taken = run.get("seconds", {})
    seconds = sum(taken.values()) if taken.keys() >= run["cells"].keys() else 0.0
    lacks = max(run.get("wanted", 0) - len(run["cells"]), 0)
    return Run(
        blender, run["vgroove"], run["quick"], tuple(contests), tuple(cases), tuple(left_out), tuple(everyday), tables,
        lacks, seconds,
    )  # fmt: skip


def _contest(cell: dict[str, Any], picked: dict[str, Any]) -> Contest:
    samples = np.asarray(cell["samples"], np.float64)
    pictures = cell.get("pictures") or {}
    return Contest(
        cell["scene"], cell["subject"], cell.get("m"), np.broadcast_to(cell["seeds"], samples.shape),
        cell["truth"],
        {name: _curve(name, samples, one, cell) for name, one in cell["contenders"].items()},
        tuple(picked.get("estimators") or ()), picked.get("refused") or {},
        pictures.get("files", {}), pictures.get("samples", 0), cell["size"], cell["independent"],
        (cell.get("model"), cell.get("m")) == ("glass", 0.0),
    )  # fmt: skip


def _curve(name: str, samples: NDArray[np.float64], one: dict[str, Any], cell: dict[str, Any]) -> Curve:
    """Where rays seldom hit the lamp, a bias of what has none is light that no seed has met yet.

    What so many samples have not met, fewer have not.
    """
    numbers: dict[str, Any] = {key: np.asarray(one[key], np.float64) for key in NUMBERS}
    flip = np.asarray(one["flip"], np.float64) if one.get("flip") else None
    words: dict[str, Any] = {key: one.get(key) or "" for key in ("estimator", "backend", "peer", "differs")}
    spread = np.asarray(one.get("cpu_spread") or np.zeros(samples.shape), np.float64)
    resolved = np.asarray(one.get("resolved") or np.ones(samples.shape), np.bool_)
    seldom = cell["scene"] in SELDOM and words["estimator"] in RANDOM
    if seldom:
        resolved = resolved & ~(numbers["bias2"] > TOLD * numbers["bias2_error"])
        resolved = np.logical_and.accumulate(resolved[::-1])[::-1]
    return Curve(
        name,
        samples=samples,
        flip=flip,
        cpu_spread=spread,
        resolved=resolved,
        seldom=seldom,
        slope_error=one.get("slope_error"),
        seeds=np.broadcast_to(one.get("seeds") or cell["seeds"], samples.shape),
        **words,
        **numbers,
    )


def _case(group: str, case: dict[str, Any]) -> Case:
    return Case(
        group, case["what"], _value(case), case.get("setup", ""), case["finite"], case.get("lowest"),
        case.get("highest"), case.get("z"), case.get("resolves"), case.get("error"), case.get("bar"),
        case.get("limit") or "", case["passed"], bool(case.get("again")), case.get("noise"), case.get("numbers"),
        case.get("rays"),
    )  # fmt: skip


def _value(case: dict[str, Any]) -> str:
    """And what float32 has of it, where that is another number for a reader: 1 of 1 + 1e-9."""
    value, held = case["value"], case.get("held")
    rounded = isinstance(value, float) and held is not None and held != value and held == round(held)
    return _words(value) + (f" ({held:g} in float32)" if rounded else "")


def _words(value: Any) -> str:
    """A number, a table as its names and values."""
    if isinstance(value, dict):
        return ", ".join(f"{name.replace('_', ' ')} {_words(one)}" for name, one in value.items()) or "as usual"
    if isinstance(value, list):
        return " ".join(_words(one) for one in value)
    return f"{value:.10g}" if isinstance(value, float) else str(value)


def _left_out(name: str, cell: dict[str, Any], setup: dict[str, Any]) -> LeftOut:
    def pair(of: dict[str, Any]) -> tuple[Any, Any]:
        return of["built"], of["universal"]

    memory, render = cell.get("memory"), setup["render"]
    measured = memory is not None and all(memory[key] == setup[key] for key in ("scene", "backend"))
    return LeftOut(
        name, cell["preset"], setup["scene"], setup["backend"], setup["estimator"], render["ratio"],
        (min(render["rounds"]), max(render["rounds"])), setup["first"]["ratio"], pair(setup["nodes"]),
        pair(setup["instructions"]),
        (memory["built"]["over"] / 2**20, memory["universal"]["over"] / 2**20) if memory and measured else None,
        setup["same"],
        tuple(
            Dropped(one["what"], one["why"], one.get("nodes"), one.get("time"), one.get("same"))
            for one in setup["left_out"]
        ),
    )  # fmt: skip


def _everyday(cell: dict[str, Any], one: dict[str, Any]) -> Everyday:
    low, high = one["band"]
    mean, doubt = max(zip(one["mean"], one["doubt"], strict=True), key=lambda of: abs(of[0] - 1.0))
    return Everyday(
        cell["scene"], cell["title"], one["subject"], one["estimator"], mean, doubt, (low, high), one["apart"],
        one["bar"], one["black"], one["bright"], one["time"], tuple(one["said"]),
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
