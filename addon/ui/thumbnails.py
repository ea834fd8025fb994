# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of presets as Blender's icons, read a few at a time once something asks for them.

Blender reads the picture of a button by itself, but not those of a grid that pops up.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy.utils.previews

from ..library.presets import shipped
from .preferences import ROOT

if TYPE_CHECKING:
    from ..library.presets import Preset

FOLDER = Path(__file__).parents[2] / "previews"
SHOWN_IN = ("VIEW_3D", "NODE_EDITOR", "PROPERTIES")  # editors that have the picker
AT_ONCE, PAUSE = 16, 0.02  # pictures (some 2 ms each), seconds: the window stays responsive
_pictures: list[Any] = []  # the one collection, while the extension is switched on
_waiting: list[str] = []  # ids whose picture is not read yet


def register() -> None:
    """Make room for pictures; reads none."""
    _pictures.append(bpy.utils.previews.new())


def unregister() -> None:
    """Give the pictures back."""
    _waiting.clear()
    if bpy.app.timers.is_registered(_read_some):
        bpy.app.timers.unregister(_read_some)
    bpy.utils.previews.remove(_pictures.pop())


def icon(preset: Preset) -> int:
    """The icon of a preset's picture, which may be read later; 0, none, where there is no picture of it."""
    pictures = _pictures[0]
    if preset.id not in pictures:
        folder = FOLDER if preset.id in shipped() else own_folder()
        path = folder / f"{preset.id}.webp" if folder else None
        if path is None or not path.is_file():
            return 0
        pictures.load(preset.id, str(path), "IMAGE")
        _waiting.append(preset.id)
        if not bpy.app.timers.is_registered(_read_some):
            bpy.app.timers.register(_read_some, first_interval=PAUSE, persistent=True)  # also when a file opens
    return int(pictures[preset.id].icon_id)


def own_folder() -> Path | None:
    """Where pictures of the user's own presets lie; None where Blender gives the extension no folder. Makes nothing."""
    try:
        return Path(bpy.utils.extension_path_user(ROOT, path="previews"))
    except ValueError:  # it is not installed as an extension
        return None


def forget(identity: str) -> None:
    """A preset's picture has changed or is gone: it is read again when it is next drawn."""
    if identity in _waiting:
        _waiting.remove(identity)
    if identity in _pictures[0]:
        del _pictures[0][identity]
    redraw()


def _read_some() -> float | None:
    """Called by Blender until nothing waits."""
    for _ in range(min(AT_ONCE, len(_waiting))):
        _ = _pictures[0][_waiting.pop(0)].image_size[0]  # to ask for the size reads the file
    redraw()
    return PAUSE if _waiting else None


def redraw() -> None:
    """Draw the editors that show pictures again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in SHOWN_IN:
                area.tag_redraw()
