# SPDX-License-Identifier: GPL-3.0-or-later
"""Part "stability" of a report: each extreme case is as asked or says its limit, and each of these can fail."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from vgroove.addon.blender import fcurves, gonio, lamps, rays
from vgroove.addon.library import presets
from vgroove.addon.library.checks import M_RANGE
from vgroove.addon.reference import Keyframes
from vgroove.lab.bench import record, stability
from vgroove.lab.bench import stability_measures as measures
from vgroove.lab.bench import stability_pictures as pictures
from vgroove.lab.bench.stability import Outcome, Shot, Sweep
from vgroove.lab.check.cook_torrance import materials
from vgroove.lab.check.rows import SETUPS, Row, View
from vgroove.nodegroups import random_numbers, versions

pytestmark = pytest.mark.blender

GROUPS = {
    "slope", "grazing", "fresnel", "oren_nayar", "glass", "layers", "range", "origin", "scale", "filter", "motion",
    "instances", "bounces", "course", "models", "tangents", "reference",
}  # fmt: skip
CHEAP = ("range", "origin", "scale", "filter", "motion", "instances", "bounces", "course")


def test_there_is_a_cell_for_each_group_quick_or_in_full():
    for quick in (False, True):
        assert set(stability.names(quick=quick)) == GROUPS


def test_the_limit_for_noisy_cases_counts_them_all():
    """Sidak's correction is for as many cases as the table has."""
    noisy = sum(sweep.unbiased for group in GROUPS for sweep, *_ in stability.cases(group, quick=False))
    assert noisy == stability.NOISY_CASES


def test_a_quick_report_has_the_ends_of_each_sweep_in_one_setup():
    for group in GROUPS:
        full, quick = (stability.cases(group, quick=q) for q in (False, True))
        assert {sweep for sweep, *_ in full if sweep.quick} == {sweep for sweep, *_ in quick}
        assert {setup for *_, setup in quick} <= {SETUPS[0], None}
        for sweep, value, _ in quick:
            assert value in (sweep.values[0], sweep.values[-1])


@pytest.mark.parametrize("group", CHEAP)
def test_the_last_of_each_sweep_is_as_asked_or_says_its_limit(instrument, group):
    """As a cell keeps it: plain JSON."""
    wanted = {sweep: (sweep, value, setup) for sweep, value, setup in stability.cases(group, quick=True)}
    for case in wanted.values():
        found = stability.judged(*case)
        assert found.passed, found
        json.dumps(record.CODEC.unstructure(found), allow_nan=False)


@pytest.mark.parametrize("group", ["slope", "grazing", "fresnel", "oren_nayar", "glass"])
def test_osl_is_as_asked_at_an_extreme_of_each_group(instrument, group):
    cases = [case for case in stability.cases(group, quick=False) if case[2] == SETUPS[2]]
    last = next(case for case in cases if case[1] == case[0].values[-1])
    assert stability.judged(*last).passed


def judged(image, **sweep):
    return stability.judged(Sweep("", "", (0.0,), lambda *_: Outcome(image), **sweep), 0.0, SETUPS[0])


def test_what_is_not_finite_negative_or_too_much_fails():
    """And a number that JSON cannot hold is not kept."""
    assert judged(np.full((4, 4, 3), 0.5)).passed
    for bad in (np.nan, np.inf):
        found = judged(np.array([0.5, bad]))
        assert not found.passed
        assert found.lowest is None
        json.dumps(record.CODEC.unstructure(found), allow_nan=False)
    assert not judged(np.array([0.5, -1e-9])).passed
    assert not judged(np.array([0.5, 1.0001])).passed
    assert judged(np.array([0.5, 1.0001]), most=None).passed


def test_a_material_that_is_black_fails(instrument, monkeypatch):
    """Estimators that only come near the formula are held to no Z-test, and yet not to nothing."""
    for what in ("sigma, full, closure", "m, fit", "eta, closure, m = 0.1, outside"):
        sweep = next(sweep for sweep in stability.TABLE if sweep.what == what)
        assert stability.judged(sweep, sweep.values[2], SETUPS[0]).passed
        with monkeypatch.context() as patch:
            for module, name in ((measures, "measure"), (measures.check_glass, "measure_probe")):
                patch.setattr(module, name, lambda *_: np.zeros((8, 64, 3)))
            assert not stability.judged(sweep, sweep.values[2], SETUPS[0]).passed


@pytest.mark.parametrize("eta", [1.0 - 2.0**-24, 1.0, 1.0 + 2.0**-23])
def test_of_next_to_nothing_the_panel_says_that_cycles_leaves_it_out(instrument, eta):
    """Not of nothing; and light that it says is left out is not there."""
    seen = measures.facets(measures.float32_eta, eta, SETUPS[0])
    assert ("too weak for Cycles" in seen.limit) is (eta != 1.0)
    assert not seen.image.any()


def test_light_near_the_horizon_says_what_rounding_does(instrument):
    light = partial(measures.grazing_light, "direct", 1e-3)
    assert light(45.0, SETUPS[0]).limit == ""
    seen = light(89.99, SETUPS[0])
    assert f"held to {100.0 * seen.more['bar']:.2g} % of the lobe" in seen.limit
    assert "held to nothing" in light(89.99999, SETUPS[0]).limit
    assert measures.grazing_light("corrected", 0.3, 89.99999, SETUPS[2]).limit.endswith("to below 0")


def test_a_stated_limit_excuses_bias_but_nothing_else():
    """No light beyond what came, nothing negative or broken, and not what it states itself."""
    row = Row("", SETUPS[0], views=[view(np.full((32, 32, 3), 0.6))])
    for value, holds, passed in ((0.5, True, True), (0.5, False, False), (1.5, True, False), (-1.0, True, False)):
        for limit in ("", "as stated"):
            seen = Outcome(np.array([value]), row=row, limit=limit, holds=holds)
            sweep = Sweep("", "", (0.0,), lambda *_, seen=seen: seen, unbiased=True)
            assert stability.judged(sweep, 0.0, SETUPS[0]).passed == (passed and bool(limit))


def view(image):
    """Expected to be 0.5 everywhere."""
    return View(gonio.Geometry(), image, np.full(image.shape, 0.5), variance=np.full(image.shape, 1e-4))


def test_numbers_that_json_cannot_hold_are_null():
    seen = Outcome(np.array([0.5]), more={"noise": float("nan"), "numbers": float("inf"), "rays": 3.0})
    found = stability.judged(Sweep("", "", (0.0,), lambda *_: seen), 0.0, SETUPS[0])
    assert (found.noise, found.numbers, found.rays) == (None, None, 3.0)
    json.dumps(record.CODEC.unstructure(found), allow_nan=False)


def test_few_rays_excuse_the_noise_they_make_and_none_besides(instrument):
    """More than N / M explains fails, and so does less than samples have, and bias."""
    mean, _ = pictures.moments()
    for shot in (Shot(where=1e4), Shot(where=10.0, filter_width=0.01)):
        photo, shared = pictures.photo(shot, SETUPS[0]), pictures.sharing(shot)
        assert photo.warned
        image = photo.row.views[0].measured
        assert pictures.is_explained(image, shared)
        law = 1.0 + pictures.SAMPLES / shared.pixel
        for noise in (0.3, 1.5 * law**0.5):
            assert not pictures.is_explained(mean + (image - mean) * noise / photo.noise, shared)
        assert not pictures.is_explained(image * 1.02, shared)


def test_chance_fails_a_picture_by_one_seed_and_a_bias_by_both(instrument):
    def off(seeds):
        def look(shot, setup):
            seen = measures.picture(shot, setup)
            return replace(seen, row=seen.row.scaled(1.03)) if shot.seed in seeds else seen

        return stability.judged(Sweep("", "", (Shot(),), look, unbiased=True), Shot(), SETUPS[0])

    assert off(()).again is None
    assert (off((0,)).again, off((0,)).passed) == (True, True)
    assert (off((0, 1)).again, off((0, 1)).passed) == (False, False)


def test_a_panel_that_foresees_the_wrong_rays_fails(instrument, monkeypatch):
    sweep = Sweep("", "", (Shot(where=1e4),), measures.picture, unbiased=True)
    assert stability.judged(sweep, Shot(where=1e4), SETUPS[0]).passed
    right = rays.different_rays
    monkeypatch.setattr(rays, "different_rays", lambda shown: 4.0 * right(shown))
    assert not stability.judged(sweep, Shot(where=1e4), SETUPS[0]).passed


@pytest.mark.parametrize("estimator", ["direct", "closure", "fit", "corrected"])
def test_one_percent_in_the_formula_fails_at_grazing_light(instrument, monkeypatch, estimator):
    """By OSL, where Cycles' own lobes have the very Fresnel term in Blender 4.5 too."""
    light = partial(measures.grazing_light, estimator, 0.3)
    assert light(89.9, SETUPS[2]).holds
    right = measures.rendered
    monkeypatch.setattr(measures, "rendered", lambda *of: lambda wi, wo: 1.01 * right(*of)(wi, wo))
    assert not light(89.9, SETUPS[2]).holds


def test_a_sun_just_above_the_horizon_stands_where_it_is(instrument, monkeypatch):
    """Blender 5.2 takes what a driver writes for 0 below 1e-4: without a factor the sun is on the horizon there."""
    light = partial(measures.grazing_light, "direct", 0.3, stability.NEAREST, SETUPS[0])
    assert light().holds
    monkeypatch.setattr(lamps, "AXIS_SCALE", 1)
    assert light().holds == (not versions.since(5, 2))


@pytest.mark.parametrize("m", [0.001, 0.3, 10.0])
def test_grazing_light_sees_the_lobe(instrument, m):
    """A view in which there is nothing to see would agree with any formula."""
    preset = materials()["dielectric"].with_parameters(m=m)
    for theta in (0.0, 45.0, 89.0):
        wi = gonio.Geometry(theta).wi()
        peak = preset.reference().evaluate(wi, wi * [-1.0, -1.0, 1.0]).max()
        assert measures.grazing_light("direct", m, theta, SETUPS[2]).image.max() > 0.9 * peak


@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_two_percent_in_the_weight_of_facets_fails(instrument, factor):
    """At slopes where a sample is always worth the same, and where it is not."""
    sweep = next(sweep for sweep in stability.TABLE if sweep.what == "m, mirror")

    def off(value, setup):
        seen = sweep.measure(value, setup)
        return replace(seen, row=seen.row.scaled(factor))

    for m in (1e-4, 1.0):
        assert stability.judged(sweep, m, SETUPS[0]).passed
        assert not stability.judged(replace(sweep, measure=off), m, SETUPS[0]).passed


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


def test_a_constant_in_place_of_the_hash_fails_in_pictures_and_under_the_sky(blender, monkeypatch):
    """A frozen pattern looks like no noise at all."""
    monkeypatch.setattr(random_numbers, "build", frozen)
    monkeypatch.setattr(random_numbers, "REVISION", 0)
    for look, value in ((measures.picture, Shot()), (partial(measures.facets, measures.white), 1.0)):
        sweep = Sweep("", "", (value,), look, unbiased=True)
        assert not stability.judged(sweep, value, SETUPS[0]).passed


def test_presets_refuse_what_is_out_of_range_and_sockets_stay_finite(instrument):
    """The limit says the range."""
    sweep = next(sweep for sweep in stability.TABLE if sweep.group == "range" and sweep.what == "m")
    found = stability.judged(sweep, 1e-6, SETUPS[0])
    assert found.lowest is not None
    assert "between 0.0001 and 10" in found.limit
    with pytest.raises(presets.PresetError, match="between"):
        measures.white(1e-6)
    assert M_RANGE == (1e-4, 10.0)


@pytest.mark.parametrize("at", [0.0, 0.5, 1.0])
def test_a_step_shorter_than_keys_may_be_apart_leads_from_the_laws_value_to_the_laws_value(at):
    """Wherever it is in the course, a thousandth of a frame beside it the value is as before, and as after."""
    within = np.linspace(-1.0, 0.0, 9) if at == 1.0 else np.linspace(0.0, 1.0, 9)
    crowd = 1.0 + 240.0 * at + 1e-5 * within
    times = np.unique([1.0, *crowd, 241.0])
    keys = Keyframes(times, np.interp(times, crowd, np.linspace(1.0, 0.05, 9)))
    apart = fcurves.apart(keys)
    assert np.diff(apart.times).min() >= fcurves.CLOSEST * (1.0 - 1e-9)  # 1e-3 added to 241 rounds by 2^-46
    assert set(apart.times) >= {1.0, 241.0}
    for frame in (61.0, 120.99, 121.01, 181.0):
        assert np.interp(frame, apart.times, apart.values) == pytest.approx(np.interp(frame, times, keys.values))
