# SPDX-License-Identifier: GPL-3.0-or-later
"""Two reports compared: what got better, what got worse. Pure NumPy; imports no bpy.

- Error, at equal samples: changed if by more than its noise allows, and by more than ``SMALLEST`` of itself. The worst
  and the best change of each contender are shown: neither hides the other.
- Bias, at the most samples: changed if it can be distinguished from 0 in one report alone, and by more than its noise.
- Time, over a peer of Cycles' in the same cell, so that the machine cancels: changed by more than ``SLOWER``, and by
  more than the scatter of the seeds' times allows.
- The universal material's time over a material as built, by more than ``SLOWER``; likewise the size of a material as
  built: its nodes and OSL instructions.
- Extreme cases: passed in one, failed in the other. Pictures of the universal material: likewise.
- Automatic: another choice, close to the best in one report and not in the other.
- What only one report has: worse if it is gone, unless one report alone is quick.

Peers are there to be compared with and are not judged themselves; nor are the tables of documents.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..bench.record import ReportError
from ..sidak import limit
from .claims import case_title
from .words import percent, times

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    from ..bench.cells import Case, LeftOut
    from .contest import Contest
    from .curve import Curve
    from .findings import Run

    Indices = NDArray[np.intp]
    Figures = dict[tuple[str, str, str], Any]
    Judged = tuple[str, str, str, bool]

SLOWER = 1.25  # ratio of times below which nothing is said
SMALLEST = 0.01  # relative change of an error below which nothing is said
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
    pairs = [(_figures(a), _figures(b), b.blender, a.quick == b.quick) for a, b in _pairs(before, after)]
    count = sum(_weight(*figure) for a, b, *_ in pairs for figure in _shared(a, b))
    if not count:
        message = "the two reports have no figure in common; measure the same Blender in both"
        raise ReportError(message)
    most = limit(count)
    found: list[Change] = []
    for a, b, blender, comparable in pairs:
        if comparable:
            found += [_there(blender, *name, gone=True) for name in _missing(a, b)]
            found += [_there(blender, *name, gone=False) for name in _missing(b, a)]
        for (kind, where, who), one, other in _shared(a, b):
            found += [Change(blender, where, who, *change) for change in JUDGES[kind](one, other, most)]
    had, has = ({run.blender for run in of} for of in (before, after))
    if len(before) > 1 or len(after) > 1:
        found += [_there(blender, "", "", gone=True) for blender in had - has]
        found += [_there(blender, "", "", gone=False) for blender in has - had]
    return sorted(found, key=lambda change: (True, False, None).index(change.worse)), count


def _pairs(before: list[Run], after: list[Run]) -> Iterator[tuple[Run, Run]]:
    """Runs of the same Blender; if there is one each, those."""
    if len(before) == len(after) == 1:
        yield before[0], after[0]
        return
    others = {run.blender: run for run in after}
    yield from ((run, others[run.blender]) for run in before if run.blender in others)


def _figures(run: Run) -> Figures:
    """All that can be judged, by kind, where and who."""
    found: Figures = {}
    for contest in run.contests:
        found["contest", contest.title, ""] = contest
        for name, curve in contest.curves.items():
            found["peer" if curve.peer else "curve", contest.title, name] = (contest, curve)
        found |= {("count", contest.title, f"{samples:g} samples"): None for samples in contest.cell.samples}
    found |= {("case", case.group, case_title(case)): case for case in run.cases}
    return found | {("left_out", "left out", one.title): one for one in run.left_out}


def _shared(a: Figures, b: Figures) -> list[tuple[tuple[str, str, str], Any, Any]]:
    return [(key, one, b[key]) for key, one in a.items() if key in b and key[0] in JUDGES]


def _weight(key: tuple[str, str, str], one: Any, other: Any) -> int:
    """How many figures of both are compared: a curve's errors by sample count and its time, or one."""
    if key[0] == "contest":
        return 0
    return len(_common(one[1], other[1])[0]) + 1 if key[0] == "curve" else 1


def _missing(a: Figures, b: Figures) -> list[tuple[str, str]]:
    """Where and who is in the first alone; a whole that is missing is named once."""
    had, has = (dict.fromkeys(name for _, where, who in of for name in ((where, ""), (where, who))) for of in (a, b))
    return [name for name in had if name not in has and (not name[1] or (name[0], "") in has)]


def _there(blender: str, where: str, who: str, *, gone: bool) -> Change:
    return Change(blender, where, who, "measured", *(("yes", "no") if gone else ("no", "yes")), worse=gone or None)


# Judges: what changed, before, after, and whether it is worse


def _automatic(one: Contest, other: Contest, _limit: float) -> Iterator[Judged]:
    picks = {pick.samples: pick for pick in other.picks}
    for pick in one.picks:
        new = picks.get(pick.samples, pick)
        if new.close != pick.close and new.estimator != pick.estimator:
            before, after = (f"{times(of.ratio)} ({of.estimator})" for of in (pick, new))
            yield f"error over the best at {pick.samples} samples", before, after, pick.close


def _curve(one: tuple[Contest, Curve], other: tuple[Contest, Curve], limit: float) -> Iterator[Judged]:
    here, there = _common(one[1], other[1])
    if len(here):
        yield from _time(one, other, (here, there), limit)
        yield from _error(one[1], other[1], (here, there), limit)


def _common(one: Curve, other: Curve) -> tuple[Indices, Indices]:
    """Where both have the same sample counts."""
    _, here, there = np.intersect1d(one.samples, other.samples, return_indices=True)
    return here, there


def _error(one: Curve, two: Curve, where: tuple[Indices, Indices], limit: float) -> Iterator[Judged]:
    known = one.resolved[where[0]] & two.resolved[where[1]]
    here, there = where[0][known], where[1][known]
    if not len(here):
        return
    off = two.rmse[there] - one.rmse[here]
    allowed = limit * np.hypot(one.rmse_error[here], two.rmse_error[there])
    allowed = np.maximum(allowed, SMALLEST * np.minimum(one.rmse[here], two.rmse[there]))
    for sign in (1.0, -1.0):
        beyond = np.where(sign * off > allowed, np.abs(off) / np.maximum(one.rmse[here], 1e-12), 0.0)
        most = int(np.argmax(beyond))
        if beyond[most] > 0.0:
            errors = percent(one.rmse[here][most]), percent(two.rmse[there][most])
            yield f"error at {one.samples[here][most]:g} samples", *errors, sign > 0.0
    last = here[-1], there[-1]
    growth = two.bias2[last[1]] - one.bias2[last[0]]
    noise = limit * np.hypot(two.bias2_error[last[1]], one.bias2_error[last[0]])
    if one.biased_at[last[0]] != two.biased_at[last[1]] and abs(growth) > noise:
        yield "bias", _bias(one, last[0]), _bias(two, last[1]), bool(growth > 0.0)


def _bias(curve: Curve, index: int) -> str:
    return percent(float(np.sqrt(curve.bias2[index]))) if curve.biased_at[index] else "not distinguished from 0"


def _time(
    one: tuple[Contest, Curve], other: tuple[Contest, Curve], where: tuple[Indices, Indices], limit: float
) -> Iterator[Judged]:
    """Over the first peer of Cycles' that both cells have: the geometric mean of the ratios at the most samples.

    The log of a time has the variance of the seeds' times, as a share; that of a median of S of them at most pi / 2 of
    that over S. Those of four medians, both contenders' in both reports, add up.
    """
    names = [name for name, curve in one[0].curves.items() if curve.peer == "cycles" and name in other[0].curves]
    if not names:
        return
    ratios, variance = [], 0.0
    for (contest, curve), index in zip((one, other), where, strict=True):
        last, peer = index[-LONGEST:], contest.curves[names[0]]
        ratios.append(float(np.exp(np.mean(np.log(curve.cpu[last] / peer.cpu[last])))))
        spread2 = np.mean(curve.cpu_spread[last] ** 2 + peer.cpu_spread[last] ** 2)  # pooled: of few seeds it is rough
        seeds = np.array(contest.cell.seeds)[last]
        variance += float(np.pi / 2.0 * spread2 * np.mean(1.0 / seeds) / len(last))
    growth = np.log(ratios[1] / ratios[0])
    if abs(growth) > max(np.log(SLOWER), limit * np.sqrt(variance)):
        yield f"time over {names[0]}", times(ratios[0]), times(ratios[1]), bool(growth > 0.0)


def _case(one: Case, other: Case, _limit: float) -> Iterator[Judged]:
    if other.passed != one.passed:
        yield "case", *(("passed", "FAILED") if one.passed else ("FAILED", "passed")), one.passed


def _left_out(one: LeftOut, other: LeftOut, _limit: float) -> Iterator[Judged]:
    slowdown = one.slowdown, other.slowdown
    if not 1.0 / SLOWER <= slowdown[1] / slowdown[0] <= SLOWER:
        yield "saving", times(slowdown[0]), times(slowdown[1]), slowdown[1] < slowdown[0]
    sizes = {
        "nodes": (one.nodes[0], other.nodes[0]),
        "OSL instructions": (one.instructions[0], other.instructions[0]),
    }
    for what, (before, after) in sizes.items():
        if before and after and not 1.0 / SLOWER <= after / before <= SLOWER:
            yield what, f"{before:.0f}", f"{after:.0f}", after > before
    if one.same != other.same:
        yield "picture", *(("same", "DIFFERS") if one.same else ("DIFFERS", "same")), one.same


JUDGES: dict[str, Callable[[Any, Any, float], Iterator[Judged]]] = {
    "contest": _automatic,
    "curve": _curve,
    "case": _case,
    "left_out": _left_out,
}
