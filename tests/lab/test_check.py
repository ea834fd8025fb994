# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles against NumPy: the whole plan of ``vgroove check``, and that it turns red."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.reference import Schlick, cook_torrance
from vgroove.lab.check import glass, oren_nayar, seeds
from vgroove.lab.check.cook_torrance import (
    DIRECT_SLOPES,
    MIRROR_SLOPES,
    NOISY_ROWS,
    SEEDED_NOISY_ROWS,
    direct_row,
    fresnel_approximation,
    furnace_row,
    hybrid_furnace_row,
    materials,
    native_row,
    plan,
    seeded_sun_row,
    sun_row,
)
from vgroove.lab.check.rows import SETUPS, Row, View, surely_seen
from vgroove.lab.check.views import closure_bar, direct_bar, disc, events, furnace, measure
from vgroove.nodegroups import beckmann_d, osl_script, random_numbers, vgroove_g
from vgroove.nodegroups._tree import Value

from ..rows import name

pytestmark = pytest.mark.blender


ROWS = [row for row in plan() if row.func not in {native_row, hybrid_furnace_row, seeded_sun_row}]  # test_hybrid's


@pytest.mark.parametrize("row", ROWS, ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row of the plan passes, and is red against a reference 1 % brighter, as by an error in D or in G."""
    row = row()
    assert row.passed, row.as_json()
    approximate = row.test in {"closure", "fit"} and fresnel_approximation(row.setup, row.variant)
    if not approximate:  # there F alone is off by more than 1 %: the Schlick row of the same m holds D and G
        assert not row.scaled(1.01).passed
        assert not row.scaled(1 / 1.01).passed
        assert not row.is_noisy or row.resolves <= surely_seen(0.01, NOISY_ROWS)  # red on any machine's noise


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    assert sum(row.func in {furnace_row, sun_row} for row in ROWS) == NOISY_ROWS


def test_a_row_is_judged_by_the_size_of_its_own_plan():
    """3.3 standard errors are beyond 1 % for 4 rows (3.02), not for 32 (3.60)."""
    ones = np.ones((32, 32, 3))
    view = View(gonio.Geometry(), ones + 3.3 / 32, ones, variance=ones)
    assert abs(Row("", SETUPS[0], views=[view]).scale_z - 3.3) < 0.01
    assert Row("", SETUPS[0], views=[view]).passed
    assert not Row("", SETUPS[0], views=[view], noisy_rows=4).passed


@pytest.mark.parametrize(
    ("row", "noisy_rows"),
    [
        (partial(glass.furnace_row, SETUPS[0], 1.5, 0.3, "all"), glass.NOISY_ROWS),
        (partial(oren_nayar.furnace_row, SETUPS[0], "full", 0.3), oren_nayar.NOISY_ROWS),
        (partial(hybrid_furnace_row, SETUPS[0], "schlick", 0.3), SEEDED_NOISY_ROWS),
    ],
    ids=["glass", "oren_nayar", "hybrid"],
)
def test_rows_of_other_plans_know_theirs(instrument, row, noisy_rows):
    """One of each: the other tests of these plans hold what it resolves to the same number."""
    assert row().noisy_rows == noisy_rows


@pytest.mark.parametrize("rare", [1e-6, 1e-3, 0.5])
def test_pixels_that_lose_light_rarely_are_judged_as_the_count_of_these(rare):
    """A sample is worth 0 with the chance ``rare``, else 1: of N samples N rare are expected to be lost.

    Near one half a sum is as symmetric as that of many more; where no sample is lost only rounding is left.
    """
    weight = np.full((1, 1, 3), 1.0 - rare)
    count = events(weight, weight, weight, 1024)[0, 0]
    skewness = (1.0 - 2.0 * rare) / np.sqrt(rare * (1.0 - rare) * 1024)
    assert count == pytest.approx(skewness**-2, rel=1e-6) if rare < 0.5 else count > 1e6
    assert np.isinf(events(*3 * [np.ones((1, 1, 3))], 1024)).all()


def test_a_row_without_noise_is_judged_by_its_pixels():
    """None has a scale that noise hides, and a pixel that is off by more than rounding turns it red."""
    ones = np.ones((20, 3))
    view = View(furnace(), ones, ones, variance=0.0 * ones)
    assert Row("", SETUPS[0], views=[view]).passed
    assert Row("", SETUPS[0], views=[view]).resolves < 1e-4
    assert not Row("", SETUPS[0], views=[replace(view, measured=ones * 1.001)]).passed


def test_a_furnace_view_may_expect_another_albedo_at_each_azimuth(monkeypatch):
    """As of an anisotropic model: by the pixel it passes, and neither 1 % off nor against the mean of each row."""
    wo = furnace().wo()
    expected = (0.5 + 0.2 * (wo[..., :1] ** 2 - wo[..., 1:2] ** 2)) * np.ones(3)

    def noisy(*given):
        return expected + np.random.default_rng(given[-1]).normal(0.0, 0.01, (*expected.shape[:2], 1))

    monkeypatch.setattr(seeds, "measure", noisy)

    def row(model):
        return Row("", SETUPS[0], views=[seeds.furnace_view(None, SETUPS[0], "mirror", model, seeds=16)])

    assert row(expected).passed
    assert not row(1.01 * expected).passed
    assert not row(expected.mean(axis=1, keepdims=True)).passed


def test_the_disc_of_a_sun_is_around_its_direction():
    """At any azimuth; its solid angles add up to the cap's."""
    geometry = gonio.Geometry(60.0, sun_angle=30.0, phi_i=130.0)
    directions, weights = disc(geometry)
    assert weights.sum() == pytest.approx(2.0 * np.pi * (1.0 - np.cos(np.radians(15.0))), rel=1e-12)
    middle = weights @ directions
    np.testing.assert_allclose(middle / np.linalg.norm(middle), geometry.wi(), atol=1e-12)
    np.testing.assert_allclose(np.max(np.arccos(directions @ geometry.wi())), np.radians(15.0), rtol=1e-2)


@pytest.mark.parametrize("m", MIRROR_SLOPES)
def test_mirror_resolves_one_percent_at_every_slope(instrument, m):
    """What the furnace row reports as resolved is under 1 %."""
    assert furnace_row(SETUPS[0], "white", m).resolves < 0.01


def one_percent(module, output):
    """The module's build function with 1 % more in its output."""
    original = module.build

    def build(tree):
        original(tree)
        sink = tree._output.inputs[output]
        before = Value(tree, sink.links[0].from_socket)
        tree.connect(before * 1.01, sink)

    return build


@pytest.mark.once
@pytest.mark.parametrize("m", DIRECT_SLOPES)
@pytest.mark.parametrize(("module", "output"), [(beckmann_d, "D"), (vgroove_g, "G")], ids=["D", "G"])
def test_an_error_of_one_percent_in_a_node_group_turns_direct_red(blender, monkeypatch, module, output, m):
    """The deliberate error is in the group itself, at every slope that ``direct`` claims."""
    monkeypatch.setattr(module, "build", one_percent(module, output))
    assert not direct_row(SETUPS[0], "schlick", m).passed


@pytest.mark.once
@pytest.mark.parametrize("m", DIRECT_SLOPES)
@pytest.mark.parametrize(
    ("old", "new"),
    [("return exp(", "return 1.01 * exp("), ("return min(1, 2 * nh", "return 1.01 * min(1, 2 * nh")],
    ids=["D", "G"],
)
def test_an_error_of_one_percent_in_osl_turns_direct_red(blender, monkeypatch, old, new, m):
    """The same in the shaders' shared header."""
    monkeypatch.setattr(osl_script, "source", mutated(old, new))
    assert not direct_row(SETUPS[2], "schlick", m).passed


def mutated(old, new):
    original = osl_script.source

    def source(shader):
        text = original(shader)
        if shader not in {"gonio_camera", "lamp"}:
            assert old in text
        return text.replace(old, new)

    return source


@pytest.mark.once
@pytest.mark.parametrize("m", MIRROR_SLOPES)
def test_a_constant_in_place_of_the_hash_turns_mirror_red(blender, monkeypatch, m):
    """A frozen random number looks like no noise at all; the Z-test sees that it is the wrong picture."""
    with monkeypatch.context() as patch:
        patch.setattr(osl_script, "source", mutated('return noise("hash", P, w)', "return 0.37"))
        assert not furnace_row(SETUPS[2], "white", m).passed
    monkeypatch.setattr(random_numbers, "build", frozen)
    assert not furnace_row(SETUPS[0], "white", m).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
@pytest.mark.parametrize("m", MIRROR_SLOPES)
@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[2]], ids=str)
def test_an_error_of_one_percent_in_the_slope_or_weight_turns_mirror_red(blender, monkeypatch, setup, m):
    """G 1 % too large in the weight, in the node group and in OSL."""
    from vgroove.nodegroups import cook_torrance_mirror, fresnel

    original = fresnel.reflectance
    monkeypatch.setattr(cook_torrance_mirror.fresnel, "reflectance", lambda *arguments: original(*arguments) * 0.99)
    monkeypatch.setattr(
        osl_script, "source", mutated("(G2 / G1)", "(0.99 * G2 / G1)")
    ) if setup.backend == "osl" else None
    assert not furnace_row(setup, "white", m).passed


@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[2]], ids=str)
@pytest.mark.parametrize("fresnel", ["schlick", "dielectric", "conductor", "f82"])
@pytest.mark.parametrize("m", [1e-4, 1e-3, 0.3, 10.0])
@pytest.mark.parametrize("theta_i", [0.0, 89.99])
def test_direct_stays_finite_and_not_negative(instrument, setup, fresnel, m, theta_i):
    """No NaN, infinity or negative value for slopes down to 1e-4 and angles to 89.99 degrees."""
    preset = materials()[fresnel].with_parameters(m=m)
    for window in (0.0, 5.0):
        with headless.quiet():
            image = gonio.measure_preset(
                preset, setup.backend, "direct", gonio.Geometry(theta_i, window), shading_osl=setup.shading_osl
            )
        assert np.isfinite(image).all()
        assert image.min() >= 0.0
    assert image.max() > 0.0 or m < 0.3  # narrow lobes fit between two pixels


@pytest.mark.parametrize("estimator", ["direct", "closure", "fit"])
@pytest.mark.parametrize("fresnel", ["schlick", "dielectric", "conductor"])
@pytest.mark.parametrize("m", [0.02, 0.1, 0.3, 1.0])
def test_osl_and_node_groups_agree_with_each_other(instrument, estimator, fresnel, m):
    """Within the bars that each has toward the reference, on the hemisphere and around the mirror direction."""
    preset = materials()[fresnel].with_parameters(m=m)
    nodes, osl = SETUPS[0], SETUPS[2]
    off = max(fresnel_approximation(setup, fresnel) for setup in (nodes, osl)) if estimator != "direct" else 0.0
    bar = off or (direct_bar(m) if estimator == "direct" else closure_bar(m))
    F = Schlick(1.0) if off else preset.reference_fresnel()  # an approximate F is judged against a lobe of F = 1
    for geometry in (gonio.Geometry(45.0), gonio.Geometry(70.0, 5.0)):
        images = [measure(preset, setup, estimator, geometry, samples=1) for setup in (nodes, osl)]
        peak = cook_torrance(geometry.wi(), geometry.wo(), m, F).max()
        assert np.abs(images[0] - images[1]).max() <= bar * peak
