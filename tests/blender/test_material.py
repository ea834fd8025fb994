# SPDX-License-Identifier: GPL-3.0-or-later
"""The builder: only what is needed, idempotent, and the saved file renders without the extension."""

import subprocess
import sys

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon import models
from vgroove.addon.blender import gonio, images, material, slots
from vgroove.addon.blender.inputs import value_of
from vgroove.addon.blender.material import Choice, MaterialError, build, lamps_to_bind
from vgroove.addon.choose import automatic
from vgroove.addon.library import presets
from vgroove.lab.check.cook_torrance import materials

pytestmark = pytest.mark.blender

FRESNELS = ("schlick", "dielectric", "conductor", "f82")
CHOICES = [Choice(backend, estimator) for backend in material.BACKENDS for estimator in material.ESTIMATORS]


def kinds_inside(tree):
    """Node types of a tree and all groups in it."""
    found = set()
    for node in tree.nodes:
        found.add(node.bl_idname)
        if node.bl_idname == "ShaderNodeGroup":
            found |= kinds_inside(node.node_tree)
    return found


@pytest.mark.parametrize("choice", CHOICES, ids=lambda c: f"{c.backend}-{c.estimator}")
@pytest.mark.parametrize("fresnel", FRESNELS)
def test_a_material_is_one_group_and_an_output(blender, choice, fresnel):
    """The artist sees a group and what it is linked to; its inputs are the preset's numbers."""
    preset = materials()[fresnel]
    made = build(preset, choice)
    outputs = 1 if choice.backend == "nodes" and choice.estimator in material.NATIVE else 2  # of which one is EEVEE's
    kinds = ["ShaderNodeGroup", *["ShaderNodeOutputMaterial"] * outputs]
    assert sorted(node.bl_idname for node in made.node_tree.nodes) == kinds
    node = next(node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeGroup")
    names = [socket.name for socket in node.inputs]
    bound = ["Bound"] * (choice.estimator == "hybrid")
    expected = [*(one.label for one in models.fresnel.KINDS[fresnel].parameters), "Roughness", "Normal", *bound]
    assert names == expected
    for key, value in preset.parameters.items():
        assert value_of(key, node.inputs[models.label(preset.model, key)]) == pytest.approx(value, rel=3e-7)  # m: twice


def test_what_an_estimator_does_not_need_is_left_out(blender):
    """No noise without mirror, no emission without direct, no script without OSL, no drivers without lamps."""
    preset = materials()["schlick"]
    for choice in CHOICES:
        made = build(preset, choice)
        inside = kinds_inside(made.node_tree)
        random = choice.estimator in {"mirror", "hybrid"}
        assert ("ShaderNodeTexWhiteNoise" in inside) == (choice.backend == "nodes" and random)
        assert ("ShaderNodeEmission" in inside) == (choice.estimator == "direct")
        assert ("ShaderNodeScript" in inside) == (choice.backend == "osl" and choice.estimator != "direct")
        assert "ShaderNodeRaycast" not in inside
        assert made.node_tree.animation_data is None
        assert made.cycles.use_bump_map_correction == (choice.estimator in material.UPRIGHT)


def test_building_twice_gives_one_material(blender):
    """The same preset by the same choice is the same material, and its groups are shared."""
    preset = materials()["conductor"]
    for choice in CHOICES:
        first = build(preset, choice)
        count = len(blender.data.materials), len(blender.data.node_groups), len(blender.data.texts)
        assert build(preset, choice) is first
        assert (len(blender.data.materials), len(blender.data.node_groups), len(blender.data.texts)) == count


def test_an_edited_material_is_left_alone(blender):
    """What an artist changed is not overwritten: a fresh material is made beside it."""
    preset = materials()["schlick"]
    first = build(preset, Choice())
    node = next(node for node in first.node_tree.nodes if node.bl_idname == "ShaderNodeGroup")
    node.inputs["Roughness"].default_value = 0.77
    second = build(preset, Choice())
    assert second is not first
    assert node.inputs["Roughness"].default_value == pytest.approx(0.77)


def test_applying_fills_the_active_slot_of_what_can_have_a_material(blender):
    """Meshes with and without slots take it, lamps and empties do not count."""
    stage = blender.context.scene
    mesh = blender.data.objects.new("Mesh", blender.data.meshes.new("Mesh"))
    slotted = blender.data.objects.new("Slotted", blender.data.meshes.new("Slotted"))
    slotted.data.materials.append(blender.data.materials.new("Old"))
    lamp = blender.data.objects.new("Lamp", blender.data.lights.new("Lamp", "POINT"))
    empty = blender.data.objects.new("Empty", None)
    for item in (mesh, slotted, lamp, empty):
        stage.collection.objects.link(item)
    made = build(materials()["schlick"], Choice())
    assert slots.apply(made, [mesh, slotted, lamp, empty]) == 2
    assert mesh.active_material is made
    assert slotted.active_material is made
    assert len(slotted.material_slots) == 1


def test_unknown_choices_are_one_line(blender):
    """Backend and estimator are checked where they enter."""
    with pytest.raises(MaterialError, match='unknown backend "cuda"; use one of nodes, osl'):
        Choice(backend="cuda")
    with pytest.raises(
        MaterialError, match='unknown estimator "exact"; use one of fit, closure, corrected, hybrid, mirror, direct'
    ):
        Choice(estimator="exact")


RENDER_WITHOUT_US = """
import pathlib, sys
sys.modules["vgroove"] = None
import bpy
for path in map(pathlib.Path, sys.argv[1:]):
    bpy.ops.wm.open_mainfile(filepath=str(path))
    bpy.context.scene.render.filepath = str(path.with_suffix(".exr"))
    bpy.ops.render.render(write_still=True)
"""


def saved(bpy, path, backend, estimator):
    """A sphere's picture, and the file that shows it."""
    with headless.quiet(), gonio.stage((48, 48), samples=16, seed=3, shading_osl=backend == "osl") as stage:
        (lamp,) = gonio.light(stage, gonio.Geometry(30.0))
        lamp.data.angle = 0.3 if estimator == "mirror" else 0.0
        lamps = lamps_to_bind(stage, estimator) if estimator == "direct" else ()
        # Shadows stay on: tracing is part of what has to survive.
        made = build(materials()["conductor"], Choice(backend, estimator, lamps))
        gonio.sphere(stage, made)
        camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
        camera.location = (0, 0, 5)
        stage.collection.objects.link(camera)
        stage.camera = camera
        bpy.context.window.scene = stage
        here = gonio.rendered(stage)
        bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return here


def test_saved_files_render_the_same_without_the_extension(blender, tmp_path):
    """Opened by a Blender that has never heard of vgroove, in another process, each picture is the same."""
    paths = [tmp_path / f"{choice.estimator} {choice.backend}.blend" for choice in CHOICES]
    pictures = [saved(blender, path, of.backend, of.estimator) for path, of in zip(paths, CHOICES, strict=True)]
    subprocess.run([sys.executable, "-c", RENDER_WITHOUT_US, *map(str, paths)], check=True, capture_output=True)
    for path, here in zip(paths, pictures, strict=True):
        there = images.load(path.with_suffix(".exr"))
        assert here.max() > 0.1, path.stem
        np.testing.assert_array_equal(here, there, err_msg=path.stem)


def test_mirror_with_a_lamp_of_zero_size_sees_it_by_the_formula(blender):
    """Under a sun of zero size alone, mirror with the sun bound is exactly direct."""
    preset = materials()["schlick"]
    images = []
    for estimator in ("direct", "mirror"):
        with headless.quiet(), gonio.stage((32, 32), samples=1, seed=0, shading_osl=False) as stage:
            gonio.light(stage, gonio.Geometry(40.0))
            lamps = lamps_to_bind(stage, estimator)
            gonio.sphere(stage, build(preset, Choice("nodes", estimator, lamps, shadows=False)))
            camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
            camera.location = (0, 0, 5)
            stage.collection.objects.link(camera)
            stage.camera = camera
            images.append(gonio.rendered(stage))
    assert images[0].max() > 0.1
    np.testing.assert_allclose(images[1], images[0], rtol=1e-6)  # an Add Shader between: one rounding


def one_of_each():
    """The first preset of every other model that builds its tree in its own way; test_every_preset.py has them all."""
    found = {}
    for preset in presets.all_presets().values():
        way = preset.model, preset.kind, preset.flags, preset.lobes, preset.m > 0, material.absorbs(preset)
        found.setdefault(way, preset)
    return [preset for preset in found.values() if preset.model != "cook_torrance"]


OTHERS = one_of_each()


@pytest.mark.parametrize("backend", material.BACKENDS)
@pytest.mark.parametrize("preset", OTHERS, ids=lambda preset: preset.id)
def test_glass_and_rough_surfaces_build_by_every_estimator_that_they_have(blender, preset, backend):
    """One group whose inputs are the preset's numbers, built once; what there is not is refused in one line."""
    for estimator in material.BUILDERS[preset.model]:
        choice = Choice(backend, estimator)
        made = build(preset, choice)
        assert build(preset, choice) is made
        node = next(node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeGroup")
        rough = any(models.label(preset.model, one).endswith("Roughness") for one in preset.parameters)
        assert any(socket.name.endswith("Roughness") for socket in node.inputs) == (rough and not preset.is_smooth)
        for key, value in preset.parameters.items():
            if (label := models.label(preset.model, key)) in node.inputs:
                assert value_of(key, node.inputs[label]) == pytest.approx(value, rel=5e-6)  # six digits
    for estimator in set(material.ESTIMATORS) - set(material.BUILDERS[preset.model]):
        with pytest.raises(MaterialError, match=f'which has no estimator "{estimator}"; use one of'):
            build(preset, Choice(backend, estimator))


@pytest.mark.parametrize("preset", [*OTHERS, presets.find("lecture/copper")], ids=lambda preset: preset.id)
def test_every_model_renders_finite_light_by_what_auto_picks(blender, preset):
    """Under a white sky with a lamp: no NaN, nothing negative, nothing black."""
    with headless.quiet(), gonio.stage((32, 32), samples=16, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        item = blender.data.objects.new("Lamp", blender.data.lights.new("Lamp", "AREA"))
        item.location = (0, 0, 4)
        stage.collection.objects.link(item)
        stage.view_layers[0].update()
        estimator = automatic.pick_estimator(stage, preset)
        bound = lamps_to_bind(stage, estimator, preset.model)
        gonio._patch(stage, build(preset, Choice("nodes", estimator, bound)), gonio.Geometry())
        camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
        camera.location = (0, 0, 3)
        stage.collection.objects.link(camera)
        stage.camera = camera
        image = gonio.rendered(stage)
    assert np.isfinite(image).all()
    assert image.min() >= 0.0
    assert image.mean() > 0.01


@pytest.mark.parametrize("choice", CHOICES, ids=lambda c: f"{c.backend}-{c.estimator}")
def test_eevee_shows_the_closure_of_the_same_inputs(blender, choice):
    """A slope that an artist turns reaches both; Cycles gets the estimator alone."""
    made = build(materials()["schlick"], choice)
    outputs = {node.target: node for node in made.node_tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"}
    if choice.backend == "nodes" and choice.estimator in material.NATIVE:
        assert set(outputs) == {"ALL"}  # of which it shows the very nodes
        return
    assert set(outputs) == {"CYCLES", "EEVEE"}
    group = outputs["EEVEE"].inputs["Surface"].links[0].from_node
    assert group == outputs["CYCLES"].inputs["Surface"].links[0].from_node
    sink = next(node for node in group.node_tree.nodes if node.bl_idname == "NodeGroupOutput")
    closure = sink.inputs["EEVEE"].links[0].from_node
    assert closure.node_tree.name.startswith("VGroove Cook-Torrance Closure")
    for socket in closure.inputs:
        assert socket.links[0].from_socket.name == socket.name
        assert socket.links[0].from_node.bl_idname == "NodeGroupInput"
