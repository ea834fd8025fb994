# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report found, in a page or two for each Blender: report.md, and how the page begins. Imports no bpy."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from ..bench.scene_table import SCENES
from .words import bias, number, times

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ..bench.record import Machine
    from .published import Published, PublishedRun, SceneFigures

FILE = "report.md"
TITLE = "Error against run time, stability, and what was left out"
PLOTS = {  # by kind: the text in its place for who cannot see it
    "error": "Error against processor time, a panel for each scene and subject",
    "noise": "Noise and bias against samples, a panel for each scene and subject",
}
SCENE_CAPTION = (
    "Bias at the most samples, as a share of the image; < where it cannot be distinguished from 0. Slope: of mirror's "
    "log noise over log samples. Cost of Automatic: its largest error over that of the best estimator that it may "
    "pick, and over that of the best of all, at equal render time."
)


@dataclass(frozen=True)
class Section:
    """A table under a title. wrong: how many rows, the first ones, show what should not be."""

    title: str
    caption: str
    columns: list[str]
    rows: list[list[str]]
    wrong: int = 0


def markdown(published: Published) -> str:
    lines = [
        f"# {TITLE}",
        "",
        "`vgroove report -o DIR` measures this and writes a page, report.html, with every figure;",
        "`vgroove report --from DIR/report.json` draws it again.",
        about(published.machine),
    ]
    for blender, run in published.runs.items():
        lines += ["", f"## {title(blender, quick=run.quick, lacks=run.lacks)}", ""]
        lines += [f"- {line}" for line in run.headlines]
        for kind, words in PLOTS.items() if run.scenes else ():
            lines += ["", f"![{words}](plots/{kind}-{blender}.png)"]
        for section in sections(run):
            lines += ["", f"### {section.title}", ""]
            lines += [section.caption, ""] if section.caption else []
            lines += table(section.columns, section.rows)
    return "\n".join([*lines, ""])


def title(blender: str, *, quick: bool, lacks: int) -> str:
    lacking = f", {lacks} measurements missing" if lacks else ""
    return f"Blender {blender}{', quick' if quick else ''}{lacking}"


def about(machine: Machine) -> str:
    """Where it was measured, and what is meant by an error and a time."""
    return (
        f"Measured on {machine.system}, {machine.processor}, {machine.cores} cores, {machine.memory_gb} GB.\n"
        "An error is the root mean square difference from the truth, over the truth's. Times are of the processor\n"
        "unless said otherwise."
    )


def sections(run: PublishedRun) -> Iterator[Section]:
    """What every part of a report comes to."""
    if run.scenes:
        yield Section("Each scene and subject", SCENE_CAPTION, *_scenes(run))
    if run.cases.rows:
        yield Section("Extreme cases", "", run.cases.columns, [[str(value) for value in row] for row in run.cases.rows])
    if run.left_out.rows:
        yield Section("What was left out", "", *_left_out(run))


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
