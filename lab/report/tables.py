# SPDX-License-Identifier: GPL-3.0-or-later
"""The page's details: every cell of a report as a row, under what its type says of its fields. Imports no bpy."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

from ..bench.cells import Accuracy, Case, Everyday, LeftOut, OmittedPart
from .claims import case_title
from .contest import Pick
from .published import CurveFigures
from .summary import Section
from .words import short

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from .findings import Run
    from .published import PublishedRun

ELSEWHERE = {"contenders", "omitted"}  # fields that have tables of their own
IN_TITLE = {"group", "what", "value", "setup"}  # what ``case_title`` says
VERDICTS = ("passed", "same")


def sections(run: Run, figures: PublishedRun) -> list[Section]:
    """A table for each type of cell that a run has; what fails comes first."""
    curves = [
        ((contest.title, name, curve.differs), figures.scenes[contest.key].curves[name])
        for contest in run.contests
        for name, curve in contest.curves.items()
    ]
    picks = [((contest.title,), pick) for contest, pick in run.picks]
    cases = [((case.group, case_title(case)), case) for case in run.cases]
    left_out = [((), one) for one in run.left_out]
    parts = [((case.title,), part) for case in run.left_out for part in case.omitted]
    everyday = [((), one) for one in run.everyday]
    found = (
        _section("Scenes and subjects", Accuracy, (), [((), contest.cell) for contest in run.contests]),
        _section("Contenders", CurveFigures, ("scene, subject", "contender", "differs"), curves),
        _section("What Automatic picks", Pick, ("scene, subject",), picks),
        _section("Extreme cases", Case, ("group", "case"), cases, IN_TITLE),
        _section("Materials as built", LeftOut, (), left_out),
        _section("Components left out", OmittedPart, ("case",), parts),
        _section("Everyday scenes", Everyday, (), everyday),
    )
    return [one for one in found if one.rows]


def _section(
    title: str, kind: type, heads: Sequence[str], cells: Iterable[tuple[Sequence[str], Any]], hidden: Iterable[str] = ()
) -> Section:
    """Cells of one type, each behind words for ``heads``; without fields that are ``hidden`` or empty in all cells."""
    ordered = sorted(cells, key=lambda of: is_right(of[1]))
    texts = {name: [text(getattr(cell, name)) for _, cell in ordered] for name in kind.__annotations__}
    shown = {name: of for name, of in texts.items() if name not in {*ELSEWHERE, *hidden} and any(of)}
    rows = [[*words, *(of[k] for of in shown.values())] for k, (words, _) in enumerate(ordered)]
    columns = [*heads, *(name.replace("_", " ") for name in shown)]
    wrong = sum(not is_right(cell) for _, cell in ordered)
    return Section(title, inspect.cleandoc(kind.__doc__ or ""), columns, rows, wrong=wrong)


def is_right(cell: Any) -> bool:
    """Whether a cell, if it is of a type that is judged, shows what it should."""
    return all(getattr(cell, name, True) is not False for name in VERDICTS)


def text(value: Any) -> str:
    """A field as a reader sees it: numbers by three digits, and nothing for what was not measured."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return short(value)
    if isinstance(value, dict):
        return ", ".join(f"{name.replace('_', ' ')} {text(one)}".strip() for name, one in value.items())
    if isinstance(value, list | tuple):
        return " / ".join(map(text, value))
    return str(value)
