# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of time against their closed forms in 50 digits, ends, clocks, and what is refused."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from vgroove.addon.reference import Exponential, Keys, Logistic, Polynomial, Power, Reciprocal, Trajectory, local_age

mp.mp.dps = 50
# Sums and products of a few float64 numbers of size 1; the bar.
BAR = 1e-12
TIMES = np.concatenate([[0.0], np.geomspace(1e-9, 1e3, 200), np.linspace(0.0, 20.0, 201)])


def exact(formula, times=TIMES):
    return np.array([float(formula(mp.mpf(float(t)))) for t in times])


@pytest.mark.parametrize("rates", [(2.0,), (1e4, 1.0), (1e8, 1e-2, 3.0)])
def test_exponential_is_its_closed_form(rates):
    """Of one rate, and of several that differ by ten powers of ten."""
    shares = tuple(1.0 / len(rates) for _ in rates)
    law = Exponential(0.9, 0.05, rates, shares, begin=0.25)

    def formula(t):
        since = max(t - mp.mpf("0.25"), mp.mpf(0))
        left = sum(mp.mpf(share) * mp.exp(-mp.mpf(rate) * since) for rate, share in zip(rates, shares, strict=True))
        left = left / sum(mp.mpf(share) for share in shares)
        return mp.mpf(0.05) + (mp.mpf(0.9) - mp.mpf(0.05)) * left

    assert np.abs(law(TIMES) - exact(formula)).max() < BAR


def test_reciprocal_is_the_form_of_drying_paint():
    """sigma_wet sigma_dry / ((sigma_dry - sigma_wet) exp(-lambda t) + sigma_wet)."""
    wet, dry, rate = 0.05, 0.4, 1.7
    law = Reciprocal(wet, dry, rate)
    w, d = mp.mpf(wet), mp.mpf(dry)
    assert np.abs(law(TIMES) - exact(lambda t: w * d / ((d - w) * mp.exp(-mp.mpf(rate) * t) + w))).max() < BAR


@pytest.mark.parametrize(("rate", "middle"), [(3.0, 5.0), (1e3, 5.0), (0.1, 0.0), (1e-3, 20.0), (50.0, 1.0)])
def test_logistic_is_its_closed_form(rate, middle):
    """From exactly the start at 0, gently or as a step."""
    law = Logistic(0.1, 0.7, rate, middle)

    def s(t):
        return 1 / (1 + mp.exp(-mp.mpf(rate) * (t - mp.mpf(middle))))

    def formula(t):
        return mp.mpf(0.1) + (mp.mpf(0.7) - mp.mpf(0.1)) * (s(t) - s(0)) / (1 - s(0))

    assert np.abs(law(TIMES) - exact(formula)).max() < BAR
    assert law(0.0) == 0.1


@pytest.mark.parametrize("exponent", [0.5, 1.0, 3.0])
def test_power_is_its_closed_form(exponent):
    """Parabolic growth and others, from begin to finish."""
    law = Power(0.2, 0.9, exponent, begin=1.0, finish=9.0)

    def formula(t):
        part = min(max((t - 1) / 8, mp.mpf(0)), mp.mpf(1))
        return mp.mpf(0.2) + (mp.mpf(0.9) - mp.mpf(0.2)) * part ** mp.mpf(exponent)

    assert np.abs(law(TIMES) - exact(formula)).max() < BAR


def test_polynomial_is_its_closed_form_for_colours_too():
    """Rusting iron's own cubics."""
    red, green = (0.07361, 0.38336, -0.96641, 0.57903), (0.08224, 0.14058, -0.56873, 0.40007)
    law = Polynomial(np.array([red, green, red]).T)
    times = np.linspace(0.0, 1.0, 101)
    got = law(times)
    assert got.shape == (101, 3)
    for channel, c in ((0, red), (1, green)):
        expected = exact(lambda t, c=c: sum(mp.mpf(part) * t**k for k, part in enumerate(c)), times)
        assert np.abs(got[:, channel] - expected).max() < BAR


@pytest.mark.parametrize("geometric", [False, True])
def test_keys_go_straight_or_straight_in_the_logarithm(geometric):
    """Between keys by the rule of the parameter, at keys exactly, beyond them held."""
    times, values = (0.0, 1e-6, 2.5, 4.0), (0.05, 0.4, 0.2, 0.31)
    law = Keys(times, values, geometric)

    def formula(t):
        k = max(i for i in range(3) if t >= times[i])
        part = min((t - mp.mpf(times[k])) / (mp.mpf(times[k + 1]) - mp.mpf(times[k])), mp.mpf(1))
        a, b = mp.mpf(values[k]), mp.mpf(values[k + 1])
        return a * (b / a) ** part if geometric else a + (b - a) * part

    assert np.abs(law(TIMES) - exact(formula)).max() < BAR
    assert law(np.array(times)).tolist() == list(values)
    assert law([-1.0, 9.0]).tolist() == [0.05, 0.31]


def test_colours_have_a_channel_dimension_and_numbers_none():
    """(...) for a number, (..., 3) for RGB, for any shape of t."""
    rgb = Exponential((0.1, 0.2, 0.3), (0.3, 0.2, 0.1), (1.0,))
    for shape in ((), (4,), (2, 5)):
        t = np.zeros(shape)
        assert rgb(t).shape == (*shape, 3)
        assert Keys((0.0, 1.0), ((0.1, 0.2, 0.3), (0.3, 0.2, 0.1)))(t).shape == (*shape, 3)
        assert Keys((0.0,), ((0.1, 0.2, 0.3),))(t).shape == (*shape, 3)
        assert Logistic(0.1, 0.2, 1.0, 0.0)(t).shape == shape


def test_beyond_its_range_a_trajectory_holds_its_ends():
    """And weights stay weights, whatever their law says."""
    course = Trajectory({"s": Polynomial((0.5, -1.0))}, 0.0, 2.0, {"s": (0.0, 1.0)})
    assert course.value("s", [-1e300, -1.0, 0.0, 0.25, 1.0, 2.0, 1e300]).tolist() == [
        0.5,
        0.5,
        0.5,
        0.25,
        0.0,
        0.0,
        0.0,
    ]
    assert course.age([-1.0, 0.0, 1.0, 3.0]).tolist() == [0.0, 0.0, 0.5, 1.0]
    assert course.time([0.0, 0.5, 1.0]).tolist() == [0.0, 1.0, 2.0]
    assert set(course.at(0.0)) == {"s"}


@given(
    start=st.floats(0.0, 1.0), end=st.floats(0.0, 1.0), scale=st.floats(-9.0, 9.0), t=st.floats(-1e300, 1e300),
)  # fmt: skip
@example(start=0.0, end=1.0, scale=9.0, t=1.797693134862316e299)
@settings(max_examples=300, deadline=None)
def test_laws_stay_between_their_ends_at_any_rate_and_time(start, end, scale, t):
    """Finite, no overshoot, for rates of 1e-9 to 1e9 and every time."""
    rate = 10.0**scale
    laws = [Exponential(start, end, (rate, 1.0), (0.5, 0.5)), Logistic(start, end, rate, 1.0), Power(start, end, 0.5)]
    laws.append(Keys((0.0, 1.0 / rate), (start, end)))
    low, high = min(start, end), max(start, end)
    if low > 1e-3:
        laws.append(Reciprocal(start, end, rate))
    for law in laws:
        value = float(law(t))
        assert low - 1e-15 <= value <= high + 1e-15


def test_each_point_has_a_clock_of_its_own():
    """rate age - offset, held to 0..1; a point of rate 0 and offset 0 stays at the start."""
    got = local_age(0.5, rate=[1.0, 2.0, 4.0, 0.0], offset=[0.0, 0.25, 0.0, 0.0])
    assert got.tolist() == [0.5, 0.75, 1.0, 0.0]
    assert local_age(0.5, 1.0, 2.0) == 0.0


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: Exponential(0, 1, (0.0,)), "rates must be greater than 0"),
        (lambda: Exponential(0, 1, (1.0, 2.0)), "shares must be one for each of 2 rates"),
        (lambda: Exponential(0, 1, (1.0, 2.0), (0.5, 0.6)), "sum to 1"),
        (lambda: Reciprocal(0.0, 1.0, 1.0), "start must be greater than 0"),
        (lambda: Logistic(0, 1, 1.0, -100.0), "middle must not lie more than 30 / rate before 0"),
        (lambda: Power(0, 1, 0.0), "exponent must be between 0.1 and 10"),
        (lambda: Power(0, 1, 1.0, begin=2.0), "finish must be later than 2"),
        (lambda: Keys((0.0, 0.0), (1.0, 2.0)), "times must ascend"),
        (lambda: Keys((0.0, 1.0), (1.0,)), "values must be one for each of 2 times, got 1"),
        (lambda: Keys((0.0, 1.0), (0.0, 1.0), geometric=True), "values must be greater than 0"),
        (lambda: Trajectory({}, 1.0, 1.0), "end must be later than start"),
        (lambda: Trajectory({}, 0.0, np.inf), "end must be later than start"),
        (lambda: Polynomial(()), "coefficients must hold at least one"),
        (lambda: Keys((0.0, 1.0), (1.0, 2.0))(np.nan), "t must be finite"),
    ],
)
def test_what_does_not_hold_is_refused(make, complaint):
    """One clear line for each."""
    with pytest.raises(ValueError, match=complaint):
        make()
