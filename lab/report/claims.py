# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report must show, and whether it does: the sentences of the page, of report.md and of the documents.

Imports no bpy.
"""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any

from ..bench.cells import SLOWER
from ..sidak import limit
from .contest import AGAINST, CLOSE
from .words import number, percent, times

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ..bench.cells import Case
    from .findings import Run

TARGETS = (0.02, 0.01)  # errors whose time is shown
SLOPE, SLOPE_BAR = -0.5, 0.05  # of noise over independent samples, and how far from it a measured one may be
BROKEN = "DOES NOT HOLD"
EVEN, HASHED, BOTH = ("closure", "fit", "corrected"), "mirror", "hybrid"  # whose random numbers are Cycles', ours, both


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


def remarks(run: Run) -> list[str]:
    """What else a report says in a sentence."""
    return [line for line in (_winners(run), _bends(run), _backends(run), _duration(run)) if line]


def headlines(run: Run) -> list[str]:
    return [*(claim.text for claim in of(run)), *remarks(run)]


def _slope(run: Run) -> Claim | None:
    """It takes more than half of the scenes to hold.

    Where a slope is known less well than the bar, it says nothing for or against the claim. Nor does that of a smooth
    interface, where nothing is drawn by a hash and all noise comes from Cycles' even samples.
    """
    mirrors = [(contest, curve) for contest, curve in run.curves if curve.estimator == "mirror" and curve.competes]
    sloped = [(contest, curve.slope) for contest, curve in mirrors if curve.slope]
    slopes = {contest.title: slope for contest, slope in sloped if not contest.cell.smooth}
    if not slopes:
        return None
    known = {title: one.value for title, one in slopes.items() if one.known_to(SLOPE_BAR)}
    off = [f"{title}: {number(value)}" for title, value in known.items() if abs(value - SLOPE) > SLOPE_BAR]
    found = f"no slope is known to ±{SLOPE_BAR:g}"
    if known:
        low, middle, high = (number(of(known.values())) for of in (min, median, max))
        found = f"{middle}, the median of {len(known)} scenes ({low} to {high})"
        if len(known) < len(slopes):
            found += f"; known less well in {', '.join(title for title in slopes if title not in known)}"
        if rare := sum(curve.rarely_hit for _, curve in mirrors):
            found += f"; not evaluated in {rare} scenes whose light is rarely hit"
        for title, slope in ((contest.title, slope) for contest, slope in sloped if contest.cell.smooth):
            found += f"; not judged in {title}: a smooth interface draws no random facets ({number(slope.value)})"
    if off:
        found += f"; but {', '.join(off)}"
    claim = f"Mirror's noise falls as samples^({number(SLOPE)} ± {SLOPE_BAR:g})"
    return Claim(claim, found, 2 * len(known) > len(slopes) and not off)


def _unbiased(run: Run) -> Claim | None:
    """At every sample count: all tests together fail by chance in one report of a hundred (Sidak)."""
    mirrors = [
        (contest, curve)
        for contest, curve in run.curves
        if curve.estimator == "mirror" and curve.competes and curve.last is not None
    ]
    judged = [(contest, curve) for contest, curve in mirrors if contest.cell.independent and not curve.rarely_hit]
    if not judged:
        return None
    most = limit(sum(int(curve.resolved.sum()) for _, curve in judged), sides=1)
    biased = [
        f"{contest.title} at {', '.join(f'{samples:g}' for samples in curve.samples[curve.bias_z > most])} samples"
        for contest, curve in judged
        if (curve.bias_z > most).any()
    ]
    small = sum(curve.bias_bound < TARGETS[-1] for _, curve in judged)
    found = (
        f"in {len(judged) - len(biased)} of {len(judged)} scenes with an independent reference; at the most "
        f"samples it is below {percent(TARGETS[-1])} in {small} of them, below "
        f"{percent(max(curve.bias_bound for _, curve in judged))} in all"
    )
    if biased:
        found += f"; but there is a bias in {', '.join(biased)}"
    if rare := sum(curve.rarely_hit for _, curve in mirrors):
        found += f"; not evaluated in {rare} scenes whose light is rarely hit"
    if others := sum(not contest.cell.independent for contest, _ in mirrors):
        found += f"; in {others} more the reference was itself rendered with mirror, which `vgroove check` verifies"
    return Claim("Mirror's bias cannot be distinguished from 0 at any sample count", found, not biased)


def _automatic(run: Run) -> Claim | None:
    picks = run.picks
    if not picks:
        return None
    near, poor = sum(pick.close for _, pick in picks), sum(pick.poor for _, pick in picks)
    contest, worst = max(picks, key=lambda one: one[1].ratio)
    found = f"at {near} of {len(picks)} sample counts"
    if by_chance := len(picks) - near - poor:
        found += f", and within the noise of the measurement at {by_chance} more"
    if worst.ratio > 1.0:
        found += (
            f"; at worst {worst.estimator}'s error is {times(worst.ratio)} {worst.winner}'s ({contest.title}, "
            f"{worst.samples} samples, ±{100.0 * worst.doubt:.0f} %)"
        )
    if (of_all := sum(pick.of_all <= CLOSE for _, pick in picks)) < near:
        contest, worst = max(picks, key=lambda one: one[1].of_all)
        found += (
            f"; compared with all six estimators: within {100 * (CLOSE - 1):.0f} % at {of_all}, at worst "
            f"{times(worst.of_all)} the smallest error ({contest.title}, {worst.samples} samples, {worst.best_of_all})"
        )
    return Claim(
        f"Automatic is within {100 * (CLOSE - 1):.0f} % of the best estimator that it may pick", found, not poor
    )


def _universal(run: Run) -> Claim | None:
    if not run.left_out:
        return None
    ratios = [case.slowdown for case in run.left_out]
    slower = [f"{case.title}: {times(case.slowdown)}" for case in run.left_out if case.slowdown < 1.0]
    found = (
        f"{times(median(ratios))} as fast in the median of {len(ratios)} cases ({min(ratios):.3g} to {max(ratios):.3g})"
    )
    if slower:
        found += f"; but slower in {', '.join(slower)}"
    return Claim("Specialised materials are faster than one universal material", found, not slower)


def _pictures(run: Run) -> Claim | None:
    if not run.left_out:
        return None
    differing = [case.title for case in run.left_out if not case.all_same]
    put_back = sum(any(one.same is not None for one in case.omitted) for case in run.left_out)
    found = (
        f"{len(run.left_out) - len(differing)} of {len(run.left_out)} cases match the universal material; {put_back} "
        "also match with each component put back"
    )
    if differing:
        found += f"; they differ in {', '.join(differing)}"
    return Claim("Omitted components do not change the render", found, not differing)


def _stability(run: Run) -> Claim | None:
    if not run.cases:
        return None
    failed = [f"{case.group}: {case_title(case)}" for case in run.cases if not case.passed]
    limited = sum(bool(case.limit) for case in run.cases if case.passed)
    found = f"{len(run.cases) - len(failed)} of {len(run.cases)}, {limited} of them within a stated limit"
    if failed:
        by_z = sum(case.z is not None for case in run.cases)
        found += f"; failed: {'; '.join(failed)}"
        found += f"; {by_z} are judged by Z, of which one fails by chance in one report of a hundred"
    return Claim("Extreme cases pass", found, not failed)


def _everyday(run: Run) -> Claim | None:
    rows = run.everyday
    if not rows:
        return None
    where = {
        "the image differs": [one for one in rows if not one.right],
        "it is slower": [one for one in rows if not one.quick],
        "a warning is wrong": [one for one in rows if one.warnings],
    }
    slowdowns = [one.slowdown for one in rows if one.slowdown is not None]
    found = f"in {sum(one.passed for one in rows)} of {len(rows)} scenes and subjects"
    if slowdowns:
        found += f"; it takes {times(median(slowdowns))} as long in the median of {len(slowdowns)}, "
        found += f"at most {times(max(slowdowns))}"
    for what, ones in where.items():
        if ones:
            found += f"; {what} in {'; '.join(f'{one.title}, {one.subject}' for one in ones)}"
    claim = "In everyday scenes the default shows what the nearest native material shows, without a wrong warning"
    return Claim(f"{claim}, in at most {times(SLOWER)} its time", found, all(one.passed for one in rows))


def case_title(case: Case) -> str:
    return f"{case.what} {_words(case.value)} {case.setup}".strip()


def _words(value: Any) -> str:
    """A number, or a table by its names and values."""
    if isinstance(value, dict):
        return ", ".join(f"{name.replace('_', ' ')} {_words(one)}" for name, one in value.items()) or "as usual"
    return f"{value:.10g}" if isinstance(value, float) else str(value)


# What else is said


def _winners(run: Run) -> str:
    """In the median and at worst, as one estimator may be the best in most scenes and far off in some."""
    said = []
    for name in AGAINST:
        factors = [(win.over[name], contest.title) for contest, win in run.wins if name in win.over]
        if factors:
            worst, where = max(factors)
            middle = median(factor for factor, _ in factors)
            said.append(f"{name}'s error is {times(middle)} the smallest, at worst {times(worst)} ({where})")
    if not said:
        return ""
    but = "; not counted where the light is rarely hit" if any(contest.rarely_hit for contest in run.contests) else ""
    return f"At equal time, in the median, {' and '.join(said)}{but}."


def _bends(run: Run) -> str:
    """Why curves are no straight lines of slope -1/2; by slopes that are known well enough.

    Nothing where Cycles' even samples do no better than independent ones: then the cause is another.
    """
    known = [
        (curve.estimator, curve.slope.value)
        for contest, curve in run.curves
        if curve.competes and curve.slope and curve.slope.known_to(SLOPE_BAR) and not contest.cell.smooth
    ]
    even, hashed, both = ([slope for name, slope in known if name in names] for names in (EVEN, (HASHED,), (BOTH,)))
    if not even or not hashed or median(even) >= median(hashed):
        return ""

    def fall(slopes: Iterable[float]) -> str:
        low, middle, high = (number(of(slopes)) for of in (min, median, max))
        return f"{middle} in the median ({low} to {high})"

    said = (
        f"The noise of {', '.join(EVEN)} falls as samples^{fall(even)}, because Cycles stratifies its samples; "
        f"{HASHED}'s as samples^{fall(hashed)}, because mirror hashes independent random numbers"
    )
    if both:
        said += f"; that of {BOTH}, which is part of each, as samples^{fall(both)}"
    return f"{said}. Errors stop falling where bias is left, and jump where a seed first hits a light."


def _backends(run: Run) -> str:
    """Where both were timed: elsewhere OSL would show the same pictures again."""
    timed = {contest.title: contest.osl_over_nodes for contest in run.contests if contest.osl_over_nodes}
    if not timed:
        return ""
    ratios = [ratio for of in timed.values() for ratio in of.values()]
    return (
        f"OSL takes {times(median(ratios))} the time of nodes per sample, in the median of {len(ratios)} "
        f"estimators in {'; '.join(timed)}, the only scenes timed as both."
    )


def _duration(run: Run) -> str:
    return f"All of this took {run.seconds / 60:.0f} minutes to measure." if run.seconds else ""
