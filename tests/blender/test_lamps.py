# SPDX-License-Identifier: GPL-3.0-or-later
"""``direct`` follows its lamps: what they send, where they go, and when they give nothing."""

from contextlib import contextmanager
from functools import partial
from math import pi

import numpy as np
import pytest

from vgroove import headless, nodegroups
from vgroove.addon.blender import follow, gonio, lamps, material, roles
from vgroove.addon.blender.choice import lamps_to_bind, most_lights
from vgroove.addon.choose import advice
from vgroove.lab.check.cook_torrance import SUN_THETAS, materials
from vgroove.lab.check.rows import SETUPS, Row, View
from vgroove.lab.check.views import disc, measure
from vgroove.lab.sidak import limit
from vgroove.nodegroups import lamp as lamp_group
from vgroove.nodegroups import osl_script, random_numbers, versions

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
    """Emission of the irradiance that the stage's one light sends, times the cosine."""
    import bpy

    made = empty_material("Irradiance")
    tree = made.node_tree
    (stage,) = (scene for scene in bpy.data.scenes if scene.name.startswith("VGroove gonio"))
    (light,) = lamps.follow(stage)
    build = partial(lamp_group.build_slot, slot=light.slot, shadows=shadows, osl=backend == "osl")
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = nodegroups.ensure(f"{light.slot} {shadows} {backend}", 1, build)
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


def as_object(stage, item):
    """The light is an object of the scene."""
    stage.collection.objects.link(item)


def as_instance(stage, item):
    """The light comes by a collection instance that is moved, turned and not at the collection's own middle."""
    import bpy

    rig, holder = bpy.data.collections.new("Rig"), bpy.data.objects.new("Holder", None)
    rig.objects.link(item)
    rig.instance_offset = (0.2, 0.1, -0.3)
    holder.instance_type, holder.instance_collection = "COLLECTION", rig
    holder.location, holder.rotation_euler = (0.3, -0.2, 0.2), (0.2, -0.1, 0.8)
    stage.collection.objects.link(holder)


def in_set(stage, item):
    """The light is in the scene's background set."""
    import bpy

    stage.background_set = bpy.data.scenes.new("Set")
    stage.background_set.collection.objects.link(item)


def by_seed(stage, seeds):
    """The stage's render for each seed. Cycles keeps all but the seed, as preparing it takes longer than the render."""
    stage.render.use_persistent_data = True
    found = []
    for seed in seeds:
        stage.cycles.seed = seed
        found.append(gonio.rendered(stage).astype(float))
    return found


def floor_image(*given, **settings):
    """Radiance of a floor 4 m wide, seen from above, lit by one lamp, without bounces."""
    return floor_images([0], *given, **settings)[0]


def floor_images(
    seeds, bpy, make_material, kind, *, shading_osl, occluder=False, settings=None, samples=1, size=64, eye_near=False,
    bring=as_object,
):  # fmt: skip
    """``floor_image`` for each seed."""
    with headless.quiet(), gonio.stage((size, size), samples=samples, seed=0, shading_osl=shading_osl) as stage:
        stage.cycles.max_bounces = 0
        gonio.light(stage, gonio.Geometry())
        bpy.data.objects.remove(stage.objects[0])
        item = make_lamp(bpy, kind)
        bring(stage, item)
        if settings is not None:
            stage.cycles.filter_width = 1.0  # moves P, from which random numbers come, over the whole pixel
            settings(item)
            stage.frame_set(7)
        stage.view_layers[0].update()
        add_mesh(bpy, stage, "Floor", 3.0, 0.0, make_material(item))
        if occluder:
            add_mesh(bpy, stage, "Occluder", 0.3, 0.7).visible_camera = False
        gonio.look_down(stage, 4.0, (0.3, -0.4, 1.3) if eye_near else (0, 0, 5))
        if eye_near:
            stage.camera.data.type = "PERSP"
        return by_seed(stage, seeds)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("setup", SETUPS, ids=str)
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
@pytest.mark.parametrize("setup", SETUPS, ids=str)
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
        blender.context.scene.collection.objects.link(make_lamp(blender, kind))
        found = advice.problems(blender.context.scene, "nodes", "direct")
        assert any(problem.key == "shadows" for problem in found)
        assert dark.any()
        return
    assert (cycles.max(-1) == 0).sum() > 50
    np.testing.assert_allclose(ours, cycles, atol=5e-6 * cycles.max())


@pytest.mark.parametrize(("kind", "bring"), [(kind, as_instance) for kind in (*KINDS, "AREA")] + [("SPOT", in_set)])
def test_a_light_that_an_instance_or_a_set_brings_sends_what_cycles_own_sends(blender, empty_material, kind, bring):
    """Moved and turned by the instance, less the collection's offset."""
    more = {"shading_osl": False, "bring": bring, "samples": 512 if kind == "AREA" else 1, "size": 16}
    cycles = pi * floor_image(blender, lambda _: white_diffuse(empty_material), kind, **more)
    ours = floor_image(
        blender, lambda item: irradiance_material(empty_material, item, "nodes", shadows=False), kind, **more
    )
    for scene in [one for one in blender.data.scenes if one.name.startswith("Set")]:
        blender.data.scenes.remove(scene)
    assert cycles.max() > 0.1
    # A point as above, and two products of matrices more; an area light of 512 samples: 16 of them over each of the
    # lamp's 5 % wide cells, across which the irradiance changes by a tenth at the most.
    np.testing.assert_allclose(ours, cycles, atol=(0.02 if kind == "AREA" else 1e-5) * cycles.max())


# Lamps with a size


def given(kind, keys=None, **values):
    """A case: the kind of a lamp, and a function that sets its properties and keys some of them at frames 1 and 11."""

    def settings(item):
        for name, value in values.items():
            setattr(item if hasattr(item, name) and name != "size" else item.data, name, value)
        for name, ends in (keys or {}).items():
            owner = item if hasattr(item, name) and name != "size" else item.data
            for frame, value in zip((1, 11), ends, strict=True):
                setattr(owner, name, value)
                owner.keyframe_insert(name, frame=frame)

    return kind, settings


BALL, DISC = {"use_soft_falloff": False}, {"use_soft_falloff": True}
WIDE = {"spot_size": 2.0, "spot_blend": 0.4, "shadow_soft_size": 0.3}
SIZED = {
    "sun": given("SUN", angle=0.2),
    "sun over half the sky": given("SUN", angle=2.1),
    "sun, not normalized": given("SUN", angle=0.3, normalize=False),
    "ball": given("POINT", shadow_soft_size=0.3, **BALL),
    "ball, not normalized": given("POINT", shadow_soft_size=0.3, normalize=False, **BALL),
    "facing disc": given("POINT", shadow_soft_size=0.3, **DISC),
    "facing disc through the floor": given("POINT", location=(0.7, -0.4, 0.5), shadow_soft_size=1.0, **DISC),
    "spot ball": given("SPOT", **WIDE, **BALL),
    "spot facing disc": given("SPOT", **WIDE, **DISC),
    "spot, scaled": given("SPOT", scale=(2, 2, 2), **WIDE, **BALL),
    "square": given("AREA", shape="SQUARE", size=0.8),
    "rectangle, scaled and mirrored": given("AREA", shape="RECTANGLE", size=0.8, size_y=0.3, scale=(1.5, -0.7, 2)),
    "disk": given("AREA", shape="DISK", size=0.8),
    "ellipse, scaled": given("AREA", shape="ELLIPSE", size=0.8, size_y=1.6, scale=(1.2, 0.5, 1)),
    "ellipse, not normalized": given("AREA", shape="ELLIPSE", size=0.8, size_y=0.3, normalize=False),
    "rectangle, spread": given("AREA", shape="RECTANGLE", size=0.8, size_y=0.3, spread=2.0),
    "square, narrow spread": given("AREA", shape="SQUARE", size=2.0, spread=0.07, rotation_euler=(0.1, 0, 0.4)),
    "disk, narrow spread": given("AREA", shape="DISK", size=2.0, spread=0.35, rotation_euler=(0.1, 0, 0)),
    "square, partly below the floor": given(
        "AREA", shape="SQUARE", size=0.8, location=(2.6, 0, 0.15), rotation_euler=(0, 1.3, 0)
    ),
    "animated": given(
        "AREA", {"size": (0.2, 1.0), "location": ((2, 0, 2), (-1, 0, 1)), "rotation_euler": ((0, 0, 0), (0, 0, 2))},
        shape="RECTANGLE", size_y=0.3,
    ),
}  # fmt: skip
BACKENDS = (SETUPS[0], SETUPS[2])
SEEDS = 4


def seen(images):
    """Mean and variance of the mean of 8 x 8 pixels each, from the spread of each pixel over its seeds; red channel."""
    images = np.array(images)[..., 0]
    blocks = [
        values.reshape(images.shape[1] // 8, 8, -1, 8).mean((1, 3))
        for values in (images.mean(0), images.var(0, ddof=1) / len(images) / 64)
    ]
    return blocks[0].ravel(), blocks[1].ravel()


def judged(ours, cycles, tests):
    """(passed, resolved): every block and the common scale within the limits of ``tests`` tests; smallest scale error.

    A block's variance comes from 64 pixels of 4 seeds each, so its 192 degrees of freedom make a t nearly normal.
    Where Cycles' own sampling leaves no spread, float32 does: 2^-15.5 of the mean, as in ``View.z``.
    """
    (mean, spread), (expected, of_expected) = ours, cycles
    floor = np.square(2.0**-15.5 * np.maximum(mean, expected).max())
    variance = spread + of_expected + floor
    z = (mean - expected) / np.sqrt(variance)
    information = np.sum(expected**2 / variance)
    scale_z = np.sum((mean - expected) * expected / variance) / np.sqrt(information)
    # Few hits at a cone's edge skew a block: its limit is that of four times as many tests.
    passed = abs(scale_z) <= limit(tests) and np.all(np.abs(z) <= limit(4 * tests * z.size))
    return passed, limit(tests) / np.sqrt(information)


@pytest.fixture
def two_floors(blender, empty_material):
    """A function that lights one floor by Cycles' own lamp sampling and one by ours: blocks of the two, times pi."""

    def render(case, setup, *, occluder=False, samples=64, **more):
        kind, settings = SIZED[case] if isinstance(case, str) else case
        arguments = {"shading_osl": setup.shading_osl, "settings": settings, "samples": samples, "size": 32}
        arguments |= {"occluder": occluder} | more
        ours = floor_images(
            range(SEEDS),
            blender,
            lambda item: irradiance_material(empty_material, item, setup.backend, shadows=occluder),
            kind,
            **arguments,
        )
        cycles = floor_images(
            range(50, 50 + SEEDS), blender, lambda _: white_diffuse(empty_material), kind, **arguments
        )
        return seen(ours), seen(pi * np.array(cycles))

    return render


def traces(setup):
    return setup.backend == "osl" or lamp_group.can_cast_shadows()


@pytest.mark.parametrize("occluder", [False, True], ids=["open", "penumbra"])
@pytest.mark.parametrize("setup", BACKENDS, ids=str)
@pytest.mark.parametrize("case", SIZED)
def test_a_lamp_with_a_size_gives_what_cycles_own_sampling_finds(two_floors, case, setup, occluder):
    """Irradiance at 16 places by Z-test, in the open and in half shadow; an error of 1 % either way would show."""
    occluder = occluder and traces(setup)  # 4.5's nodes trace no rays: there the open floor is measured twice
    ours, cycles = two_floors(case, setup, occluder=occluder, samples=512 if "narrow" in case else 128)
    tests = 2 * len(BACKENDS) * len(SIZED)
    assert cycles[0].max() > 0
    passed, resolves = judged(ours, cycles, tests)
    assert passed
    assert resolves < 0.01
    for factor in (0.99, 1.01):
        assert not judged(ours, (cycles[0] * factor, cycles[1] * factor**2), tests)[0]


@pytest.mark.parametrize("setup", BACKENDS, ids=str)
@pytest.mark.parametrize("case", ["square", "facing disc"])
def test_a_camera_beside_a_lamp_sees_the_same(two_floors, case, setup):
    """Rays leave from where the lamp is; what it sends does not depend on them."""
    assert judged(*two_floors(case, setup, occluder=traces(setup), samples=128, eye_near=True), 4)[0]


@pytest.mark.parametrize("setup", BACKENDS, ids=str)
def test_a_spot_around_the_floor_gives_what_cycles_light_sampling_finds(two_floors, setup):
    """Inside a ball the cone is off; Cycles' rays to the lamp disagree there, so it is asked without them."""
    kind, place = given("SPOT", location=(0.5, 0, 0.5), shadow_soft_size=1.0, spot_size=1.2, spot_blend=0.4, **BALL)

    def settings(item):
        place(item)
        item.data.cycles.use_multiple_importance_sampling = False

    ours, cycles = two_floors((kind, settings), setup, samples=512)
    passed, resolves = judged(ours, cycles, len(BACKENDS))
    assert passed
    assert resolves < 0.01


@pytest.mark.once
@pytest.mark.parametrize("setup", [setup for setup in BACKENDS if traces(setup)], ids=str)
@pytest.mark.parametrize("case", ["sun", "ball", "spot facing disc", "rectangle, spread", "disk"])
def test_a_constant_in_place_of_the_hash_turns_half_shadows_red(two_floors, monkeypatch, case, setup):
    """One point of the lamp for all samples casts a hard shadow."""

    def frozen(tree):
        tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
        tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")

    monkeypatch.setattr(random_numbers, "build", frozen)
    source, drawn = osl_script.source, 'noise("hash", P, w)'
    assert drawn in source("lamp")
    monkeypatch.setattr(osl_script, "source", lambda name: source(name).replace(drawn, "0.37"))
    assert not judged(*two_floors(case, setup, occluder=True, samples=16), 1)[0]


@pytest.mark.parametrize("setup", BACKENDS, ids=str)
@pytest.mark.parametrize("kind", ["SUN", "POINT"])
def test_a_disc_of_sun_and_a_ball_give_what_a_point_gives(blender, empty_material, kind, setup):
    """E cos and P cos / (4 pi d^2) hold for both at every size while all of the lamp is above the horizon."""
    values = {"angle": 0.8} if kind == "SUN" else {"shadow_soft_size": 1.0, **BALL}
    images = []
    for sized in (False, True):
        _, settings = given(kind, **(values if sized else {}), location=(0.7, -0.4, 1.5))
        images.append(
            floor_images(
                range(SEEDS),
                blender,
                lambda item: irradiance_material(empty_material, item, setup.backend, shadows=False),
                kind,
                shading_osl=setup.shading_osl,
                settings=settings,
                samples=128,
                size=32,
            )
        )
    passed, resolves = judged(seen(images[1]), seen(images[0]), 4)
    assert passed
    assert resolves < 0.005


@pytest.mark.parametrize("setup", SETUPS, ids=str)
def test_direct_under_a_disc_of_sun_is_the_mean_of_the_formula(setup):
    """Cook-Torrance under a sun of 10 degrees against NumPy's integral of f cos over the disc."""
    preset = materials()["schlick"].with_parameters(m=0.3)
    model, samples, angle = preset.reference(), 256, 10.0
    row = Row("direct, sun", setup)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, window=20.0, resolution=(16, 16), sun_angle=angle)
        wo = geometry.wo()
        directions, weights = disc(geometry)
        # A direction's irradiance: the sun's strength 1/cos(theta_i), by 2 / (1 + cos a) of nodegroups/lamp.py.
        beam = 2.0 / (1.0 + np.cos(np.radians(angle / 2))) / np.cos(np.radians(theta_i))
        mean, square = np.zeros_like(wo), np.zeros_like(wo)
        for wi, weight in zip(directions, weights / weights.sum(), strict=True):
            radiance = model.evaluate(wi, wo) * max(wi[2], 0.0) * beam
            mean += weight * radiance
            square += weight * radiance**2
        measured = measure(preset, setup, "direct", geometry, samples=samples)
        row.views.append(View(geometry, measured, mean, variance=np.maximum(square - mean**2, 0.0) / samples))
    assert row.passed
    assert row.resolves < 0.005
    assert not row.scaled(0.99).passed
    assert not row.scaled(1.01).passed


def test_a_lamp_of_no_size_draws_nothing_at_random(blender):
    """What a lamp does not need is left out: no noise, no tangents, no socket for a size."""
    stage = blender.context.scene
    for kind in KINDS:
        item = make_lamp(blender, kind)
        stage.collection.objects.link(item)
        made = material.build(
            materials()["schlick"], material.Choice("nodes", "direct", lamps_to_bind(stage, "direct"))
        )
        node = next(node for node in made.node_tree.nodes if node.label.startswith("Light 1"))
        assert not {"Stream", "Radius", "Angle", "Soft Falloff"} & set(node.inputs.keys())
        (light,) = (inner for inner in node.node_tree.nodes if inner.bl_idname == "ShaderNodeGroup")
        assert not any(inner.label.startswith(".VGroove Random") for inner in light.node_tree.nodes)
        setattr(item.data, "angle" if kind == "SUN" else "shadow_soft_size", 0.2)
        sized = material.build(
            materials()["schlick"], material.Choice("nodes", "direct", lamps_to_bind(stage, "direct"))
        )
        assert sized is not made
        node = next(node for node in sized.node_tree.nodes if node.label.startswith("Light 1"))
        assert "Stream" in node.inputs
        blender.data.objects.remove(item)


@pytest.mark.parametrize("setup", BACKENDS, ids=str)
def test_each_lamp_draws_its_own_numbers(blender, setup):
    """Two lamps in one place: their variances add, where common numbers would give twice the sum."""
    variances = []
    for count in (1, 2):
        with ball_under(blender, ["AREA"] * count, setup) as (stage, _):
            images = by_seed(stage, range(8))
        variances.append(np.var(np.array(images)[..., 0], axis=0, ddof=1).sum())
    # About 400 pixels of 7 degrees of freedom: each sum is known to 3 %.
    assert variances[1] == pytest.approx(2 * variances[0], rel=0.15)


@pytest.mark.parametrize("setup", SETUPS, ids=str)
def test_eight_lamps_with_a_size_fit_into_one_material(blender, setup):
    """The largest material that can be built renders, and gives what its lamps give one by one."""
    kinds = ["AREA", "SPOT", "POINT", "SUN"] * 2

    def brightness(chosen):
        with ball_under(blender, kinds, setup, chosen) as (stage, _):
            return gonio.rendered(stage).astype(float).mean()

    # Over 400 pixels of 16 samples of less than their own spread: 1.3 % at most for one lamp, less for eight.
    assert brightness(range(8)) == pytest.approx(sum(brightness([index]) for index in range(8)), rel=0.03)


@pytest.mark.parametrize(
    ("kind", "m", "least"),
    [("SUN", 0.6, 0.02), ("POINT", 1.0, 0.02), ("SPOT", 0.1, 0.05), ("AREA", 0.1, 0.05), ("AREA", 0.6, 0.02)],
)
@pytest.mark.parametrize("setup", BACKENDS, ids=str)
def test_corrected_under_a_lamp_with_a_size_is_the_formula(blender, setup, kind, m, least):
    """On a ball, ``corrected`` agrees with ``direct`` by Z-test, and would not if ``least`` off: narrow ones are noisy.

    What Cycles' rays make of its own lobes (up to 0.33 % of them) is less where light sampling shares the work.
    """
    tests, blocks = len(BACKENDS) * 5, {}
    for estimator in ("direct", "corrected"):
        with ball_under(blender, [kind], setup, estimator=estimator, m=m, samples=512) as (stage, _):
            first = 10 * len(blocks)
            blocks[estimator] = seen(by_seed(stage, range(first, first + SEEDS)))
    mean, variance = blocks["direct"]
    assert judged(blocks["corrected"], blocks["direct"], tests)[0]
    for factor in (1 - least, 1 + least):
        assert not judged(blocks["corrected"], (mean * factor, variance * factor**2), tests)[0]


@contextmanager
def ball_under(bpy, kinds, setup, chosen=None, *, estimator="direct", m=0.5, samples=16):
    """A stage whose ball is lit by lamps with a size above it, seen from above; yields it and the lamps."""
    with headless.quiet(), gonio.stage((24, 24), samples=samples, seed=0, shading_osl=setup.shading_osl) as stage:
        stage.cycles.filter_width = 1.0
        gonio.light(stage, gonio.Geometry())
        bpy.data.objects.remove(stage.objects[0])
        items = []
        for index, kind in enumerate(kinds):
            item = make_lamp(bpy, kind, f"Lamp {index}")
            item.location = (0.7, -0.4, 2.5)
            setattr(item.data, {"SUN": "angle", "AREA": "size"}.get(kind, "shadow_soft_size"), 0.5)
            stage.collection.objects.link(item)
            items.append(item)
        stage.view_layers[0].update()
        for index, item in enumerate(items):
            item.hide_render = chosen is not None and index not in chosen
        bound = lamps_to_bind(stage, estimator)
        preset = materials()["schlick"].with_parameters(m=m)
        choice = material.Choice(setup.backend, estimator, bound)
        gonio._sphere(stage, material.build(preset, choice))
        gonio.look_down(stage, 2.0)
        yield stage, items


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
    node.inputs["Slope m"].default_value = 0.27
    for kind in ("SUN", "POINT"):
        stage.collection.objects.link(make_lamp(blender, kind, f"Late {kind}"))
    blender.context.view_layer.update()
    assert material.bound_slots(made) == {"SUN 1", "SUN 2", "POINT 1"}
    assert strength("POINT 1")[0] > 0
    assert roles.node(made, roles.MODEL).inputs["Slope m"].default_value == pytest.approx(0.27)
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


def test_what_cannot_be_followed_is_refused_in_one_line(blender):
    """Portals, needles of light, sheared lamps, lamps with nodes and uneven spots are named with a way out."""
    stage = blender.context.scene
    items = {name: make_lamp(blender, "AREA", name) for name in ("portal", "spread under", "sheared")}
    items |= {"scaled unevenly": make_lamp(blender, "SPOT", "Spot"), "node tree": make_lamp(blender, "SUN", "Sun")}
    items |= {word: make_lamp(blender, "POINT", word) for word in ("shadow linking", "glossy rays")}
    for item in items.values():
        stage.collection.objects.link(item)
    items["portal"].data.cycles.is_portal = True
    items["shadow linking"].light_linking.blocker_collection = blender.data.collections.new("Blockers")
    items["glossy rays"].visible_glossy = False
    items["spread under"].data.spread = 0.01
    parent = blender.data.objects.new("Parent", None)
    parent.scale = (1, 3, 1)
    stage.collection.objects.link(parent)
    items["sheared"].parent = parent
    items["scaled unevenly"].scale = (1.0, 2.0, 1.0)
    versions.nodes_of(items["node tree"].data).nodes.new("ShaderNodeTexNoise")
    blender.context.view_layer.update()
    for word, item in items.items():
        refused = lamps.refusal(item)
        assert word in refused
        assert f'"{item.name}"' in refused
        assert "\n" not in refused
        with pytest.raises(material.MaterialError, match=word):
            material.Choice("nodes", "direct", (lamps.Light(item, stage),))
    assert lamps_to_bind(stage, "direct") == ()


def test_as_many_lamps_are_bound_as_fit_the_strongest_first(blender):
    """Of ten the weakest are left out, and the advice says which: two, and on 4.5 as many as its smaller stack asks."""
    most = most_lights("direct", "cook_torrance")
    assert most == (8 if versions.LEAN_STACK else 6)
    stage = blender.context.scene
    stage.render.engine = "CYCLES"
    for index in range(10):
        item = make_lamp(blender, "SUN", f"Sun {index}")
        item.data.energy = 1.0 + index
        stage.collection.objects.link(item)
    taken = lamps_to_bind(stage, "direct")
    strongest_first = [f"Sun {index}" for index in range(9, -1, -1)]
    assert [light.name for light in taken] == strongest_first[:most]
    (said,) = (p for p in advice.problems(stage, "nodes", "direct") if p.key == "limit")
    assert ", ".join(strongest_first[most:]) in said.text
    with pytest.raises(material.MaterialError, match="at most 8"):
        material.Choice("nodes", "direct", (taken * 2)[:9])


def test_the_strongest_lamp_is_the_one_that_gives_most_to_the_middle_of_the_objects(blender):
    """Near beats far, and watts count by what they give there: a sun of 1 W/m^2, 4 pi W at 1 m, pi W of area."""
    stage = blender.context.scene
    add_mesh(blender, stage, "Left", 1.0, 0.0).location = (9, 0, 0)
    add_mesh(blender, stage, "Right", 1.0, 0.0).location = (11, -4, 0)  # the middle is at (10, 0, 0)
    for name, kind, strength, height in (
        ("sun", "SUN", 1.0, 50.0),
        ("near point", "POINT", 4 * pi * 1.1, 1.0),
        ("far point", "POINT", 4 * pi * 3.0, 2.0),
        ("area", "AREA", pi * 0.9 * 2.0, 1.0),
        ("glare", "AREA", pi * 0.3, 1.0),
    ):
        item = make_lamp(blender, kind, name)
        light = item.data
        light.color, light.use_temperature, light.exposure, light.energy = (1, 1, 1), False, 0.0, strength
        if kind == "AREA":
            light.size = 1.0  # its own size counts as distance, so that a lamp at the middle stays finite
        item.location = (10, 0, height)
        stage.collection.objects.link(item)
    stage.objects["glare"].data.normalize = False
    stage.objects["glare"].scale = (3, 4, 1)
    blender.context.view_layer.update()
    names = [item.name for item in lamps.of_scene(stage)]
    assert names == ["glare", "near point", "sun", "area", "far point"]


@pytest.mark.parametrize("setup", SETUPS, ids=str)
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
            for index, item in enumerate(items):
                item.hide_render = index not in chosen
            preset = materials()["conductor"]
            bound = lamps_to_bind(stage, "direct")
            made = material.build(preset, material.Choice(setup.backend, "direct", bound, shadows=False))
            gonio._sphere(stage, made)
            gonio.look_down(stage, 2.0)
            images.append(gonio.rendered(stage).astype(float))
    *single, together = images
    assert all(image.max() > 0 for image in single)
    # Emission closures round when they are added: four sums of 6e-8.
    np.testing.assert_allclose(together, sum(single), atol=4e-7 * together.max())
