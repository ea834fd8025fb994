# SPDX-License-Identifier: GPL-3.0-or-later
"""UTIA's .bin: anisotropic, on a grid of 15 and 7.5 degrees."""

import numpy as np
import pytest

from vgroove.addon.measured import read, write_csv
from vgroove.addon.reference import spherical

from .makers import directions, utia_angles, utia_bytes


def brushed(wi, wo):
    """Different along x and y, and not reciprocal."""
    return (0.1 + wi[..., :1] ** 2 + 0.25 * wo[..., 1:2] ** 2) * np.array([1.0, 0.5, 0.25])


@pytest.fixture
def made(tmp_path):
    def make(content):
        path = tmp_path / "made.bin"
        path.write_bytes(content)
        return path

    return make


def test_nodes_have_their_own_values_and_between_them_it_is_linear(made):
    """sin^2 cos^2 over 15 and 7.5 degrees: h^2/8 of second derivatives up to 2 is 0.0171 + 0.0043 a direction."""
    found = read(made(utia_bytes(brushed)))
    wi, wo = (one.reshape(-1, 3)[::37] for one in utia_angles())
    lit = (wi[:, 2] > 0) & (wo[:, 2] > 0)
    np.testing.assert_allclose(found.evaluate(wi, wo)[lit], brushed(wi, wo)[lit], atol=1e-12)
    wi, wo = directions(3000, 1)
    inside = (wi[:, 2] > np.cos(np.radians(75.0))) & (wo[:, 2] > np.cos(np.radians(75.0)))
    error = np.abs(found.evaluate(wi, wo) - brushed(wi, wo))[inside]
    assert error.max() < 1.25 * 0.0214
    assert not found.contents.isotropic
    assert found.contents.coverage == 1.0


def test_beyond_75_degrees_it_is_held(made):
    found = read(made(utia_bytes(brushed)))
    wo = spherical(np.radians(40.0), 1.0)
    f = found.evaluate(spherical(np.radians([75.0, 80.0, 89.0]), 2.0), wo)
    np.testing.assert_allclose(f[1:], f[[0, 0]], rtol=1e-12)


def test_holes_are_counted_and_filled(made):
    """Negative ones are noise in the dark, and black; others take the azimuth before, in all channels."""
    table = np.frombuffer(utia_bytes(brushed)).reshape(3, 6, 48, 6, 48).copy()
    table[0, 2, 3, 4, 5] = -0.01
    table[1, 2, 3, 4, 7] = np.nan
    table[:, 3, 4, 5] = np.inf
    found = read(made(table.tobytes()))
    assert found.contents.holes == 2 + 48
    assert found.table[0, 2, 3, 4, 5] == 0
    np.testing.assert_array_equal(found.table[1:, 2, 3, 4, 5], table[1:, 2, 3, 4, 5])
    np.testing.assert_array_equal(found.table[:, 2, 3, 4, 7], table[:, 2, 3, 4, 6])
    np.testing.assert_array_equal(found.table[:, 3, 4, 5], table[:, 3, 3, 5])


def test_a_csv_of_it_turns_the_light_too(made, tmp_path):
    path = tmp_path / "out.csv"
    write_csv(path, read(made(utia_bytes(brushed))), 45.0)
    rows = np.loadtxt(path, delimiter=",", skiprows=1)
    assert rows.shape == ((2 * 8) ** 2, 7)
    assert set(rows[:, 1]) == set(np.arange(0.0, 360.0, 45.0))
