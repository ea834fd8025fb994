# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists do to a course: stretch it, reverse it, bake it, take it away and add it again."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import course, material, rebuild
from vgroove.addon.blender.course import AnimationError, Play
from vgroove.addon.blender.material import Choice, MaterialError, build, lamps_to_bind
from vgroove.addon.library.presets import find
from vgroove.addon.models import parameter
from vgroove.nodegroups import trajectory

from .courses import CHANGING, SHORT, made, shown, stiff

pytestmark = pytest.mark.blender


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
        for key in a:
            np.testing.assert_allclose(a[key], b[key], atol=2e-6)
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
            to_input = parameter(name).scale.to_input  # whose keys are placed
            reach = np.ptp([to_input(each[name]) for each in before], axis=0).max()
            assert np.abs(to_input(value) - to_input(expected[name])).max() <= 1.01e-3 * reach + 1e-6


def test_baking_keeps_what_an_artist_changed_in_a_ramp(blender):
    """The keys are read from the nodes, or the script's text, as they are now."""
    one = made(blender, find(SHORT[0]), driving="age", start=0.0, length=100.0)
    group = course.trajectory_node(one).node_tree
    last = (
        next(node for node in group.nodes if node.bl_idname == "NodeGroupOutput").inputs["Roughness"].links[0].from_node
    )
    last.inputs["After"].default_value = 0.77
    course.bake(one, material.parameter_sockets(one))
    assert float(shown(one, 100.0)["m"]) == pytest.approx(0.77**2, abs=1e-6)


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


def test_what_has_no_keys_cannot_be_retimed(blender):
    with pytest.raises(AnimationError, match="has no keys"):
        course.retime([], 1.0, 2.0)
