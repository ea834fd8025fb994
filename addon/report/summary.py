# SPDX-License-Identifier: GPL-3.0-or-later
"""report.md: what a report found, in words and tables. The words of figures are the page's too. Imports no bpy."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from ..files import replacing
from .findings import AGAINST, TARGETS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from .findings import Contest, Curve, Dropped, Reached, Run
    from .plots import Drawn

FILE = "report.md"


def write(path: Path, found: list[Run], machine: Mapping[str, Any], figures: Mapping[str, Mapping[str, Drawn]]) -> None:
    """figures: by Blender and kind, what lies in plots/ beside ``path``."""
    with replacing(path) as temporary:
        temporary.write_text(markdown(found, machine, figures), encoding="utf-8")


def markdown(found: list[Run], machine: Mapping[str, Any], figures: Mapping[str, Mapping[str, Drawn]]) -> str:
    lines = [
        "# Error against run time, stability, and what was left out",
        "",
        "`vgroove report -o DIR` measured this, and `vgroove report --from DIR/report.json` draws it anew; on",
        f"{machine_text(machine)}.",
        "Errors are root mean squares, as shares of the truth's. Times are of the processor unless said otherwise.",
    ]
    for run in found:
        drawn = figures.get(run.blender, {})
        images = {kind: ["", f"![{one.text}](plots/{one.name}.png)"] for kind, one in drawn.items()}
        lines += ["", f"## {title(run)}", "", *(f"- {line}" for line in headlines(run))]
        lines += images.get("error", []) + images.get("noise", [])
        if run.wins:
            lines += ["", "### Who errs least at a time", "", WINS, "", *_table(*win_rows(run))]
        if run.contests:
            lines += ["", "### Each scene and subject", "", CURVES]
        for contest in run.contests:
            lines += ["", f"#### {contest.title}", "", about(contest), "", *_table(CURVE_COLUMNS, curve_rows(contest))]
        if run.cases:
            lines += ["", "### Extreme cases", *images.get("stability", []), "", *_table(CASE_COLUMNS, case_rows(run))]
        if run.left_out:
            lines += [
                "",
                "### What was left out",
                *images.get("left_out", []),
                "",
                LEFT_OUT,
                "",
                *_table(LEFT_OUT_COLUMNS, left_out_rows(run)),
                "",
                DROPPED,
                "",
                *_table(DROPPED_COLUMNS, dropped_rows(run)),
            ]
    return "\n".join([*lines, ""])


WINS = (
    "The estimator that errs least, its error, and how many times as much "
    + " and ".join(AGAINST)
    + " err then. Node groups alone; shorter times are mostly what a render needs to start."
)
CURVES = (
    "Slope: of log noise over log samples, from 64 to 4096. Bias: at the most samples; < where it cannot be told from "
    "0. Times: of the processor, and in brackets by the clock."
)
CURVE_COLUMNS = ("contender", "slope", "bias", *(f"to {100 * target:g} %" for target in TARGETS), "FLIP", "differs")
CASE_COLUMNS = ("group", "what", "value", "run as", "lowest", "highest", "Z", "limit", "")
LEFT_OUT = (
    "The universal material, which can show every preset by its inputs alone, against each as it is built. Time and "
    "first (a render that compiles): universal over as built. Nodes, instructions of OSL, MB: as built / universal."
)
LEFT_OUT_COLUMNS = (
    "case", "preset", "scene", "run as", "time", "spread", "first", "nodes", "instructions", "MB", "picture",
)  # fmt: skip
DROPPED = (
    "What the builder leaves out, put back one by one: in how many cases, and by how much more of it in the median."
)
DROPPED_COLUMNS = ("what", "left out", "nodes", "time", "picture")
SAME = {True: "the same", False: "DIFFERS"}


def title(run: Run) -> str:
    return f"Blender {run.blender}" + (", quick" if run.quick else "")


def machine_text(machine: Mapping[str, Any]) -> str:
    return "{system}, {processor}, {cores} cores, {memory_gb} GB".format_map(machine)


def headlines(run: Run) -> list[str]:
    """What a report says in a sentence each; only what it has numbers for."""
    said = (_slopes, _unbiased, _winners, _automatic, _backends, _savings, _stability)
    return [line for line in (of(run) for of in said) if line]


def _slopes(run: Run) -> str:
    slopes = [c.slope.value for _, c in run.curves if c.estimator == "mirror" and c.competes and c.slope]
    if not slopes:
        return ""
    return (
        f"The noise of mirror falls as samples to the power of {number(median(slopes))}, the median of "
        f"{len(slopes)} scenes ({number(min(slopes))} to {number(max(slopes))})."
    )


def _unbiased(run: Run) -> str:
    mirrors = [(contest, c) for contest, c in run.curves if c.estimator == "mirror" and c.competes]
    told = [f"{contest.title}: {percent(c.floor)}" for contest, c in mirrors if c.told]
    if not mirrors:
        return ""
    small = sum(not c.told and c.at_most < TARGETS[-1] for _, c in mirrors)
    line = (
        f"The bias of mirror cannot be told from 0 in {len(mirrors) - len(told)} of {len(mirrors)} scenes; in {small} "
        f"of these it is known to be below {percent(TARGETS[-1])}"
    )
    return f"{line}. It is told in {'; '.join(told)}." if told else f"{line}."


def _winners(run: Run) -> str:
    factors = {name: [win.over[name] for _, win in run.wins if name in win.over] for name in AGAINST}
    said = [f"{name} errs {times(median(values))}" for name, values in factors.items() if values]
    return f"After the same time, in the median, {' and '.join(said)} as much as the best estimator." if said else ""


def _automatic(run: Run) -> str:
    if not run.picks:
        return ""
    near = sum(pick.close for _, pick in run.picks)
    contest, worst = max(run.picks, key=lambda one: one[1].ratio)
    line = f"Automatic is within 10 % of the best at {near} of {len(run.picks)} sample counts"
    if worst.ratio <= 1.0:
        return f"{line}."
    return (
        f"{line}; at worst it errs {times(worst.ratio)} as much as {worst.winner} "
        f"({contest.title}, {worst.samples} samples, {worst.estimator})."
    )


def _backends(run: Run) -> str:
    ratios = [ratio for contest in run.contests for ratio in contest.osl_over_nodes.values()]
    return (
        f"A sample takes {times(median(ratios))} as long as OSL as it does as nodes, in the median." if ratios else ""
    )


def _savings(run: Run) -> str:
    if not run.left_out:
        return ""
    ratios = [case.time for case in run.left_out]
    differing = [case.title for case in run.left_out if not (case.same and all(one.same for one in case.dropped))]
    line = (
        f"One universal material takes {times(median(ratios))} as long as a material that holds only what it needs, in "
        f"the median of {len(ratios)} cases ({min(ratios):.3g} to {max(ratios):.3g})"
    )
    if differing:
        return f"{line}; the pictures differ in {'; '.join(differing)}."
    return f"{line}; the pictures are the same."


def _stability(run: Run) -> str:
    if not run.cases:
        return ""
    failed = [f"{case.group}: {case.what} {case.value} {case.setup}".rstrip() for case in run.cases if not case.passed]
    limited = sum(bool(case.limit) for case in run.cases if case.passed)
    passed = f"{len(run.cases) - len(failed)} of {len(run.cases)} extreme cases pass"
    line = f"{passed}, {limited} of them within a stated limit"
    return f"{line}; failed: {'; '.join(failed)}." if failed else f"{line}."


def win_rows(run: Run) -> tuple[list[str], list[list[str]]]:
    """Columns and rows: scenes by times."""
    seconds = sorted({win.seconds for _, win in run.wins})
    rows = []
    for contest in run.contests:
        won = {win.seconds: win for win in contest.wins}
        if won:
            said = [
                f"{won[at].winner} {percent(won[at].error)} ({', '.join(times(f) for f in won[at].over.values())})"
                if at in won
                else ""
                for at in seconds
            ]
            rows.append([contest.title, *said])
    return ["scene, subject", *(f"{at:g} s" for at in seconds)], rows


def about(contest: Contest) -> str:
    """The truth, the seeds, and Automatic's choices in words."""
    few, many = int(np.min(contest.seeds)), int(np.max(contest.seeds))
    said = f"Truth: {contest.truth}. {many if few == many else f'{few} to {many}'} seeds." + (
        f" m = {contest.m:g}." if contest.m else ""
    )
    if contest.picks:
        choices = {pick.estimator: None for pick in contest.picks}
        worst = max(contest.picks, key=lambda pick: pick.ratio)
        said += f" Automatic: {', then '.join(choices)}; at worst {times(worst.ratio)} as much error as the best."
    return said


def curve_rows(contest: Contest) -> list[list[str]]:
    return [
        [
            curve.name,
            f"{number(curve.slope.value)} ± {curve.slope.error:.2f}" if curve.slope else "",
            bias(curve),
            *(both(curve.time_to(at, "cpu"), curve.time_to(at, "wall")) for at in TARGETS),
            f"{curve.flip[-1]:.3g}" if curve.flip is not None else "",
            curve.differs,
        ]
        for curve in contest.curves.values()
    ]


def case_rows(run: Run) -> list[list[str]]:
    """Failed ones first, then by group as measured."""
    ordered = sorted(run.cases, key=lambda case: case.passed)
    return [
        [
            case.group, case.what, case.value, case.setup, plain(case.lowest), plain(case.highest), plain(case.z),
            case.limit, "passed" if case.passed else "FAILED",
        ]
        for case in ordered
    ]  # fmt: skip


def left_out_rows(run: Run) -> list[list[str]]:
    """As built / universal, the most saved first."""

    def pair(values: Iterable[float] | None) -> str:
        return " / ".join(f"{value:.0f}" for value in values) if values and any(values) else ""

    return [
        [
            case.case, case.preset, case.scene, case.backend, times(case.time),
            f"{case.spread[0]:.2f} to {case.spread[1]:.2f}", times(case.first), pair(case.nodes),
            pair(case.instructions), pair(case.memory_mb), SAME[case.same],
        ]
        for case in sorted(run.left_out, key=lambda case: case.time, reverse=True)
    ]  # fmt: skip


def dropped_rows(run: Run) -> list[list[str]]:
    """Each thing that some material does without: how often, and medians of what it would take."""
    found: dict[str, list[Dropped]] = {}
    for one in (one for case in run.left_out for one in case.dropped):
        found.setdefault(one.what, []).append(one)
    return [
        [
            what, f"{len(ones)} of {len(run.left_out)}", f"{median(one.nodes for one in ones):g}",
            times(median(one.time for one in ones)), SAME[all(one.same for one in ones)],
        ]
        for what, ones in found.items()
    ]  # fmt: skip


def bias(curve: Curve) -> str:
    return percent(curve.floor) if curve.told else f"< {percent(curve.at_most)}"


def reached(at: Reached) -> str:
    if at.seconds is not None:
        return f"{'≤ ' if at.within else ''}{at.seconds:.3g} s"
    return f"floor {percent(at.value)}" if at.limit == "floor" else f"> {at.value:.3g} s"


def both(cpu: Reached, wall: Reached) -> str:
    return reached(cpu) if cpu.limit == "floor" else f"{reached(cpu)} ({reached(wall)})"


def percent(share: float) -> str:
    return f"{short(100.0 * share)} %"


def times(factor: float) -> str:
    return f"{factor:.2f} ×" if factor < 10.0 else f"{short(factor)} ×"


def short(value: float) -> str:
    """Three digits, and all that stand before the point."""
    return f"{value:.3g}" if abs(value) < 1000.0 else f"{value:.0f}"


def number(value: float) -> str:
    """With a minus that is as wide as a digit."""
    return f"{value:.2f}".replace("-", "−")


def plain(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _table(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    names = list(columns)
    lines = [names, ["---"] * len(names), *rows]
    return ["| " + " | ".join(text.replace("|", "\\|") for text in line) + " |" for line in lines]
