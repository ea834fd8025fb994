# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/tutorial.md, followed without a window: tools/still_life.py does what its table says."""

import importlib.util
from pathlib import Path

import pytest

from vgroove.addon.blender import material
from vgroove.addon.ui import operators, watch
from vgroove.nodegroups import versions

_spec = importlib.util.spec_from_file_location("still_life", Path(__file__).parents[2] / "tools" / "still_life.py")
still_life = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(still_life)


@pytest.mark.blender
def test_the_artists_tutorial_can_be_followed(extension):
    """Its table finds its presets; the advice is the one it tells of, and its button ends it."""
    made = still_life.follow()
    assert len(made) == 4
    assert [material.preset_of(one.active_material).name for one in made] == [
        "Oak, Varnished", "Copper", "Apple", "BK7 Crown Glass",
    ]  # fmt: skip
    scene = extension.context.scene
    (problem,) = [one for one in operators.current_problems(watch.current(scene)) if one.button == "Allow 12 Bounces"]
    extension.ops.vgroove.mend(key=problem.key)
    left = {one.key for one in operators.current_problems(watch.current(scene))}
    assert left == (set() if versions.EXACT_CONDUCTOR else {"fresnel"})  # of 4.5, as the page says
