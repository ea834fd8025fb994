# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer's slice through the plane of incidence, in the viewport's corner: a polar plot with its values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import blf
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..reference import lobe

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..blender.lobes import Slice
    from ..reference.directions import Floats

RADIUS, LEFT, BOTTOM = 110.0, 190.0, 40.0  # in pixels of a display whose scale is 1, to the plot's centre
FONT, SIZE = 0, 11.0
FAINT, TEXT, GOLD, GREY = (1, 1, 1, 0.18), (0.9, 0.9, 0.9, 1), (0.95, 0.72, 0.1, 0.9), (0.75, 0.75, 0.75, 0.9)
Lines = list[tuple["Floats", tuple[float, ...], float]]  # points (n, 2), color, width in pixels
Words = list[tuple[str, float, float, tuple[float, ...]]]  # text, the middle of its foot (x, y), color


def plotted(
    slices: Sequence[tuple[Slice, tuple[float, ...]]], wi: Floats, channel: str, peak: float, *, log: bool
) -> tuple[Lines, Words]:
    """Lines and words of the plot; the half circle of radius 1 is ``peak``."""
    theta_i = float(np.degrees(np.arctan2(np.hypot(wi[0], wi[1]), wi[2])))
    turn = np.linspace(-90.0, 90.0, 91)
    circles = np.arange(1.0, 0.0, -1.0 / lobe.DECADES if log else -0.5)
    lines: Lines = [(_polar(turn, radius), FAINT, 1.0) for radius in circles]
    lines += [(np.array([[0.0, 0.0], _polar(np.array([at]), 1.0)[0]]), FAINT, 1.0) for at in range(-90, 91, 30)]
    lines += [(_polar(np.array([at, at]), np.array([0.0, 1.08])), color, 1.0)
              for at, color in ((-theta_i, GOLD), (theta_i, GREY))]  # fmt: skip
    words: Words = [(f"{abs(at)}°", *(1.16 * _polar(np.array([at]), 1.0)[0]), TEXT) for at in range(-90, 91, 30)]
    words += [(f"{_value(radius, peak, log=log):.2g}", radius, -0.14, TEXT) for radius in (1.0, 0.5)]
    for row, (one, color) in enumerate(slices):
        values = lobe.channel_of(one.rgb, channel)
        lines.append((_polar(one.theta_o, lobe.radii(values, peak, log=log)), (*color, 1.0), 2.0))
        at = one.theta_o[int(np.argmax(values))]
        words.append((f"peak {np.max(values):.3g} at {abs(at):.1f}°", -0.55, -0.14 - 0.14 * row, (*color, 1.0)))
    return lines, words


def _value(radius: float, peak: float, *, log: bool) -> float:
    return peak * 10.0 ** (lobe.DECADES * (radius - 1.0)) if log else peak * radius


def _polar(theta: Floats, radius: Any) -> Floats:
    """Points (n, 2) at ``theta`` in degrees from straight up, clockwise."""
    angle = np.radians(theta)
    return np.stack(np.broadcast_arrays(radius * np.sin(angle), radius * np.cos(angle)), axis=-1)


def draw(lines: Lines, words: Words, scale: float, left: float) -> None:
    """In a region's pixels, ``left`` of which something else covers."""
    centre, radius = np.array([left + LEFT * scale, BOTTOM * scale]), RADIUS * scale
    gpu.state.blend_set("ALPHA")
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    for points, color, width in lines:
        flat = np.column_stack([centre + radius * points, np.zeros(len(points))])
        batch = batch_for_shader(shader, "LINE_STRIP", {"pos": flat.astype(np.float32)})
        shader.uniform_float("lineWidth", width * scale)
        shader.uniform_float("color", color)
        batch.draw(shader)
    gpu.state.blend_set("NONE")
    blf.size(FONT, SIZE * scale)
    for text, x, y, color in words:
        width, height = blf.dimensions(FONT, text)
        blf.color(FONT, *color)
        blf.position(FONT, centre[0] + radius * x - width / 2.0, centre[1] + radius * y - height / 2.0, 0.0)
        blf.draw(FONT, text)
