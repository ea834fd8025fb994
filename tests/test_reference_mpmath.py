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
    """Snell's law and Fresnel's two amplitudes; 1 where no real angle of refraction exists."""
    inside2 = 1 - (1 - c**2) / eta**2
    if inside2 <= 0:
        return mpf(1)
    t = mp.sqrt(inside2)
    r_s = (c - eta * t) / (c + eta * t)
    r_p = (eta * c - t) / (eta * c + t)
    return (r_s**2 + r_p**2) / 2


def exact_conductor(c, n, k):
    """In real numbers, with a + ib = sqrt((n + ik)^2 - sin^2); Sparrow & Cess 1978, eqs. 2-64 to 2-66."""
    if c == 0:
        return mpf(1)
    sin2 = 1 - c**2
    real = n**2 - k**2 - sin2
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
        for azimuth in (0.0, 90.0, 170.0, 179.9, 180.0, 180.0 + 1e-4):
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
