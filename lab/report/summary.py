# SPDX-License-Identifier: GPL-3.0-or-later
"""report.md: what a report found, in words and tables. The words of figures are the page's too. Imports no bpy."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from ...addon.library.files import write_text
from . import claims
from .findings import AGAINST, TARGETS
from .words import number, percent, plain, times

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from numpy.typing import NDArray

    from .findings import Case, Contest, Curve, Dropped, Everyday, Reached, Run, Win
    from .plots import Drawn

FILE = "report.md"


def write(path: Path, found: list[Run], machine: Mapping[str, Any], figures: Mapping[str, Mapping[str, Drawn]]) -> None:
    """figures: by Blender and kind, what lies in plots/ beside ``path``."""
    write_text(path, markdown(found, machine, figures))


def markdown(found: list[Run], machine: Mapping[str, Any], figures: Mapping[str, Mapping[str, Drawn]]) -> str:
    lines = [
        "# Error against run time, stability, and what was left out",
        "",
        "`vgroove report -o DIR` measured this, and `vgroove report --from DIR/report.json` draws it anew; on",
        f"{machine_text(machine)}.",
        "An error is the root mean square of a picture less the truth, over that of the truth. Times are of the",
        "processor unless said otherwise.",
    ]
    for run in found:
        drawn = figures.get(run.blender, {})
        images = {kind: ["", f"![{one.text}](plots/{one.name}.png)"] for kind, one in drawn.items()}
        lines += ["", f"## {title(run)}", "", *(f"- {line}" for line in headlines(run))]
        lines += images.get("error", []) + images.get("noise", [])
        if run.wins:
            lines += ["", "### Who errs least at a time", "", WINS, "", *table(*win_rows(run))]
        if short := too_short(run):
            lines += ["", TOO_SHORT, "", *(f"- {line}" for line in short)]
        if run.contests:
            lines += ["", "### Each scene and subject", "", CURVES]
        for contest in run.contests:
            lines += ["", f"#### {contest.title}", "", about(contest), "", *table(CURVE_COLUMNS, curve_rows(contest))]
        if run.cases:
            lines += ["", "### Extreme cases", *images.get("stability", []), "", CASES, ""]
            lines += [f"<details><summary>{len(run.cases)} cases</summary>", "", *table(CASE_COLUMNS, case_rows(run))]
            lines += ["", "</details>"]
        if run.left_out:
            lines += [
                "",
                "### What was left out",
                *images.get("left_out", []),
                "",
                LEFT_OUT,
                "",
                *table(LEFT_OUT_COLUMNS, left_out_rows(run)),
                "",
                DROPPED,
                "",
                *table(DROPPED_COLUMNS, dropped_rows(run)),
                "",
                DROPPED_EACH,
                "",
                *table(DROPPED_EACH_COLUMNS, dropped_each_rows(run)),
            ]
        if run.everyday:
            lines += ["", "### Everyday scenes", "", EVERYDAY, "", *table(EVERYDAY_COLUMNS, everyday_rows(run))]
    return "\n".join([*lines, ""])


WINS = (
    "The estimator that errs least, its error, and how many times as much "
    + " and ".join(AGAINST)
    + " err then, where that is known. Only node groups compete. Times that a render mostly starts in are left out."
)
TOO_SHORT = "Where all renders are too short to be judged by their times, who errs least at equal samples:"
CURVES = (
    "From 4 to 4096 samples, by powers of 4. Slope: of log noise over log samples, from 64 on. Bias: at the largest "
    "sample count; < an upper bound, where it cannot be told from 0. Times: of the processor, and in brackets by the "
    "clock. FLIP: at the largest sample count, of the pixels that are judged. Not resolved: rare events make most of "
    "the noise, and no seed has met them; such sample counts are left out. Direct leaves out all but lamps, which "
    "counts as its bias. Automatic picks one of Cycles' own closures by rounded numbers of reports like this one; no "
    "scene but these has tested it. What that rule costs is said beside each scene: its error over that of the best of "
    "all estimators at equal render time. "
    "Not raced: glass in a furnace, which sends back all light; what scatters below its surface under a lamp, which no "
    "formula at lamps has; pairs that tell nothing that the others do not."
)
CURVE_COLUMNS = ("contender", "slope", "bias", *(f"to {100 * target:g} %" for target in TARGETS), "FLIP", "remarks")
CASES = (
    "Lowest and highest: of all pixels; under a white sky what is sent back of it, else f in 1/sr. Z: of an error of "
    "scale that all pixels share, in its standard errors; tells: the smallest such error that would be found. Error: "
    "of what needs no chance, beside its bar. Noise: over what independent samples have; numbers: how many different "
    "ones the hash of position draws in a pixel, and how many the panel foresees."
)
CASE_COLUMNS = (
    "group", "what", "value", "run as", "lowest", "highest", "Z", "tells", "error", "bar", "noise", "numbers", "limit",
    "",
)  # fmt: skip
LEFT_OUT = (
    "The universal material (one for each estimator and backend, which are no inputs), which shows presets by its "
    "inputs alone (all but absorption, which it leaves to the one as built), against each as it is built. Time and "
    "first (a render that compiles): universal over as built. Nodes, instructions of OSL, MB that it takes beside "
    "Blender: as built / universal. By the estimator that its row names. Picture: by the same seed; "
    "of rough glass by mirror, which draws other facets behind its first, by its mean."
)
LEFT_OUT_COLUMNS = (
    "case", "preset", "scene", "estimator", "run as", "time", "spread", "first", "nodes", "instructions", "MB",
    "picture",
)  # fmt: skip
DROPPED = (
    "What the builder leaves out: in how many cases, and how many nodes more and times as long in the median of those "
    "where it was put back (the closure beside it, which EEVEE shows, is built and was taken away). These times are of "
    "one round each: what differs little from 1 is chance. To save time nothing is put back under the softbox, nor by "
    "mirror."
)
DROPPED_COLUMNS = ("what", "left out", "nodes", "time", "picture")
DROPPED_EACH = "Case by case, and why."
DROPPED_EACH_COLUMNS = ("case", "what", "why", "nodes", "time", "picture")
EVERYDAY = (
    "The material that Automatic gives, beside what an artist would wire of Cycles' own nodes with the same numbers. "
    "Mean: of the pixels that show the material, over the native material's, by the channel that is farthest off. "
    "Band: within 5 %, or as far apart as the two models are by the reference on a ball that is lit from any "
    "direction up to 120 degrees from the view. Apart: by what share of the light the pictures differ pixel by pixel, "
    "less noise, and what it may be by the same reckoning. Black, bright: pixels that are so where the native "
    "material's are not. "
    "Time: over the native material's, the median of rounds that take turns. Warnings: those that are not right there."
)
EVERYDAY_COLUMNS = (
    "scene", "subject", "estimator", "mean", "band", "apart", "black", "bright", "time", "warnings", "",
)  # fmt: skip
EVEN, HASHED, BOTH = ("closure", "fit", "corrected"), "mirror", "hybrid"  # of random numbers of Cycles', ours, and both
SAME = {True: "the same", False: "DIFFERS", None: ""}


def title(run: Run) -> str:
    lacks = f", which lacks {run.lacks} measurements yet" if run.lacks else ""
    return f"Blender {run.blender}" + (", quick" if run.quick else "") + lacks


def machine_text(machine: Mapping[str, Any]) -> str:
    return "{system}, {processor}, {cores} cores, {memory_gb} GB".format_map(machine)


def headlines(run: Run) -> list[str]:
    """What a report must show, whether it does, and what else it says in a sentence."""
    return [
        *(claim.text for claim in claims.of(run)),
        *(line for of in (_winners, _bends, _backends, _taken) if (line := of(run))),
    ]


def _winners(run: Run) -> str:
    """In the median and at worst, as one estimator may be the best in most scenes and far off in some."""
    said = []
    for name in AGAINST:
        found = [(win.over[name], contest.title) for contest, win in run.wins if name in win.over]
        if found:
            worst, where = max(found)
            said.append(
                f"{name} errs {times(median(factor for factor, _ in found))}, at worst {times(worst)} ({where}),"
            )
    if not said:
        return ""
    but = " Not counted is what seldom hits the lamp." if any(contest.seldom for contest in run.contests) else ""
    return f"After the same time, in the median, {' and '.join(said)} as much as the best of all, these included.{but}"


def _bends(run: Run) -> str:
    """Why curves are no straight lines of slope -1/2; of slopes that are known well enough to say it.

    Nothing where Cycles' even samples do no better than independent ones: then the cause is another.
    """
    known = [
        (curve.estimator, curve.slope.value)
        for contest, curve in run.curves
        if curve.competes and curve.slope and curve.slope.known_to(claims.SLOPE_BAR) and not contest.smooth
    ]
    even, hashed, both = ([slope for name, slope in known if name in names] for names in (EVEN, (HASHED,), (BOTH,)))
    if not even or not hashed or median(even) >= median(hashed):
        return ""

    def fall(slopes: list[float]) -> str:
        return f"{number(median(slopes))} in the median ({number(min(slopes))} to {number(max(slopes))})"

    said = (
        f"Noise of {', '.join(EVEN)} falls as samples to the power of {fall(even)}, as Cycles spreads a pixel's "
        f"samples evenly; that of {HASHED} as {fall(hashed)}, as its facets are independent, by a hash"
    )
    if both:
        said += f"; that of {BOTH}, which is a part of each, as {fall(both)}"
    return (
        f"{said}. Errors stop falling where bias is left, which plots mark, and jump where a light is met for the "
        "first time."
    )


def _backends(run: Run) -> str:
    """Where both were timed: elsewhere their pictures would be told twice."""
    timed = {contest.title: contest.osl_over_nodes for contest in run.contests if contest.osl_over_nodes}
    if not timed:
        return ""
    ratios = [ratio for of in timed.values() for ratio in of.values()]
    return (
        f"A sample takes {times(median(ratios))} as long as OSL as it does as nodes, in the median of {len(ratios)} "
        f"estimators in {'; '.join(timed)}: the only ones timed as both."
    )


def _taken(run: Run) -> str:
    return f"All of this took {run.seconds / 60:.0f} minutes to measure." if run.seconds else ""


def win_rows(run: Run) -> tuple[list[str], list[list[str]]]:
    """Columns and rows: scenes by times."""
    seconds = sorted({win.at for _, win in run.wins})
    rows = []
    for contest in run.contests:
        won = {win.at: win for win in contest.wins}
        if won:
            rows.append([contest.title, *(won_text(won[at]) if at in won else "" for at in seconds)])
    return ["scene, subject", *(f"{at:g} s" for at in seconds)], rows


def won_text(win: Win) -> str:
    over = ", ".join(f"{name} {times(factor)}" for name, factor in win.over.items() if name != win.winner)
    return f"{win.winner} {percent(win.error)}" + (f" ({over})" if over else "")


def too_short(run: Run) -> list[str]:
    """Of each contest without a winner at a time, those at equal samples."""
    return [
        f"{contest.title}: starting dominates up to {contest.judged_from:.3g} s; at "
        + "; ".join(f"{win.at:g} samples {won_text(win)}" for win in contest.even)
        for contest in run.contests
        if contest.even and not contest.wins
    ]


def _range(counts: NDArray[np.int_]) -> str:
    few, many = int(np.min(counts)), int(np.max(counts))
    return f"{many}" if few == many else f"{few} to {many}"


def _more_seeds(contest: Contest) -> str:
    """Of whom there are more than of the rest, where a slope is judged."""
    more = {curve.estimator: curve.seeds[curve.seeds > contest.seeds] for curve in contest.rivals}
    said = [f"{estimator} {_range(counts)}" for estimator, counts in more.items() if len(counts)]
    return f" ({', '.join(said)} where its slope is judged)" if said else ""


def about(contest: Contest) -> str:
    """The truth, the seeds, and Automatic's choices in words."""
    said = (
        f"Truth: {contest.truth}. {_range(contest.seeds)} seeds{_more_seeds(contest)}. "
        f"{contest.size} × {contest.size} pixels."
    ) + (f" m = {contest.m:g}." if contest.m else "")
    if contest.picks:
        choices = {pick.estimator: None for pick in contest.picks}
        worst = max(contest.picks, key=lambda pick: pick.ratio)
        said += (
            f" Automatic: {', then '.join(choices)}; at worst {times(worst.ratio)} the error of the best that it may"
        )
        cost = max(contest.picks, key=lambda pick: pick.of_all)
        said += f" pick, and {times(cost.of_all)} that of the best of all"
        said += f" ({cost.best_of_all}, at {cost.samples} samples)." if cost.of_all > 1.0 else "."
        if contest.refused:
            said += f" It never picks {', '.join(f'{name} ({why})' for name, why in contest.refused.items())}."
    return said


def curve_rows(contest: Contest) -> list[list[str]]:
    return [
        [
            curve.name,
            slope(curve),
            bias(curve),
            *(both(curve.time_to(at, "cpu"), curve.time_to(at, "wall")) for at in TARGETS),
            f"{curve.flip[-1]:.3g}" if curve.flip is not None else "",
            remarks(curve),
        ]
        for curve in contest.curves.values()
    ]


def case_rows(run: Run) -> list[list[str]]:
    """Failed ones first, then by group as measured."""
    ordered = sorted(run.cases, key=lambda case: case.passed)
    return [
        [
            case.group, case.what, case.value, case.setup, plain(case.lowest), plain(case.highest), plain(case.z),
            plain(case.resolves), plain(case.error), plain(case.bar), plain(case.noise), numbers(case), case.limit,
            verdict(case),
        ]
        for case in ordered
    ]  # fmt: skip


def numbers(case: Case) -> str:
    """Seen, and in brackets foreseen."""
    if case.numbers is None:
        return ""
    return f"{case.numbers:.0f}" + ("" if case.rays is None else f" ({case.rays:.0f})")


def verdict(case: Case) -> str:
    if not case.passed:
        return "FAILED"
    return "passed by another seed" if case.again else "passed"


def left_out_rows(run: Run) -> list[list[str]]:
    """As built / universal, the most saved first."""

    def pair(values: Iterable[float] | None) -> str:
        return " / ".join(f"{value:.0f}" for value in values) if values and any(values) else ""

    return [
        [
            case.case, case.preset, case.scene, case.estimator, case.backend, times(case.time),
            f"{case.spread[0]:.2f} to {case.spread[1]:.2f}", times(case.first), pair(case.nodes),
            pair(case.instructions), pair(case.memory_mb), SAME[case.same],
        ]
        for case in sorted(run.left_out, key=lambda case: case.time, reverse=True)
    ]  # fmt: skip


def dropped_rows(run: Run) -> list[list[str]]:
    """Each thing that some material does without: of how many that have a list, and medians of what it would take."""
    found: dict[str, list[Dropped]] = {}
    listed = [case for case in run.left_out if case.dropped]
    for one in (one for case in listed for one in case.dropped):
        found.setdefault(one.what, []).append(one)
    rows = []
    for what, ones in found.items():
        same = [one.same for one in ones if one.same is not None]
        nodes = [one.nodes for one in ones if one.nodes is not None]
        seconds = [one.time for one in ones if one.time is not None]
        rows.append(
            [
                what, f"{len(ones)} of {len(listed)}", f"{median(nodes):g}" if nodes else "",
                times(median(seconds)) if seconds else "", SAME[all(same) if same else None],
            ]
        )  # fmt: skip
    return rows


def dropped_each_rows(run: Run) -> list[list[str]]:
    return [
        [
            case.title, one.what, one.why, "" if one.nodes is None else str(one.nodes),
            "" if one.time is None else times(one.time), SAME[one.same],
        ]
        for case in run.left_out
        for one in case.dropped
    ]  # fmt: skip


def everyday_rows(run: Run) -> list[list[str]]:
    """Those that fail first, then as measured."""
    return [
        [
            one.title, one.subject, one.estimator, f"{one.mean:.3f} ± {one.doubt:.3f}",
            f"{one.band[0]:.2f} to {one.band[1]:.2f}",
            f"{percent(max(one.apart, 0.0))} ({percent(one.bar)})", str(one.black or ""), str(one.bright or ""),
            "" if one.time is None else times(one.time), "; ".join(one.said), everyday_verdict(one),
        ]
        for one in sorted(run.everyday, key=lambda one: everyday_verdict(one) == "passed")
    ]  # fmt: skip


def everyday_verdict(one: Everyday) -> str:
    return "passed" if one.right and one.quick and not one.said else "FAILED"


def slope(curve: Curve) -> str:
    if curve.slope is None:
        return ""
    return number(curve.slope.value) + ("" if curve.slope.error is None else f" ± {curve.slope.error:.2f}")


def remarks(curve: Curve) -> str:
    """In what its model differs, and the sample counts of which nothing is known."""
    unknown = ", ".join(f"{count:g}" for count in curve.samples[~curve.resolved])
    found = (
        curve.differs,
        "rays seldom hit the lamp: no slope is told" if curve.seldom else "",
        unknown and f"not resolved at {unknown} samples",
    )
    return "; ".join(text for text in found if text)


def bias(curve: Curve) -> str:
    if curve.last is None:
        return ""
    if curve.told:
        return percent(curve.floor)
    return f"< {percent(curve.at_most)}" if curve.at_most < 1.0 else "not known"


def reached(at: Reached) -> str:
    if at.seconds is not None:
        return f"{'≤ ' if at.within else ''}{at.seconds:.3g} s"
    return {"floor": f"floor {percent(at.value)}", "time": f"> {at.value:.3g} s", "noise": ""}[at.limit]


def both(cpu: Reached, wall: Reached) -> str:
    return reached(cpu) if cpu.limit in {"floor", "noise"} else f"{reached(cpu)} ({reached(wall)})"


def table(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    names = list(columns)
    lines = [names, ["---"] * len(names), *rows]
    return ["| " + " | ".join(text.replace("|", "\\|") for text in line) + " |" for line in lines]
