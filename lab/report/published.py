# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/figures.json: of a report, the numbers that documents and tests quote. Imports no bpy."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from ...addon.library.files import read_text
from ..bench.cells import Picks, Table, part_of
from ..bench.figures import COMPUTED
from ..bench.record import CODEC, Machine, ReportError, json_text
from . import claims
from .claims import Claim  # noqa: TC001 - the codec looks types up
from .contest import Contest, Pick  # noqa: TC001
from .findings import runs

if TYPE_CHECKING:
    from pathlib import Path

    from ..bench.record import Report
    from .curve import Curve
    from .findings import Run

FILE = "docs/figures.json"
LONGEST_FILE = 150_000  # bytes
DIGITS = 4
NOISE_SAMPLES = 256


class CurveFigures(NamedTuple):
    """A contender in a scene. bias: at the most samples, None where it cannot be distinguished from 0; bound: what it
    does not exceed, None where neither is known. noise: of ``NOISE_SAMPLES`` samples, None where hits are rare.
    """  # noqa: D205

    bias: float | None
    bound: float | None
    slope: float | None
    slope_error: float | None
    seconds_per_sample: float
    noise: float | None


@dataclass(frozen=True)
class SceneFigures:
    """A scene and subject. auto: what Automatic picks at each sample count; picks: what that costs, where known."""

    model: str
    roughness: dict[str, float]
    curves: dict[str, CurveFigures]
    auto: Picks = field(default_factory=lambda: Picks(estimators=()))
    picks: list[Pick] = field(default_factory=list)
    smooth: bool = False


@dataclass(frozen=True)
class PublishedRun:
    """One Blender. code: digests of what measured each part; keys: its cells, by part. scenes: by SCENE/SUBJECT.

    cases: extreme cases by group. left_out: a row for each setup. tables: by document and name.
    """

    vgroove: str
    quick: bool
    lacks: int
    code: dict[str, str]
    keys: dict[str, list[str]]
    claims: list[Claim]
    remarks: list[str]
    scenes: dict[str, SceneFigures]
    cases: Table
    left_out: Table
    tables: dict[str, dict[str, Table]]

    @property
    def headlines(self) -> list[str]:
        return [*(claim.text for claim in self.claims), *self.remarks]


@dataclass(frozen=True)
class Published:
    """By Blender, the default one first."""

    machine: Machine
    runs: dict[str, PublishedRun]

    @property
    def default(self) -> PublishedRun:
        return next(iter(self.runs.values()))


def publish(report: Report) -> Published:
    found: dict[str, PublishedRun] = {}
    for run in runs(report):
        found[run.blender] = _run(run, first=not found)
    return Published(report.machine, found)


def read(path: Path) -> Published:
    published: Published = CODEC.structure(json.loads(read_text(path, LONGEST_FILE)), Published)
    return published


def to_json(published: Published) -> str:
    return json_text(CODEC.unstructure(published))


def require_one_program(published: Published) -> None:
    """ReportError unless one program measured every Blender, and the default one in full; quick ones have fewer cells.

    Figures of other code would not compare.
    """
    default, first = published.default, next(iter(published.runs))
    if default.quick:
        message = f"Blender {first} was measured quickly; measure it in full"
        raise ReportError(message)
    for blender, run in published.runs.items():
        if run.code != default.code:
            message = f"Blender {blender} and {first} were measured by different code; measure both again"
            raise ReportError(message)
        if not run.quick and run.keys != default.keys:
            message = f"Blender {blender} and {first} have different measurements; measure both in full"
            raise ReportError(message)


def _run(run: Run, *, first: bool) -> PublishedRun:
    keys: dict[str, list[str]] = {}
    for key in sorted(run.record.cells):
        keys.setdefault(part_of(key), []).append(key.partition("/")[2])
    scenes = {of.key: _scene(of) for of in run.contests}
    # What is computed does not depend on the Blender: the first has it.
    tables = {name: of for name, of in run.tables.items() if first or name not in COMPUTED}
    return PublishedRun(
        run.record.vgroove, run.quick, run.lacks, dict(run.record.code), keys, claims.of(run), claims.remarks(run),
        scenes, _cases(run), _left_out(run), tables,
    )  # fmt: skip


def _scene(contest: Contest) -> SceneFigures:
    cell = contest.cell
    picks = [
        pick._replace(ratio=_short(pick.ratio), doubt=_short(pick.doubt), of_all=_short(pick.of_all))
        for pick in contest.picks
    ]
    curves = {name: _curve(curve) for name, curve in contest.curves.items()}
    auto = Picks(estimators=contest.auto.estimators, refused=dict.fromkeys(contest.auto.refused, ""))
    return SceneFigures(cell.model, cell.roughness, curves, auto, picks, cell.smooth)


def _curve(curve: Curve) -> CurveFigures:
    slope = curve.slope
    noise = curve.noise[(curve.samples == NOISE_SAMPLES) & curve.resolved]
    return CurveFigures(
        _short(curve.floor) if curve.biased else None,
        _short(curve.bias_bound) if curve.last is not None else None,
        _short(slope.value) if slope else None,
        _short(slope.error) if slope and slope.error else None,
        _short(curve.per_sample),
        _short(float(noise[0])) if len(noise) and not curve.rarely_hit else None,
    )


def _cases(run: Run) -> Table:
    rows = []
    for group in dict.fromkeys(case.group for case in run.cases):
        cases = [case for case in run.cases if case.group == group]
        passed = [case for case in cases if case.passed]
        rows.append([group, len(cases), len(passed), sum(bool(case.limit) for case in passed)])
    return Table(["group", "cases", "passed", "within a stated limit"], rows)


def _left_out(run: Run) -> Table:
    return Table(
        ["case", "scene", "estimator", "backend", "time of the universal material", "nodes", "universal nodes"],
        [[one.case, one.scene, one.estimator, one.backend, _short(one.slowdown), *one.nodes] for one in run.left_out],
    )


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
