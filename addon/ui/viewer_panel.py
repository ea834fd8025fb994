# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel BRDF Viewer."""

from __future__ import annotations

from typing import Any

import bpy

from ..blender import lobes, material, texel
from . import viewer, viewer_measure
from .panels import InSidebar
from .text import lines


def problem(context: bpy.types.Context) -> str:
    """Why nothing is drawn, and what to do; "" if a lobe is."""
    settings = context.scene.vgroove_viewer
    found = [one for one in viewer.candidates(context) if material.is_ours(one)]
    if not found and viewer.candidates(context):
        return "The lobe's formula is known of V-Groove materials. This one's values can be measured"
    if not found:
        return "Apply a preset to the active object to see its lobe"
    have = [
        lobes.has_term(one, settings.term, viewer.uvs_of(context.scene, one)) for one in found
    ]  # of all: what does not hold is an error
    if not any(have):
        return f"This model has no facets, so no {settings.term}. Choose f"
    at = viewer.frame(context.scene)
    wi = viewer.toward_light(context.scene, getattr(context, "region_data", None), at)
    if wi is None:
        return "Add a light, or let the light come from View or Angles" if settings.light_from == "LIGHT" else ""
    if wi[2] <= 0.0:
        return "The light is below the surface here. Turn the 3D cursor, or pick a point on a surface that is lit"
    return ""


class VGROOVE_PT_viewer(InSidebar, bpy.types.Panel):
    bl_label = "BRDF Viewer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.scene.vgroove_viewer, "show", text="")

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.vgroove_viewer, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.active = settings.show
        try:
            text = problem(context)
        except ValueError as error:  # numbers that do not go together, too
            text = str(error)
        if text:
            lines(layout, text, context.region.width, icon="INFO")
        column = layout.column()
        column.row().prop(settings, "place", expand=True)
        column.operator("vgroove.pick_point", icon="EYEDROPPER")
        for one in viewer.candidates(context):
            if settings.place == "POINT" and one == settings.picked:
                draw_picked(column, one, texel.loads(settings.picked_uvs), context.region.width)
        column = layout.column()
        column.row().prop(settings, "light_from", expand=True)
        if settings.light_from == "LIGHT":
            column.prop(settings, "lamp")
        elif settings.light_from == "ANGLES":
            column.prop(settings, "theta")
            column.prop(settings, "phi")
        column.operator("vgroove.aim_light", icon="LIGHT_SUN")
        column = layout.column()
        column.row().prop(settings, "term", expand=True)
        row = column.row()
        row.enabled = settings.term == lobes.BRDF
        row.prop(settings, "times")
        column.prop(settings, "channel")
        column.prop(settings, "log")
        column.prop(settings, "absolute")
        column.prop(settings, "size")
        column.prop(settings, "mirror")
        column.prop(settings, "half")
        layout.column().prop(settings, "other")
        layout.column().prop(settings, "plots")
        viewer_measure.draw(layout, context)
        layout.column().operator("vgroove.export_plots", icon="EXPORT")


def draw_picked(layout: bpy.types.UILayout, of: bpy.types.Material, uvs: dict[str, Any], width: int) -> None:
    """The material at the clicked point, and the textures there that could not be read."""
    layout.label(text=of.name, icon="MATERIAL")
    unread = texel.read(of, uvs).unread
    if unread:
        lines(layout, f"Not read here: {', '.join(unread)}. Drawn with the input's own value", width, icon="INFO")


CLASSES = (VGROOVE_PT_viewer,)
