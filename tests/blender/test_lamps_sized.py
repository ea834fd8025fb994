# SPDX-License-Identifier: GPL-3.0-or-later
"""Lamps with a size: what ``direct`` and ``corrected`` draw at random from them is what Cycles' own sampling finds."""

from contextlib import contextmanager
from math import pi

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, material
from vgroove.addon.blender.choice import lamps_to_bind
from vgroove.lab.check.cook_torrance import SUN_THETAS, materials
from vgroove.lab.check.rows import SETUPS, Row, View
from vgroove.lab.check.views import disc, measure
from vgroove.lab.sidak import limit
from vgroove.nodegroups import lamp as lamp_group
from vgroove.nodegroups import osl_script, random_numbers

from .lights import KINDS, by_seed, floor_images, irradiance_material, make_lamp, white_diffuse

pytestmark = pytest.mark.blender


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
        gonio.sphere(stage, material.build(preset, choice))
        gonio.look_down(stage, 2.0)
        yield stage, items
