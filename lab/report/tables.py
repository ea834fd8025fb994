# SPDX-License-Identifier: GPL-3.0-or-later
"""The page's tables: for each a caption, columns and rows of text. Imports no bpy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from . import words
from .claims import TARGETS, value_text
from .contest import AGAINST
from .words import number, percent, plain, times

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ..bench.cells import Case
    from .contest import Contest, Win
    from .curve import Curve, TimeTo
    from .findings import Run

Rows = list[list[str]]
SAME = {True: "the same", False: "DIFFERS", None: ""}
CURVES = (
    "From 4 to 4096 samples, by powers of 4. Slope: of log noise over log samples, from 64 on. Bias: at the largest "
    "sample count; < an upper bound, where it cannot be distinguished from 0. Times: of the processor, and in brackets "
    "wall time. FLIP: at the largest sample count, of the judged pixels. Not resolved: rare events make most of the "
    "noise and no seed hit them; such sample counts are left out. Direct leaves out everything but lights, which "
    "counts as its bias. Automatic picks one of Cycles' own closures by a rule fitted to reports like this one, not "
    "tested on other scenes. What that rule costs is said beside each scene: its error over that of the best of "
    "all estimators at equal render time. Not measured: glass in a furnace, which reflects or transmits all light; "
    "subsurface scattering under a light, for which direct has no formula; pairs that add nothing."
)
CURVE_COLUMNS = ("contender", "slope", "bias", *(f"to {100 * target:g} %" for target in TARGETS), "FLIP", "remarks")


@dataclass(frozen=True)
class Section:
    """A table under a title. plot: the kind of figure above it; folded: rows that a reader opens."""

    title: str
    caption: str
    columns: tuple[str, ...]
    rows: Rows
    plot: str = ""
    folded: bool = False


def sections(run: Run) -> list[Section]:
    """The tables of all that was measured, but for the contests'."""
    return [one for part in (_wins, _stability, _left_out, _everyday) for one in part(run) if one.rows]


# Who has the smallest error


def _wins(run: Run) -> Iterator[Section]:
    """Scenes by times."""
    seconds = sorted({win.at for _, win in run.wins})
    rows = []
    for contest in run.contests:
        won = {win.at: win_text(win) for win in contest.wins}
        if won:
            rows.append([contest.title, *(won.get(at, "") for at in seconds)])
    yield Section(
        "The smallest error at equal time",
        "The estimator with the smallest error, that error, and how many times larger "
        f"{' and '.join(AGAINST)}'s is, where it is known. Only node groups compete. Times dominated by scene setup "
        "are omitted.",
        ("scene, subject", *(f"{at:g} s" for at in seconds)),
        rows,
    )


def win_text(win: Win) -> str:
    over = ", ".join(f"{name} {times(factor)}" for name, factor in win.over.items() if name != win.winner)
    return f"{win.winner} {percent(win.error)}" + (f" ({over})" if over else "")


# A scene and subject


def about(contest: Contest) -> str:
    """The truth, the seeds, and Automatic's choices in words."""
    cell = contest.cell
    said = (
        f"Truth: {cell.truth}. {_range(cell.seeds)} seeds{_more_seeds(contest)}. {cell.size} × {cell.size} pixels."
        + "".join(f" {name} = {value:g}." for name, value in cell.roughness.items())
        + (f" {cell.without}." if cell.without else "")
    )
    if not contest.picks:
        return said
    worst, cost = (max(contest.picks, key=key) for key in (lambda pick: pick.ratio, lambda pick: pick.of_all))
    said += (
        f" Automatic: {', then '.join(dict.fromkeys(pick.estimator for pick in contest.picks))}; at worst "
        f"{times(worst.ratio)} the error of the best that it may pick, and {times(cost.of_all)} that of the best of all"
    )
    said += f" ({cost.best_of_all}, at {cost.samples} samples)." if cost.of_all > 1.0 else "."
    if refused := contest.auto.refused:
        said += f" It never picks {', '.join(f'{name} ({why})' for name, why in refused.items())}."
    return said


def _range(counts: Iterable[float]) -> str:
    few, many = int(min(counts)), int(max(counts))
    return f"{many}" if few == many else f"{few} to {many}"


def _more_seeds(contest: Contest) -> str:
    """Who has more seeds than the others, where a slope is judged."""
    more = {curve.estimator: curve.seeds[curve.seeds > np.array(contest.cell.seeds)] for curve in contest.rivals}
    said = [f"{estimator} {_range(counts)}" for estimator, counts in more.items() if len(counts)]
    return f" ({', '.join(said)} where its slope is judged)" if said else ""


def curve_rows(contest: Contest) -> Rows:
    return [
        [
            curve.name, slope(curve), bias(curve),
            *(both(curve.time_to(at, "cpu"), curve.time_to(at, "wall")) for at in TARGETS),
            f"{curve.flip[-1]:.3g}", remarks(curve),
        ]
        for curve in contest.curves.values()
    ]  # fmt: skip


def slope(curve: Curve) -> str:
    if curve.slope is None:
        return ""
    return number(curve.slope.value) + ("" if curve.slope.error is None else f" ± {curve.slope.error:.2f}")


def bias(curve: Curve) -> str:
    return words.bias(curve.floor if curve.biased else None, None if curve.last is None else curve.bias_bound)


def reached(at: TimeTo) -> str:
    if at.seconds is not None:
        return f"{'≤ ' if at.within else ''}{at.seconds:.3g} s"
    return {"floor": f"floor {percent(at.value)}", "time": f"> {at.value:.3g} s", "noise": ""}[at.limit]


def both(cpu: TimeTo, wall: TimeTo) -> str:
    return reached(cpu) if cpu.limit in {"floor", "noise"} else f"{reached(cpu)} ({reached(wall)})"


def remarks(curve: Curve) -> str:
    """How its model differs, and the sample counts of which nothing is known."""
    unknown = ", ".join(f"{count:g}" for count in curve.samples[~curve.resolved])
    found = (
        curve.differs,
        "rays rarely hit the light: no slope" if curve.rarely_hit else "",
        unknown and f"not resolved at {unknown} samples",
    )
    return "; ".join(text for text in found if text)


# Extreme cases


def _stability(run: Run) -> Iterator[Section]:
    """Failed ones first, then by group as measured."""
    yield Section(
        "Extreme cases",
        "Lowest and highest: of all pixels; under a white sky what is reflected of it, else f in 1/sr. Z: of an error "
        "of scale that all pixels share, in its standard errors; resolves: the smallest such error that would be "
        "found. Error: of noise-free cases, with its limit. Noise: over that of independent samples; numbers: how "
        "many different ones the hash of position draws in a pixel, and in brackets how many the panel predicts.",
        (
            "group", "what", "value", "setup", "lowest", "highest", "Z", "resolves", "error", "bar", "noise", "numbers",
            "limit", "",
        ),
        [
            [
                case.group, case.what, value_text(case), case.setup, plain(case.lowest), plain(case.highest),
                plain(case.z), plain(case.resolves), plain(case.error), plain(case.bar), plain(case.noise),
                _numbers(case), case.limit, verdict(case),
            ]
            for case in sorted(run.cases, key=lambda case: case.passed)
        ],
        "stability",
        folded=True,
    )  # fmt: skip


def _numbers(case: Case) -> str:
    if case.numbers is None:
        return ""
    return f"{case.numbers:.0f}" + ("" if case.rays is None else f" ({case.rays:.0f})")


def verdict(case: Case) -> str:
    if not case.passed:
        return "FAILED"
    return "passed by another seed" if case.again else "passed"


# What was left out


def _left_out(run: Run) -> Iterator[Section]:
    """The largest saving first."""
    yield Section(
        "What was left out",
        "The universal material (one for each estimator and backend), which shows presets by its inputs alone (but for "
        "absorption), against each material as it is built. Time: universal over as built. Nodes, OSL instructions and "
        "MB beside Blender: as built / universal. Picture: by the same seed; for "
        "rough glass by mirror by its mean, as after the first hit its random numbers differ.",
        (
            "case", "preset", "scene", "estimator", "backend", "time", "spread", "nodes", "instructions", "MB",
            "picture",
        ),
        [
            [
                case.case, case.preset, case.scene, case.estimator, case.backend, times(case.slowdown),
                f"{case.spread[0]:.2f} to {case.spread[1]:.2f}", _pair(case.nodes), _pair(case.instructions),
                _pair(case.memory_mb), SAME[case.same],
            ]
            for case in sorted(run.left_out, key=lambda case: case.slowdown, reverse=True)
        ],
        "left_out",
    )  # fmt: skip
    yield Section(
        "Components left out",
        "What the builder leaves out and why; where it was put back, how many nodes it adds (the closure beside it, "
        "which EEVEE shows, is built and was removed). Nothing is put back under the softbox, nor by mirror.",
        ("case", "what", "why", "nodes", "picture"),
        [
            [case.title, one.what, one.why, "" if one.nodes is None else str(one.nodes), SAME[one.same]]
            for case in run.left_out
            for one in case.omitted
        ],
        folded=True,
    )  # fmt: skip


def _pair(values: Iterable[float] | None) -> str:
    return " / ".join(f"{value:.0f}" for value in values) if values and any(values) else ""


# Everyday scenes


def _everyday(run: Run) -> Iterator[Section]:
    """Those that fail first."""
    yield Section(
        "Everyday scenes",
        "The material that Automatic gives, beside what an artist would wire from Cycles' own nodes with the same "
        "numbers. Mean: over the pixels that show the material, ours over the native one's, for the channel that is "
        "farthest off. Band: within 5 %, or as far apart as the two models are by the reference on a ball lit from any "
        "direction up to 120 degrees from the view. Apart: by what share of the light the pictures differ pixel by "
        "pixel, less noise, and in brackets what the models themselves differ by. Black, bright: pixels that are so "
        "where the native material's are not. Time: over the native material's, the median of rounds that take turns. "
        "Warnings: those that are wrong there.",
        (
            "scene", "subject", "estimator", "mean", "band", "apart", "black", "bright", "time", "warnings", "",
        ),
        [
            [
                one.title, one.subject, one.estimator, f"{one.mean:.3f} ± {one.doubt:.3f}",
                f"{one.band[0]:.2f} to {one.band[1]:.2f}", f"{percent(max(one.apart, 0.0))} ({percent(one.bar)})",
                str(one.black or ""), str(one.bright or ""), "" if one.slowdown is None else times(one.slowdown),
                "; ".join(one.warnings), "passed" if one.passed else "FAILED",
            ]
            for one in sorted(run.everyday, key=lambda one: one.passed)
        ],
    )  # fmt: skip
