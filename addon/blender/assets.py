# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library in the user's preferences: registered and taken out again by a button, never on its own."""

from __future__ import annotations

from pathlib import Path

import bpy

from ...nodegroups import versions

FOLDER = Path(__file__).parents[2] / "assets"
FILE = "vgroove.blend"
NAME = "V-Groove"


def version() -> str:
    """The name of this Blender's folder, "5.2"."""
    return ".".join(map(str, versions.version()))


def folder() -> Path | None:
    """The library that suits this Blender: its own, else that of the nearest earlier one; None where there is none."""

    def number(path: Path) -> tuple[int, ...]:
        return tuple(int(part) for part in path.parent.name.split("."))

    suited = [path for path in FOLDER.glob(f"[0-9]*.[0-9]*/{FILE}") if number(path) <= versions.version()]
    return max(suited, key=number).parent if suited else None


def find_library() -> bpy.types.UserAssetLibrary | None:
    """The library's entry in the preferences."""
    libraries = bpy.context.preferences.filepaths.asset_libraries
    return next((one for one in libraries if Path(one.path).is_relative_to(FOLDER)), None)


def register_library() -> None:
    """Add this Blender's library to the preferences. FileNotFoundError where none came with the extension."""
    found = folder()
    if found is None:
        message = f"this extension came without its asset library ({FOLDER}); install the zip that has it"
        raise FileNotFoundError(message)
    unregister_library()
    entry = bpy.context.preferences.filepaths.asset_libraries.new(name=NAME, directory=str(found))
    entry.import_method = "APPEND"  # what is linked or packed cannot be edited


def unregister_library() -> None:
    """Take it out of the preferences; what was appended from it stays."""
    entry = find_library()
    if entry is not None:
        bpy.context.preferences.filepaths.asset_libraries.remove(entry)
