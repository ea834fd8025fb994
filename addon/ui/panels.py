# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the 3D viewport's sidebar, tab "V-Groove"."""

from __future__ import annotations

import bpy

from ...nodegroups import versions
from ..blender import material, textures
from ..library import families, presets
from . import memory, numbers, operators, properties, watch
from .preferences import ROOT
from .text import lines

MOST_READ = 20  # objects that a redraw looks at


class InSidebar:
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "V-Groove"


class _InShaderEditor:
    bl_space_type = "NODE_EDITOR"
    bl_region_type = "UI"
    bl_category = "V-Groove"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        space = context.space_data
        return space.tree_type == "ShaderNodeTree" and space.shader_type == "OBJECT"


class _InProperties:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "material"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None


class _Picker:
    """Choose a preset and apply it."""

    layout: bpy.types.UILayout
    bl_label = "V-Groove Material"

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.vgroove, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        preset = properties.chosen_preset(settings)
        draw_choice(layout, settings, preset)
        column = layout.column()
        if bpy.app.build_options.cycles_osl or settings.backend == "osl":  # some Blenders have none
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
        if preset.can_disperse:
            row = column.row()
            row.enabled = versions.DISPERSES
            row.prop(settings, "disperses")
        if families.gets_bounces(preset):
            column.prop(settings, "bounces")
        if _replaces_textures(context):
            column.prop(settings, "keep_textures")
        row = layout.row()
        row.scale_y = 1.4
        row.operator("vgroove.apply", icon="MATERIAL")
        if picked.why:
            lines(layout, picked.why[0].upper() + picked.why[1:], context.region.width)
        if text := versions.untested():
            lines(layout, text, context.region.width, icon="INFO")
        for error in presets.load_errors()[:1]:
            lines(layout, f"Preset skipped: {error}", context.region.width, icon="ERROR")


class VGROOVE_PT_material(_Picker, InSidebar, bpy.types.Panel):
    pass


class VGROOVE_PT_material_nodes(_Picker, _InShaderEditor, bpy.types.Panel):
    pass


class VGROOVE_PT_material_properties(_Picker, _InProperties, bpy.types.Panel):
    pass


class _Parameters:
    """The parameters of the active object's material."""

    layout: bpy.types.UILayout
    bl_label = "Edit Parameters"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, made = self.layout, operators.ours(context)
        layout.use_property_split = True
        layout.use_property_decorate = False
        if made is None:
            lines(layout, "Apply a preset to edit its parameters here", context.region.width)
            return
        layout.label(text=made.name, icon="MATERIAL")
        if not material.parameter_sockets(made):
            lines(layout, "Its node group was deleted; Reset to Preset restores it", context.region.width)
        numbers.draw(layout.column(), made)
        row = layout.row()
        row.enabled = material.is_edited(made)
        row.operator("vgroove.reset", icon="LOOP_BACK")
        layout.operator("vgroove.add_image_set", icon="TEXTURE")
        layout.operator("vgroove.update", icon="FILE_REFRESH")
        layout.operator("vgroove.save_preset", icon="FILE_TICK")


class VGROOVE_PT_parameters(_Parameters, InSidebar, bpy.types.Panel):
    bl_parent_id = "VGROOVE_PT_material"


class VGROOVE_PT_parameters_nodes(_Parameters, _InShaderEditor, bpy.types.Panel):
    bl_parent_id = "VGROOVE_PT_material_nodes"


class VGROOVE_PT_parameters_properties(_Parameters, _InProperties, bpy.types.Panel):
    bl_parent_id = "VGROOVE_PT_material_properties"


class VGROOVE_PT_published(InSidebar, bpy.types.Panel):
    """The parameters that papers give, where the inputs hold others."""

    bl_label = "As Published"
    bl_parent_id = "VGROOVE_PT_parameters"
    bl_options = {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        made = operators.ours(context)
        return made is not None and numbers.is_published(made)

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        made = operators.ours(context)
        assert made is not None  # noqa: S101 - poll saw to it
        numbers.draw_published(self.layout.column(), made)


class VGROOVE_PT_source(InSidebar, bpy.types.Panel):
    """Where the chosen preset's numbers come from."""

    bl_label = "Source"
    bl_parent_id = "VGROOVE_PT_material"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        layout, preset = self.layout, properties.chosen_preset(context.scene.vgroove)
        width = context.region.width
        lines(layout, f"Source: {preset.source['data']}", width)
        if "trust" in preset.source:
            lines(layout, f"Reliability: {preset.source['trust']}", width)
        if preset.notes:
            lines(layout, preset.notes, width)
        if abbe := preset.parameters.get("abbe"):
            layout.label(text=f"Abbe number: {abbe:.3g}")
        if preset.m_range:
            low, high = (m**0.5 for m in preset.m_range)  # as Blender's own Roughness
            lines(layout, f"Recommended roughness: {low:.2g} to {high:.2g}", width)
        layout.operator("vgroove.copy_citation", icon="COPYDOWN")
        row = layout.row(align=True)
        row.operator("vgroove.import_preset", text="Import", icon="IMPORT")
        row.operator("vgroove.export_preset", text="Export", icon="EXPORT")
        if preset.id not in presets.shipped():
            row = layout.row(align=True)
            row.operator("vgroove.rename_preset", text="Rename", icon="GREASEPENCIL")
            row.operator("vgroove.delete_preset", text="Delete", icon="TRASH")


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


def _replaces_textures(context: bpy.types.Context) -> bool:
    """Whether something selected has textures; in Edit Mode faces get a material beside the others."""
    if context.mode != "OBJECT":
        return False
    items = context.selected_objects[:MOST_READ]
    return any(textures.may_have(one) for one in {item.active_material for item in items})


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
    if preset.evidence:
        column.label(text=preset.evidence)
    star = "SOLO_ON" if preset.id in memory.favourites() else "SOLO_OFF"
    row.operator("vgroove.favourite", text="", icon=star)


def listing(settings: bpy.types.PropertyGroup, count: int) -> str:
    """How many presets a search found; why none is shown."""
    if asked := settings.search.split():
        searched = properties.searched_words(settings)
        if not count:
            return "Nothing found. Try another word, or clear the search"
        return f"{count} found" if searched.split() == asked else f"{count} found for {searched}"
    return "" if count else "No presets here yet. Choose another family"


CLASSES = (
    VGROOVE_PT_material,
    VGROOVE_PT_material_nodes,
    VGROOVE_PT_material_properties,
    VGROOVE_PT_advice,
    VGROOVE_PT_parameters,
    VGROOVE_PT_parameters_nodes,
    VGROOVE_PT_parameters_properties,
    VGROOVE_PT_published,
    VGROOVE_PT_source,
)
