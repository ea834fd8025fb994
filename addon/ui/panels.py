# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the 3D viewport's sidebar, tab "V-Groove"."""

from __future__ import annotations

import bpy

from ...nodegroups import versions
from ..blender import material
from ..library import presets
from . import memory, operators, properties, watch
from .preferences import ROOT
from .text import lines


class InSidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "V-Groove"


class VGROOVE_PT_material(InSidebar, bpy.types.Panel):
    """Choose a preset and apply it."""

    bl_label = "V-Groove Material"

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.vgroove, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        preset = properties.chosen_preset(settings)
        draw_choice(layout, settings, preset)
        column = layout.column()
        column.row().prop(settings, "backend", expand=True)
        picked = operators.pick(watch.current(context.scene))
        if _shows_estimators(settings):
            column.prop(settings, "estimator")
            split = column.split(factor=0.4)  # stays when nothing is picked, or buttons would jump
            split.label()
            split.label(text=f"Picks {picked.estimator.title()} here" if settings.estimator == "auto" else "")
        else:
            column.prop(settings, "quality")
        if picked.estimator == "hybrid":
            column.prop(settings, "bound", slider=True)
        row = layout.row()
        row.scale_y = 1.4
        row.operator("vgroove.apply", icon="MATERIAL")
        if picked.why:
            lines(layout, picked.why[0].upper() + picked.why[1:], context.region.width)
        if text := versions.untested():
            lines(layout, text, context.region.width, icon="INFO")
        for error in presets.load_errors()[:1]:
            lines(layout, f"Preset skipped: {error}", context.region.width, icon="ERROR")


class VGROOVE_PT_parameters(InSidebar, bpy.types.Panel):
    """The parameters of the active object's material."""

    bl_label = "Edit Parameters"
    bl_parent_id = "VGROOVE_PT_material"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, made = self.layout, operators.ours(context)
        layout.use_property_split = True
        layout.use_property_decorate = False
        if made is None:
            lines(layout, "Apply a preset to edit its parameters here", context.region.width)
            return
        layout.label(text=made.name, icon="MATERIAL")
        column = layout.column()
        sockets = material.parameter_sockets(made).values()
        if not sockets:
            lines(layout, "Its node group was deleted; Reset to Preset restores it", context.region.width)
        for socket in sockets:
            if not socket.is_linked:
                column.prop(socket, "default_value", text=socket.name)
        row = layout.row()
        row.enabled = material.is_edited(made)
        row.operator("vgroove.reset", icon="LOOP_BACK")
        layout.operator("vgroove.update", icon="FILE_REFRESH")
        layout.operator("vgroove.save_preset", icon="FILE_TICK")


class VGROOVE_PT_source(InSidebar, bpy.types.Panel):
    """Where the chosen preset's numbers come from."""

    bl_label = "Source"
    bl_parent_id = "VGROOVE_PT_material"

    def draw(self, context: bpy.types.Context) -> None:
        layout, preset = self.layout, properties.chosen_preset(context.scene.vgroove)
        width = context.region.width
        lines(layout, f"Source: {preset.source['data']}", width)
        if "trust" in preset.source:
            lines(layout, f"Reliability: {preset.source['trust']}", width)
        if preset.notes:
            lines(layout, preset.notes, width)
        if preset.m_range:
            low, high = (m**0.5 for m in preset.m_range)  # as Blender's own Roughness
            lines(layout, f"Recommended roughness: {low:.2g} to {high:.2g}", width)
        layout.operator("vgroove.copy_citation", icon="COPYDOWN")
        row = layout.row(align=True)
        row.operator("vgroove.import_preset", text="Import", icon="IMPORT")
        row.operator("vgroove.export_preset", text="Export", icon="EXPORT")


class VGROOVE_PT_advice(InSidebar, bpy.types.Panel):
    """Scene settings that would spoil the render, with a button to fix each."""

    bl_label = "Scene Advice"
    bl_parent_id = "VGROOVE_PT_material"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return ROOT not in context.preferences.addons or context.preferences.addons[ROOT].preferences.show_advice

    def draw(self, context: bpy.types.Context) -> None:
        found = operators.current_problems(watch.current(context.scene))
        if not found:
            self.layout.label(text="No problems found", icon="CHECKMARK")
        if sum(problem.fix is not None and not problem.costs for problem in found) > 1:
            self.layout.operator("vgroove.mend", text="Fix All", icon="CHECKMARK").key = ""
        for problem in found:
            box = self.layout.box()
            lines(box, problem.text, context.region.width, icon="ERROR")
            if problem.fix:
                box.operator("vgroove.mend", text=problem.button).key = problem.key


def _shows_estimators(settings: bpy.types.PropertyGroup) -> bool:
    """If the preferences say so, or the file uses an estimator that is no quality of its own."""
    preferences = memory.preferences()
    return settings.estimator not in properties.STORED or bool(preferences and preferences.show_estimators)


def draw_choice(layout: bpy.types.UILayout, settings: bpy.types.PropertyGroup, preset: presets.Preset) -> None:
    """The family or the search, and the presets that it lists as pictures to choose from."""
    column = layout.column(align=True)
    column.use_property_split = False
    row = column.row()
    row.active = not settings.search.strip()  # a search looks into all families
    row.prop(settings, "family", text="")
    column.prop(settings, "search", text="", icon="VIEWZOOM")
    listed = properties.matching(settings)
    if text := listing(settings, len(listed)):
        column.label(text=text)
    if not listed:
        return
    column.template_icon_view(settings, "shown", show_labels=True, scale=7.0, scale_popup=5.0)
    row = column.row(align=True)
    row.prop(settings, "shown", text="")
    star = "SOLO_ON" if preset.id in memory.favourites() else "SOLO_OFF"
    row.operator("vgroove.favourite", text="", icon=star)


def listing(settings: bpy.types.PropertyGroup, count: int) -> str:
    """How many presets a search found; why none is shown."""
    if settings.search.strip():
        return f"{count} found" if count else "Nothing found. Try another word, or clear the search"
    return "" if count else "No presets here yet. Choose another family"


CLASSES = (VGROOVE_PT_material, VGROOVE_PT_advice, VGROOVE_PT_parameters, VGROOVE_PT_source)
