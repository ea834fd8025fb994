# SPDX-License-Identifier: GPL-3.0-or-later
"""``corrected`` and ``hybrid``: the V-groove model where they say so, and red where they are broken."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, material
from vgroove.addon.reference.hybrid import DEFAULT_BOUND
from vgroove.lab.check.cook_torrance import (
    SEEDED,
    SEEDED_NOISY_ROWS,
    fresnel_approximation,
    hybrid_furnace_row,
    materials,
    native_row,
    plan,
    seeded_sun_row,
)
from vgroove.lab.check.hybrid import excess, sent_by_lobes
from vgroove.lab.check.rows import SETUPS, surely_seen
from vgroove.lab.check.seeds import furnace_directions
from vgroove.lab.check.views import closure_bar, furnace, measure
from vgroove.lab.sidak import limit
from vgroove.nodegroups import cook_torrance_mirror, osl_script, random_numbers, smith_lobe, versions
from vgroove.nodegroups._tree import Value

from ..rows import name

pytestmark = pytest.mark.blender


ROWS = [row for row in plan() if row.func in {native_row, hybrid_furnace_row, seeded_sun_row}]


@pytest.mark.parametrize("row", ROWS, ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, row):
    """Every row passes, and is red against a reference 1 % brighter or darker."""
    row = row()
    assert row.passed, row.as_json()
    if not fresnel_approximation(row.setup, row.variant):
        assert not row.scaled(1.01).passed
        assert not row.scaled(1 / 1.01).passed
        assert not row.is_noisy or row.resolves <= surely_seen(0.01, SEEDED_NOISY_ROWS)


@pytest.mark.parametrize("m", [0.3, 0.6, 1.0])
def test_lobes_of_fit_send_what_their_formula_says_and_lean_as_is_allowed_for(instrument, m):
    """In the mean over views, to the noise of 4096 samples and what two grids of the formula differ by."""
    coarse, fine = (np.array([sent_by_lobes(wo, m, nodes) for wo in furnace_directions()]) for nodes in (100, 160))
    white = materials()["white"].with_parameters(m=m)
    images = [measure(white, SETUPS[2], "fit", furnace(), 1024, seed)[..., 0] for seed in range(4)]
    pixels = np.asarray(images, np.float64) / fine[:, None]
    noise = np.sqrt(np.mean(np.var(pixels, axis=(0, 2), ddof=1)) / pixels.size)
    bar = limit(3) * noise + np.mean(np.abs(fine / coarse - 1.0))
    leaning = versions.LEANING * m
    assert -bar <= pixels.mean() - 1.0 <= leaning + bar
    assert bar < 1e-3 * m  # so that what 4.5 has would be seen


def test_what_hybrid_sends_back_is_computed_for_any_direction():
    """Turned about the normal, a view gets the same."""
    wo = np.array([0.6, 0.0, 0.8])
    turned = np.array([0.6 * np.cos(2.0), 0.6 * np.sin(2.0), 0.8])
    white = materials()["white"].reference_fresnel()
    for of in (lambda view: excess(view, 0.3, white, DEFAULT_BOUND, 40), lambda view: sent_by_lobes(view, 0.3, 40)):
        np.testing.assert_allclose(of(turned), of(wo), rtol=1e-12)


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    assert sum(row.func is not native_row for row in ROWS) == SEEDED_NOISY_ROWS


def one_percent_more(tree):
    """The lobe that is subtracted, 1 % too large."""
    smith_lobe_build(tree)
    sink = tree._output.inputs["f cos"]
    tree.connect(Value(tree, sink.links[0].from_socket) * 1.01, sink)


smith_lobe_build = smith_lobe.build


@pytest.mark.once
@pytest.mark.parametrize("estimator", SEEDED)
def test_one_percent_in_the_subtracted_lobe_turns_lamps_red(blender, monkeypatch, estimator):
    """In the node group and in OSL."""
    monkeypatch.setattr(smith_lobe, "build", one_percent_more)
    assert not native_row(estimator, SETUPS[0], "schlick", 0.3).passed
    original = osl_script.source

    def source(shader):
        return original(shader).replace("return D / ((1 +", "return 1.01 * D / ((1 +")

    assert source("cook_torrance_correction") != original("cook_torrance_correction")
    monkeypatch.setattr(osl_script, "source", source)
    assert not native_row(estimator, SETUPS[2], "schlick", 0.3).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
def test_a_constant_in_place_of_the_hash_turns_hybrid_red(blender, monkeypatch):
    """A frozen random number looks like no noise at all."""
    monkeypatch.setattr(random_numbers, "build", frozen)
    assert not hybrid_furnace_row(SETUPS[0], "white", 0.6).passed


@pytest.mark.once
def test_ten_percent_in_the_random_part_turns_hybrid_red(blender, monkeypatch):
    """The mirror carries about a third: a tenth of it is some 3 % of the whole."""
    original = cook_torrance_mirror.fresnel.reflectance
    monkeypatch.setattr(cook_torrance_mirror.fresnel, "reflectance", lambda *arguments: original(*arguments) * 0.9)
    assert not hybrid_furnace_row(SETUPS[0], "white", 0.6).passed


@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[2]], ids=str)
@pytest.mark.parametrize("m", [1e-4, 1e-3, 0.3, 1.0])
@pytest.mark.parametrize("theta_i", [0.0, 89.99])
def test_both_stay_finite(instrument, setup, m, theta_i):
    """No NaN or infinity for slopes down to 1e-4 and light at 89.99 degrees; nothing below 0 but by rounding."""
    preset = materials()["schlick"].with_parameters(m=m)
    for estimator in SEEDED:
        for window in (0.0, 5.0):
            with headless.quiet():
                image = gonio.measure_preset(
                    preset, setup.backend, estimator, gonio.Geometry(theta_i, window), shading_osl=setup.shading_osl
                )
            assert np.isfinite(image).all()
            assert image.min() >= -max(closure_bar(m), 1e-3) * max(image.max(), 1.0)


@pytest.mark.parametrize("backend", material.BACKENDS)
def test_a_tighter_bound_leaves_more_to_the_mirror(instrument, backend):
    """The bound is the artist's to turn, and reaches the shader: the noise of a furnace grows as it shrinks."""
    preset = materials()["white"].with_parameters(m=0.6)
    noise = []
    for bound in (0.001, 0.05):
        with headless.quiet():
            image = gonio.measure_preset(
                preset, backend, "hybrid", gonio.Geometry(furnace=True, resolution=(32, 32)), samples=16,
                shading_osl=backend == "osl", bound=bound,
            )  # fmt: skip
        noise.append(float(np.mean(np.std(image[..., 0], axis=1))))
    assert noise[0] > 1.3 * noise[1]


def test_a_bound_out_of_range_is_refused():
    """One line: what, and what it may be."""
    with pytest.raises(material.MaterialError, match=r"bound must be between 0.001 and 0.05"):
        material.Choice("nodes", "hybrid", bound=0.5)
