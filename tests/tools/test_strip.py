# SPDX-License-Identifier: GPL-3.0-or-later
"""The README's strip: Principled with the material's own inputs, and how far a picture is from the reference."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from vgroove.addon.library.presets import find

pytestmark = pytest.mark.blender

_spec = importlib.util.spec_from_file_location("strip", Path(__file__).parents[2] / "tools" / "strip.py")
strip = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(strip)


def test_principled_gets_the_materials_inputs(blender):
    """Its Roughness is the root of m, its colour what the metal reflects head-on."""
    gold = find("metals/gold").with_parameters(m=0.36)
    (shader,) = (node for node in strip.as_principled(gold).node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    assert shader.inputs["Roughness"].default_value == pytest.approx(0.6)
    assert shader.inputs["Metallic"].default_value == 1.0
    assert tuple(shader.inputs["Base Color"].default_value)[:3] == pytest.approx(gold.solid, abs=2e-3)


def test_the_difference_is_that_of_the_object_alone():
    """A tenth too bright is 10 %; what the object leaves as it was does not count, whatever differs there."""
    empty = np.full((4, 4, 3), 0.2, np.float32)
    truth, found = empty.copy(), empty.copy()
    truth[:2], found[:2], found[3] = 0.5, 0.55, 9.0
    assert strip.difference(found, truth, empty) == pytest.approx(0.1, rel=1e-5)
