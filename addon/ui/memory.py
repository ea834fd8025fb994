# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist liked and used, kept with Blender's preferences and so in every file."""

from __future__ import annotations

import bpy

from .preferences import ROOT, VGroovePreferences

MOST_RECENT = 12


def preferences() -> VGroovePreferences | None:
    """The extension's preferences; None where Blender does not know it as an extension."""
    entry = bpy.context.preferences.addons.get(ROOT)
    return entry.preferences if entry else None


def favourites() -> list[str]:
    """Ids of presets, first those that were marked first."""
    kept = preferences()
    return kept.favourites.split() if kept else []


def recent() -> list[str]:
    """Ids of presets that were applied, the last one first."""
    kept = preferences()
    return kept.recent.split() if kept else []


def toggle_favourite(identity: str) -> bool:
    """Mark a preset as liked, or no longer; whether it is now."""
    kept = preferences()
    if kept is None:
        return False
    ids = favourites()
    liked = identity not in ids
    kept.favourites = " ".join([*ids, identity] if liked else [one for one in ids if one != identity])
    bpy.context.preferences.is_dirty = True  # so that Blender saves them, if it was told to
    return liked


def used(identity: str) -> None:
    """Remember that a preset was applied."""
    kept = preferences()
    if kept is not None:
        others = [one for one in recent() if one != identity]
        kept.recent = " ".join([identity, *others][:MOST_RECENT])
        bpy.context.preferences.is_dirty = True
