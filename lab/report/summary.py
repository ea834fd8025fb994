# SPDX-License-Identifier: GPL-3.0-or-later
"""report.md: what a report found, in a page or two for each Blender. Imports no bpy."""

from __future__ import annotations

from statistics import median
from typing import TYPE_CHECKING

from ..bench.cells import Table
from ..bench.scene_table import SCENES
from .words import bias, number, times

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .published import Published, PublishedRun, SceneFigures

FILE = "report.md"
KINDS = {  # of plots: what holds them, and the text in their place for who cannot see them
    "error": ("scenes", "Error against processor time, a panel for each scene and subject"),
    "noise": ("scenes", "Noise and bias against samples, a panel for each scene and subject"),
    "stability": ("cases", "Extreme cases by group: passed, passed within a limit, failed"),
    "left_out": ("left_out", "Render time of the universal material over each as it is built"),
}
SCENE_CAPTION = (
    "Bias at the most samples, as a share of the image; < where it cannot be distinguished from 0. Slope: of mirror's "
    "log noise over log samples. Cost of Automatic: its largest error over that of the best estimator that it may "
    "pick, and over that of the best of all, at equal render time."
)


def markdown(published: Published) -> str:
    machine = published.machine
    lines = [
        "# Error against run time, stability, and what was left out",
        "",
        "`vgroove report -o DIR` measures this and writes a page, report.html, with every figure and picture;",
        "`vgroove report --from DIR/report.json` draws it again. Measured on",
        f"{machine.system}, {machine.processor}, {machine.cores} cores, {machine.memory_gb} GB.",
        "An error is the root mean square difference from the truth, over the truth's. Times are of the processor",
        "unless said otherwise.",
    ]
    for blender, run in published.runs.items():
        lines += ["", f"## {title(blender, quick=run.quick, lacks=run.lacks)}", ""]
        lines += [f"- {line}" for line in run.headlines]
        lines += _images(blender, run, "error", "noise")
        if run.scenes:
            lines += ["", "### Each scene and subject", "", SCENE_CAPTION, "", *table(*_scenes(run))]
        if run.cases.rows:
            lines += ["", "### Extreme cases", *_images(blender, run, "stability"), ""]
            lines += table(run.cases.columns, ([str(value) for value in row] for row in run.cases.rows))
        if run.left_out.rows:
            lines += ["", "### What was left out", *_images(blender, run, "left_out"), "", *table(*_left_out(run))]
    return "\n".join([*lines, ""])


def title(blender: str, *, quick: bool, lacks: int) -> str:
    lacking = f", {lacks} measurements missing" if lacks else ""
    return f"Blender {blender}{', quick' if quick else ''}{lacking}"


def _images(blender: str, run: PublishedRun, *kinds: str) -> list[str]:
    return [
        line for kind in kinds if _has(run, kind) for line in ("", f"![{KINDS[kind][1]}](plots/{kind}-{blender}.png)")
    ]


def _has(run: PublishedRun, kind: str) -> bool:
    found = getattr(run, KINDS[kind][0])
    return bool(found.rows if isinstance(found, Table) else found)


def _scenes(run: PublishedRun) -> tuple[list[str], list[list[str]]]:
    rows = []
    for key, of in run.scenes.items():
        scene, _, subject = key.partition("/")
        mirror = of.curves.get("mirror, nodes")
        costs = [
            max(costs) for costs in ([pick.ratio for pick in of.picks], [pick.of_all for pick in of.picks]) if costs
        ]
        rows.append(
            [
                f"{SCENES[scene].title}, {subject}", _bias(of, "closure"), _bias(of, "fit"),
                "" if mirror is None or mirror.slope is None else number(mirror.slope),
                ", ".join(dict.fromkeys(of.auto.estimators)), " / ".join(map(times, costs)),
            ]
        )  # fmt: skip
    return ["scene, subject", "closure's bias", "fit's bias", "slope", "Automatic", "cost of Automatic"], rows


def _bias(of: SceneFigures, estimator: str) -> str:
    curve = of.curves.get(f"{estimator}, nodes")
    return bias(curve.bias, curve.bound) if curve else ""


def _left_out(run: PublishedRun) -> tuple[list[str], list[list[str]]]:
    """The median over each case's scenes, and the sizes in its first."""
    rows = []
    for case in dict.fromkeys(row[0] for row in run.left_out.rows):
        setups = [row for row in run.left_out.rows if row[0] == case]
        nodes, universal = setups[0][5:7]
        rows.append([case, str(len(setups)), times(median(row[4] for row in setups)), f"{nodes} / {universal}"])
    return ["case", "setups", "time of the universal material, median", "nodes as built / universal"], rows


def table(columns: Iterable[str], rows: Iterable[Iterable[str]]) -> list[str]:
    names = list(columns)
    lines = [names, ["---"] * len(names), *rows]
    return ["| " + " | ".join(text.replace("|", "\\|") for text in line) + " |" for line in lines]
