# SPDX-License-Identifier: GPL-3.0-or-later
"""Keeps the scenes' rigs of lights up to date while the extension is on, and before a command renders."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from . import lamps, origin
from .material import bindable, bound_slots
from .rebuild import rebuild

if TYPE_CHECKING:
    from bpy.types import Depsgraph, Scene

HANDLERS = ("load_post", "undo_post", "redo_post")


def refresh(scene: Scene) -> None:
    """Update the scene's rig of lights, if a material reads it, and rebuild materials that need more lights.

    Writes nothing that is up to date.
    """
    if scene.library is not None or not any(map(bound_slots, bpy.data.materials)):
        return
    lights = lamps.follow(scene)
    for made in lamps.materials_in(scene):
        record = origin.read(made)
        if record is None or not record.lights or made.library is not None or made.override_library is not None:
            continue
        wanted = {str(light.slot) for light in bindable(lights, record.estimator, record.preset.model)}
        if bound_slots(made) and not wanted <= bound_slots(made):
            rebuild(made, scene)


def register() -> None:
    """Start following lights."""
    bpy.app.handlers.depsgraph_update_post.append(_on_update)
    for name in HANDLERS:
        getattr(bpy.app.handlers, name).append(_on_file)


def unregister() -> None:
    """Stop following them."""
    bpy.app.handlers.depsgraph_update_post.remove(_on_update)
    for name in HANDLERS:
        getattr(bpy.app.handlers, name).remove(_on_file)


@bpy.app.handlers.persistent
def _on_update(scene: Scene, depsgraph: Depsgraph) -> None:
    if not bpy.app.is_job_running("RENDER") and any(map(_concerns_lights, depsgraph.updates)):
        refresh(scene)


@bpy.app.handlers.persistent
def _on_file(*_: object) -> None:
    for scene in bpy.data.scenes:
        refresh(scene)


def _concerns_lights(update: Any) -> bool:
    """Whether a light may have come, gone or become another. A light that only moves is followed by its drivers."""
    changed = update.id
    if isinstance(changed, bpy.types.Object):
        moved = update.is_updated_transform and not update.is_updated_geometry
        return not moved and (changed.type == "LIGHT" or changed.instance_type == "COLLECTION")
    return isinstance(changed, bpy.types.Light | bpy.types.Collection)
