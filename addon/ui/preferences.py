# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences of the extension. They belong to its root package, two levels up."""

from __future__ import annotations

import bpy

from ..blender import assets

ROOT = __package__.removesuffix(".addon.ui")


class VGROOVE_OT_asset_library(bpy.types.Operator):
    """Add the materials to Blender's asset libraries, or remove them."""

    bl_idname = "vgroove.asset_library"
    bl_label = "Asset Library"
    bl_description = "Add all materials to Blender's asset libraries, or remove them; appended materials stay"
    bl_options = {"REGISTER", "INTERNAL"}  # preferences have no undo

    shown: bpy.props.BoolProperty(name="Shown", description="Whether the Asset Browser shows the materials")

    def execute(self, _context: bpy.types.Context) -> set[str]:
        try:
            (assets.register_library if self.shown else assets.unregister_library)()
        except FileNotFoundError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        bpy.context.preferences.is_dirty = True
        where = "is in the Asset Browser now" if self.shown else "is no longer in the Asset Browser"
        self.report({"INFO"}, f'The library "{assets.NAME}" {where}')
        return {"FINISHED"}


class VGroovePreferences(bpy.types.AddonPreferences):
    """What the panel shows, and an artist's favourite and recent presets."""

    bl_idname = ROOT

    show_advice: bpy.props.BoolProperty(
        name="Show Scene Advice",
        description="List scene settings that would spoil the render",
        default=True,
    )
    show_estimators: bpy.props.BoolProperty(
        name="Show Estimators",
        description="Show the six estimators by name instead of the three qualities",
        default=False,
    )
    favourites: bpy.props.StringProperty(
        name="Favourites", description="Presets marked with a star, by id", options={"HIDDEN"}
    )
    recent: bpy.props.StringProperty(name="Recent", description="Presets applied last, by id", options={"HIDDEN"})

    def draw(self, _context: bpy.types.Context) -> None:
        column = self.layout.column()
        column.prop(self, "show_advice")
        column.prop(self, "show_estimators")
        there = assets.find_library() is not None
        text = "Remove from the Asset Browser" if there else "Show in the Asset Browser"
        column.operator("vgroove.asset_library", text=text, icon="ASSET_MANAGER").shown = not there
        if assets.folder() is None:
            column.label(text="Asset library not included in this copy", icon="INFO")


CLASSES = (VGROOVE_OT_asset_library, VGroovePreferences)
