# SPDX-License-Identifier: GPL-3.0-or-later
"""ASTM E1392: scattered pairs of directions as text, and the CSV that we write."""

import numpy as np
import pytest

from vgroove.addon.library.files import FileError
from vgroove.addon.measured import read, write_csv
from vgroove.addon.measured.spectrum import FROM_XYZ
from vgroove.addon.reference import CookTorrance, OrenNayar, Schlick, spherical

from .makers import astm_text, directions

COPPER = CookTorrance(0.4, Schlick([0.95, 0.64, 0.54]))


@pytest.fixture
def made(tmp_path):
    def make(text, name="made.astm"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    return make


@pytest.mark.parametrize("degrees", [False, True])
@pytest.mark.parametrize("phi_i", [(0.0,), (2.0,), (0.0, 1.0, 2.5)])
def test_a_pair_that_was_measured_has_its_own_value(made, degrees, phi_i):
    """A point of weight 1e10 outweighs three at 0.01 or more (float32 angles: 1e-7 of a value, times its steepness)."""
    found = read(made(astm_text(COPPER.evaluate, degrees=degrees, phi_i=phi_i)))
    assert found.contents.isotropic == (len(phi_i) == 1)
    wi, wo = spherical(np.radians(30.0), phi_i[-1]), spherical(np.radians([0.0, 45.0, 75.0]), [0.0, np.pi, np.pi / 3])
    np.testing.assert_allclose(found.evaluate(wi, wo), COPPER.evaluate(wi, wo), rtol=1e-5)


def test_an_isotropic_surface_may_be_turned_and_mirrored(made):
    found = read(made(astm_text(COPPER.evaluate)))
    wi, wo = directions(200, 1)
    f, turn = found.evaluate(wi, wo), np.array([[0.6, 0.8, 0], [-0.8, 0.6, 0], [0, 0, 1]])
    np.testing.assert_allclose(found.evaluate(wi @ turn, wo @ turn), f, rtol=1e-9)
    np.testing.assert_allclose(found.evaluate(wi * [1, -1, 1], wo * [1, -1, 1]), f, rtol=1e-9)


def test_between_pairs_it_lies_between_their_values(made):
    """A smooth surface is met within the range that it has over a step: Oren-Nayar's 15 degrees."""
    clay = OrenNayar([0.6, 0.3, 0.1], 0.5)
    found = read(made(astm_text(clay.evaluate)))
    wi, wo = directions(1000, 2)
    up = (wi[:, 2] > 0.3) & (wo[:, 2] > 0.3)
    f, expected = found.evaluate(wi, wo)[up], clay.evaluate(wi, wo)[up]
    assert np.abs(f - expected).sum() < 0.05 * expected.sum()
    assert (f.max(axis=0) <= found.rgb.max(axis=0)).all()


@pytest.mark.parametrize(
    ("columns", "expected"),
    [
        ("R,G,B", [0.5, 0.25, 0.125]),
        ("X,Y,Z", np.array([0.25, 0.25, 0.25]) @ FROM_XYZ.T),
        ("BRDF", [0.5, 0.5, 0.5]),
        ("400nm,550nm,700nm", None),
    ],
)
def test_columns_may_be_rgb_xyz_grey_or_wavelengths(made, columns, expected):
    """Of one value, each; 500 to 600 nm are green."""
    values = {"400nm,550nm,700nm": [0.0, 1.0, 0.0], "X,Y,Z": [0.25] * 3}.get(columns, [0.5, 0.25, 0.125])
    values = values[: columns.count(",") + 1]
    found = read(made(astm_text(lambda wi, _: np.broadcast_to(values, (len(wi), len(values))), columns=columns)))
    f = found.evaluate([0, 0, 1], [0, 0, 1])
    if expected is None:
        assert f[1] > 0.5
        assert f[1] > 2 * f[2]
    else:
        np.testing.assert_allclose(f, np.array(expected), rtol=1e-6)


def test_pairs_without_a_reflectance_are_left_out_and_counted(made):
    lines = ["0,0,0,0,0.5", "0,0,0.5,0,-1", "0,0,0.6,0,nan", "0,0,1.58,0,0.5", "-0.2,0,0.7,0,0.25"]
    found = read(made("VARS theta_i,phi_i,theta_s,phi_s,BRDF\n" + "\n".join(lines) + "\n"))
    assert (found.contents.entries, found.contents.holes, found.contents.below) == (5, 2, 1)
    assert found.contents.coverage == 0.5
    np.testing.assert_allclose(found.evaluate([0, 0, 1], spherical(0.5)), 0.4, atol=0.11)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("NUM_POINTS 2\n0,0,0,0,1\n", 'has no line "VARS theta_i'),
        ("VARS theta_i,phi_i,theta_s,R,G,B\n0,0,0,1,1,1\n", "VARS names no phi_s"),
        ("VARS theta_i,phi_i,theta_s,phi_s,R,B\n0,0,0,0,1,1\n", "VARS must name R,G,B or"),
        ("VARS theta_i,phi_i,theta_s,phi_s,B\n0,0,0,0,1\n0,0,0,0\n", 'line 3 must be 5 numbers.*; got "0 0 0 0"'),
        ("VARS theta_i,phi_i,theta_s,phi_s,B\n0,0,zero,0,1\n", "line 2 must be 5 numbers"),
        ("VARS theta_i,phi_i,theta_s,phi_s,B\n0,0,nan,0,1\n", "line 2 must be 5 numbers"),
        ("NUM_POINTS 3\nVARS theta_i,phi_i,theta_s,phi_s,B\n0,0,0,0,1\n", "NUM_POINTS says 3, but 1 lines"),
        ("VARS theta_i,phi_i,theta_s,phi_s,B\n0,0,0,0,-1\n", "holds no reflectance"),
        ("VARS theta_i,phi_i,theta_s,phi_s,B\n", "holds no reflectance"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(made, text, message):
    with pytest.raises(FileError, match=f"made.astm: {message}"):
        read(made(text))


def test_a_csv_holds_f_in_degrees_and_can_be_read(made, tmp_path):
    """9 digits of each number."""
    table = read(made(astm_text(COPPER.evaluate)))
    path = tmp_path / "out.csv"
    write_csv(path, table, 30.0)
    lines = path.read_text(encoding="utf-8").splitlines()
    assert lines[0] == "theta_i,phi_i,theta_o,phi_o,R,G,B"
    rows = np.array([line.split(",") for line in lines[1:]], np.float64)
    assert rows.shape == (3 * 3 * 12, 7)
    angles = np.radians(rows[:, :4])
    expected = table.evaluate(spherical(angles[:, 0], angles[:, 1]), spherical(angles[:, 2], angles[:, 3]))
    np.testing.assert_allclose(rows[:, 4:], expected, rtol=1e-8)
    wi, wo = spherical(np.radians(30.0)), spherical(np.radians(60.0), np.radians(60.0))
    np.testing.assert_allclose(read(path).evaluate(wi, wo), table.evaluate(wi, wo), rtol=1e-5)
