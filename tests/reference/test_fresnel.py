# SPDX-License-Identifier: GPL-3.0-or-later
"""Reflectances of a smooth interface: between 0 and 1, with the values that textbooks give."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vgroove.addon.reference import (
    F82,
    Conductor,
    CookTorrance,
    Dielectric,
    Schlick,
    Smooth,
    albedo,
    f82,
    fresnel_conductor,
    fresnel_dielectric,
    schlick,
    spherical,
)

from .examples import ANGLES, thorough

COSINES = np.array([0.0, 1e-300, 1e-8, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 1 - 1e-9, 1.0])


@given(
    cos=st.floats(0.0, 1.0), n=st.floats(0.0, 20.0), k=st.floats(0.0, 20.0), f0=st.floats(0.0, 1.0),
    tint=st.floats(0.0, 1.0),
)  # fmt: skip
@thorough
def test_fresnel_lies_between_0_and_1(cos, n, k, f0, tint):
    """All forms, for any medium."""
    values = [schlick(cos, f0), f82(cos, f0, tint)]
    if n > 1e-50:
        values.append(fresnel_dielectric(cos, n))
    if n > 0 or k > 0:
        values.append(fresnel_conductor(cos, n, k))
    for F in values:
        assert F.shape == ()
        assert 0.0 <= F <= 1.0


def test_index_of_1_reflects_nothing():
    """eta = 1 is no interface: exactly 0, at every angle, in every model."""
    F = fresnel_dielectric(COSINES, 1.0)
    assert F.shape == COSINES.shape
    assert (F == 0).all()
    assert (fresnel_conductor(COSINES, 1.0, 0.0) == 0).all()
    wi, wo = spherical(ANGLES)[:, None], spherical(ANGLES, 2.0)
    for fresnel in (Dielectric(1.0), Conductor(1.0, 0.0)):
        assert (CookTorrance(0.3, fresnel).evaluate(wi, wo) == 0).all()
        assert (CookTorrance(0.3, fresnel).sample(wo, [0.1, 0.3, 0.5, 0.7])[1] == 0).all()
        assert (albedo(CookTorrance(0.3, fresnel), wo) == 0).all()
        assert (albedo(Smooth(fresnel), wo) == 0).all()


@pytest.mark.parametrize("eta", [0.1, 0.5, 0.75, 0.999, 1 - 1e-9])
def test_total_internal_reflection_is_1(eta):
    """Beyond the critical angle exactly 1; before it less."""
    critical = np.sqrt((1 - eta) * (1 + eta))
    beyond = fresnel_dielectric(critical * np.array([0.0, 1e-9, 0.5, 0.999999]), eta)
    before = fresnel_dielectric(np.minimum(critical * np.array([1.000001, 1.1, 2.0]), 1.0), eta)
    assert beyond.shape == (4,)
    assert (beyond == 1).all()
    assert (before < 1).all()
    np.testing.assert_allclose(fresnel_conductor(critical * 0.5, eta, 0.0), 1.0, rtol=1e-15)


@pytest.mark.parametrize("eta", [0.3, 0.999, 1.001, 1.333, 1.5, 2.4, 10.0])
def test_fresnel_has_its_textbook_values(eta):
    """((eta - 1)/(eta + 1))^2 head-on, 1 at grazing, no parallel part at Brewster's angle."""
    head_on = ((eta - 1) / (eta + 1)) ** 2
    assert fresnel_dielectric(1.0, eta) == pytest.approx(head_on, rel=1e-14)
    assert fresnel_conductor(1.0, eta, 0.0) == pytest.approx(head_on, rel=1e-14)
    assert fresnel_dielectric(0.0, eta) == 1.0
    brewster = 1 / np.sqrt(1 + eta**2)
    # There refracted and reflected ray are at right angles, and r_s = (1 - eta^2)/(1 + eta^2).
    expected = 0.5 * ((1 - eta**2) / (1 + eta**2)) ** 2
    # 1 - eta^2 by subtraction, as here, has an absolute rounding of 1.1e-16: relatively 5e-14 at 1.001, squared 1e-13.
    assert fresnel_dielectric(brewster, eta) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(("n", "k"), [(0.2, 3.9), (1.5, 0.0), (3.0, 3.0), (1.0, 20.0)])
def test_fresnel_conductor_head_on_is_that_of_two_indices(n, k):
    """((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)."""
    expected = ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
    assert fresnel_conductor(1.0, n, k) == pytest.approx(expected, rel=1e-14)


def test_schlick_ends_at_f0_and_1():
    """F0 head-on and 1 at grazing, exactly; never falling between."""
    f0 = np.array([0.0, 0.04, 0.54, 1.0])
    assert schlick(1.0, f0).tolist() == f0.tolist()
    assert schlick(0.0, f0).tolist() == [1.0] * 4
    F = schlick(np.linspace(0, 1, 101)[:, None], f0)
    assert F.shape == (101, 4)
    assert (np.diff(F, axis=0) <= 0).all()


def test_f82_is_schlick_but_for_the_tint_at_82_degrees():
    """White leaves Schlick's formula; else head-on and grazing stay, and at cos = 1/7 it is multiplied by the tint."""
    f0, tint = np.array([0.02, 0.5, 0.95]), np.array([0.4, 0.8, 1.0])
    assert (f82(COSINES[:, None], f0, 1.0) == schlick(COSINES[:, None], f0)).all()
    assert f82(1.0, f0, tint).tolist() == f0.tolist()
    assert f82(0.0, f0, tint).tolist() == [1.0] * 3
    np.testing.assert_allclose(f82(1 / 7, f0, tint), tint * schlick(1 / 7, f0), rtol=1e-14)
    with pytest.raises(ValueError, match="tint"):
        f82(0.5, 0.5, 1.1)


@pytest.mark.parametrize(
    ("one", "colour"),
    [
        (Schlick(0.3), Schlick((0.3, 0.3, 0.3))),
        (F82(0.3, 0.8), F82((0.3, 0.3, 0.3), 0.8)),
        (Dielectric(1.5), Dielectric((1.5, 1.5, 1.5))),
        (Conductor(0.2, 3.9), Conductor((0.2, 0.2, 0.2), 3.9)),
        (Conductor(0.2, 3.9), Conductor(0.2, (3.9, 3.9, 3.9))),
    ],
    ids=repr,
)
def test_fresnel_of_one_number_is_grey(one, colour):
    """A single number means all three channels, also when as many cosines as channels come in."""
    for cosines in (0.5, COSINES, COSINES[:3], COSINES[:9].reshape(3, 3)):
        got = one(cosines)
        assert got.shape == (*np.shape(cosines), 3)
        assert (got == colour(cosines)).all()
