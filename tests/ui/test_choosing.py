# SPDX-License-Identifier: GPL-3.0-or-later
"""Choosing a preset in the panel: search, families, names in files, pictures."""

from types import SimpleNamespace

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import material

from .panel import drawn

pytestmark = pytest.mark.blender


def test_the_search_offers_what_it_finds(extension):
    """In all families, the best first; what is shown is one of the hits, and Apply applies it."""
    from vgroove.addon.ui import properties

    settings = extension.context.scene.vgroove
    assert (settings.family, settings.preset, settings.shown) == ("Metals", "metals/copper", "metals/copper")
    settings.search = "gold SATIN"
    gold, purple = "finished_metals/gold_satin", "finished_metals/purple_gold_aual2_satin"
    assert [preset.id for preset in properties.matching(settings)] == [gold, purple]
    assert [item[0] for item in properties.shown_items(settings, None)] == [gold, purple]
    assert settings.shown == settings.preset == gold
    settings.shown = purple
    settings.search = "purple"
    assert settings.preset == purple  # still a hit
    settings.search = ""
    assert settings.preset != purple  # the family Metals has it not
    settings.preset = "gems/diamond"
    assert (settings.shown, settings.family) == ("gems/diamond", "Gems")  # a script's choice stands, and is listed
    settings.search = "gold"
    settings.preset = "gems/ruby"
    assert (settings.shown, settings.family, settings.search) == ("gems/ruby", "Gems", "")


@pytest.fixture
def _preferences(extension, monkeypatch):
    """Preferences, as Blender gives them to what it knows as an extension."""
    from vgroove.addon.ui import memory

    kept = SimpleNamespace(favourites="", recent="", show_estimators=False)
    monkeypatch.setattr(memory, "preferences", lambda: kept)


@pytest.mark.usefixtures("_preferences")
def test_favourites_and_recent_ones_are_families(extension):
    """A star and Apply add to them; what is shown is always listed, and is what Apply applies."""
    from vgroove.addon.ui import properties

    settings, operators = extension.context.scene.vgroove, extension.ops.vgroove
    offered = [item[0] for item in properties.family_items(settings, None)]
    assert offered[:3] == [properties.ALL, properties.FAVOURITES, properties.RECENT]
    settings.family = properties.FAVOURITES
    assert properties.matching(settings) == []
    assert not operators.apply.poll()
    for identity in ("gems/diamond", "stone/slate", "metals/gold"):
        settings.preset = identity
        assert operators.favourite() == {"FINISHED"}
    settings.family = properties.FAVOURITES
    assert [one.id for one in properties.matching(settings)] == ["gems/diamond", "stone/slate", "metals/gold"]
    assert settings.shown == "metals/gold"
    operators.favourite()  # takes the star
    assert [one.id for one in properties.matching(settings)] == ["gems/diamond", "stone/slate"]
    assert settings.shown == "gems/diamond"
    for shown in ("stone/slate", "gems/diamond"):
        settings.shown = shown
        with headless.quiet():
            assert operators.apply() == {"FINISHED"}
        assert material.preset_of(extension.context.object.active_material).id == shown
    settings.family = properties.RECENT
    assert [one.id for one in properties.matching(settings)] == ["gems/diamond", "stone/slate"]
    settings.search = "slate"
    assert settings.shown == "stone/slate"
    with headless.quiet():
        operators.apply()
    assert material.preset_of(extension.context.object.active_material).id == "stone/slate"


def test_another_family_shows_one_of_its_own(extension):
    from vgroove.addon.ui import properties

    settings = extension.context.scene.vgroove
    settings.family = "Gems"
    assert settings.preset.startswith("gems/")
    settings.family = properties.ALL
    assert settings.preset.startswith("gems/")


def test_a_search_without_hits_applies_nothing(extension):
    """It says so, shows no picture, and Apply is refused in words."""
    from vgroove.addon.ui import panels, properties

    settings = extension.context.scene.vgroove
    settings.search = "no such thing"
    assert properties.matching(settings) == []
    told = drawn(extension, panels.VGROOVE_PT_material)
    assert "Nothing found" in " ".join(told.texts)
    assert not extension.ops.vgroove.apply.poll()
    settings.search = "scratched copper"
    count = len(properties.matching(settings))
    assert f"{count} found for copper" in " ".join(drawn(extension, panels.VGROOVE_PT_material).texts)
    settings.search = "copper"
    assert f"{count} found " in " ".join(drawn(extension, panels.VGROOVE_PT_material).texts)
    assert extension.ops.vgroove.apply.poll()


def test_what_is_chosen_is_kept_by_name(extension, tmp_path):
    """Through a saved file, whatever presets come or go; one that is not there gives the first."""
    from vgroove.addon.ui import properties

    extension.context.scene.vgroove.preset = "gems/diamond"
    with headless.quiet():
        extension.ops.wm.save_as_mainfile(filepath=str(tmp_path / "saved.blend"))
        extension.ops.wm.read_factory_settings(use_empty=True)
        extension.ops.wm.open_mainfile(filepath=str(tmp_path / "saved.blend"))
    settings = extension.context.scene.vgroove
    assert settings.shown == settings.preset == "gems/diamond"
    settings.preset = "mine/lost"
    assert settings.shown == properties.chosen_preset(settings).id == "metals/copper"


def test_a_click_on_a_picture_chooses_its_preset(extension):
    """A button of the grid writes the number of its choice, which it holds as float32."""
    from vgroove.addon.ui import properties

    settings = extension.context.scene.vgroove
    settings.family = properties.ALL
    for identity, *_, number in list(properties.shown_items(settings, None)):
        properties._set_shown(settings, int(np.float32(number)))
        assert settings.preset == identity
    assert all(int(np.float32(number)) == number for *_, number in properties.family_items(None, None))


def test_pictures_are_read_when_they_are_drawn(extension, tmp_path, monkeypatch):
    """Each once, a little later; one that is not there leaves no icon. (Without a window no icon has a number.)"""
    from vgroove.addon.library.presets import find
    from vgroove.addon.ui import panels, thumbnails

    assert {kind.bl_space_type for kind in panels._Picker.__subclasses__()} == set(thumbnails.SHOWN_IN)
    monkeypatch.setattr(thumbnails, "FOLDER", tmp_path)
    (pictures,) = thumbnails._pictures
    assert thumbnails.icon(find("gems/diamond")) == 0
    assert not pictures
    (tmp_path / "gems").mkdir()
    image = extension.data.images.new("Picture", 8, 8)
    image.file_format, image.filepath_raw = "WEBP", str(tmp_path / "gems" / "diamond.webp")
    image.save()
    for _ in range(2):
        thumbnails.icon(find("gems/diamond"))
    assert set(pictures) == {"gems/diamond"}
    assert thumbnails._waiting == ["gems/diamond"]
    assert extension.app.timers.is_registered(thumbnails._read_some)
    assert thumbnails._read_some() is None  # as Blender's timer does, when it has time
    assert not thumbnails._waiting
    assert min(pictures["gems/diamond"].image_size) >= 8
    thumbnails.icon(find("gems/diamond"))
    assert not thumbnails._waiting
