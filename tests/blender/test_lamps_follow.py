# SPDX-License-Identifier: GPL-3.0-or-later
"""Bound lamps are followed: changed, hidden, deleted, copied with their scene, appended to another."""

from math import pi

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import follow, gonio, lamps, material, roles
from vgroove.addon.blender.choice import lamps_to_bind
from vgroove.addon.choose import advice
from vgroove.lab.check.cook_torrance import materials
from vgroove.nodegroups import versions

from .lights import add_mesh, make_lamp

pytestmark = pytest.mark.blender


@pytest.fixture
def bound(blender, request):
    """A ball with a ``direct`` material bound to a sun, or a lamp of the kind that a test asks for; and a function that
    tells what it now gives."""
    stage = blender.context.scene
    sun = make_lamp(blender, getattr(request, "param", "SUN"), 'The "sun"')
    stage.collection.objects.link(sun)
    made = material.build(materials()["schlick"], material.Choice("nodes", "direct", lamps_to_bind(stage, "direct")))
    add_mesh(blender, stage, "Ball", 1.0, 0.0, made)
    (entry,) = material.bound_slots(made)
    return blender, stage, sun, made, lambda of=entry: told(blender, of)


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


def light_linked(bpy, _stage, sun):
    sun.light_linking.receiver_collection = bpy.data.collections.new("Lit")


def shadow_linked(bpy, _stage, sun):
    sun.light_linking.blocker_collection = bpy.data.collections.new("Blockers")


def made_a_portal(_bpy, _stage, area):
    area.data.cycles.is_portal = True
    area.data.update_tag()  # as Blender does when an artist clicks it


def emission_of(sun):
    tree = versions.nodes_of(sun.data)
    return tree, next(node for node in tree.nodes if node.bl_idname == "ShaderNodeEmission")


def dimmed_by_nodes(_bpy, _stage, sun):
    emission_of(sun)[1].inputs["Strength"].default_value = 0.3


def coloured_by_nodes(_bpy, _stage, sun):
    emission_of(sun)[1].inputs["Color"].default_value = (0.1, 0.5, 1.0, 1.0)


def textured(_bpy, _stage, sun):
    tree, emission = emission_of(sun)
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], emission.inputs["Strength"])


def unplugged(_bpy, _stage, sun):
    tree, _ = emission_of(sun)
    tree.links.clear()


def muted(_bpy, _stage, sun):
    emission_of(sun)[1].mute = True


CHANGES = {
    renamed: "SUN 1", swapped: "SUN 1", retyped: "POINT 1", sized: "SUN sized 1", unshadowed: "SUN unshadowed 1",
    hidden_from_glossy: None, light_linked: None, shadow_linked: None, made_a_portal: None, dimmed_by_nodes: None,
    coloured_by_nodes: None, textured: None, unplugged: None, muted: None,
}  # fmt: skip
# No driver sees these, or, of a swap, sees numbers as they were.
SEEN_BY_FOLLOWING = {swapped, dimmed_by_nodes, coloured_by_nodes, textured, unplugged, muted}
KIND_OF = {made_a_portal: "AREA"}
each_change = pytest.mark.parametrize(
    ("bound", "change"),
    [(KIND_OF.get(change, "SUN"), change) for change in CHANGES],
    ids=[change.__name__ for change in CHANGES],
    indirect=["bound"],
)


@each_change
def test_a_light_that_is_no_longer_what_it_was_gives_nothing_until_it_is_followed_again(bound, change):
    """Never what it is not: a sun's drivers on a point would be 114 times too bright. Nothing is written twice."""
    blender, stage, sun, _, strength = bound
    level, _ = strength()
    change(blender, stage, sun)
    if change not in SEEN_BY_FOLLOWING:
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


@each_change
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


@pytest.mark.parametrize("estimator", ["direct", "corrected"])
@pytest.mark.parametrize("change", CHANGES, ids=lambda of: of.__name__)
def test_a_changed_light_is_rendered_as_by_a_material_made_anew(blender, following, change, estimator):
    """A light that the formula no longer takes is left out by ``direct``, and ``corrected`` is ``fit`` there; the
    advice says so, but for a portal, which emits nothing."""
    preset, refused = materials()["schlick"], CHANGES[change] is None
    with headless.quiet(), gonio.stage((16, 16), samples=4, seed=0, shading_osl=False) as stage:
        lamp = make_lamp(blender, KIND_OF.get(change, "SUN"))
        stage.collection.objects.link(lamp)
        stage.view_layers[0].update()
        made = material.build(preset, material.Choice("nodes", estimator, lamps_to_bind(stage, estimator)))
        floor = add_mesh(blender, stage, "Floor", 1.0, 0.0, made)
        gonio.look_down(stage, 2.0, (0, 0, 5))
        assert gonio.rendered(stage).max() > 0.1
        stage.view_layers[0].update()  # so that the next update has the change alone
        change(blender, stage, lamp)
        stage.view_layers[0].update()
        found = gonio.rendered(stage)
        name, said = lamp.name, [one.text for one in advice.problems(stage, "nodes", estimator) if one.key == "refused"]
        blender.data.materials.remove(made)
        lights = lamps_to_bind(stage, estimator)
        choice = material.Choice("nodes", estimator, lights)
        if refused:
            assert lights == ()
            choice = material.Choice("nodes", "direct" if estimator == "direct" else "fit")
        floor.data.materials[0] = material.build(preset, choice)
        wanted = gonio.rendered(stage)
    assert any(name in text for text in said) == (refused and change is not made_a_portal)
    # Emission closures round when they are added: four sums of 6e-8, as in test_lamps.py; black is black.
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=4e-7 * wanted.max())


def test_a_light_comes_back_when_its_linking_is_cleared(bound, following):
    """By the deletion of the collection too."""
    blender, _, sun, _, strength = bound
    level, _ = strength()
    for clear in (lambda: setattr(sun.light_linking, "receiver_collection", None),
                  lambda: blender.data.collections.remove(sun.light_linking.receiver_collection)):  # fmt: skip
        sun.light_linking.receiver_collection = blender.data.collections.new("Lit")
        blender.context.view_layer.update()
        assert list(blender.context.scene[lamps.RIG].keys()) == [lamps.PLAN]
        clear()
        assert strength()[0] == level


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


def test_a_material_in_two_scenes_has_the_lights_of_both(bound):
    """A ball that is linked into a second scene, lit by a point, shows each scene's light in its render."""
    blender, stage, _, made, strength = bound
    other = blender.data.scenes.new("Other")
    other.collection.objects.link(stage.objects["Ball"])
    other.collection.objects.link(make_lamp(blender, "POINT", "Bulb"))
    for scene in (other, stage, other):
        follow.refresh(scene)
        assert material.bound_slots(made) == {"SUN 1", "POINT 1"}
    assert strength()[0] > 0.0
    blender.context.window.scene = other
    assert strength("POINT 1")[0] > 0.0
    assert "SUN 1 color" not in other[lamps.RIG]


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
