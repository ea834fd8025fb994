# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of the user's own: saved, renamed, deleted, imported and exported."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..blender import material
from ..library import presets
from ..library import writing as preset_files
from ..library.errors import InputError
from ..library.files import replacing
from . import memory, pictures
from .operators import ours, poll_ours
from .properties import FIRST, chosen_preset, matching

if TYPE_CHECKING:
    from collections.abc import Callable

FILE_PATH = bpy.props.StringProperty(
    name="File Path", description="The preset file", subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"}
)


class VGROOVE_OT_save_preset(bpy.types.Operator):
    """Save the active material's values as a preset in the user's folder."""

    bl_idname = "vgroove.save_preset"
    bl_label = "Save as My Preset"
    bl_description = "Save the material's current values as a preset in your folder"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; the file stays

    name: bpy.props.StringProperty(name="Name", description="Name of the preset", maxlen=60)
    overwrite: bpy.props.BoolProperty(
        name="Overwrite", description="Replace your preset of this name, if there is one", options={"SKIP_SAVE"}
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return poll_folder(cls) and poll_ours(cls, context)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        preset = material.preset_of(ours(context))
        self.name = (preset.name if _own_file(preset) else f"My {preset.name}")[:60]
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        made = ours(context)
        try:
            preset = material.to_preset(made)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        source = dict(preset.source)
        if material.is_edited(made):
            source |= {"data": f"edited from {preset.id}, whose source is: {source['data']}"}
            source |= {"colour": "by eye", "roughness": "by eye"}
        edited = replace(preset, name=self.name, source=source)
        return _save_with_picture(
            self, context, lambda folder: preset_files.save(edited, folder, overwrite=self.overwrite)
        )


class VGROOVE_OT_import_preset(bpy.types.Operator, ImportHelper):
    """Copy a preset file into the user's folder."""

    bl_idname = "vgroove.import_preset"
    bl_label = "Import Preset"
    bl_description = "Copy a preset file into your folder"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; the file stays

    filename_ext = ".toml"
    filepath: FILE_PATH
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return poll_folder(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        return _save_with_picture(
            self, context, lambda folder: preset_files.import_file(Path(bpy.path.abspath(self.filepath)), folder)
        )


class VGROOVE_OT_export_preset(bpy.types.Operator, ExportHelper):
    """Write the preset to a file."""

    bl_idname = "vgroove.export_preset"
    bl_label = "Export Preset"
    bl_description = "Write the preset to a file, to share or edit"
    bl_options = {"REGISTER"}

    filename_ext = ".toml"
    filepath: FILE_PATH
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.filepath = f"{preset_files.file_name(chosen_preset(context.scene.vgroove).name)}.toml"
        return ExportHelper.invoke(self, context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        path = Path(bpy.path.abspath(self.filepath))  # "//" is the .blend's folder
        try:
            with replacing(path) as temporary:
                temporary.write_text(preset_files.dumps(chosen_preset(context.scene.vgroove)), encoding="utf-8")
        except OSError as error:
            self.report({"ERROR"}, f"{path} cannot be written: {error.strerror or error}")
            return {"CANCELLED"}
        self.report({"INFO"}, f"Wrote {path}")
        return {"FINISHED"}


class VGROOVE_OT_rename_preset(bpy.types.Operator):
    """Give one of the user's presets another name."""

    bl_idname = "vgroove.rename_preset"
    bl_label = "Rename My Preset"
    bl_description = "Give this preset of yours another name. Materials made of it stay as they are"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; the file stays

    name: bpy.props.StringProperty(name="Name", description="Name of the preset", maxlen=60)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _poll_own(cls, context)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        self.name = chosen_preset(context.scene.vgroove).name
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.vgroove
        preset = chosen_preset(settings)
        done = _save(self, context, lambda folder: preset_files.rename(preset, self.name, folder))
        if done == {"FINISHED"}:
            memory.renamed(preset.id, settings.preset)
            pictures.rename(preset.id, settings.preset)
        return done


class VGROOVE_OT_delete_preset(bpy.types.Operator):
    """Delete one of the user's presets."""

    bl_idname = "vgroove.delete_preset"
    bl_label = "Delete My Preset"
    bl_description = "Delete this preset of yours from your folder. Materials made of it stay as they are"
    bl_options = {"REGISTER"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _poll_own(cls, context)

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.vgroove
        preset, folder = chosen_preset(settings), presets.user_folder()
        assert folder is not None  # noqa: S101 - poll saw to it
        try:
            preset_files.delete(preset, folder)
        except (InputError, OSError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        pictures.delete(preset.id)
        listed = matching(settings)
        settings.preset = listed[0].id if listed else FIRST
        self.report({"INFO"}, f"{preset.name} deleted from {folder}")
        return {"FINISHED"}


def _save(operator: bpy.types.Operator, context: bpy.types.Context, save: Callable[[Path], presets.Preset]) -> set[str]:
    """Save a preset in the user's folder, and choose it."""
    folder = presets.user_folder()
    try:
        saved = save(folder) if folder else None
    except (InputError, OSError) as error:
        operator.report({"ERROR"}, str(error))
        return {"CANCELLED"}
    if saved is None:
        return {"CANCELLED"}
    context.scene.vgroove.preset = saved.id
    operator.report({"INFO"}, f"{saved.name} saved in {folder}")
    return {"FINISHED"}


def _save_with_picture(
    operator: bpy.types.Operator, context: bpy.types.Context, save: Callable[[Path], presets.Preset]
) -> set[str]:
    done = _save(operator, context, save)
    if done == {"FINISHED"}:
        pictures.request(context.scene.vgroove.preset)
    return done


def poll_folder(operator: type[bpy.types.Operator]) -> bool:
    if presets.user_folder() is None:
        operator.poll_message_set("No preset folder: install the extension, or set VGROOVE_PRESETS")
        return False
    return True


def _own_file(preset: presets.Preset) -> Path | None:
    return preset_files.own_file(preset, presets.user_folder())


def _poll_own(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    if _own_file(chosen_preset(context.scene.vgroove)) is None:
        operator.poll_message_set("Choose a preset of your own: those that ship with V-Groove stay")
        return False
    return True


CLASSES = (
    VGROOVE_OT_save_preset,
    VGROOVE_OT_rename_preset,
    VGROOVE_OT_delete_preset,
    VGROOVE_OT_import_preset,
    VGROOVE_OT_export_preset,
)
