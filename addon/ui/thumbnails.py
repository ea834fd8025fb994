# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of presets as Blender's icons. Each is read from disk when it is first drawn."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy.utils.previews

if TYPE_CHECKING:
    from ..presets import Preset

FOLDER = Path(__file__).parent.parent.parent / "previews"
_pictures: list[Any] = []  # the one collection, while the extension is switched on


def register() -> None:
    """Make room for pictures; reads none."""
    _pictures.append(bpy.utils.previews.new())


def unregister() -> None:
    """Give the pictures back."""
    bpy.utils.previews.remove(_pictures.pop())


def icon(preset: Preset) -> int:
    """The icon of a preset's picture; 0, none, where there is no picture of it."""
    pictures, path = _pictures[0], FOLDER / f"{preset.id}.webp"
    if preset.id not in pictures:
        if not path.is_file():
            return 0
        pictures.load(preset.id, str(path), "IMAGE")
    return int(pictures[preset.id].icon_id)
