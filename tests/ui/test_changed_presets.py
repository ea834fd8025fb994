# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of an artist's own: overwritten if asked, renamed, deleted; those that ship stay."""

import pytest

from vgroove import headless
from vgroove.addon.library import presets

pytestmark = pytest.mark.blender


@pytest.fixture
def folder(extension, tmp_path, monkeypatch):
    """The user's folder, with a preset "Mine" of the cube's material."""
    monkeypatch.setenv(presets.USER_FOLDER, str(tmp_path))
    presets.reread()
    extension.context.scene.vgroove.preset = "metals/copper"
    run(extension, "apply")
    run(extension, "save_preset", name="Mine")
    yield tmp_path
    monkeypatch.undo()
    presets.reread()


def run(extension, operator, /, **settings):
    with headless.quiet():
        return getattr(extension.ops.vgroove, operator)(**settings)


def test_a_preset_is_overwritten_only_if_asked(extension, folder):
    made = extension.context.object.active_material
    made.vgroove_numbers.m = 0.5
    with pytest.raises(RuntimeError, match='there is a preset "mine" in'):
        run(extension, "save_preset", name="Mine")
    assert presets.find("mine/mine").m != pytest.approx(0.5)
    assert run(extension, "save_preset", name="Mine", overwrite=True) == {"FINISHED"}
    assert presets.find("mine/mine").m == pytest.approx(0.5)


def test_a_preset_is_renamed_and_its_file_with_it(extension, folder):
    """Also where the file keeps its name; not onto another one."""
    settings = extension.context.scene.vgroove
    assert settings.preset == "mine/mine"
    assert run(extension, "rename_preset", name="Warm Copper") == {"FINISHED"}
    assert settings.preset == "mine/warm_copper"
    assert [path.name for path in folder.iterdir()] == ["warm_copper.toml"]
    assert run(extension, "rename_preset", name="WARM copper") == {"FINISHED"}
    assert presets.find("mine/warm_copper").name == "WARM copper"
    run(extension, "save_preset", name="Other")
    with pytest.raises(RuntimeError, match='there is a preset "warm_copper" in'):
        run(extension, "rename_preset", name="Warm Copper")
    assert presets.find("mine/other").name == "Other"


def test_a_deleted_preset_leaves_its_materials(extension, folder):
    """The panel goes on with another one."""
    made = extension.context.object.active_material
    assert run(extension, "delete_preset") == {"FINISHED"}
    assert list(folder.iterdir()) == []
    assert extension.context.object.active_material == made
    assert extension.context.scene.vgroove.preset in presets.all_presets()


def test_presets_that_ship_stay(extension, folder):
    extension.context.scene.vgroove.preset = "metals/copper"
    for operator in ("rename_preset", "delete_preset"):
        with pytest.raises(RuntimeError, match="Choose a preset of your own"):
            run(extension, operator)
