# SPDX-License-Identifier: GPL-3.0-or-later
"""A preset's picture: the studio's shape for it, with the material as Standard builds it."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from ..blender import material, studio
from ..library import presets
from ..library.files import replacing
from . import automatic

if TYPE_CHECKING:
    from bpy.types import Scene

SHOWN_AGE = 0.6  # of what changes over time: most of it has changed


def render(shown: Scene, preset: presets.Preset, path: Path) -> None:
    """One picture to ``path``, whose folder is made; its material is removed again."""
    if preset.time is not None:
        preset = preset.at(float(preset.trajectory().time(SHOWN_AGE)))
    made = material.build(preset, material.Choice("nodes", automatic.pick_estimator(shown, preset)))
    try:
        studio.show(shown, preset, made)
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as temporary:
            studio.picture(shown, temporary)
    finally:
        bpy.data.materials.remove(made)


def main() -> None:
    """In a Blender of its own: the preset and the file that the command line names last."""
    identity, path = sys.argv[-2:]
    render(studio.scene(), presets.find(identity), Path(path))
