# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists see. Each step of registration puts its undo beside it; ``unregister`` runs them backwards."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import bpy

from ..blender import colour_update, follow
from ..library import presets
from . import (
    apply,
    course,
    export,
    measure,
    measured,
    numbers,
    opened,
    operators,
    own_presets,
    panels,
    pictures,
    preferences,
    properties,
    shader_editor,
    textures,
    thumbnails,
    viewer,
    viewer_draw,
    viewer_export,
    viewer_measure,
    viewer_panel,
    watch,
)

WITH_CLASSES = (
    preferences,
    properties,
    numbers,
    operators,
    own_presets,
    apply,
    textures,
    shader_editor,
    panels,
    course,
    measured,
    measure,
    export,
    viewer,
    viewer_measure,
    viewer_export,
    viewer_panel,
)
_registered = ExitStack()


def register() -> None:
    """Called when the extension is switched on; leaves nothing behind if a step fails."""
    with ExitStack() as undo:
        for kind in [one for of in WITH_CLASSES for one in of.CLASSES]:
            bpy.utils.register_class(kind)
            undo.callback(bpy.utils.unregister_class, kind)
        bpy.types.Material.vgroove_numbers = bpy.props.PointerProperty(type=numbers.VGrooveNumbers)
        undo.callback(delattr, bpy.types.Material, "vgroove_numbers")
        shader_editor.register()
        undo.callback(shader_editor.unregister)
        thumbnails.register()
        undo.callback(thumbnails.unregister)
        undo.callback(pictures.unregister)
        measured.register()
        undo.callback(measured.unregister)
        undo.callback(measure.unregister)
        undo.callback(watch.unregister)
        watch.register()
        colour_update.register()
        undo.callback(colour_update.unregister)
        presets.set_user_folder(_user_folder())
        undo.callback(presets.set_user_folder, None)
        bpy.types.Scene.vgroove = bpy.props.PointerProperty(type=properties.VGrooveSettings)
        undo.callback(delattr, bpy.types.Scene, "vgroove")
        bpy.types.Scene.vgroove_course = bpy.props.PointerProperty(type=course.VGrooveCourse)
        undo.callback(delattr, bpy.types.Scene, "vgroove_course")
        bpy.types.Scene.vgroove_viewer = bpy.props.PointerProperty(type=viewer.VGrooveViewer)
        undo.callback(delattr, bpy.types.Scene, "vgroove_viewer")
        undo.callback(viewer_measure.unregister)
        undo.callback(viewer_draw.unregister)
        viewer_draw.register()
        follow.register()
        undo.callback(follow.unregister)
        opened.register()
        undo.callback(opened.unregister)
        _registered.enter_context(undo.pop_all())


def _user_folder() -> Path | None:
    """Where Blender lets this extension keep files; None where it is not installed as an extension. Makes nothing."""
    try:
        return Path(bpy.utils.extension_path_user(preferences.ROOT, path="presets"))
    except ValueError:
        return None


def unregister() -> None:
    """Called when the extension is switched off."""
    _registered.close()
