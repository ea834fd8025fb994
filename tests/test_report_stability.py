# SPDX-License-Identifier: GPL-3.0-or-later
"""Part "stability" of a report: each extreme case is as asked or says its limit, and each of these can fail."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from vgroove.addon import animation, check, material, presets
from vgroove.addon.reference import Keyframes
from vgroove.addon.report import stability
from vgroove.addon.report.stability import Line, Seen, Shot
from vgroove.nodegroups import random_numbers

pytestmark = pytest.mark.blender

GROUPS = {
    "slope", "grazing", "fresnel", "oren_nayar", "glass", "layers", "range", "origin", "scale", "filter", "motion",
    "instances", "bounces", "course", "reference",
}  # fmt: skip
CHEAP = ("range", "origin", "scale", "filter", "motion", "instances", "bounces", "course")


def test_there_is_a_cell_for_each_group_quick_or_in_full():
    for quick in (False, True):
        assert {cell.key for cell in stability.cells(quick=quick)} == {f"stability/{group}" for group in GROUPS}


def test_the_limit_for_noisy_cases_counts_them_all():
    """Sidak's correction is for as many cases as the table has."""
    noisy = sum(line.unbiased for group in GROUPS for line, *_ in stability.cases(group, quick=False))
    assert noisy == stability.NOISY


def test_a_quick_report_has_the_ends_of_each_line_in_one_setup():
    for group in GROUPS:
        full, quick = (stability.cases(group, quick=q) for q in (False, True))
        assert {line for line, *_ in full if line.quick} == {line for line, *_ in quick}
        assert {setup for *_, setup in quick} <= {check.SETUPS[0], None}
        for line, value, _ in quick:
            assert value in (line.values if len(line.values) <= stability.FEW else (line.values[0], line.values[-1]))


@pytest.mark.parametrize("group", CHEAP)
def test_the_last_of_each_line_is_as_asked_or_says_its_limit(instrument, group):
    """As a cell keeps it: plain JSON."""
    wanted = {line: (line, value, setup) for line, value, setup in stability.cases(group, quick=True)}
    for case in wanted.values():
        found = stability.judged(*case)
        assert found["passed"], found
        json.dumps(found, allow_nan=False)


@pytest.mark.parametrize("group", ["slope", "grazing", "fresnel", "oren_nayar", "glass"])
def test_osl_is_as_asked_at_an_extreme_of_each_group(instrument, group):
    cases = [case for case in stability.cases(group, quick=False) if case[2] == check.SETUPS[2]]
    last = next(case for case in cases if case[1] == case[0].values[-1])
    assert stability.judged(*last)["passed"]


def judged(image, **line):
    return stability.judged(Line("", "", (0.0,), lambda *_: Seen(image), **line), 0.0, check.SETUPS[0])


def test_what_is_not_finite_negative_or_too_much_fails():
    """And a number that JSON cannot hold is not kept."""
    assert judged(np.full((4, 4, 3), 0.5))["passed"]
    for bad in (np.nan, np.inf):
        found = judged(np.array([0.5, bad]))
        assert not found["passed"]
        assert found["lowest"] is None
        json.dumps(found, allow_nan=False)
    assert not judged(np.array([0.5, -1e-9]))["passed"]
    assert not judged(np.array([0.5, 1.0001]))["passed"]
    assert judged(np.array([0.5, 1.0001]), most=None)["passed"]


def test_a_stated_limit_excuses_bias_but_no_negative_or_broken_number():
    for value, passed in ((1.5, True), (-1.0, False), (np.nan, False)):
        line = Line("", "", (0.0,), lambda *_, value=value: Seen(np.array([value]), limit="as stated"))
        assert stability.judged(line, 0.0, check.SETUPS[0])["passed"] == passed


@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_two_percent_in_the_weight_of_facets_fails(instrument, factor):
    """At slopes where a sample is always worth the same, and where it is not."""
    line = next(line for line in stability.TABLE if line.what == "m, mirror")

    def off(value, setup):
        seen = line.look(value, setup)
        return replace(seen, row=seen.row.scaled(factor))

    for m in (1e-4, 1.0):
        assert stability.judged(line, m, check.SETUPS[0])["passed"]
        assert not stability.judged(replace(line, look=off), m, check.SETUPS[0])["passed"]


def frozen(tree):
    tree.input_float("Stream", 0.0, low=0.0, high=100.0, tip="Not used")
    tree.output_vector("Random", (0.37, 0.37, 0.37), tip="A constant")


def test_a_constant_in_place_of_the_hash_fails_in_pictures_and_under_the_sky(blender, monkeypatch):
    """A frozen pattern looks like no noise at all."""
    monkeypatch.setattr(random_numbers, "build", frozen)
    monkeypatch.setattr(random_numbers, "REVISION", 0)
    for look, value in ((stability.picture, Shot()), (partial(stability.facets, stability.white), 1.0)):
        line = Line("", "", (value,), look, unbiased=True)
        assert not stability.judged(line, value, check.SETUPS[0])["passed"]


def test_presets_refuse_what_is_out_of_range_and_sockets_stay_finite(instrument):
    """The limit says the range."""
    line = next(line for line in stability.TABLE if line.group == "range" and line.what == "m")
    found = stability.judged(line, 1e-6, check.SETUPS[0])
    assert found["finite"]
    assert "between 0.0001 and 10" in found["limit"]
    with pytest.raises(presets.PresetError, match="between"):
        stability.white(1e-6)
    assert material.M_RANGE == (1e-4, 10.0)


@pytest.mark.parametrize("at", [0.0, 0.5, 1.0])
def test_a_step_shorter_than_keys_may_be_apart_leads_from_the_laws_value_to_the_laws_value(at):
    """Wherever it is in the course, a thousandth of a frame beside it the value is as before, and as after."""
    within = np.linspace(-1.0, 0.0, 9) if at == 1.0 else np.linspace(0.0, 1.0, 9)
    crowd = 1.0 + 240.0 * at + 1e-5 * within
    times = np.unique([1.0, *crowd, 241.0])
    keys = Keyframes(times, np.interp(times, crowd, np.linspace(1.0, 0.05, 9)))
    apart = animation._apart(keys)
    assert np.diff(apart.times).min() >= animation.CLOSEST * (1.0 - 1e-9)  # 1e-3 added to 241 rounds by 2^-46
    assert set(apart.times) >= {1.0, 241.0}
    for frame in (61.0, 120.99, 121.01, 181.0):
        assert np.interp(frame, apart.times, apart.values) == pytest.approx(np.interp(frame, times, keys.values))
