# SPDX-License-Identifier: GPL-3.0-or-later
"""Mitsuba's scenes against Cycles'."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.library import presets
from vgroove.addon.reference.fresnel import fresnel_conductor, schlick
from vgroove.headless import scene
from vgroove.lab.bench import contenders, mitsuba_peer, mitsuba_scenes, peers, scene_table, scenes
from vgroove.lab.bench.peers import cook_torrance, exported
from vgroove.nodegroups import versions

SIZE, SAMPLES, SEEDS = 16, 128, 8
COLOUR = (0.8, 0.6, 0.4)
COPPER = (0.95, 0.64, 0.54)


@pytest.fixture(scope="module")
def peer():
    with mitsuba_peer.started() as begun:
        yield begun


def test_conductor_has_schlicks_f0_and_is_nearest_to_schlick():
    """F0 to rounding, elsewhere at most as far as ``DIFFERS`` says, and farther with any other n."""
    cos = np.linspace(0.0, 1.0, 301)
    n, k = np.array(cook_torrance.conductor_like(COPPER))

    def distance(n, k):
        return np.max(np.abs(fresnel_conductor(cos, n, k) - schlick(cos, COPPER)), axis=0)

    np.testing.assert_allclose(fresnel_conductor(1.0, n, k), COPPER, rtol=1e-12)
    assert distance(n, k).max() < 0.007
    for factor in (0.9, 1.1):
        f0, other = np.array(COPPER), factor * n
        assert np.all(distance(other, np.sqrt((f0 * (other + 1) ** 2 - (other - 1) ** 2) / (1 - f0))) > distance(n, k))


def test_the_nearest_bsdf_has_the_numbers_of_its_preset():
    """Slope, colours, weights and index are read from the preset; without a slope it is smooth."""
    plastic = presets.find("plastics/red_plastic").with_parameters(m=0.25, d=0.3, s=0.6)
    found = mitsuba_peer.nearest(plastic)
    assert (found["type"], found["alpha"], found["int_ior"]) == ("roughplastic", 0.25, 1.49054)
    assert found["specular_reflectance"]["value"] == [0.6, 0.6, 0.6]
    assert found["diffuse_reflectance"]["value"] == pytest.approx([0.18, 0.012, 0.009])
    assert mitsuba_peer.nearest(plastic.with_parameters(m=0.0))["type"] == "plastic"
    gold = presets.find("metals/gold")
    assert mitsuba_peer.nearest(gold)["k"]["value"] == list(gold.parameters["k"])
    for other in ("translucent/marble", "glasses/window"):
        with pytest.raises(ValueError, match=f"nothing like {other}"):
            mitsuba_peer.nearest(presets.find(other))


def test_every_subject_of_the_report_has_a_peer_that_says_how_it_differs():
    """All that accuracy renders, and smooth forms of it; car paint, scattering bodies and ``exported`` have none."""
    for preset in contenders.subjects().values():
        if preset.model in {"car_paint", "translucent"} or peers.of(preset) is exported:
            continue
        assert mitsuba_peer.nearest(preset)["type"] in mitsuba_peer.DIFFERS
        if "m" in preset.parameters:
            assert mitsuba_peer.nearest(preset.with_parameters(m=0.0))["type"] in mitsuba_peer.DIFFERS


def test_the_maps_lattice_lies_where_mitsuba_looks():
    """Columns at pixels' middles, rows from pole to pole: what grows evenly is read off as it is."""
    y, x = np.mgrid[0:16, 0:32].astype(np.float32) / 32.0
    found = mitsuba_scenes.resampled(np.stack([x, y, 0 * x], axis=-1))
    assert found.shape == (17, 32, 3)
    inner = found[1:-1, 1:-1]  # elsewhere the map repeats or ends
    np.testing.assert_allclose(inner[..., 0], np.broadcast_to(np.arange(1, 31) / 32.0, (15, 30)), atol=1e-6)
    np.testing.assert_allclose(inner[..., 1].T, np.broadcast_to((np.arange(1, 16) - 0.5) / 32.0, (30, 15)), atol=1e-6)


def test_the_maps_cut_loses_no_light():
    """A bright pixel, interpolated and then cut, shines over its neighbourhood; points alone would hold a quarter.

    Its patch is a square of nearly 2 by 2 pixels. Eight probes a pixel place its edge to half a probe: of 8 pixels of
    edge 1 / 16, an eighth of the patch at most.
    """
    world = np.zeros((16, 32, 3), np.float32)
    world[8, 16] = 600.0
    tent = 1.0 - np.abs(np.linspace(-1.0, 1.0, 2001))
    light = 4.0 * np.mean(np.minimum(600.0 * np.outer(tent, tent), scene_table.BRIGHTEST))
    assert mitsuba_scenes.resampled(world).sum(axis=(0, 1)) == pytest.approx(np.full(3, light), rel=1.0 / 8.0)


def shaded(kind, **values):
    """A material of one node of Blender's."""
    made = versions.empty_material("Peer")
    bsdf, output = made.node_tree.nodes.new(kind), made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    made.node_tree.links.new(bsdf.outputs[0], output.inputs["Surface"])
    for name, value in values.items():
        if name in bsdf.inputs:
            bsdf.inputs[name].default_value = value
        else:
            setattr(bsdf, name, value)
    return made


def cycles(name, make):
    """Pictures by ``SEEDS`` seeds, of a ball without visible facets."""
    with headless.quiet(), scenes.stage(name, SIZE) as stage:
        stage.item.data = scene.ball_mesh(512, 256)  # within 2e-5 of a sphere
        assert stage.scene.cycles.max_bounces == mitsuba_scenes.BOUNCES
        stage.item.active_material = make()
        stage.scene.cycles.samples = SAMPLES
        stage.scene.view_layers[0].update()
        found = []
        for stage.scene.cycles.seed in range(SEEDS):
            found.append(gonio.rendered(stage.scene).astype(np.float64))
        return np.array(found)


def assert_same(ours, theirs, within):
    """Pictures by S seeds each differ by their noise, in the mean and pixel by pixel; channels see the same samples.

    The mean is judged by Student's t with 2 (S - 1) = 14 degrees of freedom, at 1 % over five comparisons (Sidak): 3.8.
    The squares of the pixels' differences add up to what their variances say; the sum of ~100 of them, of which the
    noisiest half does most, spreads by sqrt(2 / 50) = 0.2 of it, and 2 is five times that above.
    """
    ours, theirs = ours[:, within].mean(axis=-1), theirs[:, within].mean(axis=-1)
    means = ours.mean(axis=1), theirs.mean(axis=1)
    doubt = np.sqrt(sum(mean.var(ddof=1) for mean in means) / SEEDS)
    assert abs(means[0].mean() - means[1].mean()) < 3.8 * doubt
    expected = np.sum(ours.var(axis=0, ddof=1) + theirs.var(axis=0, ddof=1)) / SEEDS
    assert np.sum((ours.mean(axis=0) - theirs.mean(axis=0)) ** 2) < 2.0 * expected


def mitsuba(peer, name, bsdf):
    return np.array([peer.render(name, bsdf, SAMPLES, seed, SIZE).picture for seed in range(SEEDS)])


@pytest.mark.blender
@pytest.mark.parametrize("name", mitsuba_scenes.SCENES)
def test_mitsubas_scenes_are_those_of_cycles(blender, peer, name):
    """Camera, light, its units and its orientation: a Lambert ball is the same picture in both."""
    bsdf = {"type": "diffuse", "reflectance": mitsuba_scenes.rgb(COLOUR)}
    ours = cycles(name, lambda: shaded("ShaderNodeBsdfDiffuse", Color=(*COLOUR, 1.0)))
    everything = np.ones((SIZE, SIZE), np.bool_)
    assert_same(ours, mitsuba(peer, name, bsdf), everything if name == "checker" else scenes.ball_pixels(SIZE))


@pytest.mark.blender
def test_mitsubas_copper_is_cycles_metallic_bsdf(blender, peer):
    """The same D, F and slope, where G is the same; 4.5, which approximates F, has a metal that reflects all.

    Mitsuba's G is the product of Smith's for either direction, Cycles' knows that they are one height; as both take
    that of a direction to be 1 where tan < 1 / (1.6 m), they agree wherever the ball is seen at less than 64 degrees.
    """
    preset = presets.find("lecture/copper")
    bsdf = mitsuba_peer.nearest(preset)
    metallic = {"distribution": "BECKMANN", "Roughness": preset.m**0.5}
    if versions.EXACT_CONDUCTOR:
        metallic |= {
            "fresnel_type": "PHYSICAL_CONDUCTOR",
            "IOR": bsdf["eta"]["value"],
            "Extinction": bsdf["k"]["value"],
        }
    else:
        bsdf = {key: bsdf[key] for key in ("type", "distribution", "alpha")} | {"material": "none"}
        white = (1.0, 1.0, 1.0, 1.0)
        metallic |= {"fresnel_type": "F82", "Base Color": white, "Edge Tint": white}
    ours = cycles("softbox", lambda: shaded("ShaderNodeBsdfMetallic", **metallic))
    assert_same(ours, mitsuba(peer, "softbox", bsdf), scenes.ball_pixels(SIZE))


@pytest.mark.blender
def test_mitsuba_repeats_a_seed_and_keeps_time(peer):
    """A seed is a picture; the render time is reported."""
    first, again, other = (peer.render("softbox", mitsuba_peer.TRIAL, 16, seed, 8) for seed in (1, 1, 2))
    np.testing.assert_array_equal(first.picture, again.picture)
    assert np.any(first.picture != other.picture)
    assert first.picture.shape == (8, 8, 3)
    assert first.cpu > 0.0


@pytest.mark.blender
def test_mitsuba_says_what_it_cannot_render_and_goes_on(peer):
    """A mistake does not end the process."""
    with pytest.raises(mitsuba_peer.PeerError, match="no scene 'attic'; there are environment"):
        peer.render("attic", mitsuba_peer.TRIAL, 1, 0, 8)
    with pytest.raises(mitsuba_peer.PeerError, match="velvet"):
        peer.render("softbox", {"type": "velvet"}, 1, 0, 8)
    assert peer.render("softbox", mitsuba_peer.TRIAL, 1, 0, 8).picture.max() > 0.0


@pytest.mark.blender
def test_mitsuba_falls_back_to_a_variant_that_works(blender, monkeypatch):
    """One that cannot be had, or whose process ends, is passed over; a process that is lost later is told of."""
    monkeypatch.setattr(mitsuba_peer, "VARIANTS", ("no_such_variant", "scalar_rgb"))
    with mitsuba_peer.started() as begun:
        assert begun.variant == "scalar_rgb"
        begun._process.kill()
        with pytest.raises(mitsuba_peer.PeerError, match=r"\(scalar_rgb\) ended \(SIGKILL, as where memory runs out\)"):
            begun.render("softbox", mitsuba_peer.TRIAL, 1, 0, 8)
