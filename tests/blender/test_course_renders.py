# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles renders materials that change as the reference has them, at any moment and with a clock from a texture."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import course, gonio
from vgroove.addon.blender.course import Play
from vgroove.addon.blender.material import Choice, build, lamps_to_bind
from vgroove.addon.library.presets import find
from vgroove.addon.models import parameter
from vgroove.addon.reference import local_age, rendered
from vgroove.lab.check.cook_torrance import fresnel_approximation
from vgroove.lab.check.rows import surely_seen
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

from .courses import CHANGING, EPS, SHORT, SVM_AND_OSL

pytestmark = pytest.mark.blender

# With SHORT, every model and every law that changes a parameter of it; `vgroove check` has all courses.
MORE = "time_varying/yellowing_paper", "time_varying/copper_patina", "time_varying/drying_wood"

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

    def late(changes, play, scales=None):
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
    2 tan^2 / m^2 - 2, and tan^2 < 6 m^2; and m is the square of its input. All parameters add up; f is no more than
    proportional to the others.
    """
    total = 0.0
    for name, keys in course.keyframes(preset.trajectory(), play).items():
        values = keys.values.reshape(len(keys.times), -1)
        steepest = np.abs(np.diff(values, axis=0)).max(axis=1) / np.diff(keys.times) * keys.times[1:]
        rounded = 4.0 * EPS * (np.abs(values).max() + steepest.max())
        total += 20.0 * rounded / values.min() if name == "m" else rounded / values.max()
    return total


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
    keys = {name: of.law() for name, of in course.keyframes(preset.trajectory(), play).items()}
    wi, wo = np.array([np.sin(theta), 0.0, np.cos(theta)]), np.array([0.0, 0.0, 1.0])
    expected = np.empty((size, size, 3))
    for index in np.ndindex(size, size):
        now = {name: parameter(name).scale.of_input(law(ages[index])) for name, law in keys.items()}
        plain = {name: tuple(v.tolist()) if v.ndim else float(v) for name, v in now.items()}
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
