# SPDX-License-Identifier: GPL-3.0-or-later
"""The lecture's formulas as printed against the corrected ones, for docs/errata.md."""

from __future__ import annotations

import numpy as np

from ....addon.reference import beckmann_d, fresnel_dielectric, spherical
from ..cells import Table


def tables() -> dict[str, Table]:
    return {"area": area_of_d(), "head_on": head_on(), "oblique": oblique()}


def lecture_d(angle: float, m: float) -> float:
    """As printed: 1/(4 m^2 cos^4) exp(-(tan/m)^2), without 1/pi."""
    return float(np.exp(-((np.tan(angle) / m) ** 2)) / (4 * m**2 * np.cos(angle) ** 4))


def lecture_g2(c: float, eta: float) -> float:
    """As printed: g^2 = eta^2 + c^2 + 1."""
    return eta**2 + c**2 + 1


def fresnel(c: float, g2: float, denominator: float) -> float:
    """1/2 ((g-c)/(g+c))^2 (1 + ((c(g+c) - 1)/(c(g-c) + denominator))^2)."""
    g = np.sqrt(g2)
    p = (c * (g + c) - 1) / (c * (g - c) + denominator)
    return float(0.5 * ((g - c) / (g + c)) ** 2 * (1 + p**2))


def area_of_d() -> Table:
    """What all facets together cast on the surface below: integral of D cos over the hemisphere; must be 1."""
    x, weight = np.polynomial.legendre.leggauss(400)
    angle, weight = (x + 1) * np.pi / 4, weight * np.pi / 4
    rows = []
    for m in (0.1, 0.3, 0.6):
        measure = 2 * np.pi * np.cos(angle) * np.sin(angle) * weight
        printed = sum(lecture_d(a, m) * w for a, w in zip(angle, measure, strict=True))
        rows.append([m, printed, printed * 4 / np.pi, float(np.sum(beckmann_d(spherical(angle), m) * measure))])
    return Table(["m", "as printed", "printed times 4/pi", "corrected"], rows)


def head_on() -> Table:
    """F at normal incidence against ((eta - 1)/(eta + 1))^2."""
    rows = []
    for eta in (1.333, 1.5, 2.417):
        wrong_g = fresnel(1.0, lecture_g2(1.0, eta), 1.0)
        wrong_sign = fresnel(1.0, eta**2, -1.0)
        right = float(fresnel_dielectric(1.0, eta))
        rows.append([eta, ((eta - 1) / (eta + 1)) ** 2, wrong_g, wrong_sign, right])
    return Table(["eta", "((eta-1)/(eta+1))^2", "g^2 as printed", "denominator as printed", "corrected"], rows)


def oblique() -> Table:
    """F of glass at angles, with the denominator as printed and corrected."""
    rows = []
    for degrees in (0, 30, 56.31, 75, 89):
        c = float(np.cos(np.radians(degrees)))
        rows.append([degrees, fresnel(c, 1.5**2 + c**2 - 1, -1.0), float(fresnel_dielectric(c, 1.5))])
    return Table(["angle in degrees", "denominator as printed", "corrected"], rows)
