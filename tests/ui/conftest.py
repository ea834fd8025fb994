# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension, and a folder of an artist's own presets."""

import pytest

import vgroove
from vgroove import headless
from vgroove.addon.library import presets


@pytest.fixture
def extension(blender):
    """The extension switched on in Blender's default scene, with the cube selected."""
    with headless.quiet():
        blender.ops.wm.read_factory_settings()
    vgroove.register()
    yield blender
    vgroove.unregister()


@pytest.fixture
def own_folder(extension, tmp_path, monkeypatch):
    monkeypatch.setenv(presets.USER_FOLDER, str(tmp_path))
    presets.reread()
    yield tmp_path
    presets.reread()
