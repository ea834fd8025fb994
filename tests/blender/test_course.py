# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that change: both ways of driving are one course, what stands still stays plain, and what is added goes."""

import math

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import course, fcurves, gonio, images, material, origin, rebuild
from vgroove.addon.blender.course import AnimationError, Play
from vgroove.addon.blender.material import Choice, MaterialError, build, lamps_to_bind
from vgroove.addon.library.presets import find, parse, shipped
from vgroove.addon.reference import local_age, place_keys, rendered
from vgroove.headless import sequence
from vgroove.lab.check.cook_torrance import fresnel_approximation
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.lab.check.time import (
    FURNACE_MOMENTS,
    MOMENTS,
    NOISY_ROWS,
    at_frame,
    direct_row,
    hybrid_row,
    moments,
    play_of,
)
from vgroove.lab.check.views import direct_bar
from vgroove.nodegroups import osl_script, ramp, trajectory

pytestmark = pytest.mark.blender

CHANGING = sorted(preset.id for preset in shipped().values() if preset.time)
SHORT = "time_varying/rusting_iron", "time_varying/curing_lacquer", "time_varying/heat_tinted_steel"
# With these every model and every law that changes a parameter of it; `vgroove check` has all courses.
MORE = "time_varying/yellowing_paper", "time_varying/copper_patina", "time_varying/drying_wood"
SVM_AND_OSL = (SETUPS[0], SETUPS[2])
EPS = 2.0**-24
# Flash of two colours and a slope with a kink: rates apart by 1e5
STIFF = """name = "Stiff"
model = "sum"
d = 0.6
s = 0.4
albedo = [0.8, 0.2, 0.1]
sigma = 0.3
m = 0.1
[fresnel]
f0 = [0.9, 0.6, 0.5]
[source]
data = "test"
[time]
unit = "h"
range = [0.0, 10.0]
kind = "authored"
[time.albedo]
law = "exponential"
end = [0.1, 0.5, 0.1]
rates = [1e5, 0.3]
shares = [0.5, 0.5]
[time.m]
law = "keys"
times = [2.0, 2.001, 10.0]
values = [0.2, 0.6, 0.3]
[time.d]
law = "polynomial"
coefficients = [-0.5]
"""


def stiff():
    return parse(STIFF, "test/stiff", "stiff.toml")


def made(blender, preset, backend="nodes", estimator="fit", **play):
    """A material that plays its course, on an object of the scene so that Blender evaluates it."""
    with headless.quiet():
        one = build(preset, Choice(backend, estimator, play=Play(**play)))
    mesh = blender.data.meshes.new("Plane")
    mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(one)
    blender.context.scene.collection.objects.link(blender.data.objects.new("Plane", mesh))
    return one


def shown(one, frame):
    """The inputs of a material at a frame, as its curves or its trajectory's keys have them."""
    import bpy

    bpy.context.scene.frame_set(int(frame), subframe=frame - int(frame))
    sockets = material.parameter_sockets(one)
    values = {
        name: np.array(of.default_value)[:3] if of.type in {"RGBA", "VECTOR"} else np.array(of.default_value)
        for name, of in sockets.items()
    }
    node = course.trajectory_node(one)
    if node is not None:
        age = node.inputs["Age"].default_value
        local = local_age(age, node.inputs["Rate"].default_value, node.inputs["Offset"].default_value)
        for label, played in trajectory.keys_of(node.node_tree).items():
            name = next(name for name in sockets if material.socket_name(name) == label)
            ages, points = (np.array(part) for part in zip(*played, strict=True))
            values[name] = course.Keys(ages, points)(local)
    return values


# Cycles against the reference, at twenty moments of every preset


@pytest.mark.parametrize("setup", SVM_AND_OSL, ids=str)
@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("name", CHANGING)
def test_direct_renders_every_moment_as_the_reference_has_it(instrument, name, driving, setup):
    """Within the bars of the slope at that moment; red against a reference 1 % brighter."""
    row = direct_row(setup, driving, name)
    assert len(row.views) == MOMENTS
    assert row.passed, row.as_json()
    assert not row.scaled(1.01).passed
    assert not row.scaled(1 / 1.01).passed


@pytest.mark.parametrize(
    "name", [*SHORT[::2], *(pytest.param(name, marks=pytest.mark.more) for name in (SHORT[1], *MORE))]
)
def test_hybrid_sends_back_at_every_moment_what_the_reference_says(instrument, name):
    """By Z-tests, in both backends and both ways of driving; one item, as they share the reference: a sum and a metal.

    F-curves on an OSL material's inputs are those of nodes: they are looked at on a few.
    """
    for setup in SVM_AND_OSL:
        for driving in course.DRIVINGS if name in SHORT or setup.backend == "nodes" else ("age",):
            row = hybrid_row(setup, driving, name)
            assert len(row.views) == FURNACE_MOMENTS
            assert row.passed, (str(setup), driving, row.as_json())
            if not fresnel_approximation(setup, find(name).kind):  # on 4.5 native Fresnel terms are approximate
                assert row.resolves <= surely_seen(0.01, NOISY_ROWS)
                assert not row.scaled(1.01).passed


@pytest.mark.parametrize("setup", SVM_AND_OSL, ids=str)
@pytest.mark.parametrize("name", SHORT)
def test_the_instrument_sees_a_course_that_is_off_by_one_percent_of_its_length(instrument, monkeypatch, name, setup):
    """Keys 1 % of the course too late turn the row red, in both ways of driving."""
    original = course.keyframes

    def late(changes, play):
        found = original(changes, play)
        return {name: course.Keyframes(0.99 * keys.times + 0.01, keys.values) for name, keys in found.items()}

    for driving in course.DRIVINGS:
        play = play_of(find(name), driving)
        frames = moments(find(name), play)[::3]
        geometry = gonio.Geometry(45.0, 0.0, (32, 32))
        with monkeypatch.context() as patch, headless.quiet():
            patch.setattr(course, "keyframes", late)
            images = gonio.measure_course(
                find(name), setup.backend, "direct", geometry, play, frames, shading_osl=setup.shading_osl
            )
        worst = 0.0
        for image, frame in zip(images, frames, strict=True):
            of = at_frame(find(name), play, frame).reference()
            expected = rendered(of, "direct")(geometry.wi(), geometry.wo())
            worst = max(worst, np.abs(image - expected).max() / expected.max())
        assert worst > 10.0 * direct_bar(0.02)


@pytest.mark.parametrize("setup", SVM_AND_OSL, ids=str)
@pytest.mark.parametrize("name", [*SHORT, "time_varying/copper_patina"])
def test_both_ways_of_driving_give_one_picture(instrument, name, setup):
    """To float32 rounding of the parameters, at the same frames."""
    preset = find(name)
    play = play_of(preset, "curves")
    frames = moments(preset, play)[::3]
    geometry = gonio.Geometry(45.0, 0.0, (32, 32))
    with headless.quiet():
        images = [
            gonio.measure_course(
                preset,
                setup.backend,
                "direct",
                geometry,
                play_of(preset, driving),
                frames,
                shading_osl=setup.shading_osl,
            )
            for driving in course.DRIVINGS
        ]
    peak = images[0].max(axis=(1, 2, 3), keepdims=True)
    assert (np.abs(images[0] - images[1]) / peak).max() <= rounding_of(preset, play)


def rounding_of(preset, play):
    """By how much f may differ, relative to its peak, where the parameters' interpolation rounds in float32.

    A value rounds in its key and in the sum and product that make it, 4 times 2^-24 of itself; an age rounds in the
    product and quotient that make it, 4 times 2^-24 of itself, which the steepest piece at that age makes a value of.
    D has at most 10 times the relative error of its slope where it is not next to 0: d ln D / d ln m is
    2 tan^2 / m^2 - 2, and tan^2 < 6 m^2. All parameters add up; f is no more than proportional to the others.
    """
    total = 0.0
    for name, keys in course.keyframes(preset.trajectory(), play).items():
        values = keys.values.reshape(len(keys.times), -1)
        steepest = np.abs(np.diff(values, axis=0)).max(axis=1) / np.diff(keys.times) * keys.times[1:]
        rounded = 4.0 * EPS * (np.abs(values).max() + steepest.max())
        total += 10.0 * rounded / values.min() if name == "m" else rounded / values.max()
    return total


# Materials hold what they need


def test_a_material_that_stands_still_has_nothing_of_time(blender):
    """No nodes, drivers or actions, also of a preset that could change."""
    for name in ("lecture/copper", "plastics/red_plastic", *SHORT):
        for backend in material.BACKENDS:
            with headless.quiet():
                one = build(find(name), Choice(backend, "fit"))
            assert one.node_tree.animation_data is None
            assert one.animation_data is None
            assert origin.read(one).play is None
            assert not material.plays(one)
    assert len(blender.data.actions) == 0
    names = [group.name for group in blender.data.node_groups]
    assert not any(word in name for name in names for word in (ramp.NAME, trajectory.NAME))
    assert not any("trajectory" in text.name for text in blender.data.texts)


@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("name", CHANGING)
def test_only_what_changes_has_curves_or_is_driven(blender, name, driving):
    """F-curves of the changing parameters alone, or one of Age and links to them alone; no drivers."""
    preset = find(name)
    one = made(blender, preset, driving=driving)
    data = one.node_tree.animation_data
    assert len(data.drivers) == 0
    sockets = material.parameter_sockets(one)
    paths = {socket.path_from_id("default_value"): name for name, socket in sockets.items()}
    found = material.curves(one)
    assert len(found) == len(fcurves.channelbag(one).fcurves)
    if driving == "curves":
        assert {paths[curve.data_path] for curve in found} == set(preset.time.laws)
        assert course.trajectory_node(one) is None
    else:
        assert len(found) == 1
        assert {name for name, socket in sockets.items() if socket.is_linked} == set(preset.time.laws)


def test_each_material_is_made_once(blender):
    """Same preset, same play: the same material, also at another frame; another play, or none: another one."""
    with headless.quiet():
        first = build(find(SHORT[0]), Choice(play=Play()))
        blender.context.scene.frame_set(77)
        assert build(find(SHORT[0]), Choice(play=Play())) == first
        assert not material.is_edited(first)
        assert build(find(SHORT[0]), Choice(play=Play(length=100.0))) != first
        assert build(find(SHORT[0]), Choice()) != first
        course.retime(material.curves(first), 5.0, 50.0)
        assert material.is_edited(first)
        assert build(find(SHORT[0]), Choice(play=Play())) != first


# Keys and frames


@pytest.mark.parametrize("driving", course.DRIVINGS)
@pytest.mark.parametrize("interpolation", course.INTERPOLATIONS)
def test_keys_stay_within_the_tolerance_of_the_law(blender, driving, interpolation):
    """As Blender plays them; with handles no value leaves the parameter's own range between any two frames."""
    if driving == "age" and interpolation == "shape":
        with pytest.raises(AnimationError, match="goes straight between keys"):
            Play(driving, interpolation=interpolation)
        return
    preset = stiff()
    changes = preset.trajectory()
    # so long that the flash, 1e-5 h, lasts a frame
    one = made(blender, preset, driving=driving, interpolation=interpolation, start=1.0, length=1e6, tolerance=1e-3)
    parts = np.geomspace(1e-7, 1.0, 150), np.linspace(0.0, 1.0, 60), np.linspace(0.19, 0.21, 60)
    ages = np.unique(np.concatenate(parts))
    frames = np.float32(1.0 + ages * 1e6).astype(float)
    values = [shown(one, frame) for frame in frames]
    for name in changes.laws:
        got = np.array([value[name] for value in values])
        law = changes.value(name, changes.time((frames - 1.0) / 1e6))
        reach = np.ptp(law, axis=0).max()
        # float32: a value rounds by 2^-24, and a frame by 2^-24 of itself, at the law's steepest slope there
        steep = np.abs(np.gradient(law, frames, axis=0)) * (frames * EPS)[(...,) + (None,) * (law.ndim - 1)]
        assert (np.abs(got - law) <= 1e-3 * reach + 4.0 * EPS + 2.0 * steep).all()
        whole = changes.value(name, np.concatenate([changes.laws[name].events(), changes.time(ages)]))
        assert (got >= whole.min(axis=0) - 1e-6).all()
        assert (got <= whole.max(axis=0) + 1e-6).all()


def test_transients_shorter_than_a_frame_are_kept(blender):
    """A flash of a twentieth of a frame is seen by who looks between frames."""
    one = made(blender, stiff(), start=1.0, length=5e3)  # the flash, 1e-5 h, is 1/200 frame
    before, inside, after = (float(shown(one, frame)["albedo"][0]) for frame in (1.0, 1.0 + 5e3 * 1e-6, 1.1))
    assert before == pytest.approx(0.8, abs=1e-6)
    assert inside == pytest.approx(0.45 + 0.35 * math.exp(-1.0), abs=0.01)
    assert after == pytest.approx(0.45, abs=1e-3)


def test_cycles_reads_materials_once_a_frame(blender):
    """With motion blur too: the shutter does not average what changes, whatever its position."""
    one = made(blender, find("time_varying/yellowing_paper"), estimator="closure", start=1.0, length=2.0)
    (curve, *_) = material.curves(one)
    with headless.quiet(), gonio.stage((4, 4), samples=16, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        gonio._patch(stage, one, gonio.Geometry())
        camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
        camera.location.z = 2.0
        stage.collection.objects.link(camera)
        stage.camera = camera
        for item in (stage, blender.context.scene):
            item.frame_set(2)
        stage.render.motion_blur_shutter = 1.0
        images = []
        for blurred, position in ((False, "CENTER"), (True, "START"), (True, "CENTER"), (True, "END")):
            stage.render.use_motion_blur, stage.render.motion_blur_position = blurred, position
            images.append(gonio.rendered(stage))
    assert curve.evaluate(1.5) != curve.evaluate(2.0)
    for image in images[1:]:
        np.testing.assert_allclose(image, images[0], rtol=1e-5)


@pytest.fixture
def flash(blender, empty_material):
    """The window's scene with a plane that glows with 1 at frame 2 and with 0 a quarter of a frame before and after."""
    one = empty_material()
    tree = one.node_tree
    glow, sink = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(glow.outputs[0], sink.inputs["Surface"])
    for frame, value in ((1.75, 0.0), (2.0, 1.0), (2.25, 0.0)):
        glow.inputs["Strength"].default_value = value
        glow.inputs["Strength"].keyframe_insert("default_value", frame=frame)
    for curve in fcurves.channelbag(one).fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    view = blender.context.scene
    mesh = blender.data.meshes.new("Plane")
    mesh.from_pydata([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(one)
    camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
    camera.location.z = 2.0
    for item in (camera, blender.data.objects.new("Plane", mesh)):
        view.collection.objects.link(item)
    view.camera, view.render.engine, view.cycles.use_denoising = camera, "CYCLES", False
    view.view_settings.view_transform = "Standard"
    view.render.dither_intensity = 0.0
    return view


@pytest.mark.parametrize("ending", ["exr", "png"])
@pytest.mark.parametrize("shutter", [0.0, 0.5, 1.0])
def test_an_exposed_frame_sees_what_happens_within_it(flash, tmp_path, shutter, ending):
    """The mean over the shutter, here of a triangle of half a frame: 1/2 of it, and 1/4 of a whole frame."""
    path = tmp_path / f"frame.{ending}"
    flash.render.use_motion_blur = True
    with headless.quiet():
        assert not sequence.frame_to(flash, 2, path, "a note", shutter, samples=16, seed=3, resolution=(4, 4))
        assert sequence.frame_to(flash, 2, path, "a note", shutter, samples=16, seed=3, resolution=(4, 4))
    assert not sequence.is_done(path, "another note")
    assert flash.render.use_motion_blur
    # At midpoints of equal parts the mean of straight lines is exact, as the tips of the triangle lie between them.
    expected = {0.0: 1.0, 0.5: 0.5, 1.0: 0.25}[shutter]
    image = images.load(path)
    if ending == "png":
        np.testing.assert_allclose(image, images.srgb(np.float32(expected)), atol=0.5 / 255 + 1e-4)
    else:
        np.testing.assert_allclose(image, expected, rtol=1e-5)


@pytest.mark.parametrize("factor", [1e-6, 1e6])
@pytest.mark.parametrize("driving", course.DRIVINGS)
def test_an_extreme_retime_stays_finite_and_keeps_the_ends(blender, driving, factor):
    """A millionth or a million times as long."""
    one = made(blender, stiff(), driving=driving, start=10.0, length=100.0)
    start, end = (shown(one, frame) for frame in (10.0, 110.0))
    course.retime(material.curves(one), 10.0, 100.0 * factor)
    for frame in (-1000.0, 0.0, 10.0):
        for name, value in shown(one, frame).items():
            np.testing.assert_allclose(value, start[name], atol=1e-6)
    for frame in (10.0, 10.25, 11.0, 200.0, 1e6):
        assert all(np.isfinite(value).all() for value in shown(one, frame).values())
    if factor < 1.0:
        for name, value in shown(one, 11.0).items():
            np.testing.assert_allclose(value, end[name], atol=1e-6)
    course.retime(material.curves(one), 10.0, 100.0)
    for name, value in shown(one, 110.0).items():
        np.testing.assert_allclose(value, end[name], atol=1e-6)


@pytest.mark.parametrize("driving", course.DRIVINGS)
def test_reverse_plays_the_course_from_its_end(blender, driving):
    """At frame f what was at first + last - f; twice is once again."""
    one = made(blender, find(SHORT[0]), driving=driving, start=5.0, length=60.0)
    frames = np.linspace(0.0, 70.0, 29)
    before = [shown(one, frame) for frame in frames]
    course.reverse(material.curves(one))
    mirrored = [shown(one, 70.0 - frame) for frame in frames]
    for a, b in zip(before, mirrored, strict=True):
        for name in a:
            np.testing.assert_allclose(a[name], b[name], atol=2e-6)
    course.reverse(material.curves(one))
    for a, frame in zip(before, frames, strict=True):
        for name, value in shown(one, frame).items():
            np.testing.assert_allclose(a[name], value, atol=2e-6)


def test_reverse_keeps_handles_too(blender):
    one = made(blender, find("time_varying/drying_paint"), interpolation="shape", start=5.0, length=60.0)
    frames = np.linspace(5.0, 65.0, 41)
    before = [float(shown(one, frame)["m"]) for frame in frames]
    course.reverse(material.curves(one))
    after = [float(shown(one, 70.0 - frame)["m"]) for frame in frames]
    np.testing.assert_allclose(before, after, atol=2e-6)


@pytest.mark.parametrize("backend", material.BACKENDS)
@pytest.mark.parametrize("name", CHANGING)
def test_baking_gives_the_curves_that_would_have_been_made(blender, name, backend):
    """Age turned into F-curves: the same keys as driving by curves has, and nothing else is left."""
    preset = find(name)
    aged = made(blender, preset, backend, driving="age", start=3.0, length=500.0)
    curved = made(blender, preset, backend, driving="curves", start=3.0, length=500.0)
    before = [shown(aged, frame) for frame in (1.0, 40.0, 333.25, 600.0)]
    course.bake(aged, material.parameter_sockets(aged))
    assert course.trajectory_node(aged) is None
    assert not [group for group in blender.data.node_groups if group.name.startswith(trajectory.NAME)]
    assert not [text for text in blender.data.texts if "trajectory" in text.name]
    after = [shown(aged, frame) for frame in (1.0, 40.0, 333.25, 600.0)]
    for a, b in zip(before, after, strict=True):
        for parameter in a:
            np.testing.assert_allclose(a[parameter], b[parameter], atol=2e-6)
    both = [sorted(material.curves(one), key=lambda c: (c.data_path, c.array_index)) for one in (aged, curved)]
    assert len(both[0]) == len(both[1])
    for a, b in zip(*both, strict=True):
        points = [np.array([point.co for point in curve.keyframe_points]) for curve in (a, b)]
        if len(points[0]) == len(points[1]):  # keys that Blender could not tell apart are left out of either
            np.testing.assert_allclose(*points, rtol=1e-6, atol=1e-5)


def test_baking_follows_a_curve_of_age_that_an_artist_shaped(blender):
    """A pause in the middle, a smooth start, and a clock that is late and fast."""
    one = made(blender, find(SHORT[0]), driving="age", start=0.0, length=100.0)
    (curve,) = material.curves(one)
    curve.keyframe_points[0].interpolation = "BEZIER"
    node = course.trajectory_node(one)
    node.inputs["Rate"].default_value, node.inputs["Offset"].default_value = 1.5, 0.2
    frames = np.linspace(0.0, 100.0, 41)
    before = [shown(one, frame) for frame in frames]
    course.bake(one, material.parameter_sockets(one))
    for frame, expected in zip(frames, before, strict=True):
        for name, value in shown(one, frame).items():
            reach = np.ptp([each[name] for each in before], axis=0).max()
            assert np.abs(value - expected[name]).max() <= 1.01e-3 * reach + 1e-6


def test_baking_keeps_what_an_artist_changed_in_a_ramp(blender):
    """The keys are read from the nodes, or the script's text, as they are now."""
    one = made(blender, find(SHORT[0]), driving="age", start=0.0, length=100.0)
    group = course.trajectory_node(one).node_tree
    last = (
        next(node for node in group.nodes if node.bl_idname == "NodeGroupOutput").inputs["Slope m"].links[0].from_node
    )
    last.inputs["After"].default_value = 0.77
    course.bake(one, material.parameter_sockets(one))
    assert float(shown(one, 100.0)["m"]) == pytest.approx(0.77, abs=1e-6)


def test_a_clock_from_a_texture_cannot_be_baked(blender):
    one = made(blender, find(SHORT[0]), driving="age")
    node = course.trajectory_node(one)
    noise = one.node_tree.nodes.new("ShaderNodeTexNoise")
    one.node_tree.links.new(noise.outputs[0], node.inputs["Offset"])
    with pytest.raises(AnimationError, match="come from a texture, which no curve can follow"):
        course.bake(one, material.parameter_sockets(one))
    assert course.trajectory_node(one) is not None
    curved = made(blender, find(SHORT[0]))
    with pytest.raises(AnimationError, match="is not driven by Age"):
        course.bake(curved, material.parameter_sockets(curved))


@pytest.mark.parametrize("backend", material.BACKENDS)
@pytest.mark.parametrize("driving", course.DRIVINGS)
def test_removing_leaves_the_moment_and_nothing_else(blender, driving, backend):
    """The material stands as the frame showed it; no curve, action, node, group or text stays. Lamps stay bound."""
    lamp = blender.data.objects.new("Lamp", blender.data.lights.new("Lamp", "SUN"))
    blender.context.scene.collection.objects.link(lamp)
    bound = lamps_to_bind(blender.context.scene, "direct")
    with headless.quiet():
        one = build(find(SHORT[0]), Choice(backend, "direct", bound, play=Play(driving, 1.0, 100.0)))
    groups = {group.name for group in blender.data.node_groups if not group.name.startswith(trajectory.NAME)}
    blender.context.scene.frame_set(31)
    expected = find(SHORT[0]).trajectory().at(0.3)
    material.stop(one)
    after = shown(one, 90.0)
    for name in find(SHORT[0]).time.laws:
        np.testing.assert_allclose(after[name], expected[name], atol=1e-3)
    assert not material.plays(one)
    assert len(blender.data.actions) == 0
    assert {group.name for group in blender.data.node_groups} == groups
    assert not [text for text in blender.data.texts if "trajectory" in text.name]
    assert [node.label for node in one.node_tree.nodes if node.label.startswith("Light")] == ["Light 1: SUN sized 1"]


def test_a_course_can_be_added_again_and_reset(blender):
    """After it was taken away, or changed: as it was built."""
    one = made(blender, find(SHORT[0]), start=1.0, length=100.0)
    fresh = shown(one, 51.0)
    course.retime(material.curves(one), 200.0, 10.0)
    rebuild.reset(one, blender.context.scene)
    for name, value in shown(one, 51.0).items():
        np.testing.assert_allclose(value, fresh[name], atol=1e-6)
    assert not material.is_edited(one)
    material.stop(one)
    material.play(one, Play("age", 1.0, 100.0))
    for name, value in shown(one, 51.0).items():
        np.testing.assert_allclose(value, fresh[name], atol=1e-6)
    still = build(find("lecture/copper"), Choice())
    with pytest.raises(MaterialError, match="does not change over time"):
        material.play(still, Play())
    with pytest.raises(MaterialError, match="does not change over time; leave play out"):
        build(find("lecture/copper"), Choice(play=Play()))


def test_a_saved_file_plays_as_before(blender, tmp_path):
    """Keys nearer than a hundredth of a frame too, which Blender's own tools would merge."""
    paths = {}
    for driving in course.DRIVINGS:
        with headless.quiet():
            blender.ops.wm.read_factory_settings(use_empty=True)
        one = made(blender, stiff(), driving=driving, start=1.0, length=5e3)
        frames = (1.0, 1.005, 1.01, 40.5, 1000.0, 1001.0)
        before = [shown(one, frame) for frame in frames]
        paths[driving] = tmp_path / f"{driving}.blend"
        with headless.quiet():
            blender.ops.wm.save_as_mainfile(filepath=str(paths[driving]))
            blender.ops.wm.open_mainfile(filepath=str(paths[driving]))
        again = blender.data.objects["Plane"].active_material
        for frame, expected in zip(frames, before, strict=True):
            for name, value in shown(again, frame).items():
                np.testing.assert_allclose(value, expected[name], atol=1e-7)


# Textured clocks


@pytest.mark.parametrize("setup", SVM_AND_OSL, ids=str)
@pytest.mark.parametrize("name", [SHORT[0], SHORT[2]])
def test_a_plane_with_a_textured_clock_matches_the_reference_per_pixel(blender, name, setup):
    """Rate and Offset from an image: every pixel is the material at its own age."""
    size, frame, rng = 16, 40.0, np.random.default_rng(7)
    rate, offset = rng.uniform(0.0, 3.0, (size, size)), rng.uniform(-0.2, 0.8, (size, size))
    preset = find(name)
    play = Play("age", 1.0, 100.0)
    theta = np.radians(35.0)
    with headless.quiet(), gonio.stage((size, size), samples=1, seed=0, shading_osl=setup.shading_osl) as stage:
        gonio.light(stage, gonio.Geometry(35.0))
        bound = lamps_to_bind(stage, "direct", preset.model)
        one = build(preset, Choice(setup.backend, "direct", bound, shadows=False, play=play))
        _texture(blender, one, rate, offset)
        mesh = blender.data.meshes.new("Plane")
        mesh.from_pydata([(-1, -1, 0), (3, -1, 0), (-1, 3, 0)], [], [(0, 1, 2)])  # one triangle beyond the view
        layer = mesh.uv_layers.new()
        for loop, uv in enumerate([(0, 0), (2, 0), (0, 2)]):
            layer.data[loop].uv = uv
        mesh.materials.append(one)
        stage.collection.objects.link(blender.data.objects.new("Plane", mesh))
        gonio.look_down(stage, 2.0)
        for item in (stage, blender.context.scene):
            item.frame_set(int(frame))
        image = gonio.rendered(stage)[::-1]  # row 0 at v = 0, as the texture
    ages = local_age(np.float32(0.39), rate.astype(np.float32), offset.astype(np.float32))
    keys = {parameter: of.law() for parameter, of in course.keyframes(preset.trajectory(), play).items()}
    wi, wo = np.array([np.sin(theta), 0.0, np.cos(theta)]), np.array([0.0, 0.0, 1.0])
    expected = np.empty((size, size, 3))
    for index in np.ndindex(size, size):
        now = {parameter: law(ages[index]) for parameter, law in keys.items()}
        plain = {parameter: tuple(v.tolist()) if v.ndim else float(v) for parameter, v in now.items()}
        expected[index] = preset.with_parameters(**plain).reference().evaluate(wi, wo)
    assert np.unique(ages.round(6)).size > 100
    # An age rounds by a few 2^-24, of which a segment of 1/100 of the course makes 1e-5 of the step between two keys.
    assert np.abs(image - expected).max() <= direct_bar(0.1) * expected.max()
    shifted = np.roll(expected, 1, axis=0)
    assert np.abs(image - shifted).max() > 100.0 * direct_bar(0.1) * expected.max()


def _texture(blender, one, rate, offset):
    """Link an image's red and green to Rate and Offset, texel by texel."""
    size = len(rate)
    picture = blender.data.images.new("Clock", size, size, float_buffer=True, is_data=True)
    pixels = np.stack([rate, offset, 0.0 * rate, 0.0 * rate + 1.0], axis=-1)
    picture.pixels.foreach_set(pixels.astype(np.float32).ravel())
    picture.pack()
    tree = one.node_tree
    texture, split = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeSeparateColor")
    texture.image, texture.interpolation = picture, "Closest"
    tree.links.new(texture.outputs["Color"], split.inputs[0])
    node = course.trajectory_node(one)
    tree.links.new(split.outputs[0], node.inputs["Rate"])
    tree.links.new(split.outputs[1], node.inputs["Offset"])


# Bad input


@pytest.mark.parametrize(
    ("given", "complaint"),
    [
        ({"driving": "wind"}, 'unknown driving "wind"; use one of curves, age'),
        ({"interpolation": "wavy"}, 'unknown interpolation "wavy"'),
        ({"length": 0.0}, "length must be between 1e-06 and 1e"),
        ({"length": math.nan}, "length must be between"),
        ({"start": math.inf}, "start must be between"),
        ({"tolerance": 0.0}, "tolerance must be between 1e-06 and 0.1"),
    ],
)
def test_a_play_that_does_not_hold_is_refused(given, complaint):
    with pytest.raises(AnimationError, match=complaint):
        Play(**given)


def test_what_has_no_keys_cannot_be_retimed(blender):
    with pytest.raises(AnimationError, match="has no keys"):
        course.retime([], 1.0, 2.0)


def test_a_script_that_does_not_compile_leaves_nothing_behind(blender, monkeypatch):
    """No half-made material, group or text."""
    source = osl_script.source
    monkeypatch.setattr(osl_script, "source", lambda shader, tables=None: "no" if tables else source(shader))
    with headless.quiet(), pytest.raises(osl_script.OslError):
        build(find("time_varying/yellowing_paper"), Choice("osl", "direct", play=Play("age")))
    assert not [text for text in blender.data.texts if "trajectory" in text.name]
    assert not [group for group in blender.data.node_groups if group.name.startswith(trajectory.NAME)]
    assert len(blender.data.materials) == 0


def test_keys_of_a_course_are_those_that_the_reference_places(blender):
    """By age, within the tolerance that was asked for."""
    changes = find("time_varying/drying_paint").trajectory()
    for tolerance in (1e-2, 1e-3):
        keys = course.keyframes(changes, Play(tolerance=tolerance))
        for name in changes.laws:
            direct = place_keys(changes, name, tolerance)
            assert abs(keys[name].times.size - direct.times.size) <= 1
