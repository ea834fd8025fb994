# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension switched on."""

import pytest

import vgroove
from vgroove import headless


@pytest.fixture
def extension(blender):
    """Blender's default scene with the extension, and the cube selected."""
    with headless.quiet():
        blender.ops.wm.read_factory_settings()
    vgroove.register()
    blender.context.scene.vgroove.estimator = "closure"
    yield blender
    vgroove.unregister()
