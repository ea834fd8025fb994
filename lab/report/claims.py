# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report must show, and whether it does: the sentences of the page, of report.md and of the documents.

Imports no bpy.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import NormalDist, median
from typing import TYPE_CHECKING

from .findings import CLOSE, SLOWER, TARGETS
from .words import number, percent, times

if TYPE_CHECKING:
    from .findings import Run

SLOPE, SLOPE_BAR = -0.5, 0.05  # of noise over independent samples, and how far from it a measured one may be
BROKEN = "DOES NOT HOLD"


@dataclass(frozen=True)
class Claim:
    """A claim, the numbers that were found, and whether it holds by them."""

    claim: str
    found: str
    holds: bool

    @property
    def text(self) -> str:
        return f"{self.claim}: {self.found}." if self.holds else f"{BROKEN}: {self.claim}: {self.found}."


def of(run: Run) -> list[Claim]:
    """Those that a run has numbers for."""
    made = (_slope, _unbiased, _automatic, _universal, _pictures, _stability, _everyday)
    return [claim for one in made if (claim := one(run))]


def _slope(run: Run) -> Claim | None:
    """As it stands. It takes more than half of the scenes to hold.

    Where a slope is known less well than the bar, it says nothing for or against the claim.
    Nor does that of a smooth interface, where nothing is drawn by a hash and all noise is of Cycles' even samples.
    """
    seldom = [
        contest.title
        for contest, curve in run.curves
        if curve.estimator == "mirror" and curve.competes and curve.seldom
    ]
    told = [
        (contest, curve.slope)
        for contest, curve in run.curves
        if curve.estimator == "mirror" and curve.competes and curve.slope
    ]
    slopes = {contest.title: slope for contest, slope in told if not contest.smooth}
    if not slopes:
        return None
    known = {title: one.value for title, one in slopes.items() if one.known_to(SLOPE_BAR)}
    off = [f"{title}: {number(value)}" for title, value in known.items() if abs(value - SLOPE) > SLOPE_BAR]
    found = "in no scene is it known so well"
    if known:
        found = (
            f"{number(median(known.values()))}, the median of {len(known)} scenes ({number(min(known.values()))} to "
            f"{number(max(known.values()))})"
        )
        if len(known) < len(slopes):
            found += f"; not known so well in {', '.join(title for title in slopes if title not in known)}"
        if seldom:
            found += f"; not told in {len(seldom)} whose lamp rays seldom hit"
        for title, slope in ((contest.title, slope) for contest, slope in told if contest.smooth):
            found += f"; not judged in {title}, where nothing is drawn by a hash ({number(slope.value)})"
    claim = f"The noise of mirror falls as samples to the power of {number(SLOPE)} ± {SLOPE_BAR:g}"
    return Claim(
        claim, "; but ".join([found, *([", ".join(off)] if off else [])]), 2 * len(known) > len(slopes) and not off
    )


def _unbiased(run: Run) -> Claim | None:
    """At every sample count: all tests together fail by chance in one report of a hundred (Sidak)."""
    mirrors = [
        (contest, curve)
        for contest, curve in run.curves
        if curve.estimator == "mirror" and curve.competes and curve.last is not None
    ]
    judged = [(contest, curve) for contest, curve in mirrors if contest.independent and not curve.seldom]
    if not judged:
        return None
    most = NormalDist().inv_cdf(0.99 ** (1.0 / sum(int(curve.resolved.sum()) for _, curve in judged)))
    told = [
        f"{contest.title} at {', '.join(f'{samples:g}' for samples in curve.samples[curve.bias_z > most])} samples"
        for contest, curve in judged
        if (curve.bias_z > most).any()
    ]
    small = sum(curve.at_most < TARGETS[-1] for _, curve in judged)
    found = (
        f"in {len(judged) - len(told)} of {len(judged)} scenes whose truth is had without it; at the most samples it "
        f"is below {percent(TARGETS[-1])} in {small} of them, below "
        f"{percent(max(curve.at_most for _, curve in judged))} in all"
    )
    if told:
        found += f"; but it is told in {', '.join(told)}"
    if seldom := sum(curve.seldom for _, curve in mirrors):
        found += f"; not judged in {seldom} whose lamp rays seldom hit"
    if others := sum(not contest.independent for contest, _ in mirrors):
        found += f"; in {others} more the truth is mirror's own, which `vgroove check` holds against the reference"
    return Claim("The bias of mirror cannot be told from 0 at any number of samples", found, not told)


def _automatic(run: Run) -> Claim | None:
    if not run.picks:
        return None
    near, far = (sum(verdicts) for verdicts in zip(*((pick.close, pick.far) for _, pick in run.picks), strict=True))
    contest, worst = max(run.picks, key=lambda one: one[1].ratio)
    found = f"at {near} of {len(run.picks)} sample counts"
    if by_chance := len(run.picks) - near - far:
        found += f", and as far as chance lets one tell at {by_chance} more"
    if worst.ratio > 1.0:
        found += (
            f"; at worst it errs {times(worst.ratio)} as much as {worst.winner} "
            f"({contest.title}, {worst.samples} samples, {worst.estimator}; this factor is known to "
            f"{100.0 * worst.doubt:.0f} %)"
        )
    if (of_all := sum(pick.of_all <= CLOSE for _, pick in run.picks)) < near:
        contest, worst = max(run.picks, key=lambda one: one[1].of_all)
        found += (
            f"; compared with all estimators at {of_all}, at worst {times(worst.of_all)} the error of the best "
            f"({contest.title}, {worst.samples} samples, {worst.best_of_all})"
        )
    return Claim(f"Automatic is within {100 * (CLOSE - 1):.0f} % of the best that it may pick", found, not far)


def _universal(run: Run) -> Claim | None:
    if not run.left_out:
        return None
    ratios = [case.time for case in run.left_out]
    quicker = [f"{case.title}: {times(case.time)}" for case in run.left_out if case.time < 1.0]
    saved = 1.0 - 1.0 / median(ratios)
    found = (
        f"it takes {times(median(ratios))} as long in the median of {len(ratios)} cases ({min(ratios):.3g} to "
        f"{max(ratios):.3g}), of which the material as built saves {100 * saved:.0f} %"
    )
    if quicker:
        found += f"; but quicker in {', '.join(quicker)}"
    return Claim("One universal material is nowhere quicker than one that holds only what it needs", found, not quicker)


def _pictures(run: Run) -> Claim | None:
    if not run.left_out:
        return None
    differing = [case.title for case in run.left_out if not case.all_same]
    put_back = sum(any(one.same is not None for one in case.dropped) for case in run.left_out)
    found = (
        f"in {len(run.left_out) - len(differing)} of {len(run.left_out)} cases beside the universal material's, and "
        f"in {put_back} of these with one thing after the other put back"
    )
    if differing:
        found += f"; the pictures differ in {', '.join(differing)}"
    return Claim("Pictures are the same without what was left out", found, not differing)


def _stability(run: Run) -> Claim | None:
    if not run.cases:
        return None
    failed = [f"{case.group}: {case.what} {case.value} {case.setup}".rstrip() for case in run.cases if not case.passed]
    limited = sum(bool(case.limit) for case in run.cases if case.passed)
    found = f"{len(run.cases) - len(failed)} of {len(run.cases)}, {limited} of them within a stated limit"
    if failed:
        found += f"; failed: {'; '.join(failed)}"
        by_z = sum(case.z is not None for case in run.cases)
        found += f"; {by_z} are judged by Z, of which one fails by chance in one report of a hundred"
    return Claim("Extreme cases pass", found, not failed)


def _everyday(run: Run) -> Claim | None:
    if not run.everyday:
        return None
    where: dict[str, list[str]] = {what: [] for what in ("the picture is off", "it is slower", "a warning is wrong")}
    for one in run.everyday:
        for what, fails in zip(where, (not one.right, not one.quick, bool(one.said)), strict=True):
            where[what] += [f"{one.title}, {one.subject}"] * fails
    failed = {title for titles in where.values() for title in titles}
    timed = [one.time for one in run.everyday if one.time is not None]
    found = f"in {len(run.everyday) - len(failed)} of {len(run.everyday)} scenes and subjects"
    if timed:
        found += f"; it takes {times(median(timed))} as long in the median of {len(timed)}, at most {times(max(timed))}"
    found += "".join(f"; {what} in {'; '.join(titles)}" for what, titles in where.items() if titles)
    claim = "In everyday scenes the default shows what the nearest native material does, without a wrong warning"
    return Claim(f"{claim}, in at most {times(SLOWER)} its time", found, not failed)
