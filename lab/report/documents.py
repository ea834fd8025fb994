# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures that documents show: each stands between two marks that name it, and is written there from a report.

    <!-- report fit.gentle -->3.5 %<!-- /report -->

Imports no bpy.
"""

from __future__ import annotations

import re
from functools import partial
from statistics import median
from typing import TYPE_CHECKING, Any

from ...addon.library.files import FileError, read_text, write_text
from ...addon.models import MODELS, fresnel, label
from ..bench.record import ReportError
from ..bench.scene_table import SCENES
from . import automatic, published, summary
from .words import percent, times

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path

    from ...addon.models import Parameter
    from ..bench.cells import Table
    from .published import Published

MARKED = re.compile(r"<!-- report (\S+) -->(.*?)<!-- /report -->", re.DOTALL)
PAGES = ("README.md", "docs/**/*.md")
LONGEST_PAGE = 10_000_000  # bytes
SPEED_SCENES = ("environment", "softbox", "sun")
PEER = "Metallic BSDF"  # whose time and noise are 1
ERRATA = ("area", "head_on", "oblique")  # tables
L1 = ("short", "full", "qualitative", "full_5_3", "qualitative_5_3")


def write(folder: Path, found: Published) -> Iterator[Path]:
    """Rewrite a checkout's documents, docs/figures.json and Automatic's table, or none of them; those that changed."""
    published.require_one_program(found)
    table = folder / automatic.FILE
    new = {
        folder / published.FILE: published.to_json(found),
        folder / "docs" / summary.FILE: summary.markdown(found),
        table: automatic.to_toml(automatic.updated(automatic.read(table), found)),
    }
    for path in sorted(path for pattern in PAGES for path in folder.glob(pattern)):
        if path not in new:
            try:
                new[path] = rewritten(read_text(path, LONGEST_PAGE), found)
            except (FileError, ReportError) as error:
                message = f"{path}: {error}"
                raise ReportError(message) from error
    for path, text in new.items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            write_text(path, text)
            yield path


def rewritten(text: str, found: Published) -> str:
    """A document with the figures of a report. ReportError if it names one that was not measured."""

    def one(match: re.Match[str]) -> str:
        return f"<!-- report {match[1]} -->{figure(match[1], found)}<!-- /report -->"

    return MARKED.sub(one, text)


def figure(name: str, found: Published) -> str:
    """A figure as documents show it; a table stands on lines of its own."""
    if name not in FIGURES:
        message = f"there is no figure {name}; there are {', '.join(FIGURES)}"
        raise ReportError(message)
    try:
        text = FIGURES[name](found)
    except (KeyError, IndexError, ValueError, StopIteration) as error:
        message = f"the report has not measured {name}; measure it in full"
        raise ReportError(message) from error
    return f"\n\n{text}\n\n" if "\n" in text else text


# Figures


def _table(found: Published, cell: str, name: str) -> Table:
    """Of the first Blender that has it: what is computed does not depend on it."""
    return next(run.tables[cell][name] for run in found.runs.values() if cell in run.tables)


def _whole(found: Published, cell: str, name: str, first: str, others: str) -> str:
    """A table as it is; first, others: the format of the first column and of all others, "%" for 100 times."""
    table = _table(found, cell, name)
    forms = [first] + [others] * (len(table.columns) - 1)
    rows = ([_number(*one) for one in zip(row, forms, strict=True)] for row in table.rows)
    return _markdown(table.columns, rows)


def _number(value: Any, form: str) -> str:
    return f"{100.0 * value:.1f}" if form == "%" else format(value, form)


def _markdown(columns: Any, rows: Any) -> str:
    return "\n".join(summary.table(columns, rows))


def _fit_worst(found: Published, highest: float) -> str:
    """Of slopes up to ``highest``."""
    rows = [row for row in _table(found, "fit", "l1").rows if row[0] <= highest]
    return percent(max(value for row in rows for value in row[2::2]))


def _fit_l1(found: Published) -> str:
    table = _table(found, "fit", "l1")
    views = [name.removeprefix("closure ") for name in table.columns[1::2]]
    rows = [
        [f"{row[0]:g}", *(f"{100.0 * row[k]:.1f} / {100.0 * row[k + 1]:.1f}" for k in range(1, len(row), 2))]
        for row in table.rows
    ]
    return _markdown(["m", *(f"{view} deg" for view in views)], rows)


def _extreme(found: Published, column: str, form: str) -> str:
    table = _table(found, "oren_nayar", "extremes")
    return format(table.rows[0][table.columns.index(column)], form)


def _formula_rows(found: Published, table: str, estimator: str) -> Iterator[tuple[str, float, float, float]]:
    """Setup, slope or sigma, largest difference and bar, on every Blender."""
    for run in found.runs.values():
        for row in run.tables["formula"][table].rows if "formula" in run.tables else ():
            if row[0] == estimator:
                yield tuple(row[1:])


def _formula(found: Published, estimator: str) -> str:
    """The worst of all setups and Blenders, by slope."""
    rows = list(_formula_rows(found, "cook_torrance", estimator))
    slopes = sorted({m for _, m, _, _ in rows}, reverse=True)
    worst = [max(off for _, m, off, _ in rows if m == one) for one in slopes]
    bars = [max(bar for _, m, _, bar in rows if m == one) for one in slopes]
    lines = (["worst", *map(_power, worst)], ["bar", *map(_power, bars)])
    return _markdown(["m", *(f"{m:g}" for m in slopes)], lines)


def _formula_worst(
    found: Published, table: str, estimator: str, low: float = 0.0, high: float = 2.0, within: str = ""
) -> str:
    """Of slopes or sigmas from ``low`` to ``high``; within: of setups that run in "SVM", or in "OSL"."""
    rows = _formula_rows(found, table, estimator)
    return _power(max(off for setup, at, off, _ in rows if low <= at <= high and within in setup.upper()))


def _power(value: float) -> str:
    return f"{value:.1e}"


def _keys_worst(found: Published) -> str:
    return ", ".join(f"{off:.2e} at {tolerance:g}" for tolerance, off in _table(found, "keys", "worst").rows)


def _keys_exponential(found: Published) -> str:
    tolerance, pieces, fewest = _table(found, "keys", "exponential").rows[0]
    return f"exp(-t) to {tolerance:g}: {pieces} straight pieces; at least {fewest:.1f} are needed."


def _costs(found: Published) -> dict[str, dict[str, Any]]:
    """What ``vgroove batch`` costs, by Blender."""
    return {name: dict(run.tables["batch"]["cost"].rows) for name, run in found.runs.items() if "batch" in run.tables}


def _batch(found: Published) -> str:
    """One column a Blender."""
    costs = _costs(found)
    alone, together = "seconds by a process a still", "seconds in a batch"
    rows: dict[str, Callable[[dict[str, Any]], str]] = {
        "64 x 64 at 16 samples, one `vgroove render` process per still": lambda of: f"{of[alone]:.2f} s",
        "the same in a batch": lambda of: f"{of[together]:.3f} s",
        "speed-up by batch": lambda of: times(of[alone] / of[together]),
        "overhead relative to Cycles' render call, at 64 x 64 and 16 samples": lambda of: percent(
            of["outside Cycles at 64 x 64 and 16 samples"]
        ),
        "at 256 x 256 and 64 samples": lambda of: percent(of["outside Cycles at 256 x 256 and 64 samples"]),
        "memory growth per task of a process that is never replaced": lambda of: (
            f"{of['bytes a task'] / 1000.0:.1f} kB"
        ),
    }
    return _markdown(["", *costs], [[what, *map(form, costs.values())] for what, form in rows.items()])


def _batch_stills(found: Published) -> str:
    return " and ".join(dict.fromkeys(str(of["stills"]) for of in _costs(found).values()))


def _speed(found: Published) -> str:
    """Time a sample, and noise at equal samples, over the peer's, by estimator and scene."""
    scenes = {name: found.default.scenes[f"{name}/copper"].curves for name in SPEED_SCENES}
    rows = []
    for name in dict.fromkeys(name for curves in scenes.values() for name in curves if name.endswith(", nodes")):
        row = [name.removesuffix(", nodes")]
        for curves in scenes.values():
            if name not in curves:
                row += ["", ""]
                continue
            own, peer = curves[name], curves[PEER]
            noise = "rare hits" if own.noise is None or peer.noise is None else f"{own.noise / peer.noise:.2f}"
            row += [f"{own.seconds_per_sample / peer.seconds_per_sample:.2f}", noise]
        rows.append(row)
    columns = [text for name in scenes for text in (f"{SCENES[name].title}, copper: time", "noise")]
    return _markdown(["estimator", *columns], rows)


def _osl(found: Published) -> str:
    """The median ratio of a sample's time, of all that were timed as both."""
    ratios = [
        osl.seconds_per_sample / of.curves[name.replace(", osl", ", nodes")].seconds_per_sample
        for of in found.default.scenes.values()
        for name, osl in of.curves.items()
        if name.endswith(", osl")
    ]
    return times(median(ratios))


def _fit_time(found: Published, scene: str) -> str:
    curves = found.default.scenes[f"{scene}/copper"].curves
    return times(curves["fit, nodes"].seconds_per_sample / curves["closure, nodes"].seconds_per_sample)


def parameter_table(rows: Iterable[tuple[str, Parameter, str]], first: str = "") -> str:
    """Parameters as specs have them, and the labels of their inputs; first: what the rows' first column is, if any."""
    columns = [first, "in the file", "in Blender", "range", "unit", "what Blender says of it"]
    texts = [
        [name, f"`{one.name}`", label, f"{one.low:g} to {one.high:.4g}", one.unit, one.tip] for name, one, label in rows
    ]
    kept = slice(0 if first else 1, None)
    return _markdown(columns[kept], [row[kept] for row in texts])


def _models(_found: Published) -> str:
    """Own parameters of every model, those of its lobes too."""
    rows = [
        (f"`{model.name}`", one, label(model.name, one.name))
        for model in MODELS.values()
        for one in dict.fromkeys((*model.parameters, *model.lobes))
    ]
    return parameter_table(rows, "model")


def _fresnel(_found: Published) -> str:
    return parameter_table(
        [(of.label, one, one.label) for of in fresnel.KINDS.values() for one in of.parameters], "term"
    )


FIGURES: dict[str, Callable[[Published], str]] = {
    "models": _models,
    "fresnel": _fresnel,
    "fit.gentle": partial(_fit_worst, highest=0.4),
    "fit.rough": partial(_fit_worst, highest=1.0),
    "fit.l1": _fit_l1,
    "formula.direct": partial(_formula, estimator="direct"),
    "formula.closure": partial(_formula, estimator="closure"),
    "formula.wide": partial(_formula_worst, table="cook_torrance", estimator="direct", low=0.1),
    "formula.narrow": partial(_formula_worst, table="cook_torrance", estimator="direct", low=0.02, high=0.02),
    "formula.svm": partial(_formula_worst, table="cook_torrance", estimator="direct", low=0.3, within="SVM"),
    "formula.diffuse_svm": partial(_formula_worst, table="oren_nayar", estimator="direct", within="SVM"),
    "formula.diffuse_osl": partial(_formula_worst, table="oren_nayar", estimator="direct", within="OSL"),
    "formula.diffuse_closure": partial(_formula_worst, table="oren_nayar", estimator="closure"),
    **{f"errata.{name}": partial(_whole, cell="errata", name=name, first="g", others=".6f") for name in ERRATA},
    **{f"oren_nayar.{name}": partial(_whole, cell="oren_nayar", name=name, first=".2f", others="%") for name in L1},
    "oren_nayar.weight": partial(_extreme, column="weight", form=".1f"),
    "oren_nayar.albedo": partial(_extreme, column="albedo", form=".2f"),
    "keys.keys": partial(_whole, cell="keys", name="keys", first="", others=""),
    "keys.worst": _keys_worst,
    "keys.exponential": _keys_exponential,
    "batch.cost": _batch,
    "batch.stills": _batch_stills,
    "speed.samples": _speed,
    "speed.osl": _osl,
    "speed.fit_environment": partial(_fit_time, scene="environment"),
    "speed.fit_softbox": partial(_fit_time, scene="softbox"),
}
