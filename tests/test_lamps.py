# SPDX-License-Identifier: GPL-3.0-or-later
"""``direct`` follows its lamps: what they send, where they go, and when they give nothing."""

from functools import partial
from math import pi

import numpy as np
import pytest

from vgroove import nodegroups
from vgroove.addon import check, gonio, headless, lamps, material, scene
from vgroove.nodegroups import lamp as lamp_group

pytestmark = pytest.mark.blender

KINDS = ("SUN", "POINT", "SPOT")


def make_lamp(bpy, kind, name="Lamp"):
    """A lamp off the axis whose every followed setting differs from its default."""
    light = bpy.data.lights.new(name, kind)
    light.energy, light.color, light.exposure = 7.0, (1.0, 0.5, 0.2), 1.5
    light.use_temperature, light.temperature = True, 3000.0
    if kind == "SUN":
        light.angle = 0.0
    else:
        light.shadow_soft_size = 0.0
    if kind == "SPOT":
        light.spot_size, light.spot_blend = 1.2, 0.4
    item = bpy.data.objects.new(name, light)
    item.location, item.rotation_euler = (0.7, -0.4, 1.5), (0.5, 0.3, 0.2)
    return item


def irradiance_material(empty_material, item, backend, *, shadows):
    """Emission of the lamp group's irradiance times the cosine."""
    made = empty_material("Irradiance")
    tree = made.node_tree
    build = lamp_group.build if backend == "nodes" else lamp_group.build_osl
    kind = item.data.type
    name = lamp_group.name(kind, shadows=shadows) + backend
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = nodegroups.ensure(name, 1, partial(build, kind=kind, shadows=shadows))
    lamps.bind(node, item)
    geometry, cosine, positive, emission, output = (
        tree.nodes.new(f"ShaderNode{name}")
        for name in ("NewGeometry", "VectorMath", "Math", "Emission", "OutputMaterial")
    )
    cosine.operation, positive.operation, positive.inputs[1].default_value = "DOT_PRODUCT", "MAXIMUM", 0.0
    tree.links.new(geometry.outputs["Normal"], cosine.inputs[0])
    tree.links.new(node.outputs["To Lamp"], cosine.inputs[1])
    tree.links.new(cosine.outputs["Value"], positive.inputs[0])
    tree.links.new(positive.outputs[0], emission.inputs["Strength"])
    tree.links.new(node.outputs["Irradiance"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return made


def white_diffuse(empty_material):
    made = empty_material("White")
    tree = made.node_tree
    diffuse, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    diffuse.inputs["Color"].default_value = (1, 1, 1, 1)
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return made


def add_mesh(bpy, stage, name, half, height, made=None):
    """One triangle that covers the square of half width ``half``.

    Where a shadow ray starts exactly on the edge of two triangles the Raycast node sees the second one and nothing
    behind it, so such a pixel is lit; a floor of two triangles would have a diagonal of them.
    """
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(-3 * half, -half, height), (3 * half, -half, height), (0, 5 * half, height)], [], [(0, 1, 2)])
    if made:
        mesh.materials.append(made)
    item = bpy.data.objects.new(name, mesh)
    stage.collection.objects.link(item)
    return item


def floor_image(bpy, make_material, kind, *, shading_osl, occluder=False):
    """Radiance of a floor 4 m wide, seen from above, lit by one lamp, without bounces."""
    with headless.quiet(), gonio.stage((64, 64), samples=1, seed=0, shading_osl=shading_osl) as stage:
        stage.cycles.max_bounces = 0
        gonio.light(stage, gonio.Geometry())
        bpy.data.objects.remove(stage.objects[0])
        item = make_lamp(bpy, kind)
        stage.collection.objects.link(item)
        add_mesh(bpy, stage, "Floor", 3.0, 0.0, make_material(item))
        if occluder:
            add_mesh(bpy, stage, "Occluder", 0.3, 0.7).visible_camera = False
        camera = bpy.data.cameras.new("Camera")
        camera.type, camera.ortho_scale = "ORTHO", 4.0
        eye = bpy.data.objects.new("Camera", camera)
        eye.location = (0, 0, 5)
        stage.collection.objects.link(eye)
        stage.camera = eye
        return gonio.rendered(stage).astype(float)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("setup", check.SETUPS, ids=str)
def test_a_lamp_group_sends_what_cycles_own_lamp_sends(blender, empty_material, kind, setup):
    """Colour, temperature, exposure, strength, distance and cone agree with a white diffuse floor times pi."""
    cycles = pi * floor_image(blender, lambda _: white_diffuse(empty_material), kind, shading_osl=setup.shading_osl)
    ours = floor_image(
        blender,
        lambda item: irradiance_material(empty_material, item, setup.backend, shadows=False),
        kind,
        shading_osl=setup.shading_osl,
    )
    assert cycles.max() > 0.1
    # About 40 float32 operations of 6e-8 in either; the spot's edge multiplies one rounding by 1/blend, a dozen times.
    np.testing.assert_allclose(ours, cycles, atol=5e-6 * cycles.max())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("setup", check.SETUPS, ids=str)
def test_a_lamp_group_casts_the_shadow_of_cycles_own_lamp(blender, empty_material, kind, setup):
    """Behind an occluder both are dark in the same pixels; on 4.5 nodes cast none, and the panel says so."""
    traced = setup.backend == "osl" or lamp_group.can_cast_shadows()
    cycles = pi * floor_image(
        blender, lambda _: white_diffuse(empty_material), kind, shading_osl=setup.shading_osl, occluder=True
    )
    ours = floor_image(
        blender,
        lambda item: irradiance_material(empty_material, item, setup.backend, shadows=traced),
        kind,
        shading_osl=setup.shading_osl,
        occluder=True,
    )
    dark = (cycles.max(-1) == 0) & (ours.max(-1) > 0)
    if not traced:
        blender.context.scene.render.engine = "CYCLES"
        found = scene.problems(blender.context.scene, "nodes", "direct")
        assert any(problem.key == "shadows" for problem in found)
        assert dark.any()
        return
    assert (cycles.max(-1) == 0).sum() > 50
    np.testing.assert_allclose(ours, cycles, atol=5e-6 * cycles.max())


@pytest.fixture
def bound(blender):
    """A ball with a ``direct`` material bound to a sun; and a function that tells what the sun now gives."""
    stage = blender.context.scene
    sun = make_lamp(blender, "SUN", 'The "sun"')
    stage.collection.objects.link(sun)
    made = material.build(check.materials()["schlick"], material.Choice("nodes", "direct", (sun,)))
    ball = add_mesh(blender, stage, "Ball", 1.0, 0.0, made)

    def strength():
        blender.context.view_layer.update()
        graph = blender.context.evaluated_depsgraph_get()
        graph.update()
        tree = ball.evaluated_get(graph).data.materials[0].node_tree
        node = next(node for node in tree.nodes if node.label.startswith("Lamp 1"))
        return node.inputs["Strength"].default_value, tuple(node.inputs["Axis"].default_value)

    return blender, stage, sun, made, strength


def test_a_bound_lamp_is_followed(bound):
    """Strength, exposure and direction follow; the drivers need no Python, so they run in any session."""
    _, _, sun, made, strength = bound
    assert strength()[0] == pytest.approx(7.0 * 2**1.5, rel=1e-6)
    sun.data.energy, sun.data.exposure, sun.rotation_euler = 2.0, -1.0, (0.0, pi / 2, 0.0)
    level, axis = strength()
    assert level == pytest.approx(1.0, rel=1e-6)
    assert axis == pytest.approx((1.0, 0.0, 0.0), abs=1e-6)
    drivers = made.node_tree.animation_data.drivers
    assert all(curve.driver.is_simple_expression for curve in drivers)


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


def test_an_appended_ghost_lamp_gives_no_light(bound, tmp_path):
    """A material appended into another file brings its lamp along in no scene; it must not shine."""
    blender, _, sun, made, strength = bound
    assert strength()[0] > 0.0
    path, name, lamp_name = str(tmp_path / "from.blend"), made.name, sun.name
    with headless.quiet():
        blender.ops.wm.save_as_mainfile(filepath=path)
        blender.ops.wm.read_factory_settings(use_empty=True)
    with blender.data.libraries.load(path) as (_source, wanted):
        wanted.materials = [name]
    appended = wanted.materials[0]
    ball = add_mesh(blender, blender.context.scene, "Ball", 1.0, 0.0, appended)
    assert lamp_name in blender.data.objects  # the ghost
    graph = blender.context.evaluated_depsgraph_get()
    graph.update()
    node = next(n for n in ball.evaluated_get(graph).data.materials[0].node_tree.nodes if n.label.startswith("Lamp 1"))
    assert node.inputs["Strength"].default_value == 0.0


def test_what_cannot_be_followed_is_refused_in_one_line(blender, empty_material):
    """Area lamps, lamps with nodes, light linking and uneven spots are named with a way out."""
    stage = blender.context.scene
    area = blender.data.objects.new("Area", blender.data.lights.new("Area", "AREA"))
    spot, sun = make_lamp(blender, "SPOT", "Spot"), make_lamp(blender, "SUN", "Sun")
    for item in (area, spot, sun):
        stage.collection.objects.link(item)
    spot.scale = (1.0, 2.0, 1.0)
    if blender.app.version < (5, 0, 0):
        sun.data.use_nodes = True
    tree = sun.data.node_tree
    tree.nodes.new("ShaderNodeTexNoise")
    blender.context.view_layer.update()
    for item, word in ((area, "area lamp"), (spot, "scaled unevenly"), (sun, "node tree")):
        refused = lamps.refusal(item)
        assert word in refused
        assert f'"{item.name}"' in refused
        assert "\n" not in refused
        with pytest.raises(material.MaterialError, match=word):
            material.Choice("nodes", "direct", (item,))
    assert scene.lamps_to_bind(stage, "direct") == ()


def test_at_most_four_lamps_are_bound_the_strongest_first(blender):
    """A fifth is left out, and the advice says which."""
    stage = blender.context.scene
    stage.render.engine = "CYCLES"
    for index in range(6):
        item = make_lamp(blender, "SUN", f"Sun {index}")
        item.data.energy = 1.0 + index
        stage.collection.objects.link(item)
    taken = scene.lamps_to_bind(stage, "direct")
    assert [item.name for item in taken] == ["Sun 5", "Sun 4", "Sun 3", "Sun 2"]
    advice = next(p for p in scene.problems(stage, "nodes", "direct") if p.key == "limit")
    assert "Sun 1, Sun 0" in advice.text
    with pytest.raises(material.MaterialError, match="at most 4"):
        material.Choice("nodes", "direct", tuple(stage.objects)[:5])


@pytest.mark.parametrize("setup", check.SETUPS, ids=str)
def test_four_lamps_add_up(blender, setup):
    """The radiance of a ball under four lamps is the sum under each alone."""
    images = []
    for chosen in ([0], [1], [2], [3], [0, 1, 2, 3]):
        with headless.quiet(), gonio.stage((32, 32), samples=1, seed=0, shading_osl=setup.shading_osl) as stage:
            (first,) = gonio.light(stage, gonio.Geometry(10.0))
            items = [first]
            for kind in KINDS:
                item = make_lamp(blender, kind, f"Lamp {kind}")
                item.location = (0.7, -0.4, 2.5)
                stage.collection.objects.link(item)
                items.append(item)
            preset = check.materials()["conductor"]
            made = material.build(
                preset, material.Choice(setup.backend, "direct", tuple(items[i] for i in chosen), shadows=False)
            )
            gonio._sphere(stage, made)
            camera = blender.data.cameras.new("Camera")
            camera.type, camera.ortho_scale = "ORTHO", 2.0
            eye = blender.data.objects.new("Camera", camera)
            eye.location = (0, 0, 3)
            stage.collection.objects.link(eye)
            stage.camera = eye
            images.append(gonio.rendered(stage).astype(float))
    *single, together = images
    assert all(image.max() > 0 for image in single)
    # Emission closures round when they are added: four sums of 6e-8.
    np.testing.assert_allclose(together, sum(single), atol=4e-7 * together.max())
