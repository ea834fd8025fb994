# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets given to named objects and slots, as the command line and batches do."""

import pytest

from vgroove.addon.library import presets
from vgroove.headless import assignment
from vgroove.headless.scene import SceneError

pytestmark = pytest.mark.blender

COPPER, ALUMINIUM = presets.find("lecture/copper"), presets.find("lecture/aluminium")


@pytest.fixture
def stage(blender):
    """A scene with Ball, whose mesh has the slots body, trim and an empty one."""
    mesh = blender.data.meshes.new("Ball")
    for name in ("body", "trim"):
        mesh.materials.append(blender.data.materials.new(name))
    mesh.materials.append(None)
    blender.context.scene.collection.objects.link(blender.data.objects.new("Ball", mesh))
    return blender.context.scene


def add(stage, name, mesh):
    import bpy

    item = bpy.data.objects.new(name, mesh)
    stage.collection.objects.link(item)
    return item


def give(stage, *given, **more):
    """What is said of slots."""
    said = assignment.assign(stage, given, "nodes", "closure", 0.005, where="--assign ", **more)
    return [text for text in said if "slot" in text]


def names(item):
    return [slot.name for slot in item.material_slots]


def test_objects_that_share_a_mesh_get_a_material_each(stage):
    """With slots or without; who was not named keeps what it had."""
    import bpy

    bare = bpy.data.meshes.new("Bare")
    first, second, third = (add(stage, name, bare) for name in "ABC")
    assert give(stage, ("A", COPPER), ("B", ALUMINIUM)) == []
    assert [names(item) for item in (first, second, third)] == [["Copper"], ["Aluminium"], [""]]
    twin = add(stage, "Twin", stage.objects["Ball"].data)
    give(stage, ("Ball", COPPER), ("Twin:trim", ALUMINIUM))
    assert names(stage.objects["Ball"]) == ["Copper", "trim", ""]
    assert names(twin) == ["body", "Aluminium", ""]


def test_slots_are_named_by_material_or_number(stage):
    """From 1; an exact name of an object comes first, and what stays open is said."""
    ball = stage.objects["Ball"]
    assert give(stage, ("Ball:trim", COPPER), ("Ball:3", ALUMINIUM)) == []
    assert names(ball) == ["body", "Copper", "Aluminium"]
    (text,) = give(stage, ("Ball", COPPER))
    assert text == (
        "Ball has 3 slots (1 body, 2 Copper, 3 Aluminium); slot 1 gets the material. Name another one as Ball:SLOT"
    )
    import bpy

    exact = add(stage, "Ball:2", bpy.data.meshes.new("Exact"))
    give(stage, ("Ball:2", ALUMINIUM))
    assert names(exact) == ["Aluminium"]
    assert names(ball) == ["Copper", "Copper", "Aluminium"]


@pytest.mark.parametrize("name", ["Ball:lid", "Ball:0", "Ball:4", "Ball:²"])
def test_a_slot_that_is_not_there_is_refused(stage, name):
    """With those that there are; nothing is given."""
    with pytest.raises(SceneError, match=r'--assign ".*": Ball has no slot ".+"; it has 1 body, 2 trim, 3 \(empty\)'):
        give(stage, (name, COPPER))


def test_what_cannot_have_a_material_is_refused(stage):
    """A light, by its own words; an unknown name, with the objects that there are."""
    import bpy

    add(stage, "Lamp", bpy.data.lights.new("Lamp", "POINT"))
    with pytest.raises(SceneError, match=r'"Lamp=lecture/copper": Lamp \(light\) cannot have a material'):
        give(stage, ("Lamp", COPPER))
    with pytest.raises(SceneError, match="the scene has no object of that name; it has Ball"):
        give(stage, ("Boll:trim", COPPER))


def test_the_next_task_finds_its_slot_again(stage):
    """A batch's materials become those of the next task, also where a slot was named by the material that it had."""
    into = {}
    for preset in (COPPER, ALUMINIUM):
        give(stage, ("Ball:trim", preset), into=into)
        assert names(stage.objects["Ball"]) == ["body", preset.name, ""]
    assert len(into) == 1
