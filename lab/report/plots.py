# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of a report as PNG, the same to the byte for the same numbers."""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from PIL import Image

from ...addon.models import estimators

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from ..bench.cells import Numbers
    from .contest import Contest
    from .curve import Curve
    from .findings import Run

DPI = 110
SHADES = 64  # of a PNG
STYLE = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.grid": True,
    "grid.alpha": 0.25,
    "grid.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
}
# Okabe and Ito's colours, which the colour-blind tell apart; peers are grey.
COLOURS = dict(zip(estimators.ALL, ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"), strict=True))
PEERS = {
    "Metallic BSDF": ("#333333", (4, 1.5)),
    "Diffuse BSDF": ("#333333", (4, 1.5)),
    "Glass BSDF": ("#333333", (4, 1.5)),
    "Glossy BSDF": ("#666666", (1.5, 1.5)),
    "Principled BSDF": ("#888888", (6, 1.5, 1.5, 1.5)),
    "": ("#000000", (8, 3)),  # another renderer's
}
SLANTED: dict[str, Any] = {"c": "#888888", "lw": 0.4, "alpha": 0.5}  # lines of slope -1/2
FLOOR: dict[str, Any] = {"lw": 4, "alpha": 0.6, "solid_capstyle": "butt"}
CROSS: dict[str, Any] = {"marker": "x", "ms": 4, "ls": ""}
PANEL = (2.7, 2.1)  # inches


def draw(run: Run) -> dict[str, bytes]:
    """Those of ``summary.PLOTS``, by file name."""
    if not run.contests:
        return {}
    with mpl.rc_context(STYLE):
        return {f"plots/{kind.__name__}-{run.blender}.png": _png(kind(run)) for kind in (error, noise)}


def _png(figure: Figure) -> bytes:
    drawn, png = BytesIO(), BytesIO()
    figure.savefig(drawn, dpi=DPI, format="png")
    # Of few colours it is a third as large. Median cut, which is the default, would mix thin lines of like colours.
    few = Image.open(drawn).convert("RGB").quantize(SHADES, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    few.save(png, "png", optimize=True)
    return png.getvalue()


def error(run: Run) -> Figure:
    """Error against processor time; where a bias can be distinguished from 0, its floor at the right."""

    def mark(ax: Axes, curve: Curve, colour: str) -> None:
        if curve.biased:
            style: dict[str, Any] = {"c": colour, "zorder": 3 if curve.competes else 2}
            ax.plot([0.93, 1.0], [curve.floor] * 2, **FLOOR, **style, transform=ax.get_yaxis_transform())

    labels = "processor seconds of a render", "relative error (RMSE over the reference's RMS)"
    floor = Line2D([], [], label="bias left", c="#666666", **FLOOR)
    return _curves(run, labels, lambda curve: (curve.cpu, curve.rmse), mark, floor)


def noise(run: Run) -> Figure:
    """Noise, and bias where it can be distinguished from 0."""

    def mark(ax: Axes, curve: Curve, colour: str) -> None:
        if curve.competes:
            bias = np.sqrt(curve.bias2[curve.biased_at])
            ax.plot(curve.samples[curve.biased_at], bias, "s", ms=2.5, c=colour)

    labels = "samples per pixel", "noise (lines) and bias (squares)"
    return _curves(run, labels, lambda curve: (curve.samples, curve.noise), mark, marker="")


def _curves(
    run: Run, labels: tuple[str, str], points: Callable[[Curve], tuple[Numbers, Numbers]],
    mark: Callable[[Axes, Curve, str], None], *more: Line2D, **style: Any,
) -> Figure:  # fmt: skip
    """``points`` of every contender, with a cross at each sample count whose noise is more than it seems."""
    figure, panels = _panels(run, *labels)
    for contest, ax in panels:
        for curve in contest.curves.values():
            look, (x, y) = _look(curve) | style, points(curve)
            ax.plot(x, y, **look)
            if not curve.resolved.all():
                ax.plot(x[~curve.resolved], y[~curve.resolved], **(CROSS | {"color": look["color"]}))
            mark(ax, curve, look["color"])
    drawn = [points(curve) for _, curve in run.curves]
    heights = [y for _, y in drawn] + [curve.rmse for _, curve in run.curves]
    _finish(figure, panels, np.concatenate([x for x, _ in drawn]), np.concatenate(heights), more)
    return figure


def _panels(run: Run, x_label: str, y_label: str) -> tuple[Figure, list[tuple[Contest, Axes]]]:
    """A panel for each scene, all with the same axes. A subject's are in one row, which short ones share."""
    subjects: dict[str, list[Contest]] = {}
    for contest in run.contests:
        subjects.setdefault(contest.cell.subject, []).append(contest)
    columns = max(*(len(row) for row in subjects.values()), min(3, len(run.contests)))
    rows: list[list[Contest]] = []
    for row in subjects.values():
        if rows and len(rows[-1]) + len(row) <= columns:
            rows[-1] += row
        else:
            rows.append(list(row))
    figure = Figure(figsize=(max(columns, 3) * PANEL[0], len(rows) * PANEL[1] + 0.6), layout="constrained")
    grid = figure.subplots(len(rows), columns, squeeze=False)
    panels = []
    for line, row in zip(grid, rows, strict=True):
        for contest, ax in zip(row, line, strict=False):
            ax.set_title(contest.title)
            panels.append((contest, ax))
        for ax in line[len(row) :]:
            ax.remove()
    figure.supxlabel(x_label, fontsize=8)
    figure.supylabel(y_label, fontsize=8)
    return figure, panels


def _finish(
    figure: Figure, panels: list[tuple[Contest, Axes]], across: Numbers, up: Numbers, more: tuple[Line2D, ...]
) -> None:
    """The same logarithmic axes for all panels, lines of slope -1/2 to hold curves against, and one legend."""
    left, right = float(np.min(across)), float(np.max(across))
    low, high = float(np.min(up[up > 0.0])), float(np.max(up))
    low, high = max(low, 1e-5) / 1.5, min(high, 10.0) * 1.5
    x = np.array([left / 1.3, right * 1.3])
    for _, ax in panels:
        ax.set(xscale="log", yscale="log", xlim=x, ylim=(low, high))
        ax.xaxis.set_major_locator(LogLocator(subs=(1.0,) if right > 100.0 * left else (1.0, 2.0, 5.0)))
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g} %"))
        ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        for axis in (ax.xaxis, ax.yaxis):
            axis.set_minor_locator(NullLocator())  # most of a figure's time goes to ticks
        first, last = (np.floor(np.log10(low * np.sqrt(x[0]))), np.ceil(np.log10(high * np.sqrt(x[1]))))
        for power in np.arange(first, last + 0.5, 0.5):
            ax.plot(x, 10.0**power / np.sqrt(x), **SLANTED, zorder=0)
    handles = [*_legend([contest for contest, _ in panels]), *more]
    figure.legend(handles=handles, loc="outside upper center", ncols=6, frameon=False)


def _look(curve: Curve) -> dict[str, Any]:
    """Ours by colour, solid with dots; OSL thin and dotted; peers grey and dashed, each with a dash of its own."""
    if curve.peer:
        grey, dash = PEERS.get(curve.name, PEERS[""])
        return {"color": grey, "lw": 0.9, "dashes": dash, "marker": ".", "ms": 2}
    colour = COLOURS.get(curve.estimator, "#000000")
    if curve.backend == "osl":
        return {"color": colour, "lw": 0.8, "ls": ":", "marker": "", "alpha": 0.9}
    return {"color": colour, "lw": 1.2, "ls": "-", "marker": ".", "ms": 4}


def _legend(contests: list[Contest]) -> list[Line2D]:
    """Each colour and dash that is seen once, ours first."""
    seen: dict[str, dict[str, Any]] = {}
    curves = [curve for contest in contests for curve in contest.curves.values()]
    for curve in sorted(curves, key=lambda curve: (bool(curve.peer), curve.backend == "osl")):
        name = curve.name if curve.peer else curve.estimator
        if curve.backend == "osl":
            seen.setdefault("any, as OSL", _look(curve) | {"color": "#000000"})
        else:
            seen.setdefault(name, _look(curve))
    if not all(curve.resolved.all() for curve in curves):
        seen["not resolved"] = CROSS | {"color": "#000000"}
    handles = [Line2D([], [], label=name, **look) for name, look in seen.items()]
    return [*handles, Line2D([], [], label="slope −1/2", **(SLANTED | {"lw": 0.8, "alpha": 1.0}))]
