# SPDX-License-Identifier: GPL-3.0-or-later
"""Text in a panel, broken to its width."""

from __future__ import annotations

import blf
import bpy


def lines(layout: bpy.types.UILayout, text: str, width: int, icon: str = "NONE") -> None:
    """A text broken to the region's width; labels do not wrap by themselves.

    A boxed label with an icon has 98 pixels less than the region, a plain one 68 (seen at scale 1 in Blender 5.2).
    """
    scale = bpy.context.preferences.system.ui_scale
    room = width - (98 if icon != "NONE" else 68) * scale
    column = layout.column(align=True)
    column.scale_y = 0.8
    for index, line in enumerate(wrapped(text, room, scale)):
        column.label(text=line, icon=icon if index == 0 else "BLANK1" if icon != "NONE" else "NONE")


def wrapped(text: str, room: float, scale: float) -> list[str]:
    """``text`` in lines no wider than ``room`` pixels as Blender's own font draws them; one word at the least."""
    points = bpy.context.preferences.ui_styles[0].widget.points * scale
    blf.size(0, points)
    rows: list[str] = []
    for word in text.split():
        longer = f"{rows[-1]} {word}" if rows else word
        if rows and blf.dimensions(0, longer)[0] <= room:
            rows[-1] = longer
        else:
            rows.append(word)
    return rows
