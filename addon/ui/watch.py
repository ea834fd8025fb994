# SPDX-License-Identifier: GPL-3.0-or-later
"""Facts of scenes for what is drawn: read once after each change of the file, however often panels are drawn.

Operators call ``facts.of`` themselves, as a script may have changed what Blender has not evaluated yet.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..blender import facts

if TYPE_CHECKING:
    from bpy.types import Scene

    from ..blender.facts import SceneFacts

CHANGES = ("depsgraph_update_post", "frame_change_post", "load_pre", "load_post", "undo_pre", "undo_post", "redo_post")
_known: dict[int, SceneFacts] = {}  # by the scene's session_uid


def current(scene: Scene) -> SceneFacts:
    """The facts of a scene as Blender last evaluated it."""
    if forget not in bpy.app.handlers.depsgraph_update_post:  # nobody would say when they are stale
        return facts.of(scene, update=False)
    if scene.session_uid not in _known:
        _known[scene.session_uid] = facts.of(scene, update=False)
    return _known[scene.session_uid]


@bpy.app.handlers.persistent
def forget(*_: object) -> None:
    """Something changed."""
    _known.clear()


def register() -> None:
    for name in CHANGES:
        getattr(bpy.app.handlers, name).append(forget)


def unregister() -> None:
    for name in CHANGES:
        handlers = getattr(bpy.app.handlers, name)
        if forget in handlers:
            handlers.remove(forget)
    forget()
