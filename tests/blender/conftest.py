# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender as its exporters need it."""

import logging

import pytest

import vgroove
from vgroove import headless


@pytest.fixture
def exporters(blender):
    """Blender with its exporters and the extension switched on, and an empty file."""
    import addon_utils

    with headless.quiet():
        addon_utils.enable("io_scene_gltf2")
    logging.getLogger("glTFImporter").setLevel(logging.ERROR)
    blender.context.preferences.addons.new().module = "vgroove"
    vgroove.register()
    yield blender
    vgroove.unregister()
    blender.context.preferences.addons.remove(blender.context.preferences.addons["vgroove"])
