# SPDX-License-Identifier: GPL-3.0-or-later
"""Hair, as ribbons and as tubes: every estimator shows what Cycles' own closure does."""

import bpy
import numpy as np
import pytest
from mathutils import Vector

from vgroove import headless, nodegroups
from vgroove.addon.blender import gonio, material
from vgroove.addon.blender.material import BUILDERS, Choice, build, lamps_to_bind
from vgroove.headless import scene
from vgroove.lab.bench import everyday
from vgroove.nodegroups import shading_normal

from ..scenes import MATERIALS

pytestmark = pytest.mark.blender

STRANDS, POINTS, RADIUS = 300, 5, 0.03
SIDE, SAMPLES, EYE = 32, 32, (0.0, -5.0, 0.5)
SAMPLES_BELOW = 4  # of what scatters below the surface, whose rays meet hundreds of strands
CHANCE = 4.0  # standard errors; of a mean over some 300 pixels and two seeds
MODELS_DIFFER = 0.045  # as tests/blender/test_bump.py says


def tuft():
    """Bent strands on a square of two metres."""
    drawn = np.random.default_rng(1)
    root, lean = drawn.uniform(-1.0, 1.0, (STRANDS, 1, 2)), 0.3 * drawn.normal(size=(STRANDS, 1, 2))
    along = np.linspace(0.0, 1.0, POINTS)[None, :, None]
    places = np.concatenate([root + lean * along**2, np.broadcast_to(1.5 * along - 0.7, (STRANDS, POINTS, 1))], axis=-1)
    made = bpy.data.hair_curves.new("Tuft")
    made.add_curves([POINTS] * STRANDS)
    made.position_data.foreach_set("vector", places.astype(np.float32).ravel())
    thick = made.attributes.get("radius") or made.attributes.new("radius", "FLOAT", "POINT")
    thick.data.foreach_set("value", np.full(STRANDS * POINTS, RADIUS, np.float32))
    return made


@pytest.fixture
def pictures(blender):
    """A function that renders the tuft in a white sky or under a sun, by two seeds (2, H, W, 3), and its pixels."""

    def render(make, shape="RIBBONS", samples=SAMPLES, *, sun=False, osl=False):
        with headless.quiet(), gonio.stage((SIDE, SIDE), samples=samples, seed=0, shading_osl=osl) as stage:
            stage.cycles.filter_width, stage.cycles_curves.shape = 1.5, shape
            if sun:
                stage.world = None
                scene.add_sun(stage, 3.0)
                stage.objects["Sun"].rotation_euler = (0.8, 0.0, 0.4)
            else:
                gonio.light(stage, gonio.Geometry(furnace=True, lit="all"))
            item = blender.data.objects.new("Tuft", tuft())
            stage.collection.objects.link(item)
            item.data.materials.append(make(stage))
            camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
            camera.data.lens, camera.location = 60.0, EYE
            camera.rotation_euler = (-Vector(EYE)).to_track_quat("-Z", "Y").to_euler()
            stage.collection.objects.link(camera)
            stage.camera = camera
            found = []
            for seed in (0, 1):
                stage.cycles.seed = seed
                found.append(gonio.rendered(stage))
        return np.stack(found).astype(np.float64)

    return render


def maker(preset, estimator, backend):
    return lambda stage: build(preset, Choice(backend, estimator, lamps_to_bind(stage, estimator, preset.model)))


@pytest.mark.parametrize("backend", material.BACKENDS)
@pytest.mark.parametrize("shape", ["RIBBONS", "THICK"])
@pytest.mark.parametrize("light", ["sky", "sun"])
@pytest.mark.parametrize("estimator", ["fit", "corrected", "mirror"])
@pytest.mark.parametrize("model", MATERIALS)
def test_hair_looks_as_by_closure(pictures, model, estimator, light, shape, backend):
    """Finite, and as bright within what the models differ by and chance."""
    preset, sun, osl = MATERIALS[model], light == "sun", backend == "osl"
    if preset.model == "glass":  # mirror is the only other one, and sees no sun of zero size
        estimator, sun = "mirror", False
    assert estimator in BUILDERS[preset.model]
    samples = SAMPLES_BELOW if preset.model == "translucent" else SAMPLES
    got, wanted = (
        pictures(maker(preset, by, backend), shape, samples, sun=sun, osl=osl) for by in (estimator, "closure")
    )
    assert np.isfinite(got).all()
    where = wanted.sum(axis=(0, -1)) > 0.0
    found = everyday.judge(got, wanted, where)
    for mean, doubt in zip(found.mean, found.doubt, strict=True):
        assert mean == pytest.approx(1.0, abs=MODELS_DIFFER + CHANCE * doubt)


def test_normals_of_ribbons_are_left_as_cycles_leaves_them(pictures, empty_material):
    """Raised nowhere, though a ribbon's own normal faces the viewer and half of the mirror images lie below it."""

    def make(_stage):
        made = empty_material()
        tree = made.node_tree
        group, colour, shine, output = (
            tree.nodes.new(f"ShaderNode{kind}") for kind in ("Group", "CombineXYZ", "Emission", "OutputMaterial")
        )
        group.node_tree = nodegroups.ensure(
            shading_normal.SPECULAR_NAME, shading_normal.SPECULAR_REVISION, shading_normal.build_specular
        )
        colour.inputs["Y"].default_value = 1.0
        tree.links.new(group.outputs["Below"], colour.inputs["X"])
        tree.links.new(colour.outputs[0], shine.inputs["Color"])
        tree.links.new(shine.outputs[0], output.inputs["Surface"])
        return made

    red, green, _ = np.moveaxis(pictures(make, sun=True), -1, 0)
    assert green.mean() > 0.1
    assert red.max() == 0.0


def test_ribbons_look_alike_by_both_backends(pictures):
    """To 0.5 %: raising normals takes 2 % of what a plastic's ribbons send of a sun."""
    preset = MATERIALS["plastic"]
    nodes, osl = (pictures(maker(preset, "fit", one), sun=True, osl=one == "osl") for one in ("nodes", "osl"))
    found = everyday.judge(osl, nodes, nodes.sum(axis=(0, -1)) > 0.0)
    for mean, doubt in zip(found.mean, found.doubt, strict=True):
        assert doubt < 0.002
        assert mean == pytest.approx(1.0, abs=0.005 + CHANCE * doubt)
