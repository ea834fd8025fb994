# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists see. Each step of registration puts its undo beside it; ``unregister`` runs them backwards."""

from __future__ import annotations

from contextlib import ExitStack

import bpy

from . import operators, panels, preferences, properties

_registered = ExitStack()


def register() -> None:
    """Called when the extension is switched on; leaves nothing behind if a step fails."""
    with ExitStack() as undo:
        for kind in (*preferences.CLASSES, *properties.CLASSES, *operators.CLASSES, *panels.CLASSES):
            bpy.utils.register_class(kind)
            undo.callback(bpy.utils.unregister_class, kind)
        bpy.types.Scene.vgroove = bpy.props.PointerProperty(type=properties.VGrooveSettings)
        undo.callback(delattr, bpy.types.Scene, "vgroove")
        _registered.enter_context(undo.pop_all())


def unregister() -> None:
    """Called when the extension is switched off."""
    _registered.close()
