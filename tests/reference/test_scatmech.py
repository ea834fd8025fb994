# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance against NIST SCATMECH, an independent program; the table's header says which version and how."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from vgroove.addon.reference import Anisotropic, Conductor, CookTorrance, spherical, vgroove_g

TABLE = Path(__file__).parents[1] / "data" / "scatmech.csv"
COLUMNS = ["theta_i_deg", "theta_o_deg", "phi_deg", "m", "n", "k", "f"]


@pytest.fixture(scope="module")
def table():
    """The rows by column name."""
    lines = [line for line in TABLE.read_text().splitlines() if line and not line.startswith("#")]
    assert lines[0].split(",") == COLUMNS
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    return dict(zip(COLUMNS, rows.T, strict=True))


def directions(table):
    """wi in the plane of x and z, wo at the azimuth given."""
    wi = spherical(np.deg2rad(table["theta_i_deg"]))
    return wi, spherical(np.deg2rad(table["theta_o_deg"]), np.deg2rad(table["phi_deg"]))


def test_table_covers_lobes_angles_and_materials(table):
    """At least 200 rows: narrow and wide lobes, to grazing, dielectrics and metals, G cut on both sides and not."""
    assert table["f"].size >= 200
    assert table["f"].min() > 0
    assert np.unique(table["m"]).size >= 5
    assert table["m"].min() <= 0.02
    assert table["m"].max() >= 1.0
    assert table["theta_i_deg"].max() > 85
    assert (table["k"] == 0).sum() > 50
    assert (table["k"] > 1).sum() > 50
    G = vgroove_g(*directions(table))
    assert G.shape == table["f"].shape
    assert (G == 1).sum() > 50
    assert ((G < 1) & (table["theta_i_deg"] > table["theta_o_deg"])).sum() > 20
    assert ((G < 1) & (table["theta_i_deg"] < table["theta_o_deg"])).sum() > 20


def test_cook_torrance_agrees_with_scatmech(table):
    """Every row, with D, G, F and the 1/4 in place of the 1/pi of 1982, to 1e-11 relative."""
    wi, wo = directions(table)
    got = np.array(
        [
            CookTorrance(m, Conductor(n, k)).evaluate(light, view)
            for light, view, m, n, k in zip(wi, wo, table["m"], table["n"], table["k"], strict=True)
        ]
    )
    assert got.shape == (table["f"].size, 3)
    # Unit vectors from these decimals lose up to 1e-12 (header), SCATMECH's own digits 3e-13.
    np.testing.assert_allclose(got, np.repeat(table["f"][:, None], 3, axis=1), rtol=1e-11, atol=0)


def test_cook_torrance_takes_the_whole_table_at_once(table):
    """m and the index as arrays give what one row at a time gives."""
    wi, wo = directions(table)
    n, k = (np.repeat(table[name][:, None], 3, axis=1) for name in ("n", "k"))
    got = CookTorrance(table["m"], Conductor(n, k)).evaluate(wi, wo)
    assert got.shape == (table["f"].size, 3)
    np.testing.assert_allclose(got[:, 0], table["f"], rtol=1e-11, atol=0)


# --- anisotropic: all but D by SCATMECH, D by mpmath ------------------------------------------------------------------

ANISOTROPIC = TABLE.with_name("scatmech_anisotropic.csv")


@pytest.fixture(scope="module")
def anisotropic_table():
    """wi, wo, and rows of m_x, m_y, n, k, f."""
    lines = [line for line in ANISOTROPIC.read_text().splitlines() if line and not line.startswith("#")]
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    wi, wo = (spherical(np.deg2rad(rows[:, k]), np.deg2rad(rows[:, k + 1])) for k in (0, 2))
    return wi, wo, rows[:, 4:]


def relative_errors(table, **changes):
    """Of every row, for ``Anisotropic`` with some numbers changed."""
    found = []
    for light, view, (m_x, m_y, n, k, f) in zip(*table, strict=True):
        model = Anisotropic(m_x, m_y, Conductor(n, k))
        found.append(replace(model, **changes).evaluate(light, view) / f - 1.0)
    return np.abs(found)


def test_anisotropic_cook_torrance_agrees_with_scatmech(anisotropic_table):
    """At least 200 rows of slopes to 33:1 at eight azimuths, to 1e-11 relative."""
    assert len(anisotropic_table[0]) >= 200
    # A facet out at t slopes loses t^2 times the 1e-15 of its slope to exp(): t^2 is at most ln(1e30) = 69 here.
    assert relative_errors(anisotropic_table).max() < 1e-11


def test_the_table_sees_an_axis_turned_by_a_thousandth(anisotropic_table):
    """An azimuth off by 1e-3 is seen in most rows; the isotropic ones do not mind."""
    off = relative_errors(anisotropic_table, azimuth=1e-3).max(axis=-1)
    assert np.mean(off > 1e-6) > 0.6
