# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender is prepared before anything imports it; each Blender test starts from an empty file."""

import pytest

from vgroove.addon import headless

headless.prepare()

import bpy  # noqa: E402 - prepare() must come first


@pytest.fixture
def blender():
    """Bpy with an empty file, and its chatter kept off the terminal."""
    with headless.quiet():
        bpy.ops.wm.read_factory_settings(use_empty=True)
    yield bpy
    with headless.quiet():
        bpy.ops.wm.read_factory_settings(use_empty=True)


@pytest.fixture
def instrument():
    """Blender for measurements, which leave the file as it was: node groups stay, as building them takes longer."""
    return bpy


@pytest.fixture
def empty_material(blender):
    """A function that makes a material with an empty tree on either Blender."""

    def make(name="Test"):
        material = blender.data.materials.new(name)
        if blender.app.version < (5, 0, 0):
            material.use_nodes = True
        material.node_tree.nodes.clear()
        material.cycles.emission_sampling = "NONE"
        return material

    return make
