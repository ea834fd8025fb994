# SPDX-License-Identifier: GPL-3.0-or-later
"""Two reports held against each other: what got better, what got worse. Pure NumPy; imports no bpy.

- Error, at equal samples: changed if by more than its noise allows, and by more than ``SMALLEST`` of itself. Of each
  contender the worst and the best change are told: neither hides the other.
- Bias, at the most samples: changed if it can be told from 0 in one report alone, and by more than noise allows.
- Time, over a peer of Cycles' in the same cell, so that the machine drops out: changed by more than ``SLOWER``, and by
  more than the scatter of the seeds' times allows.
- Saving: the universal material's time over a material as built, by more than ``SLOWER``; likewise the size of a
  material as built: its nodes, OSL instructions, and what of memory is beyond ``LITTLE``.
- Extreme cases: passed in one, failed in the other. Pictures of the universal material: likewise.
- Automatic: another choice, within its bar of the best in one report and beyond it in the other.
- What only one report has: worse if it is gone, unless one report alone is quick.

FLIP says what the error says, of the same pictures, and is not judged again. Peers are there to be held against, and
are not judged themselves. The tables of documents are not compared: they are
told as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np

from ..bench.record import ReportError
from .findings import rmse_error
from .words import percent, times

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from .findings import Case, Contest, Curve, LeftOut, Run

SLOWER = 1.25  # ratio of times below which nothing is said
SMALLEST = 0.01  # change of an error, of itself, below which nothing is said
LITTLE = 16.0  # MB, by which what a process holds scatters
MISTAKEN = 0.01  # probability that noise alone makes a comparison tell a change, of all its figures together
LONGEST = 3  # sample counts whose times are judged: those beside which a start is short


@dataclass(frozen=True)
class Change:
    """Of one figure. where: scene and subject, group, or case; who: contender or case; worse: None if neither."""

    blender: str
    where: str
    who: str
    what: str
    before: str
    after: str
    worse: bool | None


def changes(before: list[Run], after: list[Run]) -> tuple[list[Change], int]:
    """What changed between two reports, worse things first, and how many figures both have.

    ReportError if they have none in common.
    """
    pairs = list(_pairs(before, after))
    count = sum(_figures(a, b) for a, b in pairs)
    if not count:
        message = "the two reports have no figure in common; measure the same Blender in both"
        raise ReportError(message)
    limit = _limit(count)
    found = [
        change
        for a, b in pairs
        for change in (
            *_gone(a, b),
            *_accuracy(a, b, limit),
            *_automatic(a, b),
            *_stability(a, b),
            *_left_out(a, b),
        )
    ]
    had, has = ({run.blender: run for run in of} for of in (before, after))
    if len(before) > 1 or len(after) > 1:
        found += [_there(blender, "", "", gone=True) for blender in had.keys() - has.keys()]
        found += [_there(blender, "", "", gone=False) for blender in has.keys() - had.keys()]
    return sorted(found, key=lambda change: (True, False, None).index(change.worse)), count


def _pairs(before: list[Run], after: list[Run]) -> Iterator[tuple[Run, Run]]:
    """Runs of the same Blender; of one each, those."""
    if len(before) == len(after) == 1:
        yield before[0], after[0]
        return
    others = {run.blender: run for run in after}
    for run in before:
        if run.blender in others:
            yield run, others[run.blender]


def _limit(count: int) -> float:
    """Standard errors that noise exceeds anywhere among ``count`` figures with probability ``MISTAKEN`` (Sidak)."""
    return NormalDist().inv_cdf((1.0 - MISTAKEN / 2.0) ** (1.0 / count))


def _figures(a: Run, b: Run) -> int:
    """How many figures both have: errors by sample count, times, and cases."""
    errors = sum(len(_common(one, other)[0]) + 1 for _, one, other in _curves(a, b) if not one.peer)
    cases = len({_name(case) for case in a.cases} & {_name(case) for case in b.cases})
    return errors + cases + len({case.title for case in a.left_out} & {case.title for case in b.left_out})


def _gone(a: Run, b: Run) -> Iterator[Change]:
    """What only one of them has; nothing between a quick and a full report, as they differ in that by intent."""
    if a.quick != b.quick:
        return
    had, has = _measured(a), _measured(b)
    for some, others, gone in ((had, has, True), (has, had, False)):
        for where, who in some:
            if (where, who) not in others and (not who or (where, "") in others):  # the whole is told once
                yield _there(b.blender, where, who, gone=gone)


def _there(blender: str, where: str, who: str, *, gone: bool) -> Change:
    return Change(blender, where, who, "measured", *(("yes", "no") if gone else ("no", "yes")), worse=gone or None)


def _measured(run: Run) -> dict[tuple[str, str], None]:
    """Where and who, in order; a whole without a who."""
    found: list[tuple[str, str]] = []
    for contest in run.contests:
        counts = {f"{count:g} samples" for curve in contest.curves.values() for count in curve.samples}
        found += [(contest.title, who) for who in ("", *contest.curves, *sorted(counts))]
    for case in run.cases:
        found += [(case.group, ""), (case.group, _called(case))]
    for one in run.left_out:
        found += [("left out", ""), ("left out", one.title)]
    return dict.fromkeys(found)


def _contests(a: Run, b: Run) -> Iterator[tuple[Contest, Contest]]:
    others = {contest.title: contest for contest in b.contests}
    for contest in a.contests:
        if contest.title in others:
            yield contest, others[contest.title]


def _curves(a: Run, b: Run) -> Iterator[tuple[tuple[Contest, Contest], Curve, Curve]]:
    for contest, other in _contests(a, b):
        for name, curve in contest.curves.items():
            if name in other.curves:
                yield (contest, other), curve, other.curves[name]


def _common(one: Curve, other: Curve) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Where both have the same sample counts."""
    _, here, there = np.intersect1d(one.samples, other.samples, return_indices=True)
    return here, there


def _accuracy(a: Run, b: Run, limit: float) -> Iterator[Change]:
    for (contest, other), one, two in _curves(a, b):
        here, there = _common(one, two)
        if one.peer or not len(here):
            continue
        place = (b.blender, contest.title, one.name)
        yield from _time(place, (contest, other), (one, two), (here, there), limit)
        known = one.resolved[here] & two.resolved[there]
        here, there = here[known], there[known]
        if not len(here):
            continue
        off = two.rmse[there] - one.rmse[here]
        allowed = limit * np.hypot(rmse_error(one)[here], rmse_error(two)[there])
        allowed = np.maximum(allowed, SMALLEST * np.minimum(one.rmse[here], two.rmse[there]))
        for sign in (1.0, -1.0):
            beyond = np.where(sign * off > allowed, np.abs(off) / np.maximum(one.rmse[here], 1e-12), 0.0)
            most = int(np.argmax(beyond))
            if beyond[most] > 0.0:
                samples = f"error at {one.samples[here][most]:g} samples"
                figures = percent(one.rmse[here][most]), percent(two.rmse[there][most])
                yield Change(*place, samples, *figures, worse=sign > 0.0)
        moved = two.bias2[there[-1]] - one.bias2[here[-1]]
        noise = limit * np.hypot(two.bias2_error[there[-1]], one.bias2_error[here[-1]])
        if one.told_at[here[-1]] != two.told_at[there[-1]] and abs(moved) > noise:
            figures = _bias(one, here[-1]), _bias(two, there[-1])
            yield Change(*place, "bias", *figures, worse=bool(moved > 0.0))


def _bias(curve: Curve, index: int) -> str:
    return percent(float(np.sqrt(curve.bias2[index]))) if curve.told_at[index] else "not told from 0"


def _time(
    place: tuple[str, str, str],
    contests: tuple[Contest, Contest],
    curves: tuple[Curve, Curve],
    where: tuple[NDArray[np.intp], NDArray[np.intp]],
    limit: float,
) -> Iterator[Change]:
    """Over the first peer of Cycles' that both cells have: the geometric mean of the ratios at the most samples.

    The log of a time has the variance of the seeds' times, as a share; that of a median of S of them at most pi / 2 of
    that over S. Those of four medians, both contenders' in both reports, add up.
    """
    names = [
        name for name, curve in contests[0].curves.items() if curve.peer == "cycles" and name in contests[1].curves
    ]
    if not names:
        return
    ratios, variance = [], 0.0
    for contest, curve, index in zip(contests, curves, where, strict=True):
        last, peer = index[-LONGEST:], contest.curves[names[0]]
        ratios.append(float(np.exp(np.mean(np.log(curve.cpu[last] / peer.cpu[last])))))
        spread2 = np.mean(curve.cpu_spread[last] ** 2 + peer.cpu_spread[last] ** 2)  # pooled: of few seeds it is rough
        variance += float(np.pi / 2.0 * spread2 * np.mean(1.0 / contest.seeds[last]) / len(last))
    growth = np.log(ratios[1] / ratios[0])
    if abs(growth) > max(np.log(SLOWER), limit * np.sqrt(variance)):
        yield Change(*place, f"time over {names[0]}", times(ratios[0]), times(ratios[1]), worse=bool(growth > 0.0))


def _automatic(a: Run, b: Run) -> Iterator[Change]:
    for one, other in _contests(a, b):
        picks = {pick.samples: pick for pick in other.picks}
        for pick in one.picks:
            new = picks.get(pick.samples, pick)
            if new.close != pick.close and new.estimator != pick.estimator:
                before, after = (f"{times(of.ratio)} ({of.estimator})" for of in (pick, new))
                what = f"error over the best at {pick.samples} samples"
                yield Change(b.blender, one.title, "Automatic", what, before, after, worse=pick.close)


def _name(case: Case) -> tuple[str, str, str, str]:
    return case.group, case.what, case.value, case.setup


def _called(case: Case) -> str:
    return f"{case.what} {case.value} {case.setup}".strip()


def _stability(a: Run, b: Run) -> Iterator[Change]:
    others = {_name(case): case for case in b.cases}
    for case in a.cases:
        other = others.get(_name(case), case)
        if other.passed != case.passed:
            figures = ("passed", "FAILED") if case.passed else ("FAILED", "passed")
            yield Change(b.blender, case.group, _called(case), "case", *figures, worse=case.passed)


def _left_out(a: Run, b: Run) -> Iterator[Change]:
    others = {case.title: case for case in b.left_out}
    for case in a.left_out:
        other = others.get(case.title, case)
        place = (b.blender, "left out", case.title)
        if not 1.0 / SLOWER <= other.time / case.time <= SLOWER:
            yield Change(*place, "saving", times(case.time), times(other.time), worse=other.time < case.time)
        for what, before, after in _sizes(case, other):
            if not 1.0 / SLOWER <= after / before <= SLOWER:
                yield Change(*place, what, f"{before:.0f}", f"{after:.0f}", worse=after > before)
        if case.same != other.same:
            figures = ("same", "DIFFERS") if case.same else ("DIFFERS", "same")
            yield Change(*place, "picture", *figures, worse=case.same)


def _sizes(case: LeftOut, other: LeftOut) -> Iterator[tuple[str, float, float]]:
    """What both have of the material as built."""
    yield "nodes", case.nodes[0], other.nodes[0]
    if case.instructions[0] and other.instructions[0]:
        yield "OSL instructions", case.instructions[0], other.instructions[0]
    if case.memory_mb and other.memory_mb:
        yield "MB of memory", max(case.memory_mb[0], LITTLE), max(other.memory_mb[0], LITTLE)
