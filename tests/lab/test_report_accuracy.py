# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against run time: bias and noise are told apart, and a cell holds what it says."""

import numpy as np
import pytest

from vgroove.addon.choose import automatic
from vgroove.lab.bench import accuracy, contenders, scenes, statistics
from vgroove.lab.bench.scene_table import SCENES
from vgroove.nodegroups import versions

RNG = np.random.default_rng(7)
PIXELS = 200


def drawn(bias, noise, seeds, doubt, truths):
    """Pictures with a bias and independent noise, and noisy truths, each a share of a truth of root mean square 1."""
    level = np.linspace(0.5, 1.5, PIXELS)[:, None] * np.ones(3)
    level /= np.sqrt(np.mean(level**2))
    off = bias * np.where(np.arange(PIXELS) % 2, 1.0, -1.0)[:, None]
    grain = [amount * RNG.standard_normal((count, PIXELS, 1)) for amount, count in ((noise, seeds), (doubt, truths))]
    return level + off + grain[0], level + grain[1]


@pytest.mark.parametrize("truths", [1, 4])
@pytest.mark.parametrize("seeds", [2, 4])
@pytest.mark.parametrize("bias", [0.0, 0.05, 0.3])
def test_bias_is_told_from_noise_without_bias(bias, seeds, truths):
    """Over 400 draws: the mean of bias^2 within 4 of its own standard errors, which bias2_error names to a tenth."""
    doubt = 0.1 if truths > 1 else 0.0
    found = [statistics.error(*drawn(bias, 0.3, seeds, doubt, truths)) for _ in range(400)]
    bias2 = np.array([one.bias2 for one in found])
    spread = bias2.std(ddof=1)
    assert abs(bias2.mean() - bias**2) < 4.0 * spread / 20.0 + 2e-4 * bias**2  # the scale is that of a noisy truth
    # The figure takes s^4 for sigma^4, which is (S + 1) / (S - 1) times that on average: 3 of two pictures.
    most = np.sqrt((seeds + 1) / (seeds - 1)) * 1.2
    assert 0.9 < np.mean([one.bias2_error for one in found]) / spread < most
    noise = np.mean([one.noise**2 for one in found])
    assert abs(noise - 0.09) < 4.0 * 0.09 * np.sqrt(2.0 / (400 * (seeds - 1) * PIXELS)) + 2e-3 * 0.09


def test_noise_is_resolved_where_what_is_rare_has_happened():
    """Of a light that a sample in 3000 meets, in 300 pixels: 4 samples each meet none of it, 4096 all that there is."""
    counts = (4, 16, 64, 256, 1024, 4096)
    draws = [RNG.binomial(n, 1 / 3000, (2, 300)) / n * 3000 + 0.01 * RNG.standard_normal((2, 300)) for n in counts]
    rare = [float(np.sqrt(np.mean(np.var(one, axis=0, ddof=1)))) for one in draws]
    rare[0] = 0.01  # as where none was met at all
    found = statistics.resolved(rare, counts)
    assert not found[0]
    assert all(found[2:])
    plain = [float(np.sqrt(np.mean(np.var(RNG.standard_normal((2, 300)), axis=0, ddof=1)) / n)) for n in counts]
    assert all(statistics.resolved(plain, counts))
    assert all(statistics.resolved([n**-0.8 for n in counts], counts))  # Cycles' even sequences


def test_one_picture_cannot_be_told_apart():
    with pytest.raises(ValueError, match="two pictures"):
        statistics.error(np.ones((1, 4, 3)), np.ones((2, 4, 3)))


def test_every_subject_has_a_peer_and_every_measured_model_a_subject():
    subjects = contenders.subjects()
    assert {preset.model for preset in subjects.values()} >= set(automatic.MEASURED)
    assert all(list(contenders.native(preset)) for preset in subjects.values())
    assert {of for _, of in contenders.PAIRS} == set(subjects)
    assert {name for name, _ in contenders.PAIRS} == set(SCENES)


@pytest.mark.blender
def test_every_peer_is_made_of_the_presets_numbers(blender):
    """Colours have an alpha, the three radii of a body have none."""
    for preset in contenders.subjects().values():
        for peer in contenders.native(preset):
            made = peer.make(blender.context.scene)
            (bsdf,) = (node for node in made.node_tree.nodes if node.bl_idname.startswith("ShaderNodeBsdf"))
            if preset.model == "translucent":
                assert tuple(bsdf.inputs["Subsurface Radius"].default_value) == pytest.approx(
                    preset.parameters["mean_free_path"]
                )
            else:
                first = next(one for one in bsdf.inputs if one.name in {"Base Color", "Color"})
                assert first.default_value[3] == 1.0


@pytest.mark.blender
def test_a_furnace_finds_mirror_without_bias_and_closure_with_its_own(monkeypatch, blender):
    """By the reference: mirror within 4 standard errors of none, closure off by what Smith's G keeps."""
    monkeypatch.setattr(contenders, "QUICK_COUNTS", (64, 256))
    found = accuracy.measure("furnace", "rough", quick=True)
    mirror, closure = (found.contenders[f"{name}, nodes"] for name in ("mirror", "closure"))
    assert np.all(np.abs(mirror.bias2) < 4.0 * mirror.bias2_error)
    assert closure.bias2[-1] > 10.0 * closure.bias2_error[-1]
    for of in found.contenders.values():
        assert len(of.bias2) == len(of.cpu) == len(of.cpu_spread) == 2
        assert np.all(of.resolved)
        assert np.all(of.cpu > 0.0)
    rounds = (mirror.seeds[0] - 4) // accuracy.ROUND[64]
    assert rounds in accuracy.ROUNDS
    assert mirror.seeds[1] == 4 + rounds * accuracy.ROUND[256]
    assert (closure.seeds.tolist(), found.seeds, found.independent) == ([4, 4], (4, 4), True)
    assert mirror.slope_error <= accuracy.SLOPE_KNOWN or rounds == accuracy.ROUNDS[-1]
    assert mirror.noise[1] == pytest.approx(mirror.noise[0] / 2.0, rel=0.2)


@pytest.mark.blender
def test_a_computed_truth_is_what_cycles_renders(monkeypatch, blender):
    """Corrected, which has no bias under a lamp, is within 4 standard errors of the reference's integral."""
    monkeypatch.setattr(contenders, "QUICK_COUNTS", (64, 1024))
    monkeypatch.setattr(accuracy, "ROUNDS", range(2, 3))
    found = accuracy.measure("softbox", "plaster", quick=True)
    corrected = found.contenders["corrected, nodes"]
    assert (found.truth, found.independent) == (accuracy.FORMULA, True)
    assert np.all(np.abs(corrected.bias2) < 4.0 * corrected.bias2_error)


@pytest.mark.blender
@pytest.mark.parametrize("name", SCENES)
def test_each_scene_shows_its_ball_where_it_is_judged(name, blender):
    """A material that glows is seen in every judged pixel, and beside the ball in none that is not near it."""
    from vgroove import headless
    from vgroove.addon.blender import gonio

    with headless.quiet(), scenes.stage(name, 16) as shown:
        made = versions.empty_material("Glow")
        glow, output = (
            made.node_tree.nodes.new("ShaderNodeEmission"),
            made.node_tree.nodes.new("ShaderNodeOutputMaterial"),
        )
        glow.inputs["Strength"].default_value = 100.0
        made.node_tree.links.new(glow.outputs[0], output.inputs["Surface"])
        shown.item.active_material = made
        shown.scene.cycles.samples = 1
        lit = gonio.rendered(shown.scene).min(axis=-1) > 90.0
    if name == "checker":
        assert 0.1 < lit.mean() < 0.9
    else:
        assert lit[shown.judged].all()


def test_the_error_of_a_slope_is_how_much_it_scatters():
    """Over 300 trials of rare events on a few pixels; a jackknife of 6 is known to a third, the mean of many better."""
    counts, seeds = (64, 256, 1024), 6

    def trial():
        draws = {n: (RNG.random((seeds, 12, n)) < 0.02).mean(axis=-1)[..., None] * np.ones(3) for n in counts}
        return statistics.slope(draws)

    slopes, errors = np.array([trial() for _ in range(300)]).T
    assert abs(slopes.mean() + 0.5) < 4.0 * slopes.std() / 300**0.5 + 0.02  # the log of a noisy variance is too small
    assert 0.8 < np.sqrt(np.mean(errors**2)) / slopes.std() < 1.35
    with pytest.raises(ValueError, match="two sample counts"):
        statistics.slope({64: np.ones((2, 4, 3))})
