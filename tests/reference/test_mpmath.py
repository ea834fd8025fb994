# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference against the papers' equations at 50 decimal digits.

The oracle takes the same float64 components as they stand, so nothing but the reference's own rounding can differ.
Fresnel is written otherwise than in the reference: the dielectric from Snell's law and the two amplitudes, the
conductor in real numbers.
"""

from __future__ import annotations

from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
import pytest
from mpmath import mp, mpf, workdps

from vgroove.addon.reference import (
    Conductor,
    CookTorrance,
    Dielectric,
    Schlick,
    beckmann_d,
    fresnel_conductor,
    fresnel_dielectric,
    oren_nayar,
    schlick,
    smith_g,
    spherical,
    vgroove_g,
)

DIGITS = 50
LIMIT = 1e-12
SMALLEST = mpf("1e-300")  # below it float64 begins to lose digits (denormal numbers)
U = 2.0**-53  # largest relative error of one float64 operation


@pytest.fixture(autouse=True)
def digits():
    """Every test here computes with ``DIGITS`` decimal digits."""
    with workdps(DIGITS):
        yield


# --- the oracle ---------------------------------------------------------------------------------------------------


def exact(vector):
    """The float64 components as they stand."""
    return [mpf(float(component)) for component in vector]


def exact_dot(a, b):
    return sum((x * y for x, y in zip(a, b, strict=True)), mpf(0))


def exact_half(wi, wo):
    """h and |wi + wo|."""
    both = [x + y for x, y in zip(wi, wo, strict=True)]
    length = mp.sqrt(exact_dot(both, both))
    return [x / length for x in both], length


def exact_d(h, m):
    """Walter et al. 2007, eq. 25."""
    tan2 = (h[0] ** 2 + h[1] ** 2) / h[2] ** 2
    return mp.exp(-tan2 / m**2) / (mp.pi * m**2 * h[2] ** 4)


def exact_schlick(c, f0):
    """Schlick 1994, eq. 15."""
    return f0 + (1 - f0) * (1 - c) ** 5


def exact_dielectric(c, eta):
    """Snell's law and Fresnel's two amplitudes; 1 where no real angle of refraction exists, 0 without an interface."""
    if eta == 1:
        return mpf(0)
    t2 = (eta**2 - 1 + c**2) / eta**2  # cos^2 of the refracted ray; in this order c = 1e-160 is not lost
    if t2 <= 0:
        return mpf(1)
    t = mp.sqrt(t2)
    r_s = (c - eta * t) / (c + eta * t)
    r_p = (eta * c - t) / (eta * c + t)
    return (r_s**2 + r_p**2) / 2


def exact_conductor(c, n, k):
    """In real numbers, with a + ib = sqrt((n + ik)^2 - sin^2); Sparrow & Cess 1978, eqs. 2-64 to 2-66."""
    if c == 0:
        return mpf(0 if (n, k) == (1, 0) else 1)
    sin2 = 1 - c**2
    real = n**2 - k**2 - 1 + c**2
    size = mp.sqrt(real**2 + 4 * n**2 * k**2)  # a^2 + b^2
    a = mp.sqrt(max(size + real, mpf(0)) / 2)
    r_s2 = (size - 2 * a * c + c**2) / (size + 2 * a * c + c**2)
    sin_tan = sin2 / c
    r_p2 = r_s2 * (size - 2 * a * sin_tan + sin_tan**2) / (size + 2 * a * sin_tan + sin_tan**2)
    return (r_s2 + r_p2) / 2


def relative(got, expected):
    """|got - expected| / expected, the difference itself where 0 is expected."""
    difference = abs(mpf(float(got)) - expected)
    return float(difference / expected) if expected != 0 else float(difference)


# --- directions ---------------------------------------------------------------------------------------------------


class Case(NamedTuple):
    kind: str
    m: float
    wi: np.ndarray
    wo: np.ndarray


def mirrored_case(kind, m, wo, p, q):
    """wi such that the facet has slopes (p, q), to the last digit of float64; None if it leaves below the surface."""
    with workdps(DIGITS):
        p, q = mpf(float(p)), mpf(float(q))
        length = mp.sqrt(1 + p**2 + q**2)
        h = [p / length, q / length, 1 / length]
        view = exact(wo)
        vh = exact_dot(view, h)
        wi = np.array([float(2 * vh * x - y) for x, y in zip(h, view, strict=True)])
    return Case(kind, m, wi, wo) if vh > 0 and wi[2] > 0 else None


def degrees(theta, phi):
    return spherical(np.deg2rad(theta), np.deg2rad(phi))


@cache
def cases():
    """Near-specular lobes of every width, grazing pairs at every difference of azimuth, and plain pairs."""
    rng = np.random.default_rng(1982)
    found = []
    thetas = [0.0, 1e-4, 30.0, 60.0, 85.0, 89.0, 89.99, 89.9999]
    for m, theta, reach in product([1e-6, 1e-4, 0.01, 0.1, 0.5, 1.0, 3.0, 10.0], thetas, [0.0, 0.3, 1.0, 5.0, 25.0]):
        view, turn = degrees(theta, rng.uniform(0, 360)), rng.uniform(0, 2 * np.pi)
        found.append(mirrored_case("lobe", m, view, reach * m * np.cos(turn), reach * m * np.sin(turn)))
    for m, low, high in product([0.3, 3.0, 10.0], [80.0, 89.0, 89.9, 89.9999], [80.0, 89.9, 89.99, 89.9999]):
        for azimuth in (0.0, 90.0, 170.0, 179.9, 179.999, 180.0, 180.0 + 1e-4):
            start = rng.uniform(0, 360)
            found.append(Case("grazing", m, degrees(low, start), degrees(high, start + azimuth)))
    for m in np.exp(rng.uniform(np.log(0.05), np.log(10.0), 100)):
        theta, phi = np.rad2deg(np.arccos(rng.uniform(0, 1, 2))), rng.uniform(0, 360, 2)
        found.append(Case("plain", float(m), degrees(theta[0], phi[0]), degrees(theta[1], phi[1])))
    for eta, off in product([0.5, 0.9, 1 - 1e-9], [1e-2, 1e-4, 1e-6, 1e-9, 0.0]):
        cosine = np.sqrt(1 - eta**2) * np.array([1 + off, 1 - off])
        for c in cosine:
            view = np.array([np.sqrt((1 - c) * (1 + c)), 0.0, c])
            found.append(Case("critical", 0.1, view * [-1, 1, 1], view))
    return [case for case in found if case is not None]


# --- F, D and G alone ---------------------------------------------------------------------------------------------

COSINES = [0.0, 1e-160, 1e-20, 1e-9, 1e-6, 4.47e-5, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1 - 1e-9, 1.0]
ETAS = [1 + 1e-9, 1 - 1e-9, 1 + 1e-15, 1 - 1e-15, 1.0, 0.1, 0.5, 0.9, 1.333, 1.5, 2.4, 10.0]
NS = [0.0, 0.05, 0.2, 0.5, 0.9, 1 - 1e-9, 1.0, 1 + 1e-9, 1.5, 10.0, 20.0]
KS = [0.0, 1e-9, 1e-6, 0.01, 0.5, 1.0, 3.9, 20.0]


def critical_cosine(eta):
    """v.h at which total internal reflection sets in; 0 for eta >= 1."""
    return float(np.sqrt((1 - min(eta, 1.0)) * (1 + min(eta, 1.0))))


def check_fresnel(function, formula, *parameters):
    """``function`` agrees to ``LIMIT`` at the plain cosines and around the critical angle, down to one part in 1e15.

    Within 2e-6 of that angle F has (nearly) a vertical tangent: g^2 = c^2 - (1 - eta^2) is what is left of its
    terms, and one rounding of those moves F by more than 1e-12. There the result must be no further off than the
    exact one for a cosine moved by two ulp.
    """
    critical = critical_cosine(parameters[0])
    near = [critical * (1 + sign * off) for sign in (-1, 1) for off in (1e-3, 1e-6, 1e-9, 1e-12, 1e-15)]
    cosines = [*COSINES, *(c for c in near if 0 < c < 1)]
    got = function(np.array(cosines), *parameters)
    assert got.shape == (len(cosines),)
    exactly = [mpf(p) for p in parameters]
    for c, value in zip(cosines, got, strict=True):
        expected = formula(mpf(c), *exactly)
        allowed = mpf(LIMIT)
        if critical > 0 and abs(c / critical - 1) < 2e-6:
            moved = [formula(min(mpf(c) * (1 + s), mpf(1)), *exactly) for s in (-4 * U, 4 * U)]
            allowed = max(LIMIT, *(abs(f - expected) / expected for f in moved))
        assert relative(value, expected) < allowed, (c, parameters)


@pytest.mark.parametrize("eta", ETAS)
def test_fresnel_dielectric_is_exact(eta):
    """Cook & Torrance's form in g and c is Snell and Fresnel, to 1e-12, at every angle."""
    check_fresnel(fresnel_dielectric, exact_dielectric, eta)


@pytest.mark.parametrize(("n", "k"), [(n, k) for n, k in product(NS, KS) if n + k > 0])
def test_fresnel_conductor_is_exact(n, k):
    """The complex form is the real one of optics textbooks, to 1e-12, at every angle and index."""
    check_fresnel(fresnel_conductor, exact_conductor, n, k)


@pytest.mark.parametrize("eta", [0.5, 0.75])
def test_fresnel_keeps_its_digits_next_to_the_critical_angle(eta):
    """Where eta^2 - 1 is exact in float64, F is right to 1e-12 down to one part in 1e15 of the critical angle.

    c^2 - (1 - eta^2) then depends on the digits of c^2 that float64 rounds off; they are carried along.
    """
    critical = critical_cosine(eta)
    cosines = critical * (1 + np.array([1e-15, 1e-14, 1e-12, 1e-9, 1e-6]))
    for got in (fresnel_dielectric(cosines, eta), fresnel_conductor(cosines, eta, 0.0)):
        assert got.shape == cosines.shape
        for c, value in zip(cosines, got, strict=True):
            assert relative(value, exact_dielectric(mpf(float(c)), mpf(eta))) < LIMIT


@pytest.mark.parametrize("n", [n for n in NS if n > 0])
def test_fresnel_conductor_without_absorption_is_dielectric(n):
    """k = 0 gives the dielectric's F, also in total internal reflection."""
    cosines = np.array(COSINES)
    got, expected = fresnel_conductor(cosines, n, 0.0), fresnel_dielectric(cosines, n)
    assert got.shape == expected.shape == cosines.shape
    np.testing.assert_allclose(got, expected, rtol=LIMIT, atol=0)


@pytest.mark.parametrize("f0", [0.0, 0.02, 0.54, 0.95, 1.0])
def test_schlick_is_exact(f0):
    """Schlick's polynomial, to the rounding of its nine operations (the fifth power multiplies one of them by 5)."""
    got = schlick(np.array(COSINES), f0)
    assert got.shape == (len(COSINES),)
    for c, value in zip(COSINES, got, strict=True):
        assert relative(value, exact_schlick(mpf(c), mpf(f0))) < 14 * U


@pytest.mark.parametrize("m", [1e-6, 1e-4, 0.01, 0.1, 0.5, 1.0, 3.0, 10.0])
def test_beckmann_d_is_exact(m):
    """D, for facets from the normal out to where it leaves float64."""
    rng = np.random.default_rng(1963)
    slopes = m * np.sqrt(np.linspace(0, 680, 60))  # exp(-680) = 1e-296
    turn = rng.uniform(0, 2 * np.pi, slopes.size)
    h = spherical(np.arctan(slopes), turn)
    got = beckmann_d(h, m)
    assert got.shape == slopes.shape
    for facet, value in zip(h, got, strict=True):
        # tan^2/m^2 takes six operations, and exp() turns their relative error into 680 times as much: 4.5e-13.
        assert relative(value, exact_d(exact(facet), mpf(m))) < 6 * 680 * U


def exact_g(wi, wo):
    """Cook & Torrance's G."""
    h, _ = exact_half(wi, wo)
    return min(mpf(1), 2 * h[2] * min(wi[2], wo[2]) / exact_dot(wo, h))


def test_vgroove_g_is_exact():
    """G, but for what the rounding of h does to v.h where h is nearly at a right angle to v."""
    got = vgroove_g(np.array([case.wi for case in cases()]), np.array([case.wo for case in cases()]))
    assert got.shape == (len(cases()),)
    strict = 0
    for case, value in zip(cases(), got, strict=True):
        wi, wo = exact(case.wi), exact(case.wo)
        h, _ = exact_half(wi, wo)
        allowed = 4 * vh_rounding(wo, h) / exact_dot(wo, h)  # G is 1/(v.h) times well-conditioned factors
        strict += allowed < LIMIT
        assert relative(value, exact_g(wi, wo)) < max(LIMIT, allowed)
    assert strict > 0.97 * len(cases())


@pytest.mark.parametrize("m", [0.02, 0.3, 1.0, 10.0])
def test_smith_g_is_exact(m):
    """Cycles' rational Smith term, from the normal to grazing."""
    got = smith_g(np.array([case.wi for case in cases()]), np.array([case.wo for case in cases()]), m)
    assert got.shape == (len(cases()),)
    # The fit's Lambda is below 0 by up to 6.2e-5 between a = 1.548 and 1.6, as in Cycles, and there are two of them.
    assert ((got > 0) & (got <= 1 + 1.3e-4)).all()
    for case, value in zip(cases(), got, strict=True):
        masked = mpf(0)
        for w in (exact(case.wi), exact(case.wo)):
            tangent = mp.sqrt(w[0] ** 2 + w[1] ** 2) / w[2]
            a = 1 / (mpf(m) * tangent) if tangent else mp.inf
            if a < mpf("1.6"):
                masked += (1 - mpf("1.259") * a + mpf("0.396") * a**2) / (mpf("3.535") * a + mpf("2.181") * a**2)
        assert relative(value, 1 / (1 + masked)) < LIMIT


# --- the models ---------------------------------------------------------------------------------------------------


def vh_rounding(wo, h):
    """Bound on the float64 rounding of v.h = sum of wo_i h_i, absolute.

    Each h_i = (wi_i + wo_i) / |wi + wo| is rounded twice and |wi + wo| three times (a common factor), each product
    once and the sum twice: 5 U on every product and 3 U on the whole. Where v and h are nearly at a right angle (both
    directions grazing, from opposite sides, not in one plane) the products are far larger than their sum.
    """
    products = sum((abs(x * y) for x, y in zip(wo, h, strict=True)), mpf(0))
    return U * (5 * products + 3 * exact_dot(wo, h))


def exact_terms(case):
    """What all Fresnel terms share: D / (4 (n.l)(n.v)), 2 (n.h) min(n.l, n.v), v.h and the rounding of v.h."""
    wi, wo = exact(case.wi), exact(case.wo)
    h, _ = exact_half(wi, wo)
    D = exact_d(h, mpf(case.m))
    return D / (4 * wi[2] * wo[2]), 2 * h[2] * min(wi[2], wo[2]), exact_dot(wo, h), vh_rounding(wo, h)


@cache
def all_terms():
    with workdps(DIGITS):
        return [exact_terms(case) for case in cases()]


FRESNELS = [
    (Schlick((0.02, 0.54, 0.95)), exact_schlick),
    (Schlick((0.0, 0.17, 1.0)), exact_schlick),
    (Dielectric((1 + 1e-9, 1 - 1e-9, 0.5)), exact_dielectric),
    (Dielectric((1.5, 10.0, 0.9)), exact_dielectric),
    (Conductor((0.2, 0.05, 1.5), (3.9, 20.0, 0.0)), exact_conductor),
    (Conductor((1 + 1e-9, 0.5, 1.0), (0.0, 0.0, 1e-9)), exact_conductor),
    (Conductor((0.9, 0.5, 1.0), (0.01, 1e-6, 20.0)), exact_conductor),
]


def test_cases_are_many_and_extreme():
    """More than 200 pairs, with every width of lobe, and angles of 89.9999 degrees."""
    wi, wo = np.array([case.wi for case in cases()]), np.array([case.wo for case in cases()])
    slopes = np.array([case.m for case in cases()])
    assert wi.shape == wo.shape == (len(cases()), 3)
    assert {case.kind for case in cases()} == {"lobe", "grazing", "plain", "critical"}
    assert len(cases()) > 500
    assert slopes.min() == 1e-6
    assert slopes.max() == 10.0
    for m in (1e-6, 1e-4, 0.01):
        assert np.sum(slopes == m) > 20
    assert np.sum(np.minimum(wi[:, 2], wo[:, 2]) < 2e-6) > 50  # cos 89.9999 degrees = 1.7e-6


@pytest.mark.parametrize(("fresnel", "formula"), FRESNELS, ids=lambda value: getattr(value, "__name__", repr(value)))
def test_cook_torrance_is_exact(fresnel, formula):
    """F D G / (4 (n.l)(n.v)) to 1e-12, but where v.h as float64 can give it does not decide F G to that.

    exp(-x) makes of the eight roundings in x = tan^2/m^2 at most 690 * 8 U = 6e-13 while the value is above 1e-300.
    More than 1e-12 is allowed only where moving v.h by its own rounding moves F G by more than 1e-12: next to the
    critical angle, where F = 0 at v.h = 1 (F0 = 0), and for opposite grazing directions out of one plane.
    """
    m = np.array([case.m for case in cases()])
    wi, wo = np.array([case.wi for case in cases()]), np.array([case.wo for case in cases()])
    got = CookTorrance(m, fresnel).evaluate(wi, wo)
    assert got.shape == (len(cases()), 3)
    parameters = np.broadcast_arrays(*(np.asarray(p, dtype=float) for p in vars(fresnel).values()), np.zeros(3))[:-1]
    compared = strict = 0
    for index, channel in product(range(len(cases())), range(3)):
        shared, twice, vh, rounding = all_terms()[index]
        numbers = [mpf(float(p[channel])) for p in parameters]

        def reflected(c, twice=twice, numbers=numbers):
            return formula(min(c, mpf(1)), *numbers) * min(mpf(1), twice / c)

        expected = shared * reflected(vh)
        if expected < SMALLEST:
            continue
        compared += 1
        error = relative(got[index, channel], expected)
        if error < LIMIT:
            strict += 1
            continue
        base = reflected(vh)
        allowed = max(abs(reflected(vh + rounding) - base), abs(reflected(vh - rounding) - base)) / base
        assert error < LIMIT + allowed, (cases()[index], fresnel, channel)
    assert compared > 1500
    assert strict > 0.98 * compared


def exact_cos_p(wi, wo):
    """Cosine between the azimuths; 0 along the normal, where it has no effect."""
    sin_i, sin_o = (mp.sqrt(w[0] ** 2 + w[1] ** 2) for w in (wi, wo))
    return (wi[0] * wo[0] + wi[1] * wo[1]) / (sin_i * sin_o) if sin_i * sin_o else mpf(0)


def exact_oren_nayar(wi, wo, cos_p, rho, sigma, *, qualitative):
    """Oren & Nayar 1994, eqs. 27 to 30."""
    sin_i, sin_o = (mp.sqrt(w[0] ** 2 + w[1] ** 2) for w in (wi, wo))
    theta_i, theta_o = mp.atan2(sin_i, wi[2]), mp.atan2(sin_o, wo[2])
    a, b = max(theta_i, theta_o), min(theta_i, theta_o)
    s2 = sigma**2
    C1 = 1 - mpf("0.5") * s2 / (s2 + mpf("0.33"))
    C2 = mpf("0.45") * s2 / (s2 + mpf("0.09"))
    if qualitative:
        return rho / mp.pi * (C1 + max(mpf(0), cos_p) * C2 * mp.sin(a) * mp.tan(b))
    C2 *= mp.sin(a) if cos_p >= 0 else mp.sin(a) - (2 * b / mp.pi) ** 3
    C3 = mpf("0.125") * s2 / (s2 + mpf("0.09")) * (4 * a * b / mp.pi**2) ** 2
    once = C1 + cos_p * C2 * mp.tan(b) + (1 - abs(cos_p)) * C3 * mp.tan((a + b) / 2)
    twice = mpf("0.17") * s2 / (s2 + mpf("0.13")) * (1 - cos_p * (2 * b / mp.pi) ** 2)
    return rho / mp.pi * once + rho**2 / mp.pi * twice


@pytest.mark.parametrize("qualitative", [False, True])
@pytest.mark.parametrize("sigma", [0.0, 1e-9, 0.1, 0.5, 1.5])
def test_oren_nayar_is_exact(sigma, qualitative):
    """Both forms to 1e-12 up to 89.9999 degrees; 0 where the full fit is negative.

    cos p comes from float64 with an absolute error of up to 4 U (two normalised vectors of three roundings each).
    Where it is nearly 0 and both directions are grazing, it multiplies tan b = 5.7e5: up to 2.5e-10 is allowed there.
    """
    rho = np.array([0.05, 0.4, 1.0])
    wi, wo = np.array([case.wi for case in cases()]), np.array([case.wo for case in cases()])
    got = oren_nayar(wi, wo, rho, sigma, qualitative=qualitative)
    assert got.shape == (len(cases()), 3)
    loose = 0
    for index, channel in product(range(0, len(cases()), 2), range(3)):
        case, numbers = cases()[index], (mpf(float(rho[channel])), mpf(sigma))
        light, view = exact(case.wi), exact(case.wo)
        cos_p = exact_cos_p(light, view)
        expected = exact_oren_nayar(light, view, cos_p, *numbers, qualitative=qualitative)
        if expected < 0:
            assert got[index, channel] == 0
            continue
        error = relative(got[index, channel], expected)
        if error >= LIMIT:
            loose += 1
            assert abs(cos_p) < 1e-9
            moved = exact_oren_nayar(light, view, cos_p + 4 * U, *numbers, qualitative=qualitative)
            assert error < LIMIT + abs(moved / expected - 1), (case, channel)
    assert loose < 0.01 * got.size
