# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures that documents tell: each stands between two marks that name it, and is written there from a report.

    <!-- report fit.gentle -->3.5 %<!-- /report -->

Imports no bpy.
"""

from __future__ import annotations

import re
from statistics import median
from typing import TYPE_CHECKING, Any

from ...addon.library.errors import InputError
from ...addon.library.files import read_text, write_text
from ..bench.record import ReportError
from . import summary
from .words import percent, times

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from .findings import Contest, Run

MARKED = re.compile(r"<!-- report (\S+) -->(.*?)<!-- /report -->", re.DOTALL)
PAGES = ("README.md", "docs/*.md")
LONGEST_PAGE = 10_000_000  # bytes
LOW, HIGH = 0.4, 1.0  # slopes to which two figures of the README go
GRAZING = 85.0  # degrees, to which they go
SPEED_SCENES = ("environment", "softbox", "sun")
PEER = "Metallic BSDF"  # whose time and noise are 1
SPEED_SAMPLES = 256


def rewritten(text: str, found: list[Run]) -> str:
    """A document with the figures of a report. ReportError if it names one that is not had."""

    def one(match: re.Match[str]) -> str:
        return f"<!-- report {match[1]} -->{figure(match[1], found)}<!-- /report -->"

    return MARKED.sub(one, text)


def figure(name: str, found: list[Run]) -> str:
    """A figure as documents tell it; a table stands on lines of its own."""
    if name not in FIGURES:
        message = f"there is no figure {name}; there are {', '.join(FIGURES)}"
        raise ReportError(message)
    try:
        told = FIGURES[name](found)
    except (KeyError, IndexError, ValueError, StopIteration) as error:
        message = f"the report has not measured what {name} tells; measure it in full"
        raise ReportError(message) from error
    return f"\n\n{told}\n\n" if "\n" in told else told


def write(folder: Path, found: list[Run]) -> Iterator[Path]:
    """Rewrite the documents of a checkout; those that changed."""
    for path in sorted(path for pattern in PAGES for path in folder.glob(pattern)):
        try:
            text = read_text(path, LONGEST_PAGE)
            new = rewritten(text, found)
        except InputError as error:
            message = f"{path}: {error}"
            raise ReportError(message) from error
        if new != text:
            write_text(path, new)
            yield path


# --- figures --------------------------------------------------------------------------------------------------------


def _rows(found: list[Run], cell: str, name: str) -> list[list[Any]]:
    """Of the default Blender: what is computed does not depend on it."""
    return next(run.tables[cell][name]["rows"] for run in found if cell in run.tables)


def _table(cell: str, name: str, *formats: str) -> Callable[[list[Run]], str]:
    """A table as it is; formats: of the columns, the last of all that follow."""

    def told(found: list[Run]) -> str:
        run = next(run for run in found if cell in run.tables)
        table = run.tables[cell][name]
        return _markdown(table["columns"], ([_form(value, k) for k, value in enumerate(row)] for row in table["rows"]))

    def _form(value: Any, column: int) -> str:
        form = formats[min(column, len(formats) - 1)]
        if form == "%":
            return f"{100.0 * value:.1f}"
        return format(value, form)

    return told


def _markdown(columns: Any, rows: Any) -> str:
    return "\n".join(summary.table(columns, rows))


def _summary(found: list[Run]) -> str:
    """Of the default Blender; a report has the others'."""
    lines = [f"- {line}" for line in summary.headlines(found[0])]
    return "\n".join([f"Blender {found[0].blender}:", "", *lines])


def _fit_worst(highest: float) -> Callable[[list[Run]], str]:
    def told(found: list[Run]) -> str:
        rows = [row for row in _rows(found, "fit", "l1") if row[0] <= highest]
        return percent(max(value for row in rows for value in row[2::2]))

    return told


def _fit_l1(found: list[Run]) -> str:
    views = [name.removeprefix("closure ") for name in found[0].tables["fit"]["l1"]["columns"][1::2]]
    rows = [
        [f"{row[0]:g}", *(f"{100.0 * row[k]:.1f} / {100.0 * row[k + 1]:.1f}" for k in range(1, len(row), 2))]
        for row in _rows(found, "fit", "l1")
    ]
    return _markdown(["m", *(f"{view} deg" for view in views)], rows)


def _extreme(column: str, form: str) -> Callable[[list[Run]], str]:
    def told(found: list[Run]) -> str:
        (row,) = _rows(found, "oren_nayar", "extremes")
        return format(row[found[0].tables["oren_nayar"]["extremes"]["columns"].index(column)], form)

    return told


def _formula_rows(table: str, estimator: str, found: list[Run]) -> Iterator[tuple[str, float, float, float]]:
    """Setup, slope or sigma, largest difference and bar, on every Blender."""
    for run in found:
        for row in run.tables.get("formula", {table: {"rows": []}})[table]["rows"]:
            if row[0] == estimator:
                yield tuple(row[1:])


def _formula(estimator: str) -> Callable[[list[Run]], str]:
    """The worst of all setups and Blenders, by slope."""

    def told(found: list[Run]) -> str:
        rows = list(_formula_rows("cook_torrance", estimator, found))
        slopes = sorted({m for _, m, _, _ in rows}, reverse=True)
        worst = [max(off for _, m, off, _ in rows if m == one) for one in slopes]
        bars = [max(bar for _, m, _, bar in rows if m == one) for one in slopes]
        columns = ["m", *(f"{m:g}" for m in slopes)]
        return _markdown(columns, [["worst", *map(_power, worst)], ["bar", *map(_power, bars)]])

    return told


def _formula_worst(
    table: str, estimator: str, low: float, high: float, setups: Callable[[str], bool] = bool
) -> Callable[[list[Run]], str]:
    """Of slopes or sigmas from ``low`` to ``high``."""

    def told(found: list[Run]) -> str:
        rows = _formula_rows(table, estimator, found)
        return _power(max(off for setup, number, off, _ in rows if low <= number <= high and setups(setup)))

    return told


def _is_svm(setup: str) -> bool:
    return setup.endswith("SVM")


def _is_osl(setup: str) -> bool:
    return not _is_svm(setup)


def _power(value: float) -> str:
    return f"{value:.1e}"


def _keys_worst(found: list[Run]) -> str:
    return ", ".join(f"{off:.2e} at {tolerance:g}" for tolerance, off in _rows(found, "keys", "worst"))


def _keys_exponential(found: list[Run]) -> str:
    tolerance, pieces, fewest = _rows(found, "keys", "exponential")[0]
    return f"exp(-t) to {tolerance:g}: {pieces} straight pieces; fewer than {fewest:.1f} cannot do."


def _batch(found: list[Run]) -> str:
    """One column a Blender."""
    costs = {run.blender: dict(run.tables["batch"]["cost"]["rows"]) for run in found if "batch" in run.tables}
    rows = [
        ["64 x 64 at 16 samples, a `vgroove render` process a still",
         *(f"{of['seconds by a process a still']:.2f} s" for of in costs.values())],
        ["the same in a batch", *(f"{of['seconds in a batch']:.3f} s" for of in costs.values())],
        ["throughput of a batch over that",
         *(times(of["seconds by a process a still"] / of["seconds in a batch"]) for of in costs.values())],
        ["outside Cycles' own render call, over it, at 64 x 64 and 16 samples",
         *(percent(of["outside Cycles at 64 x 64 and 16 samples"]) for of in costs.values())],
        ["at 256 x 256 and 64 samples",
         *(percent(of["outside Cycles at 256 x 256 and 64 samples"]) for of in costs.values())],
        ["growth of a process that is never replaced, a task",
         *(f"{of['bytes a task'] / 1000.0:.1f} kB" for of in costs.values())],
    ]  # fmt: skip
    return _markdown(["", *costs], rows)


def _batch_stills(found: list[Run]) -> str:
    counts = [dict(run.tables["batch"]["cost"]["rows"])["stills"] for run in found if "batch" in run.tables]
    return " and ".join(dict.fromkeys(map(str, counts)))


def _speed(found: list[Run]) -> str:
    """Time a sample, and noise at equal samples, over the peer's, by estimator and scene."""
    contests = [_contest(found[0], scene, "copper") for scene in SPEED_SCENES]
    names = {curve.estimator: None for contest in contests for curve in contest.rivals}
    rows = []
    for name in names:
        row = [name]
        for contest in contests:
            peer, own = contest.curves[PEER], contest.curves.get(f"{name}, nodes")
            if own is None:
                row += ["", ""]
                continue
            at = list(own.samples).index(SPEED_SAMPLES)
            row += [
                f"{own.per_sample / peer.per_sample:.2f}",
                f"{own.noise[at] / peer.noise[at]:.2f}" if own.resolved[at] and not own.seldom else "rare hits",
            ]
        rows.append(row)
    columns = [text for contest in contests for text in (f"{contest.title}: time", "noise")]
    return _markdown(["estimator", *columns], rows)


def _contest(run: Run, scene: str, subject: str) -> Contest:
    return next(one for one in run.contests if (one.scene, one.subject) == (scene, subject))


def _osl(found: list[Run]) -> str:
    ratios = [ratio for contest in found[0].contests for ratio in contest.osl_over_nodes.values()]
    return times(median(ratios))


def _fit_time(scene: str) -> Callable[[list[Run]], str]:
    def told(found: list[Run]) -> str:
        curves = _contest(found[0], scene, "copper").curves
        return times(curves["fit, nodes"].per_sample / curves["closure, nodes"].per_sample)

    return told


FIGURES: dict[str, Callable[[list[Run]], str]] = {
    "summary": _summary,
    "fit.gentle": _fit_worst(LOW),
    "fit.rough": _fit_worst(HIGH),
    "fit.l1": _fit_l1,
    "formula.direct": _formula("direct"),
    "formula.closure": _formula("closure"),
    "formula.wide": _formula_worst("cook_torrance", "direct", 0.1, 1.0),
    "formula.narrow": _formula_worst("cook_torrance", "direct", 0.02, 0.02),
    "formula.svm": _formula_worst("cook_torrance", "direct", 0.3, 1.0, _is_svm),
    "formula.diffuse_svm": _formula_worst("oren_nayar", "direct", 0.0, 2.0, _is_svm),
    "formula.diffuse_osl": _formula_worst("oren_nayar", "direct", 0.0, 2.0, _is_osl),
    "formula.diffuse_closure": _formula_worst("oren_nayar", "closure", 0.0, 2.0),
    "errata.area": _table("errata", "area", "g", ".6f"),
    "errata.head_on": _table("errata", "head_on", "g", ".6f"),
    "errata.oblique": _table("errata", "oblique", "g", ".6f"),
    "oren_nayar.short": _table("oren_nayar", "short", ".2f", "%"),
    "oren_nayar.full": _table("oren_nayar", "full", ".2f", "%"),
    "oren_nayar.qualitative": _table("oren_nayar", "qualitative", ".2f", "%"),
    "oren_nayar.full_5_3": _table("oren_nayar", "full_5_3", ".2f", "%"),
    "oren_nayar.qualitative_5_3": _table("oren_nayar", "qualitative_5_3", ".2f", "%"),
    "oren_nayar.weight": _extreme("weight", ".1f"),
    "oren_nayar.albedo": _extreme("albedo", ".2f"),
    "keys.keys": _table("keys", "keys", ""),
    "keys.worst": _keys_worst,
    "keys.exponential": _keys_exponential,
    "batch.cost": _batch,
    "batch.stills": _batch_stills,
    "speed.samples": _speed,
    "speed.osl": _osl,
    "speed.fit_environment": _fit_time("environment"),
    "speed.fit_softbox": _fit_time("softbox"),
}
