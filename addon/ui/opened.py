# SPDX-License-Identifier: GPL-3.0-or-later
"""Warns of materials in an opened file that were built in another Blender and render differently in this one."""

from __future__ import annotations

import bpy

from ..choose import advice
from .text import lines

WIDTH = 420


def draw(popup: bpy.types.Menu, context: bpy.types.Context) -> None:
    """The problem, in words, and the button that fixes it."""
    for problem in advice.cycles_problems(context.scene):
        lines(popup.layout, problem.text, WIDTH)
        if problem.fix:
            popup.layout.operator("vgroove.mend", text=problem.button, icon="FILE_REFRESH").key = problem.key


@bpy.app.handlers.persistent
def _on_file(*_: object) -> None:
    """Print the problems on the console, and show them in a window once Blender has one."""
    found = list(advice.cycles_problems(bpy.context.scene))
    for problem in found:
        print(f"V-Groove: {problem.text}")
    if found and not bpy.app.background:
        bpy.app.timers.register(_show, first_interval=0.1)


def _show() -> None:
    manager = bpy.context.window_manager
    if manager.windows:
        with bpy.context.temp_override(window=manager.windows[0]):  # a timer has none
            manager.popup_menu(draw, title="V-Groove", icon="INFO")


def register() -> None:
    """Look at each file that is opened."""
    bpy.app.handlers.load_post.append(_on_file)


def unregister() -> None:
    """No longer."""
    bpy.app.handlers.load_post.remove(_on_file)
    if bpy.app.timers.is_registered(_show):
        bpy.app.timers.unregister(_show)
