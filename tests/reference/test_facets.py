# SPDX-License-Identifier: GPL-3.0-or-later
"""How the facets of a rough surface are distributed (D), and how they shadow each other (G)."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given

from vgroove.addon.reference import Schlick, beckmann_d, cook_torrance, smith_g, spherical, vgroove_g, vgroove_g1

from .examples import SLOPES, UP, slopes, thorough, upper


@given(wi=upper, wo=upper, m=slopes)
@thorough
def test_shadowing_lies_between_0_and_1(wi, wo, m):
    """G of the V-groove is the smaller of both one-sided terms; Cycles' Smith term may pass 1 by 1.3e-4 (its fit)."""
    h = (wi + wo) / np.linalg.norm(wi + wo)
    G = vgroove_g(wi, wo)
    assert G.shape == ()
    assert 0 < G <= 1
    # wi.h and wo.h differ as in test_cook_torrance_is_reciprocal (test_models.py).
    allowed = 4e-15 / np.sum((wi + wo) ** 2) + 1e-14
    assert pytest.approx(min(vgroove_g1(wi, h), vgroove_g1(wo, h)), rel=allowed) == G
    assert 0 < smith_g(wi, wo, m) <= 1 + 1.3e-4


def test_shadowing_by_hand():
    """60 degrees from both sides: h is the normal, v.h = 1/2, 2 (n.h)(n.v)/(v.h) = 2, so nothing is hidden.

    Light along the normal, view at 80 degrees: h at 40 degrees, 2 cos 40 cos 80 / cos 40 = 2 cos 80 = 0.347.
    """
    theta = np.deg2rad(80)
    assert vgroove_g(spherical(np.pi / 3), spherical(-np.pi / 3)) == 1.0
    assert vgroove_g(UP, spherical(theta)) == pytest.approx(2 * np.cos(theta), rel=1e-14)


def test_cook_torrance_takes_another_shadowing():
    """With G = 1 and with Smith's G: the formula's other factors stay."""
    wi, wo, m = spherical(1.2), spherical(1.4, 2.5), 0.5
    plain = cook_torrance(wi, wo, m, Schlick(0.5), G=1.0)
    assert plain.shape == (3,)
    np.testing.assert_allclose(plain * vgroove_g(wi, wo), cook_torrance(wi, wo, m, Schlick(0.5)), rtol=1e-15)
    other = cook_torrance(wi, wo, m, Schlick(0.5), G=smith_g(wi, wo, m))
    np.testing.assert_allclose(plain * smith_g(wi, wo, m), other, rtol=1e-15)


@pytest.mark.parametrize("m", SLOPES)
def test_beckmann_peak_is_that_of_its_width(m):
    """D(n) = 1/(pi m^2), and at tan = m it has fallen to 1/e of that over cos^4."""
    assert beckmann_d(UP, m) == pytest.approx(1 / (np.pi * m**2), rel=1e-15)
    expected = (1 + m**2) ** 2 / (np.e * np.pi * m**2)
    assert beckmann_d(spherical(np.arctan(m)), m) == pytest.approx(expected, rel=1e-14)
