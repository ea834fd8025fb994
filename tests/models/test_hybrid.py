# SPDX-License-Identifier: GPL-3.0-or-later
"""``corrected`` and ``hybrid``: the V-groove model where they say so, and red where they are broken."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, material
from vgroove.lab.check import hybrid as check_hybrid
from vgroove.lab.check import rows as check
from vgroove.lab.check import seeds as check_seeds
from vgroove.nodegroups import cook_torrance_mirror, osl_script, random_numbers, smith_lobe, versions
from vgroove.nodegroups._tree import Value

pytestmark = pytest.mark.blender


def name(item):
    measure, arguments = item
    return f"{measure.__name__}-{'-'.join(str(part).replace(' ', '_') for part in arguments)}"


@pytest.mark.parametrize("item", check_hybrid.plan(), ids=name)
def test_cycles_agrees_with_the_reference_and_would_not_with_one_percent_more(instrument, item):
    """Every row passes, and is red against a reference 1 % brighter or darker."""
    measure, arguments = item
    row = measure(*arguments)
    assert row.passed, row.as_json()
    if not check.fresnel_approximation(row.setup, row.fresnel):
        assert not row.scaled(1.01).passed
        assert not row.scaled(1 / 1.01).passed
        assert not row.is_noisy or row.resolves <= check.surely_seen(0.01, check_hybrid.NOISY_ROWS)


@pytest.mark.parametrize("m", [0.3, 0.6, 1.0])
def test_lobes_of_fit_send_what_their_formula_says_and_lean_as_is_allowed_for(instrument, m):
    """In the mean over views, to the noise of 4096 samples and what two grids of the formula differ by."""
    coarse, fine = (
        np.array([check_hybrid.sent_by_lobes(wo, m, nodes) for wo in check_seeds.furnace_directions()])
        for nodes in (100, 160)
    )
    white = check.materials()["white"].with_parameters(m=m)
    images = [
        check.measure(white, check.SETUPS[2], "fit", check_seeds.furnace(), 1024, seed)[..., 0] for seed in range(4)
    ]
    pixels = np.asarray(images, np.float64) / fine[:, None]
    noise = np.sqrt(np.mean(np.var(pixels, axis=(0, 2), ddof=1)) / pixels.size)
    bar = check.limit(3) * noise + np.mean(np.abs(fine / coarse - 1.0))
    leaning = versions.LEANING * m
    assert -bar <= pixels.mean() - 1.0 <= leaning + bar
    assert bar < 1e-3 * m  # so that what 4.5 has would be seen


def test_the_limit_for_noisy_rows_counts_them_all():
    """Sidak's correction is for as many rows as the plan has."""
    noisy = {check_hybrid.furnace_row, check_hybrid.sun_row}
    assert sum(measure in noisy for measure, _ in check_hybrid.plan()) == check_hybrid.NOISY_ROWS


def one_percent_more(tree):
    """The lobe that is subtracted, 1 % too large."""
    smith_lobe_build(tree)
    sink = tree._output.inputs["f cos"]
    tree.connect(Value(tree, sink.links[0].from_socket) * 1.01, sink)


smith_lobe_build = smith_lobe.build


@pytest.mark.once
@pytest.mark.parametrize("estimator", check_hybrid.ESTIMATORS)
def test_one_percent_in_the_subtracted_lobe_turns_lamps_red(blender, monkeypatch, estimator):
    """In the node group and in OSL."""
    monkeypatch.setattr(smith_lobe, "build", one_percent_more)
    assert not check.native_row(estimator, check.SETUPS[0], "schlick", 0.3).passed
    original = osl_script.source

    def source(shader):
        return original(shader).replace("return D / ((1 +", "return 1.01 * D / ((1 +")

    assert source("cook_torrance_correction") != original("cook_torrance_correction")
    monkeypatch.setattr(osl_script, "source", source)
    assert not check.native_row(estimator, check.SETUPS[2], "schlick", 0.3).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


@pytest.mark.once
def test_a_constant_in_place_of_the_hash_turns_hybrid_red(blender, monkeypatch):
    """A frozen random number looks like no noise at all."""
    monkeypatch.setattr(random_numbers, "build", frozen)
    assert not check_hybrid.furnace_row(check.SETUPS[0], "white", 0.6).passed


@pytest.mark.once
def test_ten_percent_in_the_random_part_turns_hybrid_red(blender, monkeypatch):
    """The mirror carries about a third: a tenth of it is some 3 % of the whole."""
    original = cook_torrance_mirror.fresnel.reflectance
    monkeypatch.setattr(cook_torrance_mirror.fresnel, "reflectance", lambda *arguments: original(*arguments) * 0.9)
    assert not check_hybrid.furnace_row(check.SETUPS[0], "white", 0.6).passed


@pytest.mark.parametrize("setup", [check.SETUPS[0], check.SETUPS[2]], ids=str)
@pytest.mark.parametrize("m", [1e-4, 1e-3, 0.3, 1.0])
@pytest.mark.parametrize("theta_i", [0.0, 89.99])
def test_both_stay_finite(instrument, setup, m, theta_i):
    """No NaN or infinity for slopes down to 1e-4 and light at 89.99 degrees; nothing below 0 but by rounding."""
    preset = check.materials()["schlick"].with_parameters(m=m)
    for estimator in check_hybrid.ESTIMATORS:
        for window in (0.0, 5.0):
            with headless.quiet():
                image = gonio.measure_preset(
                    preset, setup.backend, estimator, gonio.Geometry(theta_i, window), shading_osl=setup.shading_osl
                )
            assert np.isfinite(image).all()
            assert image.min() >= -max(check.closure_bar(m), 1e-3) * max(image.max(), 1.0)


@pytest.mark.parametrize("backend", material.BACKENDS)
def test_a_tighter_bound_leaves_more_to_the_mirror(instrument, backend):
    """The bound is the artist's to turn, and reaches the shader: the noise of a furnace grows as it shrinks."""
    preset = check.materials()["white"].with_parameters(m=0.6)
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
