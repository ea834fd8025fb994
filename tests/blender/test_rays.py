# SPDX-License-Identifier: GPL-3.0-or-later
"""How many different rays a pixel has, and random numbers with them: foreseen, counted, warned of, mended."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, rays
from vgroove.addon.choose import advice
from vgroove.headless import scene
from vgroove.lab.bench import contenders
from vgroove.lab.bench import stability_pictures as pictures
from vgroove.lab.bench.scenes import stage
from vgroove.lab.bench.stability_pictures import Shot
from vgroove.lab.check.cook_torrance import materials
from vgroove.lab.check.rows import SETUPS
from vgroove.lab.sidak import limit
from vgroove.nodegroups import random_numbers
from vgroove.nodegroups._tree import Value

pytestmark = pytest.mark.blender

FEW = (Shot(where=3e3), Shot(where=1e4), Shot(scale=1e-4, where=1.0), Shot(where=10.0, filter_width=0.01))
MANY = (Shot(), Shot(where=1e4, opened=True), Shot("PERSP", 1e5), Shot(where=10.0, filter_width=0.01, opened=True))


def foreseen(shot):
    with pictures._shown(shot, SETUPS[0], pictures._numbers_material) as shown:
        return rays.different_rays(shown)


@pytest.mark.parametrize("shot", FEW, ids=str)
def test_few_rays_are_foreseen_as_cycles_renders_them(instrument, shot):
    """Numbers are counted on a grid in one pixel: up to half the places there are cut by an edge."""
    counted = pictures.numbers(shot)
    assert counted > 1.0
    assert counted < pictures.NUMBERS**2 / 2
    assert counted / 2 <= foreseen(shot) <= 2 * counted


@pytest.mark.parametrize("shot", MANY, ids=str)
def test_near_the_origin_in_perspective_or_by_an_aperture_all_rays_differ(instrument, shot):
    """But for a few of 4096, which birthdays among 2^22 places explain: 2 pairs, and 4 sqrt(2) more."""
    pairs = rays.SAMPLED_RAYS * (rays.SAMPLED_RAYS - 1) / 2
    for count in (pictures.numbers(shot), foreseen(shot)):
        assert count >= pairs / 8


@pytest.mark.parametrize("places", [1, 30, 3000, 50000])
def test_the_rays_that_differ_are_told_from_the_pairs_that_do_not(places):
    """Also of more than are drawn. Pairs are known to the root of their number."""
    drawn = np.random.default_rng(0).integers(0, places, rays.SAMPLED_RAYS)
    pairs = rays.SAMPLED_RAYS**2 / 2 / places
    found = rays.different(np.unique(drawn, return_counts=True)[1])
    assert found == pytest.approx(places, rel=4.0 / pairs**0.5)


def test_what_comes_up_more_often_counts_for_fewer():
    """Half of all samples at one place meet as if there were but 4: the sum of p^2 is 1/4."""
    assert rays.different(np.array([2**20, *[1] * 2**20])) == pytest.approx(4.0, rel=1e-5)


def without_parametric(tree):
    """The hash of position and direction alone."""
    stream = tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="")
    kind = {"kind": "ShaderNodeTexWhiteNoise", "noise_dimensions": "4D"}
    direction = tree.node(Vector=tree.geometry("Incoming"), W=stream, **kind)
    noise = tree.node(Vector=tree.geometry("Position"), W=Value(tree, direction.outputs["Value"]), **kind)
    tree.output_vector("Random", Value(tree, noise.outputs["Color"]), tip="")


def test_what_moves_far_from_the_origin_has_random_numbers_by_its_triangles(blender, monkeypatch):
    """World space has few places there; within a triangle that moves by less than these there are many."""
    shot = Shot(where=1e4, moving="object")
    now = pictures.numbers(shot)
    monkeypatch.setattr(random_numbers, "build", without_parametric)
    monkeypatch.setattr(random_numbers, "REVISION", 0)
    assert now > 2 * pictures.numbers(shot)


@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[2]], ids=str)
def test_an_aperture_takes_away_what_noise_the_origin_adds(instrument, setup):
    """Of 1024 pixels the spread is known to 1/sqrt(2048); without the aperture it is far from what samples explain."""
    expected = limit(2) / 2048**0.5
    assert abs(pictures.photo(Shot(where=1e4, opened=True), setup).noise - 1.0) <= expected
    far = pictures.photo(Shot(where=1e4), setup)
    assert far.noise > 1.0 + 2 * expected
    assert far.warned


def test_seeds_and_frames_of_a_far_picture_have_noise_of_their_own(instrument):
    """With the aperture; a pattern would be the same: 1024 pixels correlate by 1/32 at random."""
    images = []
    with pictures._shown(Shot(where=1e4, opened=True), SETUPS[0], white) as shown, headless.quiet():
        for seed in (0, 1):
            shown.cycles.seed = seed
            images.append(gonio.rendered(shown)[..., 0].ravel())
    assert abs(np.corrcoef(*images)[0, 1]) < limit(1) / 32


@pytest.mark.parametrize("backend", ["nodes", "osl"])
@pytest.mark.parametrize("estimator", ["mirror", "direct"])
def test_a_pixels_first_sample_has_numbers_of_its_own_by_every_seed(blender, estimator, backend):
    """Cycles sends it through the pixel's middle, by whatever seed. A seed is the same picture each time, and in every
    frame where it is not animated."""
    drawn = []
    with headless.quiet(), stage("softbox", 16) as shown:
        made = contenders.ours(contenders.subjects()["rough"], (backend,), lamps=True)
        rival = next(one for one in made if one.estimator == estimator)
        shown.item.active_material = rival.make(shown.scene)
        cycles = shown.scene.cycles
        cycles.shading_system, cycles.samples = backend == "osl", 1
        for cycles.seed, cycles.use_animated_seed, frame in (
            (1, False, 1),
            (1, False, 2),
            (2, False, 1),
            (1, True, 1),
            (1, True, 2),
        ):
            shown.scene.frame_set(frame)
            drawn.append(gonio.rendered(shown.scene)[shown.judged])
    hits = [image > 0.0 for image in drawn]  # what mirror's facets see of the lamp; its strength is what it is
    one, later, two, *animated = hits if estimator == "mirror" else drawn
    assert np.array_equal(one, later)
    for a, b in ((one, two), (one, animated[0]), animated):
        assert not np.array_equal(a, b)


def white():
    preset = materials()["white"].with_parameters(m=pictures.SLOPE)
    return pictures.build(preset, pictures.Choice("nodes", "mirror"))


@pytest.fixture
def far(blender, quick_sky):
    """The preview scene 10 km from the origin, through an orthographic camera."""
    with headless.quiet():
        shown = scene.preview()
    for item in shown.objects:
        item.location = [part + 1e4 for part in item.location]
    shown.camera.data.type, shown.camera.data.ortho_scale = "ORTHO", 3.0
    shown.cycles.samples = 256
    shown.view_layers[0].update()
    return shown


def named(shown, estimator="mirror", **more):
    return [problem for problem in advice.problems(shown, "nodes", estimator, **more) if problem.key == "rays"]


def test_the_panel_says_so_and_its_button_opens_the_aperture_a_little(far):
    """Focus goes to what is in the middle of the picture; 1024 pixels nearer, a point blurs to 1/16 of a pixel."""
    (problem,) = named(far)
    assert "orthographic" in problem.text
    assert "\n" not in problem.text
    problem.fix()
    assert named(far) == []
    camera = far.camera.data
    assert camera.dof.focus_distance == pytest.approx(np.hypot(8.2, 1.2) - 1.0, abs=0.15)  # the ball's near side
    blur = rays.aperture(camera) / rays.focal_distance(far.camera) * 1024
    assert blur == pytest.approx(1 / 16, rel=1e-5)


def test_the_panel_warns_of_as_few_samples_as_gain_noise(far):
    """With M rays N samples have the noise of 1 / (1 / N + 1 / M): 6 % more at M = 8 N."""
    found = rays.different_rays(far)
    for samples, warned in ((int(found / 8), False), (int(found / 8) + 1, True)):
        far.cycles.samples = samples
        assert bool(named(far)) == warned
    far.cycles.samples = 256
    (problem,) = named(far)
    assert f"256 samples are as noisy as {1.0 / (1.0 / 256 + 1.0 / found):.0f}" in problem.text


def test_nobody_is_warned_of_more_samples_than_can_be_told(far):
    far.camera.data.type = "PERSP"
    far.cycles.samples = 2**24
    assert named(far) == []


def test_of_a_scene_in_motion_only_what_stands_still_is_spoken_of(far):
    far.render.use_motion_blur = True
    (problem,) = named(far)
    assert "where nothing moves" in problem.text


def test_what_draws_nothing_at_random_is_not_warned_of(far):
    assert named(far, "fit") == []
    assert named(far, model="glass", m=0.0) == []
    assert named(far, model="glass", m=0.1) != []
    far.camera.data.type = "PERSP"
    assert named(far) == []


def test_bound_lamps_with_a_size_are_warned_of_too(far):
    """``corrected`` draws a place on them."""
    assert named(far, "corrected") == []
    far.objects["Sun"].data.angle = 0.1
    assert named(far, "corrected") != []


def test_too_narrow_a_pixel_filter_is_widened_first(far):
    for item in far.objects:
        item.location = [part - 9900.0 for part in item.location]
    far.cycles.filter_width = 0.01
    far.view_layers[0].update()
    (problem,) = named(far)
    assert "filter" in problem.text
    problem.fix()
    assert named(far) == []


def test_a_focus_object_is_kept(far):
    far.camera.data.dof.focus_object = far.objects["Ball"]
    rays.open_aperture(far)
    assert rays.focal_distance(far.camera) == pytest.approx(np.hypot(8.2, 1.2), abs=0.2)
    assert far.camera.data.dof.focus_object == far.objects["Ball"]
