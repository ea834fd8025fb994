# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the 3D viewport's sidebar, tab "V-Groove"."""

from __future__ import annotations

import blf
import bpy

from .. import presets
from . import operators
from .preferences import ROOT


class VGROOVE_PT_material(bpy.types.Panel):
    """Choose a preset and apply it."""

    bl_label = "V-Groove Material"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "V-Groove"

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.vgroove, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        column = layout.column()
        column.prop(settings, "preset")
        column.row().prop(settings, "backend", expand=True)
        column.prop(settings, "estimator")
        picked = operators.chosen(context.scene)
        split = column.split(factor=0.4)  # under the menu, and kept when nothing is picked: buttons must not jump
        split.label()
        split.label(text=f"Picks {picked.estimator.title()} here" if settings.estimator == "auto" else "")
        if picked.estimator == "hybrid":
            column.prop(settings, "bound", slider=True)
        row = layout.row()
        row.scale_y = 1.4
        row.operator("vgroove.apply", icon="MATERIAL")
        if picked.why:
            lines(layout, f"{picked.estimator.title()}: {picked.why}", context.region.width)
        source = presets.find(settings.preset).source
        lines(layout, f"Source: {source['data']}", context.region.width)


class VGROOVE_PT_advice(bpy.types.Panel):
    """What keeps the chosen estimator from rendering as it should."""

    bl_label = "Scene Advice"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "V-Groove"
    bl_parent_id = "VGROOVE_PT_material"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ROOT not in context.preferences.addons or context.preferences.addons[ROOT].preferences.show_advice

    def draw(self, context: bpy.types.Context) -> None:
        found = operators.current_problems(context.scene)
        if not found:
            self.layout.label(text="This scene suits the choice", icon="CHECKMARK")
        if sum(problem.mend is not None for problem in found) > 1:
            self.layout.operator("vgroove.mend", text="Mend All", icon="CHECKMARK").key = ""
        for problem in found:
            box = self.layout.box()
            lines(box, problem.text, context.region.width, icon="ERROR")
            if problem.mend:
                box.operator("vgroove.mend", text=problem.button).key = problem.key


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


CLASSES = (VGROOVE_PT_material, VGROOVE_PT_advice)
