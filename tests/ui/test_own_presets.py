# SPDX-License-Identifier: GPL-3.0-or-later
"""Edited materials become presets of one's own, which go out to files and come back; sources are cited."""

import pytest

import vgroove
from vgroove import headless
from vgroove.addon.blender import material

from .panel import drawn

pytestmark = pytest.mark.blender


def test_edited_numbers_are_reset(extension):
    """To those of the preset that the material was built from."""
    from vgroove.addon.ui import operators

    extension.context.scene.vgroove.preset = "metals/gold"
    with headless.quiet():
        extension.ops.vgroove.apply()
    made = operators.ours(extension.context)
    assert set(material.parameter_sockets(made)) == {"m", "n", "k"}
    assert not material.is_edited(made)
    material.parameter_sockets(made)["m"].default_value = 0.4
    assert material.is_edited(made)
    assert extension.ops.vgroove.reset() == {"FINISHED"}
    assert not material.is_edited(made)
    extension.context.object.active_material = None
    with pytest.raises(RuntimeError, match="active material came from this panel"):
        extension.ops.vgroove.reset()


def test_an_edited_material_is_saved_as_a_preset(extension, own_folder):
    """It is chosen at once, says what it was edited from, and never replaces another."""
    from vgroove.addon.library import presets
    from vgroove.addon.ui import operators

    settings = extension.context.scene.vgroove
    settings.preset = "metals/gold"
    with headless.quiet():
        extension.ops.vgroove.apply()
        material.parameter_sockets(operators.ours(extension.context))["m"].default_value = 0.4**0.5
        assert extension.ops.vgroove.save_preset(name="Old Gold") == {"FINISHED"}
        assert settings.preset == settings.shown == "mine/old_gold"
        with pytest.raises(RuntimeError, match="give this one another name"):
            extension.ops.vgroove.save_preset(name="Old Gold")
        with pytest.raises(RuntimeError, match="name must be 1 to 60 printable characters"):
            extension.ops.vgroove.save_preset(name=" ")
        assert extension.ops.vgroove.apply() == {"FINISHED"}
    kept = presets.find("mine/old_gold")
    assert kept.m == pytest.approx(0.4)
    assert kept.source["data"].startswith("edited from metals/gold, whose source is: Johnson and Christy 1972")
    assert "metal" in kept.tags
    assert [path.name for path in own_folder.iterdir()] == ["old_gold.toml"]


def test_a_preset_goes_out_to_a_file_and_comes_back(extension, own_folder, tmp_path_factory):
    """Export and Import; a file that is no preset is refused in one line, and nothing is kept of it."""
    from vgroove.addon.library import presets

    settings = extension.context.scene.vgroove
    settings.preset = "car_paints/blue"
    path = tmp_path_factory.mktemp("sent") / "paint.toml"
    with headless.quiet():
        assert extension.ops.vgroove.export_preset(filepath=str(path)) == {"FINISHED"}
        assert extension.ops.vgroove.import_preset(filepath=str(path)) == {"FINISHED"}
        path.write_text("name = 3", encoding="utf-8")
        with pytest.raises(RuntimeError, match="name must be a text, got 3"):
            extension.ops.vgroove.import_preset(filepath=str(path))
        with pytest.raises(RuntimeError, match="cannot be written"):
            extension.ops.vgroove.export_preset(filepath=str(path.parent / "nowhere" / "x.toml"))
    assert settings.preset == "mine/blue_car_paint"
    assert presets.find("mine/blue_car_paint").parameters == presets.find("car_paints/blue").parameters
    assert [found.name for found in own_folder.iterdir()] == ["blue_car_paint.toml"]


def test_a_folder_of_malformed_presets_does_not_keep_the_extension_from_registering(extension, own_folder):
    """The panel says why one is left out."""
    from vgroove.addon.library import presets
    from vgroove.addon.ui import panels

    for index, text in enumerate(("", "name = 3", "[[[", "\x00")):
        (own_folder / f"bad_{index}.toml").write_text(text, encoding="utf-8")
    presets.reread()
    vgroove.unregister()
    vgroove.register()
    assert "Preset skipped:" in " ".join(drawn(extension, panels.VGROOVE_PT_material).texts)


def test_the_source_recommends_a_roughness(extension):
    """As Blender's sliders have it: the square roots of the preset's slopes m."""
    from vgroove.addon.library.presets import all_presets
    from vgroove.addon.ui import panels

    preset = next(one for one in all_presets().values() if one.m_range)
    extension.context.scene.vgroove.preset = preset.id
    text = " ".join(drawn(extension, panels.VGROOVE_PT_source).texts)
    low, high = (f"{m**0.5:.2g}" for m in preset.m_range)
    assert f"Recommended roughness: {low} to {high}" in text


def test_a_citation_says_what_and_whence():
    from vgroove.addon.library.presets import find
    from vgroove.addon.ui import operators

    text = operators.citation(find("metals/gold"))
    assert text.startswith("Gold [metals/gold]: Johnson and Christy 1972: P. B. Johnson and R. W. Christy.")
    assert text.endswith("main/Au/nk/Johnson.yml (CC0-1.0).")
