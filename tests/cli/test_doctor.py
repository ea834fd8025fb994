# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove doctor``: each kind of trouble is listed, mended where it can be, and nothing is said of a sound file."""

import json
from dataclasses import replace
from pathlib import Path

import bpy
import pytest

from vgroove import headless, nodegroups
from vgroove.addon.blender import material, origin, roles
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.nodegroups import fit_table, versions

from ..commands import patient

pytestmark = pytest.mark.blender
DATA = Path(__file__).parents[1] / "data"
COPPER = presets.find("lecture/copper")


def ball(made, name="Ball"):
    """An object with a material, in the scene."""
    item = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    item.data.materials.append(made)
    bpy.context.scene.collection.objects.link(item)
    return item


def light(name="Lamp"):
    item = bpy.data.objects.new(name, bpy.data.lights.new(name, "POINT"))
    item.location = (0.0, 0.0, 3.0)
    bpy.context.scene.collection.objects.link(item)
    bpy.context.view_layer.update()
    return item


def save(line, name="sick.blend"):
    bpy.context.scene.render.engine = "CYCLES"
    with headless.quiet():
        bpy.ops.wm.save_as_mainfile(filepath=str(line.folder / name))


def examined(*arguments, code):
    said = patient("doctor", *arguments, "--json")
    assert said.code == code, said
    return json.loads(said.out.splitlines()[-1])  # in this process Blender's own lines come before it


def keys(answer):
    return sorted(problem["key"] for problem in answer["problems"])


@pytest.fixture
def sick(line, blender):
    return line


def test_nothing_is_said_of_a_sound_file(sick):
    """By each estimator, with a light; the file stays as it was."""
    lamp = light()
    for estimator in ("fit", "closure", "corrected", "mirror"):
        bound = material.lamps_to_bind(bpy.context.scene, estimator, COPPER.model)
        ball(build(COPPER, Choice("nodes", estimator, bound)).copy(), estimator)
    assert lamp.name in bpy.context.scene.objects
    save(sick)
    before = (sick.folder / "sick.blend").read_bytes()
    assert examined("sick.blend", code=0) == {"problems": [], "mended": [], "said": []}
    assert (sick.folder / "sick.blend").read_bytes() == before


def test_an_older_revision_is_listed_and_mended(sick):
    """What is edited stays; the copy has today's group and nothing is left to say of it."""
    made = build(COPPER, Choice("nodes", "fit"))
    ball(made)
    node = roles.node(made, roles.MODEL)
    node.node_tree[nodegroups.REVISION_KEY] -= 1
    nodegroups.inputs(node)["Roughness"].default_value = 0.7
    save(sick)
    answer = examined("sick.blend", code=1)
    assert keys(answer) == ["revision Copper"]
    assert answer["problems"][0]["fixable"]
    assert len(examined("sick.blend", "--mend", "-o", "well.blend", code=0)["mended"]) == 1
    assert examined("well.blend", code=0)["problems"] == []
    made = bpy.data.materials["Copper"]
    assert nodegroups.inputs(roles.node(made, roles.MODEL))["Roughness"].default_value == pytest.approx(0.7)


def test_every_material_of_the_first_format_is_mended(line):
    """All of the fixture, whatever they are; what could not be kept is said."""
    answer = examined(DATA / "format_1.blend", code=1)
    old = [key for key in keys(answer) if key.startswith("format ")]
    assert len(old) == 23
    after = examined(DATA / "format_1.blend", "--mend", "-o", "well.blend", code=0)
    assert len(after["mended"]) >= 23
    assert examined("well.blend", code=0)["problems"] == []


def test_materials_of_another_blender_are_mended(line):
    file = DATA / ("until_5_2.blend" if versions.since(5, 3) else "since_5_3.blend")
    assert "cycles" in keys(examined(file, code=1))
    said = patient("doctor", file, "--mend", "-o", "well.blend", "--json")
    assert "cycles" not in keys(json.loads(said.out.splitlines()[-1]))


def test_lights_that_came_and_went_are_mended(sick):
    """A term for a light that was deleted, and a light that no term is for."""
    lamp = light("Old")
    made = build(
        COPPER, Choice("nodes", "corrected", material.lamps_to_bind(bpy.context.scene, "corrected", COPPER.model))
    )
    ball(made)
    bpy.data.objects.remove(lamp)
    save(sick)
    assert keys(examined("sick.blend", code=1)) == ["gone Copper"]
    examined("sick.blend", "--mend", "-o", "well.blend", code=0)
    assert not material.bound_slots(bpy.data.materials["Copper"])
    light("New")
    save(sick, "newer.blend")
    assert keys(examined("newer.blend", code=1)) == ["stale Copper"]
    examined("newer.blend", "--mend", "-o", "well.blend", code=0)


def test_a_deleted_group_and_table_are_mended(sick):
    """Blender keeps the node, empty; the table's image is made again."""
    ball(build(COPPER, Choice("nodes", "fit")))
    bpy.data.images.remove(fit_table.TABLE.find())
    save(sick)
    assert keys(examined("sick.blend", code=1)) == ["table"]
    examined("sick.blend", "--mend", "-o", "well.blend", code=0)
    bpy.data.node_groups.remove(roles.node(bpy.data.materials["Copper"], roles.MODEL).node_tree)
    save(sick)
    assert keys(examined("sick.blend", code=1)) == ["lost Copper"]
    assert "had been deleted" in examined("sick.blend", "--mend", "-o", "well.blend", code=0)["said"][0]


def test_what_cannot_be_mended_is_left_and_said(sick):
    """An image that is nowhere, a record of a later version, a preset with other numbers; the exit code stays 1."""
    lost, later, changed = (build(COPPER, Choice("nodes", "closure")).copy() for _ in range(3))
    for name, made in zip(("Lost", "Later", "Changed"), (lost, later, changed), strict=True):
        made.name = name
        ball(made, name)
    node = lost.node_tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new("Map", 4, 4)
    node.image.source, node.image.filepath = "FILE", "//nowhere.png"
    later[roles.KEY] = later[roles.KEY].replace(f'"format": {origin.FORMAT}', '"format": 999')
    record = origin.read(changed)
    numbers = record.preset.parameters | {"m": 0.123}
    preset = replace(record.preset, parameters=numbers, verified={"checked": 1.0})
    origin.write(changed, replace(record, preset=preset))
    save(sick)
    wanted = ["image Lost Map", "preset Changed", "unknown Later"]
    assert keys(examined("sick.blend", code=1)) == wanted
    assert keys(examined("sick.blend", "--mend", "-o", "well.blend", code=1)) == wanted


def test_numbers_that_somebody_chose_are_no_changed_preset(sick):
    """As `--set` and the panel choose them."""
    ball(build(COPPER.with_parameters(m=0.4), Choice("nodes", "closure")))
    save(sick)
    examined("sick.blend", code=0)


def test_lines_say_what_can_be_fixed(sick):
    made = build(COPPER, Choice("nodes", "closure"))
    ball(made)
    roles.node(made, roles.MODEL).node_tree[nodegroups.REVISION_KEY] -= 1
    save(sick)
    said = patient("doctor", "sick.blend")
    assert said.code == 1
    assert said.out == "can be fixed: Copper has node groups of an earlier version; it renders as it did then\n"


def test_bad_requests_are_refused(line):
    (line.folder / "text.blend").write_text("no scene", encoding="utf-8")
    assert "no such scene" in line.refuses("doctor", "none.blend")
    assert "cannot be opened" in line.refuses("doctor", "text.blend")
    assert "go together" in line.refuses("doctor", "text.blend", "--mend")
    assert "is a .blend" in line.refuses("doctor", "text.blend", "--mend", "-o", "x.png")
