# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of BRDFs, for ``vgroove plot`` and for notebooks.

>>> from vgroove.addon.library import presets
>>> copper = presets.find("copper")
>>> satin = copper.with_parameters(m=0.5)
>>> draw("polar", {"copper": copper, "satin": satin}, View(theta_i=60.0)).axes[0].name
'polar'
"""

from __future__ import annotations

from io import BytesIO
from typing import TYPE_CHECKING, Any

import matplotlib as mpl
import numpy as np
from matplotlib.colors import LogNorm, Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

from ..addon.measured.curves import MOST, PLOTS, Numbers, View, csv_text, numbers, quantity
from ..addon.reference import lobe

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from matplotlib.axes import Axes

    from ..addon.reference.directions import Floats

__all__ = ["CHANNELS", "PLOTS", "View", "csv_text", "draw", "numbers", "png", "residuals", "svg"]

CHANNELS = (*lobe.CHANNELS, "rgb")
DPI = 160
GRAZING = 80.0  # degrees: beyond, f grows without bound, as a cosine in its denominator ends at 0; scales end before
STYLE = {
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 10,
    "axes.labelcolor": "#333333",
    "axes.edgecolor": "#999999",
    "axes.linewidth": 0.7,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "xtick.color": "#666666",
    "ytick.color": "#666666",
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "svg.hashsalt": "vgroove",  # else the names within differ from run to run
    "svg.fonttype": "none",
}
# Okabe and Ito's colours, which the colour-blind tell apart, without their yellow, and a grey
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#999999")
PRIMARIES = {"red": "#d62728", "green": "#2ca02c", "blue": "#1f5fd0"}
DASHES: tuple[Any, ...] = ("-", (0, (5, 2)), (0, (1.2, 1.4)), (0, (6, 2, 1.2, 2)), (0, (2.5, 1)), (0, (8, 3)),
                           (0, (1, 3)), (0, (4, 1, 1, 1, 1, 1)))  # fmt: skip
LIGHT: dict[str, Any] = {"color": "#b8860b", "lw": 0.9, "ls": (0, (4, 2))}
MIRROR: dict[str, Any] = {"color": "#888888", "lw": 0.8, "ls": (0, (1, 2))}
SYMBOLS = {
    "theta_o": r"$\theta_o$",
    "theta_i": r"$\theta_i$",
    "theta_h": r"$\theta_h$",
    "theta_d": r"$\theta_d$",
    "phi_d": r"$\phi_d$",
    "(theta_o)": r"$\,\theta_o$",
    "(theta_i)": r"$\,\theta_i$",
}
assert len(COLOURS) == len(DASHES) == MOST  # noqa: S101


def draw(
    plot: str, brdfs: Mapping[str, Any], view: View | None = None, *, channel: str = "luminance", log: bool = False
) -> Figure:
    """A figure of a plot of ``PLOTS``, of presets, models or measured BRDFs by name.

    channel: of ``CHANNELS``. log: in decades, the last four below the peak of all. InputError for what cannot be shown.
    """
    view = view or View()
    shown = numbers(plot, brdfs, view)
    with mpl.rc_context(STYLE):
        if plot == "lobe":
            return _lobes(shown, view, channel, log=log)
        if plot == "slice":
            return _images(shown, view, channel, log=log)
        if plot == "polar":
            return _polar(shown, view, channel, log=log)
        return _lines(plot, shown, view, channel, log=log)


def residuals(angles: Sequence[float], shares: Mapping[str, Sequence[float]], title: str) -> Figure:
    """What fits leave: by the light's angle in degrees the share of the reflected light that differs, a line each."""
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.4), layout="constrained")
        ax = figure.subplots()
        for (name, of), colour in zip(shares.items(), COLOURS, strict=False):
            ax.plot(angles, 100.0 * np.asarray(of), label=_verbatim(name), color=colour, marker="o", ms=4)
        ax.set(xlabel=f"{SYMBOLS['theta_i']} (degrees)", ylabel="differs, % of the reflected light")
        ax.set_title(_verbatim(title))
        ax.set_xlim(0, 90)
        ax.set_ylim(bottom=0.0)
        ax.xaxis.set_major_locator(FixedLocator(list(range(0, 91, 15))))
        _legend(figure, ax)
        return figure


def png(figure: Figure) -> bytes:
    """The same bytes for the same numbers, with the same Matplotlib."""
    return _saved(figure, "png", {"Software": None})


def svg(figure: Figure) -> bytes:
    """The same bytes for the same numbers, with the same Matplotlib."""
    return _saved(figure, "svg", {"Date": None, "Creator": None})


def _saved(figure: Figure, ending: str, metadata: dict[str, Any]) -> bytes:
    file = BytesIO()
    with mpl.rc_context(STYLE):
        figure.savefig(file, format=ending, dpi=DPI, metadata=metadata)
    return file.getvalue()


def _drawn(shown: Numbers, channel: str) -> Iterator[tuple[str, Floats, dict[str, Any]]]:
    """Each line: its label, its values and its style. RGB: a colour a channel, a dash a BRDF."""
    for (plain, rgb), colour, dash in zip(shown.rgb.items(), COLOURS, DASHES, strict=False):
        name = _verbatim(plain)
        if channel != "rgb":
            yield name, lobe.channel_of(rgb, channel), {"color": colour}
            continue
        for one, shade in PRIMARIES.items():
            label = f"{name}, {one}" if len(shown.rgb) > 1 else one
            yield label, lobe.channel_of(rgb, one), {"color": shade, "ls": dash}


def _verbatim(name: str) -> str:
    """A name as Matplotlib shows it letter by letter: $ would begin a formula, and a legend leaves out _names."""
    name = name.replace("$", r"\$")
    return f" {name}" if name.startswith("_") else name


def _title(plot: str, view: View, channel: str, shown: Numbers) -> str:
    what = {
        "albedo": "Directional albedo",
        "polar": "Polar slice",
        "lobe": "Lobe",
        "slice": "Image slice",
    }.get(plot, "")
    where = {
        "albedo": "",
        "theta_h": _text(f"theta_d = {view.theta_i:g}°, phi_d = {view.phi_d:g}°"),
        "theta_d": _text(f"theta_h = {view.theta_h:g}°, phi_d = {view.phi_d:g}°"),
        "slice": _text(f"phi_d = {view.phi_d:g}°"),
    }.get(plot, f"light at {view.theta_i:g}°")
    if plot in {"polar", "theta_o"} and view.phi_o:
        where += f", slice turned by {view.phi_o:g}°"
    if view.phi_i:
        where += f", azimuth {view.phi_i:g}°"
    one = channel if channel in PRIMARIES else ""
    value = "" if plot == "albedo" else _quantity(view) + (f" in {shown.unit}" if shown.unit else "")
    return ",  ".join(part for part in (what, value, one, where.strip(", ")) if part)


def _text(words: str) -> str:
    for plain, symbol in SYMBOLS.items():
        words = words.replace(plain, symbol)
    return words


def _quantity(view: View) -> str:
    return _text(quantity(view).replace("(theta_o)", " theta_o").replace("(theta_i)", " theta_i"))


def _legend(figure: Figure, ax: Axes) -> None:
    """Below the axes, where no curve can run into it."""
    handles, names = ax.get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=_columns(names), fontsize=8.5)


def _columns(names: Iterable[str]) -> int:
    """Of a legend as wide as a figure."""
    longest = max(map(len, names))
    return 3 if longest < 24 else 2 if longest < 40 else 1


def _lines(plot: str, shown: Numbers, view: View, channel: str, *, log: bool) -> Figure:
    """Values over one angle."""
    figure = Figure(figsize=(5.6, 3.9), layout="constrained")
    ax = figure.subplots()
    x = shown.at[:, 0]
    scaled = x <= GRAZING if plot == "theta_d" and (x <= GRAZING).any() else np.full(x.shape, fill_value=True)
    highest = 0.0
    for label, values, style in _drawn(shown, channel):
        ax.plot(x, values, label=label, **style)
        highest = max(highest, float(np.max(values[scaled])))
    if plot == "theta_o" and not view.phi_o:
        ax.axvline(-view.theta_i, label="light", **LIGHT, zorder=0)
        ax.axvline(view.theta_i, label="mirror direction", **MIRROR, zorder=0)
    ax.set(xlabel=f"{SYMBOLS[shown.axes[0]]} (degrees)", title=_title(plot, view, channel, shown))
    ax.set_ylabel(f"{shown.quantity} " if plot == "albedo" else f"{_quantity(view)}  ({shown.unit})")
    low, high = (-90, 90) if plot == "theta_o" else (0, 90)
    ax.set_xlim(low, high)
    ax.xaxis.set_major_locator(FixedLocator(list(range(low, high + 1, 30 if low else 15))))
    if log and highest > 0.0:
        ax.set_yscale("log")
        ax.set_ylim(highest * 10.0**-lobe.DECADES, highest * 1.6)
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    else:
        ax.set_ylim(0.0, 1.05 * highest or 1.0)
    _legend(figure, ax)
    return figure


def _polar(shown: Numbers, view: View, channel: str, *, log: bool) -> Figure:
    """The hemisphere from the side, the light at the left."""
    drawn = list(_drawn(shown, channel))
    columns = _columns(name for name, _, _ in drawn)
    legend = 0.2 * -(-(len(drawn) + 2) // columns) + 0.45  # inches below the horizon
    width, height, radius = 5.6, 3.2 + legend, 2.3
    figure = Figure(figsize=(width, height))
    # Matplotlib centres the half circle in a square, a quarter of which stays empty above and below.
    corner = (0.5 * width - radius) / width, (legend - 0.5 * radius) / height
    ax = figure.add_axes((*corner, 2.0 * radius / width, 2.0 * radius / height), projection="polar")
    peak = max(float(np.max(values)) for _, values, _ in drawn)
    theta = np.radians(shown.at[:, 0])
    for label, values, style in drawn:
        ax.plot(theta, lobe.radii(values, peak, log=log), label=label, **style)
    if not view.phi_o:
        for theta_o, name, style in ((-view.theta_i, "light", LIGHT), (view.theta_i, "mirror direction", MIRROR)):
            ax.plot(np.radians([theta_o] * 2), [0.0, 1.08], label=name, **style, zorder=1)
    ax.set_thetamin(-90.0)  # type: ignore[attr-defined]
    ax.set_thetamax(90.0)  # type: ignore[attr-defined]
    ax.set_theta_zero_location("N")  # type: ignore[attr-defined]
    ax.set_theta_direction(-1)  # type: ignore[attr-defined]
    ax.set_thetagrids(range(-90, 91, 30), [f"{abs(one)}°" for one in range(-90, 91, 30)])  # type: ignore[attr-defined]
    at, names = _circles(peak, log=log)
    ax.set_rgrids(at, names, angle=90.0, ha="center", va="top", fontsize=8, color="#666666")  # type: ignore[attr-defined]
    ax.set_rlim(0.0, 1.08)  # type: ignore[attr-defined]
    ax.spines["polar"].set_visible(False)
    figure.suptitle(_title("polar", view, channel, shown), x=0.02, ha="left", fontsize=9.5)
    handles, names = ax.get_legend_handles_labels()
    figure.legend(handles, names, loc="lower center", ncols=columns, fontsize=8.5)
    return figure


def _circles(peak: float, *, log: bool) -> tuple[list[float], list[str]]:
    """Radii of the circles that a polar plot is read by, and the values there."""
    if peak <= 0.0:
        return [1.0], ["0"]
    if log:
        top = np.floor(np.log10(peak))
        values = [10.0 ** (top - k) for k in range(int(lobe.DECADES))]
    else:
        values = [value for value in MaxNLocator(4).tick_values(0.0, peak) if 0.0 < value <= 1.05 * peak]
    drawn = [(float(lobe.radii(np.array(value), peak, log=log)), f"{value:g}") for value in sorted(values)]
    drawn = [(radius, name) for radius, name in drawn if radius > 0.15]
    return [radius for radius, _ in drawn], [name for _, name in drawn]


def _lobes(shown: Numbers, view: View, channel: str, *, log: bool) -> Figure:
    """A panel for each, all to one scale."""
    count = len(shown.rgb)
    columns = min(count, 4)
    rows = -(-count // columns)
    figure = Figure(figsize=(max(2.9 * columns, 4.6), 2.3 * rows + 0.35), layout="constrained")
    one = "luminance" if channel == "rgb" else channel
    lobes = {name: lobe.Lobe(lobe.directions(view.wi), rgb) for name, rgb in shown.rgb.items()}
    peak = max(float(np.max(each.values(one))) for each in lobes.values())
    for place, ((name, each), colour) in enumerate(zip(lobes.items(), COLOURS, strict=False), 1):
        ax = figure.add_subplot(rows, columns, place, projection="3d")
        vertices = each.vertices(one, peak, log=log)
        base = each.colors() if channel == "rgb" else np.broadcast_to(to_rgb(colour), vertices.shape)
        _surface(ax, vertices, base)
        _frame(ax, view)
        ax.set_title(_verbatim(name), loc="center", pad=0, y=0.9)
    figure.suptitle(_title("lobe", view, channel, shown), x=0.01, ha="left", fontsize=9.5)
    return figure


def _surface(ax: Any, vertices: Floats, base: Floats) -> None:
    """Shaded softly from above left, as quads that close where the columns meet."""
    toward = np.array([0.35, 0.5, 0.79])
    shade = 0.62 + 0.38 * np.clip(lobe.normals(vertices) @ toward, -0.4, 1.0)
    colours = np.clip(base * shade[..., None], 0.0, 1.0)
    closed, colours = (np.concatenate([one, one[:, :1]], axis=1) for one in (vertices, colours))
    ax.plot_surface(
        *np.moveaxis(closed, -1, 0), facecolors=colours, rstride=1, cstride=1, shade=False, linewidth=0,
        antialiased=False, rasterized=True,
    )  # fmt: skip


def _frame(ax: Any, view: View) -> None:
    """The surface's disc, its normal, the light and the mirror direction."""
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    ax.plot(np.cos(turn), np.sin(turn), 0.0 * turn, color="#bbbbbb", lw=0.7)
    mirror = view.wi * [-1.0, -1.0, 1.0]
    ax.plot(*np.outer([0.0, 1.0], [0.0, 0.0, 1.0]).T, color="#bbbbbb", lw=0.6)
    ax.plot(*np.outer([0.0, 1.15], view.wi).T, **LIGHT)
    ax.plot(*np.outer([0.0, 1.15], mirror).T, **MIRROR)
    ax.set_axis_off()
    ax.set_proj_type("ortho")
    ax.view_init(elev=22.0, azim=110.0)
    ax.set(xlim=(-0.85, 0.85), ylim=(-0.85, 0.85), zlim=(0.0, 1.0))
    ax.set_box_aspect((1.7, 1.7, 1.0), zoom=1.2)


def _images(shown: Numbers, view: View, channel: str, *, log: bool) -> Figure:
    """theta_d over theta_h, which runs by its square root; one scale for all. RGB: the colour of pi f in sRGB."""
    count = len(shown.rgb)
    columns = min(count, 4)
    rows = -(-count // columns)
    figure = Figure(figsize=(2.5 * columns + 1.2, 2.5 * rows + 0.5), layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False).ravel()
    edges = np.linspace(0.0, 1.0, len(shown.at) + 1)
    grid = 90.0 * np.square(edges), 90.0 * edges
    values = {name: rgb if channel == "rgb" else lobe.channel_of(rgb, channel) for name, rgb in shown.rgb.items()}
    peak = max(float(np.nanmax(one[:, grid[1][1:] <= GRAZING])) for one in values.values())
    drawn = None
    for ax, (name, one) in zip(axes, values.items(), strict=False):
        if channel == "rgb":
            ax.pcolormesh(*grid, np.moveaxis(_display(one, peak, log=log), 0, 1), rasterized=True)
        else:
            norm = LogNorm(peak * 10.0**-lobe.DECADES, peak, clip=True) if log and peak > 0.0 else Normalize(0.0, peak)
            drawn = ax.pcolormesh(*grid, one.T, norm=norm, cmap="viridis", rasterized=True)
        ax.set(title=_verbatim(name), xlabel=f"{SYMBOLS['theta_h']} (degrees)", ylim=(0, 90), facecolor="#eeeeee")
        ax.set_xscale("function", functions=(lambda x: np.sqrt(np.maximum(x, 0.0)), np.square))
        ax.xaxis.set_major_locator(FixedLocator([0, 5, 15, 30, 60, 90]))
        ax.yaxis.set_major_locator(FixedLocator([0, 30, 60, 90]))
        ax.set_xlim(0, 90)
        ax.grid(visible=False)
        ax.set_box_aspect(1)
    for ax in axes[count:]:
        ax.remove()
    for ax in axes[:count:columns]:
        ax.set_ylabel(f"{SYMBOLS['theta_d']} (degrees)")
    if drawn is not None:
        bar = figure.colorbar(drawn, ax=list(axes[:count]), shrink=0.85, aspect=24)
        bar.outline.set_visible(False)
        bar.ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    figure.suptitle(_title("slice", view, channel, shown), x=0.01, ha="left", fontsize=9.5)
    return figure


def _display(rgb: Floats, peak: float, *, log: bool) -> Floats:
    """sRGB, 0 to 1: of pi f, so that a white diffuser is white; log: brightness runs over decades, colour is kept."""
    linear = np.nan_to_num(rgb, nan=0.0)
    if log:
        strongest = linear.max(axis=-1, keepdims=True)
        linear = linear / np.where(strongest > 0.0, strongest, 1.0) * lobe.radii(strongest, peak, log=True) ** 2.2
    else:
        linear = np.pi * linear
    linear = np.clip(linear, 0.0, 1.0)
    shown = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return np.where(np.isnan(rgb), 0.93, shown)
