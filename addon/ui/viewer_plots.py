# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer's plots: what is in them, as lines, dots and words; drawn in the viewport's corner, or as SVG."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import blf
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..reference import lobe
from ..reference.lobe import ACROSS, ALBEDO, PLANE, THETA_H

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ..reference.directions import Floats

Color = tuple[float, ...]
ITEMS = (
    (PLANE, "Plane of Incidence", "The slice that holds the light and the normal; the light at the left", 1),
    (ACROSS, "Across", "The slice that is upright on the plane of incidence", 2),
    (ALBEDO, "Albedo", "The share of a uniform white sky that is reflected, over the angle to the normal", 4),
    (THETA_H, "θh", "f over the half vector's angle to the normal; θd is the light's angle", 8),
)  # fmt: skip
TITLES = {PLANE: "Plane of incidence", ACROSS: "Across it", ALBEDO: "Albedo over θo", THETA_H: "Over θh"}
POLAR = (PLANE, ACROSS)
WIDTH, HEIGHT, GAP = 260.0, 186.0, 8.0  # of a plot, in pixels of a display whose scale is 1
CENTRE, RADIUS = np.array([130.0, 44.0]), 100.0
ORIGIN, AXES = np.array([44.0, 44.0]), np.array([204.0, 108.0])
FONT, SIZE = 0, 11.0
GOLD = (0.85, 0.6, 0.05, 1.0)
FAINT, QUIET = 0.2, 0.6  # how much of the text's color lines and the mirror direction have
HALVES = np.array([(0, 1, 2), (0, 2, 3)])  # of a rectangle
STYLE = f'font-family="sans-serif" font-size="{SIZE:g}"'
DOT = 1.8  # pixels


class Curve(NamedTuple):
    """One material in one plot. at: degrees, (n,); rgb: (n, 3); measured: whether these are points of a measurement."""

    name: str
    at: Floats
    rgb: Floats
    color: Color
    measured: bool = False


@dataclass
class Plot:
    """In pixels from the left foot.

    lines: points (n, 2), color, width. dots: points, color. words: text, (x, y), color, and the share of it left of x.
    """

    lines: list[tuple[Floats, Color, float]] = field(default_factory=list)
    dots: list[tuple[Floats, Color]] = field(default_factory=list)
    words: list[tuple[str, tuple[float, float], Color, float]] = field(default_factory=list)

    def word(self, text: str, at: Any, color: Color, left: float = 0.5) -> None:
        self.words.append((text, (float(at[0]), float(at[1])), color, left))


def plotted(
    plot: str, curves: Sequence[Curve], theta_i: float, channel: str, ink: Color, unit: str, *, log: bool
) -> Plot:
    """One of the ``ITEMS``. theta_i: of the light, in degrees. ink: color of the text. unit: of f, as in the title."""
    found = Plot()
    values = [np.maximum(lobe.channel_of(one.rgb, channel), 0.0) for one in curves]
    lines = [of for one, of in zip(curves, values, strict=True) if not one.measured] or values
    peak = max((float(np.max(of, initial=0.0)) for of in lines), default=0.0)
    if plot == ALBEDO:
        peak, log, unit = 1.0, False, ""
    found.word(f"{TITLES[plot]}{unit and ', '}{unit}", (8.0, HEIGHT - 16.0), ink, 0.0)
    faint, is_polar = (*ink[:3], FAINT), plot in POLAR
    if is_polar:
        to_pixels = _polar_frame(found, theta_i, ink, faint, lit=plot == PLANE)
    else:
        to_pixels = _axes(found, plot, curves, ink, faint)
    for share in (1.0, 0.5):
        value = peak * 10.0 ** (lobe.DECADES * (share - 1.0)) if log else peak * share
        at = CENTRE + [RADIUS * share, -14.0] if is_polar else ORIGIN + [-6.0, AXES[1] * share - 4.0]  # noqa: RUF005 - sums
        found.word(f"{value:.2g}", at, ink, 0.5 if is_polar else 1.0)
    row = 0
    for one, of in zip(curves, values, strict=True):
        points = to_pixels(one.at, np.minimum(lobe.radii(of, peak, log=log), 1.05))
        color = (*one.color[:3], 1.0)
        if one.measured:
            found.dots.append((points, tuple((a + b) / 2.0 for a, b in zip(color, ink, strict=True))))
            continue
        found.lines.append((points, color, 2.0))
        best = int(np.argmax(of))
        found.word(f"peak {of[best]:.3g} at {abs(one.at[best]):.1f}°", (8.0, 16.0 - 13.0 * row), color, 0.0)
        row += 1
    return found


def _polar_frame(found: Plot, theta_i: float, ink: Color, faint: Color, *, lit: bool) -> Any:
    """Half circles and spokes, and the light where it is in the plane; returns how theta and a radius become pixels."""

    def to_pixels(theta: Any, radius: Any) -> Floats:
        angle = np.radians(theta)
        return CENTRE + RADIUS * np.stack(np.broadcast_arrays(radius * np.sin(angle), radius * np.cos(angle)), axis=-1)

    turn = np.linspace(-90.0, 90.0, 91)
    found.lines += [(to_pixels(turn, radius), faint, 1.0) for radius in (1.0, 0.75, 0.5, 0.25)]
    found.lines += [(to_pixels([at, at], [0.0, 1.0]), faint, 1.0) for at in range(-90, 91, 30)]
    if lit:
        found.lines.append((to_pixels([-theta_i, -theta_i], [0.0, 1.08]), GOLD, 1.0))
        found.lines.append((to_pixels([theta_i, theta_i], [0.0, 1.08]), (*ink[:3], QUIET), 1.0))
    for at in range(-90, 91, 30):
        found.word(f"{abs(at)}°", to_pixels(at, 1.13) - [0.0, 4.0], ink)
    return to_pixels


def _axes(found: Plot, plot: str, curves: Sequence[Curve], ink: Color, faint: Color) -> Any:
    """Grid of a plot over an angle; theta_h on a root scale, as highlights are narrow."""
    span = 90.0 if plot == ALBEDO else max((float(np.max(one.at)) for one in curves), default=90.0)

    def to_pixels(theta: Any, height: Any) -> Floats:
        share = np.asarray(theta, dtype=np.float64) / span
        across = share if plot == ALBEDO else np.sqrt(share)
        return ORIGIN + AXES * np.stack(np.broadcast_arrays(across, height), axis=-1)

    found.lines += [(to_pixels([0.0, span], [height, height]), faint, 1.0) for height in (0.0, 0.25, 0.5, 0.75, 1.0)]
    ticks = (0, 30, 60, 90) if plot == ALBEDO else (0, 2, 10, 30, 60)
    for at in (one for one in ticks if one <= span):
        found.lines.append((to_pixels([at, at], [0.0, 1.0]), faint, 1.0))
        found.word(f"{at}°", to_pixels(at, 0.0) - [0.0, 14.0], ink)
    return to_pixels


# In a region of Blender's


def draw(plots: Iterable[Plot], scale: float, at: tuple[float, float], paper: Color) -> None:
    """Side by side, from ``at`` in the region's pixels on."""
    flat, thick = (gpu.shader.from_builtin(name) for name in ("UNIFORM_COLOR", "POLYLINE_UNIFORM_COLOR"))
    blf.size(FONT, SIZE * scale)
    for index, one in enumerate(plots):
        foot = np.array([at[0] + index * (WIDTH + GAP) * scale, at[1]])
        gpu.state.blend_set("ALPHA")  # which text ends
        box = foot + scale * np.array([[0.0, 0.0], [WIDTH, 0.0], [WIDTH, HEIGHT], [0.0, HEIGHT]])
        _fill(flat, box, HALVES, paper)
        thick.bind()
        thick.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
        for points, color, width in one.lines:
            thick.uniform_float("lineWidth", width * scale)
            thick.uniform_float("color", color)
            batch_for_shader(thick, "LINE_STRIP", {"pos": _flat(foot + scale * points)}).draw(thick)
        for points, color in one.dots:
            corner = scale * DOT * np.array([[0.0, -1.4], [1.4, 0.0], [0.0, 1.4], [-1.4, 0.0]])
            corners = (foot + scale * points)[:, None] + corner
            first = 4 * np.arange(len(points))[:, None, None]
            _fill(flat, corners.reshape(-1, 2), (first + HALVES).reshape(-1, 3), color)
        for text, place, color, left in one.words:
            x, y = foot + scale * np.array(place)
            blf.color(FONT, *color)
            blf.position(FONT, x - left * blf.dimensions(FONT, text)[0], y, 0.0)
            blf.draw(FONT, text)
    gpu.state.blend_set("NONE")


def _fill(shader: Any, points: Floats, triangles: Any, color: Color) -> None:
    shader.bind()
    shader.uniform_float("color", color)
    indices = np.asarray(triangles, dtype=np.int32)
    batch_for_shader(shader, "TRIS", {"pos": _flat(points)}, indices=indices).draw(shader)


def _flat(points: Floats) -> Any:
    return np.column_stack([points, np.zeros(len(points))]).astype(np.float32)


# As a file


def size_of(count: int) -> tuple[float, float]:
    """Width and height of plots side by side."""
    return count * (WIDTH + GAP) - GAP, HEIGHT


def svg(plots: Sequence[Plot], paper: Color) -> str:
    """Plots side by side."""
    from html import escape  # here, as Blender imports this file when it starts

    width, height = size_of(len(plots))
    rows = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:g}" height="{height:g}" {STYLE}>',
        f'<rect width="100%" height="100%" fill="{_hex(paper)}"/>',
    ]
    for index, one in enumerate(plots):
        rows.append(f'<g transform="translate({index * (WIDTH + GAP):g} 0)">')
        for points, color, thick in one.lines:
            path = " ".join(f"{x:.2f},{HEIGHT - y:.2f}" for x, y in points)
            rows.append(
                f'<polyline points="{path}" fill="none" stroke="{_hex(color)}" stroke-opacity="{color[3]:g}" '
                f'stroke-width="{thick:g}"/>'
            )
        for points, color in one.dots:
            rows += [
                f'<circle cx="{x:.2f}" cy="{HEIGHT - y:.2f}" r="{DOT:g}" fill="{_hex(color)}"/>' for x, y in points
            ]
        for text, (x, y), color, left in one.words:
            anchor = {0.0: "start", 0.5: "middle", 1.0: "end"}[left]
            place = f'x="{x:.2f}" y="{HEIGHT - y:.2f}" text-anchor="{anchor}"'
            rows.append(f'<text {place} fill="{_hex(color)}">{escape(text)}</text>')
        rows.append("</g>")
    return "\n".join([*rows, "</svg>", ""])


def _hex(color: Color) -> str:
    return "#" + "".join(f"{round(255 * min(max(part, 0.0), 1.0)):02x}" for part in color[:3])
