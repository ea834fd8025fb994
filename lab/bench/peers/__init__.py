# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show a preset: a module for a model, named as it is, or ``exported`` for those without one.

LOCAL           whether light leaves the surface where it arrives, so that f alone says what a ball looks like
cycles(preset)  Cycles' own materials that an artist would take instead, as ``nodes.Peer``
native(tree, preset)  the node of the nearest material of Cycles' own, wired by hand
mitsuba(preset) the nearest BSDF of Mitsuba, as its dictionary; None if there is none
UNIVERSAL       what of the universal material's data the model sets: weights that its presets lack, and switches
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from ....addon.library.presets import Preset


def of(preset: Preset) -> Any:
    """The module of the preset's model."""
    own = find_spec(f".{preset.model}", __name__)
    return import_module(f".{preset.model}" if own else ".exported", __name__)
