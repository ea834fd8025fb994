# SPDX-License-Identifier: GPL-3.0-or-later
"""MERL's .binary, written and read."""

import math
import struct

import numpy as np
import pytest

from vgroove.addon.measured import Merl, merl, read, tabulate, write_merl
from vgroove.addon.reference import CookTorrance, OrenNayar, Schlick, spherical

from .makers import directions

COPPER = CookTorrance(0.3, Schlick([0.95, 0.64, 0.54]))


def independent(content, theta_i, phi_i, theta_o, phi_o):
    """RGB of the cell that a pair of directions falls into, from the format's description alone."""
    sizes = struct.unpack_from("<3i", content)

    def rotated(v, axis, angle):
        x, y, z = v
        c, s = math.cos(angle), math.sin(angle)
        return (c * x - s * y, s * x + c * y, z) if axis == "z" else (c * x + s * z, y, -s * x + c * z)

    def vector(theta, phi):
        return math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)

    wi = vector(theta_i, phi_i)
    h = [a + b for a, b in zip(wi, vector(theta_o, phi_o), strict=True)]
    theta_h, phi_h = math.atan2(math.hypot(h[0], h[1]), h[2]), math.atan2(h[1], h[0])
    x, y, z = rotated(rotated(wi, "z", -phi_h), "y", -theta_h)
    theta_d, phi_d = math.atan2(math.hypot(x, y), z), math.degrees(math.atan2(y, x)) % sizes[2]
    cell = int(90 * math.sqrt(theta_h * 2 / math.pi)), int(math.degrees(theta_d)), int(phi_d)
    at = (cell[0] * 90 + cell[1]) * sizes[2] + cell[2]
    values = (struct.unpack_from("<d", content, 12 + 8 * (at + channel * math.prod(sizes)))[0] for channel in range(3))
    return [value * scale / 1500 for value, scale in zip(values, (1.0, 1.15, 1.66), strict=True)], cell


@pytest.fixture(scope="module")
def copper(tmp_path_factory):
    path = tmp_path_factory.mktemp("merl") / "copper.binary"
    write_merl(path, tabulate(COPPER.evaluate))
    return path


@pytest.fixture(scope="module")
def table(copper):
    return read(copper)


def test_an_independent_reader_finds_what_was_written(copper):
    """Each value to its last digit: the scale and its use in writing and reading round by 1.1e-16 each."""
    content, expected = copper.read_bytes(), tabulate(COPPER.evaluate)
    wi, wo = directions(1000, 1)
    angles = [(np.arccos(v[:, 2]), np.arctan2(v[:, 1], v[:, 0])) for v in (wi, wo)]
    for theta_i, phi_i, theta_o, phi_o in zip(*angles[0], *angles[1], strict=True):
        value, cell = independent(content, theta_i, phi_i, theta_o, phi_o)
        held = expected[:, *cell]
        if (held >= 0).all():
            np.testing.assert_allclose(value, held, rtol=4.5e-16)
        else:
            assert value == pytest.approx([-1 / 1500, -1.15 / 1500, -1.66 / 1500])


def test_it_is_read_as_it_was_written(table):
    expected = tabulate(COPPER.evaluate)
    whole = (expected >= 0).all(axis=0)
    assert (table.whole == whole).all()
    np.testing.assert_allclose(table.table[:, whole], expected[:, whole], rtol=4.5e-16)
    assert table.contents.holes == 0
    assert table.contents.below == (~whole).sum()
    assert table.contents.coverage == 1.0


def test_the_centres_of_cells_have_their_own_values(table):
    """Interpolation leaves nodes alone, up to the rounding of angles: 1e-13 of an index times the step to the next."""
    theta_h, theta_d = np.square((np.arange(90) + 0.5) / 90) * np.pi / 2, np.radians(np.arange(90) + 0.5)
    for i, j, k in ((3, 20, 7), (40, 40, 90), (0, 5, 179), (20, 60, 100)):
        wi, wo = merl.directions(theta_h[i], theta_d[j], np.radians(k + 0.5))
        np.testing.assert_allclose(table.evaluate(wi, wo), table.table[:, i, j, k], rtol=1e-10)


@pytest.mark.parametrize(
    "model",
    [COPPER, CookTorrance(0.1, Schlick(0.04)), OrenNayar([0.6, 0.3, 0.1], 0.5), OrenNayar(0.9, 1.2)],
)
def test_a_model_comes_back_within_the_error_that_the_grid_states(model):
    """At 10,000 pairs, but for rounding, some 2^-53 of f."""
    grid = Merl(tabulate(model.evaluate))
    wi, wo = directions(10000, 2)
    expected = model.evaluate(wi, wo)
    error, stated = np.abs(grid.evaluate(wi, wo) - expected), grid.grid_error(wi, wo)
    known = np.isfinite(stated).all(axis=1)
    assert known.mean() > 0.8
    assert (error[known] <= stated[known] + 1e-15).all()


def test_the_stated_error_is_no_blank_cheque():
    """Over Oren-Nayar it is below 3 % of the mean, and a table that is 5 % off exceeds it nearly everywhere."""
    model = OrenNayar([0.6, 0.3, 0.1], 0.5)
    grid = Merl(1.05 * tabulate(model.evaluate))
    wi, wo = directions(4000, 3)
    expected, stated = model.evaluate(wi, wo), grid.grid_error(wi, wo)
    known = np.isfinite(stated).all(axis=1)
    assert stated[known].sum() < 0.03 * expected[known].sum()
    assert (np.abs(grid.evaluate(wi, wo) - expected)[known] > stated[known]).mean() > 0.9


def twisted(wi, wo):
    """Neither reciprocal nor the same in a mirror, as no model of ours is."""
    turn = wi[..., 0] * wo[..., 1] - wi[..., 1] * wo[..., 0]
    return (0.6 + wi[..., 2] + 0.5 * turn)[..., None] * np.array([1.0, 0.5, 0.25])


def test_360_phi_d_hold_what_is_not_reciprocal(tmp_path):
    """Angles have the sense that the independent reader gives them.

    A pair lies within half a cell of its centre: 1 degree of theta_h, 0.5 of theta_d and phi_d. wi and wo move by 0.035
    rad at most, over which f changes by 1.5 a radian each: 0.1. Interpolated, by (1 degree)^2/8 an axis: 2e-4.
    """
    path = tmp_path / "twisted.binary"
    write_merl(path, tabulate(twisted, 360))
    grid, content = read(path), path.read_bytes()
    for theta_i, phi_i, theta_o, phi_o in ((0.3, 0.3, 1.0, 2.0), (1.0, 2.0, 0.3, 0.3), (0.8, 4.0, 0.7, 1.5)):
        wi, wo = spherical(theta_i, phi_i), spherical(theta_o, phi_o)
        assert np.abs(twisted(wi, wo) - twisted(wi * [1, -1, 1], wo * [1, -1, 1]))[0] > 0.1
        np.testing.assert_allclose(grid.evaluate(wi, wo), twisted(wi, wo), atol=2e-4)
        value, _ = independent(content, theta_i, phi_i, theta_o, phi_o)
        np.testing.assert_allclose(value, twisted(wi, wo), atol=0.1)
    assert path.stat().st_size == 12 + 24 * 90 * 90 * 360
    assert "not reciprocal" in grid.contents.size


def test_holes_are_counted_and_filled_from_the_entry_before():
    """Here along theta_d; and where no theta_d is left, along theta_h."""
    table = tabulate(OrenNayar(0.5, 0.5).evaluate)
    expected = table.copy()
    table[0, 30, 10:13, 40] = [-1.0, np.nan, 1e9]
    table[2, 30, 0, 41] = np.inf
    table[:, 31, :, 42] = -1.0
    lost = 3 + 1 + int((expected[0, 31, :, 42] >= 0).sum())
    grid = Merl(table)
    assert grid.contents.holes == lost
    assert grid.contents.coverage == pytest.approx(1 - lost / (grid.contents.entries - grid.contents.below))
    np.testing.assert_array_equal(grid.table[:, 30, 10:13, 40], expected[:, 30, [9, 9, 9], 40])
    np.testing.assert_array_equal(grid.table[:, 30, 0, 41], expected[:, 30, 1, 41])
    np.testing.assert_array_equal(grid.table[:, 31, 5, 42], expected[:, 30, 5, 42])
    assert (grid.table >= 0).all()
    assert np.isfinite(grid.table).all()


def test_below_the_horizon_it_is_black(table):
    wi, wo = directions(500, 4)
    assert (table.evaluate(wi * [1, 1, -1], wo) == 0).all()
    assert (table.evaluate(wi, wo * [1, 1, -1]) == 0).all()
    assert table.evaluate([0, 0, 1], wo).shape == (500, 3)
    with pytest.raises(ValueError, match="wi must have length 1"):
        table.evaluate([0, 0, 2], wo)
    with pytest.raises(ValueError, match="a MERL table has the shape"):
        Merl(np.zeros((3, 90, 90, 90)))
