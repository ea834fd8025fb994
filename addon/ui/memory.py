# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's favourite and recent presets. They are stored in Blender's preferences, so every file shares them."""

from __future__ import annotations

import bpy

from .preferences import ROOT, VGroovePreferences

MOST_RECENT = 12


def preferences() -> VGroovePreferences | None:
    """The extension's preferences; None where Blender does not know it as an extension."""
    entry = bpy.context.preferences.addons.get(ROOT)
    return entry.preferences if entry else None


def favourites() -> list[str]:
    """Ids of presets, in the order in which they were marked."""
    found = preferences()
    return found.favourites.split() if found else []


def recent() -> list[str]:
    """Ids of presets that were applied, the latest first."""
    found = preferences()
    return found.recent.split() if found else []


def toggle_favourite(identity: str) -> bool:
    """Mark a preset as a favourite, or unmark it; whether it is one now."""
    found = preferences()
    if found is None:
        return False
    ids = favourites()
    liked = identity not in ids
    found.favourites = " ".join([*ids, identity] if liked else [one for one in ids if one != identity])
    bpy.context.preferences.is_dirty = True  # so that Blender saves them, if Auto-Save Preferences is on
    return liked


def renamed(before: str, now: str) -> None:
    """A favourite or recent preset has another id."""
    found = preferences()
    if found is not None:
        for name in ("favourites", "recent"):
            ids = getattr(found, name).split()
            setattr(found, name, " ".join(now if one == before else one for one in ids))
        bpy.context.preferences.is_dirty = True


def used(identity: str) -> None:
    """Remember that a preset was applied."""
    found = preferences()
    if found is not None:
        others = [one for one in recent() if one != identity]
        found.recent = " ".join([identity, *others][:MOST_RECENT])
        bpy.context.preferences.is_dirty = True
