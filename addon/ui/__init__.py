# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists see. Each step of registration puts its undo beside it; ``unregister`` runs them backwards."""

from __future__ import annotations

from contextlib import ExitStack
from pathlib import Path

import bpy

from ..blender import colour_update, follow
from ..library import presets
from . import course, export, opened, operators, panels, preferences, properties, thumbnails, watch

_registered = ExitStack()


def register() -> None:
    """Called when the extension is switched on; leaves nothing behind if a step fails."""
    with ExitStack() as undo:
        for module in (preferences, properties, operators, panels, course, export):
            for kind in module.CLASSES:
                bpy.utils.register_class(kind)
                undo.callback(bpy.utils.unregister_class, kind)
        thumbnails.register()
        undo.callback(thumbnails.unregister)
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
