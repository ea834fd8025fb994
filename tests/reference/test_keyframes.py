# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys placed by error: within the tolerance, as few as can be, never beyond the law's range."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgroove.addon.reference import Exponential, Keys, Logistic, Polynomial, Power, Trajectory, place_keys

STIFF = {
    "flash, then days": (Exponential(1.0, 0.0, (1e4, 1.0), (0.5, 0.5)), 10.0),
    "nine powers of ten": (Exponential((1.0, 0.5, 0.2), (0.0, 0.5, 0.9), (1e6, 1.0, 1e-3), (0.3, 0.3, 0.4)), 1e4),
    "late step": (Logistic(0.0, 1.0, 1e6, 0.7), 1.0),
    "root": (Power(0.0, 1.0, 0.5, 0.0, 8.0), 8.0),
    "wave": (Polynomial((0.5, -4.0, 10.0, -6.3)), 1.0),
    "corners": (Keys((0.0, 1e-7, 0.5, 0.500001, 4.0), (0.1, 0.3, 0.2, 0.9, 0.5)), 4.0),
    "slope": (Keys((0.0, 4.0), (0.01, 0.5), geometric=True), 4.0),
}


def course(law, end):
    return Trajectory({"p": law}, 0.0, end)


def everywhere(end, keys):
    """Times dense near 0, near every key and overall."""
    near = keys.times[:, None] + np.concatenate([-np.geomspace(1e-12, 1.0, 60), np.geomspace(1e-12, 1.0, 60)]) * end
    spread = np.linspace(0.0, 1.0, 41)
    between = (keys.times[:-1, None] + spread * np.diff(keys.times)[:, None]).ravel()
    return np.clip(np.concatenate([np.linspace(0.0, end, 20001), near.ravel(), between]), 0.0, end)


@pytest.mark.parametrize("interpolation", ["linear", "shape"])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("name", STIFF)
def test_keys_stay_within_the_tolerance_and_the_range(name, tolerance, interpolation):
    """Everywhere between, whatever the rates; Bezier handles do not overshoot."""
    law, end = STIFF[name]
    keys = place_keys(course(law, end), "p", tolerance, interpolation)
    t = everywhere(end, keys)
    expected = law(t)
    reach = np.ptp(law(np.unique(t)), axis=0).max()
    assert np.abs(keys(t) - expected).max() <= tolerance * reach * (1.0 + 1e-9)
    assert (keys(t) >= expected.min(axis=0) - 1e-12).all()
    assert (keys(t) <= expected.max(axis=0) + 1e-12).all()
    assert keys.times[0] == 0.0
    assert keys.times[-1] == end


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_an_exponential_needs_no_more_keys_than_theory_says(tolerance):
    """N straight pieces of exp(-t) miss it by at least (integral of sqrt(p'' / 8) / N)^2 = 1 / (2 N^2)."""
    pieces = place_keys(course(Exponential(1.0, 0.0, (1.0,)), 40.0), "p", tolerance).times.size - 1
    least = 1.0 / np.sqrt(2.0 * tolerance)
    # The bound is reached as N grows. Samples are 32 to the longest piece (sqrt(FINE)), so pieces are 1/32 short at
    # most; two pieces more for the one that is not full and the tail, where p'' vanishes.
    assert least <= pieces <= least * (1.0 + 1.0 / 32.0) + 2.0


def test_far_fewer_keys_than_even_spacing():
    """Evenly spaced keys would need steps as short as the fastest rate asks for: 1e5 and more."""
    law, end = STIFF["flash, then days"]
    keys = place_keys(course(law, end), "p")
    assert keys.times.size < 40
    even = Keys(np.linspace(0.0, end, 10_000), law(np.linspace(0.0, end, 10_000)))
    t = np.geomspace(1e-6, end, 10_000)
    assert np.abs(even(t) - law(t)).max() > 0.1


@given(st.lists(st.floats(0.0, 1.0), min_size=4, max_size=8), st.sampled_from([0.02, 0.1]))
@settings(max_examples=40, deadline=None)
def test_no_choice_of_the_law_s_own_corners_has_fewer_keys(values, tolerance):
    """Against every choice among the corners of a law that is straight between them."""
    times = np.arange(len(values), dtype=float)
    law = Keys(times, values)
    allowed = tolerance * np.ptp(values)
    if allowed < 1e-6:
        return
    found = place_keys(course(law, times[-1]), "p", tolerance).times.size
    for count in range(found - 1):
        for inner in combinations(range(1, len(values) - 1), max(count - 2, 0)):
            chosen = [0, *inner, len(values) - 1]
            misses = np.abs(np.interp(times, times[chosen], np.array(values)[chosen]) - values)
            assert len(chosen) >= found or misses.max() > allowed * (1.0 - 1e-2)


def test_measured_keys_come_back_as_they_are():
    """A law that is straight between its keys needs those alone, for colours and numbers."""
    times = np.array([0.0, 0.3, 1.0, 2.0])
    for values in (np.array([0.1, 0.9, 0.2, 0.4]), np.array([[0.1, 0.2, 0.3], [0.9, 0.1, 0.3], [0, 0, 0], [1, 1, 1]])):
        keys = place_keys(course(Keys(times, values), 2.0), "p", 1e-6)
        assert keys.times.tolist() == times.tolist()
        assert keys.values.tolist() == values.tolist()


def test_what_stands_still_has_one_key():
    """Whether a number or a colour."""
    for value in (0.5, (0.5, 0.1, 0.2)):
        keys = place_keys(course(Exponential(value, value, (1.0,)), 1.0), "p")
        assert keys.times.size == 1
        assert np.shape(keys.values[0]) == np.shape(value)
        assert keys(np.array([0.0, 0.3, 2.0])).shape[0] == 3


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_the_unit_of_time_does_not_matter(factor):
    """The same keys for a course that is a million times as long or as short."""
    plain = place_keys(course(Exponential(1.0, 0.0, (3.0,)), 4.0), "p")
    other = place_keys(course(Exponential(1.0, 0.0, (3.0 / factor,)), 4.0 * factor), "p")
    assert np.abs(other.times / other.times[-1] - plain.times / 4.0).max() < 0.02
    assert other.times.size == plain.times.size
    assert np.isfinite(other.values).all()


@pytest.mark.parametrize("tolerance", [0.0, 0.2, np.nan, -1.0])
def test_a_tolerance_out_of_range_is_refused(tolerance):
    with pytest.raises(ValueError, match="tolerance must be"):
        place_keys(course(Exponential(1.0, 0.0, (3.0,)), 4.0), "p", tolerance)
