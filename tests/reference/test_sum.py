# SPDX-License-Identifier: GPL-3.0-or-later
"""Sums of a diffuse and a specular part: their light adds up, and a coupled sum scatters what is not mirrored."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vgroove.addon.reference import (
    CookTorrance,
    Dielectric,
    Lambert,
    OrenNayar,
    Schlick,
    Smooth,
    Sum,
    albedo,
    schlick,
    spherical,
)

from .examples import ANGLES, UP, at_height, thorough, upper


@pytest.mark.parametrize("m", [0.02, 0.3, 1.0, 10.0])
@pytest.mark.parametrize("s", [0.0, 0.3, 1.0])
def test_sum_never_returns_more_than_it_receives(m, s):
    """White parts with d + s = 1: albedo at most 1, and the weighted sum of the parts'."""
    rough, flat, wo = CookTorrance(m, Schlick(1.0)), Lambert(1.0), spherical(ANGLES)
    energy = albedo(Sum(flat, rough, 1 - s, s), wo)
    assert energy.shape == (len(ANGLES), 3)
    assert (energy <= 1 + 1e-6).all()
    np.testing.assert_allclose(energy, (1 - s) * albedo(flat, wo) + s * albedo(rough, wo), rtol=1e-15)


@given(d=st.floats(0.0, 1.0), wi=upper, wo=upper)
@thorough
def test_sum_adds_its_parts(d, wi, wo):
    """f = d f_diffuse + s f_specular."""
    flat, rough = OrenNayar((0.1, 0.5, 0.9), 0.3), CookTorrance(0.4, Schlick(0.5))
    got = Sum(flat, rough, d, 1 - d).evaluate(wi, wo)
    assert got.shape == (3,)
    np.testing.assert_allclose(got, d * flat.evaluate(wi, wo) + (1 - d) * rough.evaluate(wi, wo), rtol=1e-15)


@given(wi=upper, wo=upper)
@settings(thorough, max_examples=20)  # each a quadrature
def test_coupled_sum_scatters_what_is_not_mirrored(wi, wo):
    """f = d (1 - s E_s(wo)) f_diffuse + s f_specular, by channel."""
    flat, rough = OrenNayar((0.1, 0.5, 0.9), 0.3), CookTorrance(0.4, Schlick((0.04, 0.5, 1.0)))
    got = Sum(flat, rough, 0.9, 0.8, coupled=True).evaluate(wi, wo)
    expected = 0.9 * (1 - 0.8 * albedo(rough, wo)) * flat.evaluate(wi, wo) + 0.8 * rough.evaluate(wi, wo)
    assert got.shape == (3,)
    np.testing.assert_allclose(got, expected, rtol=1e-9)  # a view in another azimuth rounds its cosine otherwise


@pytest.mark.parametrize("m", [0.02, 0.3, 1.0])
def test_coupled_sum_of_white_parts_loses_nothing(m):
    """d = s = 1 over white Lambert: 1 - E_s + E_s = 1 at every view; 0 from below, for a bundle and for none."""
    mixed = Sum(Lambert(1.0), CookTorrance(m, Dielectric(1.5)), 1.0, 1.0, coupled=True)
    wo = np.stack([*spherical(ANGLES[:-1:2]), -UP])
    np.testing.assert_allclose(albedo(mixed, wo), [[1.0] * 3] * (len(wo) - 1) + [[0.0] * 3], rtol=1e-12)
    assert albedo(mixed, UP).shape == (3,)
    assert mixed.evaluate(UP, np.zeros((0, 3))).shape == (0, 3)
    assert mixed.evaluate(UP, np.zeros((2, 0, 3))).shape == (2, 0, 3)


def test_coupled_sum_takes_a_slope_for_each_direction():
    """As ``CookTorrance`` does."""
    m, wo = np.array([0.1, 0.5]), spherical(0.7, np.array([0.0, 1.0]))
    got = Sum(Lambert(0.5), CookTorrance(m, Schlick(0.5)), 1.0, 1.0, coupled=True).evaluate(UP, wo)
    for index in range(2):
        one = Sum(Lambert(0.5), CookTorrance(m[index], Schlick(0.5)), 1.0, 1.0, coupled=True)
        np.testing.assert_allclose(got[index], one.evaluate(UP, wo[index]), rtol=1e-12)


class Brushed:
    """A part that looks different from each azimuth; it reflects x^2 / 2 + 0.1 of what is seen from (x, y, z)."""

    def evaluate(self, wi, wo):
        return self.directional_albedo(wo) / np.pi

    def directional_albedo(self, wo):
        return np.repeat(0.5 * np.square(np.asarray(wo)[..., :1]) + 0.1, 3, axis=-1)


def test_coupled_sum_knows_that_a_part_may_differ_by_azimuth():
    """What an anisotropic part leaves depends on the whole direction, asked for in whatever order."""
    views = np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8]])
    mixed = Sum(Lambert(0.5), Brushed(), 1.0, 0.5, coupled=True)
    seen = Brushed().directional_albedo(views)
    np.testing.assert_allclose(mixed.directional_albedo(views), 0.5 * (1.0 - 0.5 * seen) + 0.5 * seen, rtol=1e-14)


def test_coupled_sum_asks_each_view_once(monkeypatch):
    """One quadrature a cosine, whatever the azimuths, the lights and the calls."""
    rough, asked = CookTorrance(0.3, Schlick(0.5)), []
    original = CookTorrance.directional_albedo

    def counted(model, wo):
        asked.extend(wo[:, 2])
        return original(model, wo)

    monkeypatch.setattr(CookTorrance, "directional_albedo", counted)
    mixed = Sum(Lambert(0.5), rough, 1.0, 1.0, coupled=True)
    views = np.broadcast_to(np.stack([at_height(0.5), at_height(0.8)]), (50, 2, 3))
    for light in (UP, at_height(0.3)):
        mixed.evaluate(light, views)
    assert asked == [0.5, 0.8]


def test_smooth_part_of_a_sum_is_sampled_with_its_share():
    """d : s picks the lobe; the delta's weight is s F over its probability, the rest is the diffuse part alone."""
    mixed, wo = Sum(Lambert(0.5), Smooth(Schlick(0.2)), 0.3, 0.1), spherical(0.6)
    wi, weight = mixed.sample(wo, [0.24, 0.1, 0.2, 0.3])
    assert wi.tolist() == (wo * [-1, -1, 1]).tolist()
    F = schlick(wo[2], 0.2)
    np.testing.assert_allclose(weight, 0.1 * F / 0.25, rtol=1e-15)
    wi, weight = mixed.sample(wo, [0.26, 0.1, 0.2, 0.3])
    assert wi.tolist() != (wo * [-1, -1, 1]).tolist()
    np.testing.assert_allclose(weight, 0.3 * 0.5 / 0.75, rtol=1e-14)
    np.testing.assert_allclose(albedo(mixed, wo), 0.3 * 0.5 + 0.1 * F, rtol=1e-15)
