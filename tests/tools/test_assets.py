# SPDX-License-Identifier: GPL-3.0-or-later
"""The asset library: every preset in its catalog, appended as it was built."""

import subprocess
import sys
import uuid
from collections import defaultdict
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from vgroove.addon.blender.material import Choice, build, origin_of, plays
from vgroove.addon.blender.roles import KEY
from vgroove.addon.choose import automatic
from vgroove.addon.library import families
from vgroove.addon.library.presets import shipped
from vgroove.nodegroups import fit_table, versions

pytestmark = pytest.mark.blender

TOOL = Path(__file__).parents[2] / "tools" / "assets.py"


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The .blend, written by the command."""
    folder = tmp_path_factory.mktemp("assets")
    subprocess.run([sys.executable, str(TOOL), str(folder)], check=True)
    return next(folder.glob("*/vgroove.blend"))


def append_all(library):
    """All materials, by the id of the preset that each was built from."""
    with bpy.data.libraries.load(str(library), link=False, assets_only=True) as (there, here):
        here.materials = there.materials
    return {origin_of(material).preset.id: material for material in here.materials}


def as_said(material):
    """What the test of an asset asks for, as it must outlive the file."""
    data = material.asset_data
    words = ("author", "license", "description", "catalog_id", "use_preferred_import_method", "preferred_import_method")
    told = {word: getattr(data, word, None) for word in words}
    return SimpleNamespace(name=material.name, plays=plays(material), tags=set(data.tags.keys()), **told)


@pytest.fixture(scope="module")
def assets(library):
    """What each asset says, by preset, and how many actions all bring: appended once, as that takes long."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
    return {identity: as_said(material) for identity, material in append_all(library).items()}, len(bpy.data.actions)


def test_every_preset_is_an_asset_that_says_what_it_is(assets):
    """Catalog, tags, author, licence, description, all users kept; in 5.2 appended, as packed ones cannot be edited."""
    found, _ = assets
    assert set(found) == set(shipped())
    assert len({asset.name for asset in found.values()}) == len(found)
    for identity, asset in found.items():
        preset = shipped()[identity]
        assert set(preset.tags) <= asset.tags
        assert asset.author
        assert asset.license == "GPL-3.0-or-later"
        assert preset.source["data"][:100] in asset.description
        if versions.since(5, 0):
            assert asset.use_preferred_import_method
            assert asset.preferred_import_method == "APPEND"


def test_catalogs_are_the_families_and_keep_their_ids(assets, library):
    """Ids are pinned: a catalog with another id would leave materials that people have sorted."""
    lines = library.with_name("blender_assets.cats.txt").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "VERSION 1"
    entries = {path: uuid.UUID(identity) for identity, path, _ in (line.split(":") for line in lines if ":" in line)}
    assert len(entries) == 1 + len(families.TITLES)
    assert entries["V-Groove"] == uuid.UUID("5b1c3a0e-6f0d-4d53-9b3e-0d3b8f3a7c11")
    assert entries["V-Groove/Metals"] == uuid.UUID("a5fc2f08-a3a4-5c52-a5b2-8bb2ea57ab0b")
    assert entries["V-Groove/Brushed and Finished Metals"] == uuid.UUID("db7bb55d-0e6f-5d34-a87a-d221678ee9c6")
    for identity, asset in assets[0].items():
        assert uuid.UUID(asset.catalog_id) == entries[f"V-Groove/{families.title(identity)}"]


def test_assets_that_change_bring_their_course(assets):
    """F-curves that move the inputs; those that stand still bring no action."""
    found, actions = assets
    assert actions == sum(preset.time is not None for preset in shipped().values())
    for identity, asset in found.items():
        assert asset.plays == (shipped()[identity].time is not None), identity


def test_appended_materials_render_as_those_built_directly(balls, blender, library):
    """To the last digit: the same nodes with the same numbers, in an empty file. Of each family one of every kind."""
    members = defaultdict(dict)
    for preset in shipped().values():
        members[preset.family].setdefault((preset.model, preset.kind, automatic.pick_estimator(None, preset)), preset)

    def pictures(made):
        return {name: balls(partial(made, of.values()), lit="above", samples=1) for name, of in members.items()}

    direct = pictures(lambda of, _: [build(p, Choice("nodes", automatic.pick_estimator(None, p))) for p in of])
    blender.ops.wm.read_factory_settings(use_empty=True)
    found = append_all(library)
    for name, again in pictures(lambda of, _: [found[preset.id] for preset in of]).items():
        np.testing.assert_array_equal(again, direct[name], err_msg=name)
        assert direct[name].std(axis=1).min() > 0.0


def test_assets_bring_no_more_than_they_need(blender, library):
    """One material appended brings its groups and their table, and building the same preset gives that one."""
    preset = shipped()["metals/gold"]
    with blender.data.libraries.load(str(library), link=False) as (_, here):
        here.materials = [preset.name]
    (material,) = here.materials
    assert material[KEY]
    assert len(blender.data.materials) == 1
    assert not blender.data.objects
    assert [image.name for image in blender.data.images] == [fit_table.TABLE.name]
    assert build(preset, Choice("nodes", "fit")) is material
