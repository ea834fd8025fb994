# SPDX-License-Identifier: GPL-3.0-or-later
"""Bound lamps are followed: changed, hidden, deleted, copied with their scene, appended to another."""

from functools import partial
from math import pi

import pytest

from vgroove import headless
from vgroove.addon.blender import follow, lamps, material, roles
from vgroove.addon.blender.choice import lamps_to_bind
from vgroove.lab.check.cook_torrance import materials

from .lights import add_mesh, make_lamp

pytestmark = pytest.mark.blender


@pytest.fixture
def bound(blender):
    """A ball with a ``direct`` material bound to a sun; and a function that tells what the sun now gives."""
    stage = blender.context.scene
    sun = make_lamp(blender, "SUN", 'The "sun"')
    stage.collection.objects.link(sun)
    made = material.build(materials()["schlick"], material.Choice("nodes", "direct", lamps_to_bind(stage, "direct")))
    add_mesh(blender, stage, "Ball", 1.0, 0.0, made)
    return blender, stage, sun, made, partial(told, blender)


def told(bpy, entry="SUN 1"):
    """Strength and direction of a light as the scene's rig has them in a render."""
    bpy.context.view_layer.update()
    graph = bpy.context.evaluated_depsgraph_get()
    graph.update()
    rig = graph.scene_eval[lamps.RIG]
    return rig[f"{entry} color"][3], tuple(part / lamps.AXIS_SCALE for part in rig.get(f"{entry} axis", ()))


def test_a_bound_lamp_is_followed(bound):
    """Strength, exposure and direction follow; the drivers need no Python, so they run in any session."""
    _, stage, sun, made, strength = bound
    assert strength()[0] == pytest.approx(7.0 * 2**1.5, rel=1e-6)
    sun.data.energy, sun.data.exposure, sun.rotation_euler = 2.0, -1.0, (0.0, pi / 2, 0.0)
    level, axis = strength()
    assert level == pytest.approx(1.0, rel=1e-6)
    assert axis == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)
    assert all(curve.driver.is_simple_expression for curve in stage.animation_data.drivers)
    assert made.node_tree.animation_data is None


def test_a_hidden_lamp_gives_no_light_and_comes_back(bound):
    """Hidden in renders, by itself or by its collection's exclusion, it is dark."""
    blender, stage, sun, _, strength = bound
    sun.hide_render = True
    assert strength()[0] == 0.0
    sun.hide_render = False
    assert strength()[0] > 0.0
    group = blender.data.collections.new("Lamps")
    stage.collection.children.link(group)
    stage.collection.objects.unlink(sun)
    group.objects.link(sun)
    assert strength()[0] > 0.0
    blender.context.view_layer.layer_collection.children["Lamps"].exclude = True
    assert strength()[0] == 0.0


def test_an_unlinked_or_deleted_lamp_gives_no_light(bound):
    """A lamp that is in no scene is dark, and so is one that is gone."""
    blender, stage, sun, _, strength = bound
    stage.collection.objects.unlink(sun)
    assert strength()[0] == 0.0
    stage.collection.objects.link(sun)
    assert strength()[0] > 0.0
    blender.data.objects.remove(sun)
    assert strength()[0] == 0.0


def renamed(_bpy, _stage, sun):
    sun.name = "Key light"


def swapped(bpy, stage, sun):
    """Another light takes its name, as where two are swapped."""
    name, sun.name = sun.name, "Key light"
    other = make_lamp(bpy, "SUN", name)
    other.data.energy = 0.0
    stage.collection.objects.link(other)


def retyped(_bpy, _stage, sun):
    sun.data.type = "POINT"


def sized(_bpy, _stage, sun):
    sun.data.angle = 0.1


def unshadowed(_bpy, _stage, sun):
    sun.data.use_shadow = False


def hidden_from_glossy(_bpy, _stage, sun):
    sun.visible_glossy = False


CHANGES = {
    renamed: "SUN 1", swapped: "SUN 1", retyped: "POINT 1", sized: "SUN sized 1", unshadowed: "SUN unshadowed 1",
    hidden_from_glossy: None,
}  # fmt: skip


@pytest.mark.parametrize("change", CHANGES, ids=lambda of: of.__name__)
def test_a_light_that_is_no_longer_what_it_was_gives_nothing_until_it_is_followed_again(bound, change):
    """Never what it is not: a sun's drivers on a point would be 114 times too bright. Nothing is written twice."""
    blender, stage, sun, _, strength = bound
    level, _ = strength()
    change(blender, stage, sun)
    if change is not swapped:  # a light of its name is there, and the numbers are its own as before
        assert strength()[0] == 0.0
    again = lamps.follow(stage)
    mine = next((light for light in again if light.item == sun), None)
    assert (mine and str(mine.slot)) == CHANGES[change]
    if mine is None:
        return
    assert strength(CHANGES[change])[0] == pytest.approx(level, rel=1e-6)
    curves = list(stage.animation_data.drivers)
    assert lamps.follow(stage) == again
    assert list(stage.animation_data.drivers) == curves
    assert all(curve.driver.is_valid for curve in curves)


def test_a_full_copy_of_a_scene_has_lights_of_its_own(bound):
    """The copy's rig is driven by the copy's light."""
    blender, stage, sun, _, strength = bound
    with headless.quiet():
        blender.ops.scene.new(type="FULL_COPY")
    copy = blender.context.scene
    assert copy != stage
    lamps.follow(copy)
    (mine,) = lamps.rig_lights(copy)
    assert mine.item != sun
    mine.item.data.energy = 0.5
    assert strength()[0] == pytest.approx(0.5 * 2**1.5, rel=1e-6)
    blender.context.window.scene = stage
    assert strength()[0] == pytest.approx(7.0 * 2**1.5, rel=1e-6)


@pytest.fixture
def following():
    """The handlers of the extension."""
    follow.register()
    yield
    follow.unregister()


@pytest.mark.parametrize("change", CHANGES, ids=lambda of: of.__name__)
def test_while_the_extension_is_on_lights_are_followed(bound, following, change):
    """Whatever changes, the next update has it."""
    blender, stage, sun, _, strength = bound
    level, _ = strength()
    change(blender, stage, sun)
    blender.context.view_layer.update()
    if CHANGES[change] is None:
        assert list(stage[lamps.RIG].keys()) == [lamps.PLAN]
    else:
        assert strength(CHANGES[change])[0] == pytest.approx(level, rel=1e-6)


def test_while_the_extension_is_on_materials_ask_for_lights_that_come(bound, following):
    """A second sun and a point come: the material is rebuilt in place, with the artist's value."""
    blender, stage, _, made, strength = bound
    node = roles.node(made, roles.MODEL)
    node.inputs["Roughness"].default_value = 0.27
    for kind in ("SUN", "POINT"):
        stage.collection.objects.link(make_lamp(blender, kind, f"Late {kind}"))
    blender.context.view_layer.update()
    assert material.bound_slots(made) == {"SUN 1", "SUN 2", "POINT 1"}
    assert strength("POINT 1")[0] > 0
    assert roles.node(made, roles.MODEL).inputs["Roughness"].default_value == pytest.approx(0.27)
    assert stage.objects["Ball"].active_material == made


def test_handlers_leave_nothing_behind():
    """As many as before, once the extension is off."""
    import bpy

    names = ("depsgraph_update_post", *follow.HANDLERS)
    before = {name: list(getattr(bpy.app.handlers, name)) for name in names}
    follow.register()
    follow.unregister()
    assert {name: list(getattr(bpy.app.handlers, name)) for name in names} == before


def test_an_appended_material_brings_no_light_along_and_meets_those_of_its_new_scene(bound, tmp_path):
    """It holds no reference to any; in a scene without a rig its lights give nothing, with one its own do."""
    blender, _, _, made, _ = bound
    path, name = str(tmp_path / "from.blend"), made.name
    with headless.quiet():
        blender.ops.wm.save_as_mainfile(filepath=path)
        blender.ops.wm.read_factory_settings(use_empty=True)
    with blender.data.libraries.load(path) as (_source, wanted):
        wanted.materials = [name]
    stage = blender.context.scene
    add_mesh(blender, stage, "Ball", 1.0, 0.0, wanted.materials[0])
    assert not blender.data.lights
    assert not [item for item in blender.data.objects if item.type == "LIGHT"]
    sun = make_lamp(blender, "SUN", "Another sun")
    stage.collection.objects.link(sun)
    sun.data.energy = 0.5
    lamps.follow(stage)
    assert told(blender)[0] == pytest.approx(0.5 * 2**1.5, rel=1e-6)
