# SPDX-License-Identifier: GPL-3.0-or-later
"""Ward's three forms against Radiance and mpmath; reciprocity, samples, albedo, and how near ``fit`` comes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf, workdps

from vgroove.addon.reference import albedo, rendered, spherical
from vgroove.addon.reference.quadrature import gauss_legendre
from vgroove.addon.reference.ward import HIGHEST, Ward
from vgroove.lab import sidak

from ..chi_square import chi_square, draw, viewer
from .test_anisotropic import facets

TABLE = Path(__file__).parents[1] / "data" / "pyradiance_ward.csv"
KINDS = ("bounded", "ward_1992", "duer_2006")
RENDERED = pytest.mark.parametrize("kind", KINDS[:2])
SLOPES = [(0.02, 0.1), (0.26, 0.05), (0.1, 0.1), (0.5, 0.1), (0.3, 0.6), (1.0, 0.2)]
VIEWS = [0.0, 60.0, 85.0]


@pytest.fixture(scope="module")
def table():
    """wi, wo, and rows of m_x, m_y, rho_d, rho_s, f."""
    lines = [line for line in TABLE.read_text().splitlines() if line and not line.startswith("#")]
    rows = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    wi, wo = (spherical(np.deg2rad(rows[:, k]), np.deg2rad(rows[:, k + 1])) for k in (0, 2))
    return wi, wo, rows[:, 4:]


def relative_errors(table, **changes):
    """Of every row, for ``Ward`` with some numbers changed."""
    found = []
    for light, view, (m_x, m_y, rho_d, rho_s, f) in zip(*table, strict=True):
        model = replace(Ward(rho_d, rho_s, m_x, m_y), **changes)
        found.append(model.evaluate(light, view) / f - 1.0)
    return np.abs(found)


def test_the_bounded_form_agrees_with_radiance(table):
    """At least 200 rows to 88 degrees and 20:1, to 1e-11 relative."""
    assert len(table[0]) >= 200
    # Unit vectors round each slope of a facet by 2e-16 / (n.h), which exp() multiplies by 2 tan / m^2: to 1e-12 here.
    assert relative_errors(table).max() < 1e-11


def test_the_table_sees_what_is_wrong(table):
    """An axis turned by a thousandth, and each of the other forms, in most rows."""
    for changes in ({"azimuth": 1e-3}, {"kind": "ward_1992"}, {"kind": "duer_2006"}):
        assert np.mean(relative_errors(table, **changes).max(axis=-1) > 1e-6) > 0.6, changes


def directions(count=400):
    """wi and wo over the upper hemisphere, (count, 3)."""
    z, phi = np.random.default_rng(1992).random((2, 2, count))
    return (spherical(np.arccos(0.01 + 0.99 * z[k]), 2.0 * np.pi * phi[k]) for k in range(2))


def exact(kind, wi, wo, m_x, m_y):
    """The lobe at 50 digits, as each paper prints it, from H = wi + wo."""
    wi, wo = ([mpf(float(part)) for part in w] for w in (wi, wo))
    x, y, z = (a + b for a, b in zip(wi, wo, strict=True))
    gauss = mp.exp(-((x / m_x) ** 2 + (y / m_y) ** 2) / z**2) / (mp.pi * m_x * m_y)
    if kind == "bounded":
        return gauss * (x * x + y * y + z * z) / z**4
    return gauss / 4 / ((wi[2] * wo[2]) ** (mpf(1) / 2) if kind == "ward_1992" else wi[2] * wo[2])


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("m_x", "m_y"), SLOPES)
def test_each_lobe_is_the_printed_formula(kind, m_x, m_y):
    """Where it is above 1e-30 of its peak; a facet out at t slopes loses 4 t^2 < 280 roundings, and a few more."""
    wi, wo = directions()
    got = Ward(0.0, 1.0, m_x, m_y, kind=kind).lobe(wi, wo)
    with workdps(50):
        expected = np.array([float(exact(kind, i, o, mpf(m_x), mpf(m_y))) for i, o in zip(wi, wo, strict=True)])
    shown = expected > 1e-30 * expected.max()
    assert shown.sum() > 20
    # |wi + wo| may be as short as 0.2 here, which is 10 times the relative rounding of its components.
    np.testing.assert_allclose(got[shown], expected[shown], rtol=3000 * 2.0**-53)
    np.testing.assert_allclose(got[~shown], expected[~shown], atol=1e-29 * expected.max())


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("m_x", "m_y"), SLOPES)
def test_light_and_view_may_be_exchanged(kind, m_x, m_y):
    """f(wi, wo) = f(wo, wi): of all three forms, but for the order of a product."""
    wi, wo = directions()
    model = Ward((0.1, 0.2, 0.3), (0.3, 0.5, 0.7), m_x, m_y, 0.7, kind)
    np.testing.assert_allclose(model.evaluate(wi, wo), model.evaluate(wo, wi), rtol=1e-14, atol=1e-300)


CASES = [(kind, slopes, view) for kind in KINDS[:2] for slopes in SLOPES for view in VIEWS]


@pytest.mark.parametrize("case", CASES, ids=str)
def test_samples_are_distributed_as_pdf_says_and_weigh_the_albedo(case):
    """1e5 draws of the lobe alone by chi-square; their mean weight by a Z-test. Of ``bounded`` none weighs over 1."""
    kind, (m_x, m_y), view = case
    model, wo = Ward(0.0, (0.2, 0.6, 1.0), m_x, m_y, 0.4, kind), viewer(view)
    wi, weight = draw(model, wo, 100_000, 1992, CASES.index(case))
    assert chi_square(model, wo, wi) > sidak.chance(len(CASES))
    assert kind != "bounded" or (weight <= np.array([0.2, 0.6, 1.0]) * (1.0 + 1e-9)).all()
    E = albedo(model, wo)
    spread = weight.std(axis=0) / np.sqrt(len(weight))
    assert (np.abs(weight.mean(axis=0) - E) < sidak.limit(3 * len(CASES)) * spread + 1e-5 * E).all()


@pytest.mark.parametrize("slopes", [(1.06, 1.0), (1.0, 1.06)])
@pytest.mark.parametrize(("m_x", "m_y"), SLOPES)
def test_chi_square_sees_one_slope_wrong(m_x, m_y, slopes):
    """By 6 % in m_x or in m_y alone, at 45 degrees."""
    model, wo = Ward(0.0, 1.0, m_x, m_y, 0.4), viewer(45.0)
    wrong = replace(model, m_x=m_x * slopes[0], m_y=m_y * slopes[1])
    wi, _ = draw(wrong, wo, 200_000, 3)
    assert chi_square(model, wo, wi) < sidak.chance(len(CASES))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("degrees", [0.0, 50.0, 80.0])
def test_the_albedo_is_the_integral_of_f_cos(kind, degrees):
    """By a quadrature over directions, which knows nothing of facets: 300 by 360 nodes, to 1e-6."""
    model, wo = Ward(0.0, 1.0, 0.5, 0.25, 0.3, kind), spherical(np.radians(degrees), 0.9)
    x, weight = gauss_legendre(300)
    theta, phi = x * np.pi / 2, (np.arange(360) + 0.5) * np.pi / 180
    wi = spherical(theta[:, None], phi)
    f_cos = model.lobe(wi, wo) * wi[..., 2]
    found = np.sum(f_cos * (weight * np.sin(theta) * np.pi / 2 * np.pi / 180)[:, None])
    assert albedo(model, wo)[0] == pytest.approx(found, rel=1e-6)


ALL = [(m, ratio) for m in (0.003, 0.02, 0.1, 0.2, 0.3, 0.35, 0.4, 0.6, 1.0, 3.0, 10.0) for ratio in (1.0, 3.0, 10.0)]


@RENDERED
def test_no_more_light_leaves_than_the_model_says(kind):
    """A white lobe at every slope and ratio that a preset may have, along and across the tangent, to 89.5 degrees."""
    views = np.concatenate([spherical(np.radians([0.0, 60.0, 80.0, 86.0, 89.5]), azimuth) for azimuth in (0.0, 1.57)])
    most = max(albedo(Ward(0.0, 1.0, m * r**0.5, m / r**0.5, kind=kind), views).max() for m, r in ALL)
    assert HIGHEST[kind] - 0.02 < most <= HIGHEST[kind]


def test_duers_form_of_2006_sends_back_more_than_arrives():
    """Twice as much at 89 degrees with slopes of 0.1, five times with 0.6: why no preset has it."""
    for m, expected in ((0.1, 2.096), (0.6, 5.226)):
        got = albedo(Ward(0.0, 1.0, m, m, kind="duer_2006"), spherical(np.radians(89.0)))[0]
        assert got == pytest.approx(expected, abs=1e-3)


def test_bad_numbers_are_refused():
    """Colours that add up to more than 1, and slopes that are not above 0."""
    with pytest.raises(ValueError, match=r"albedo \+ specular must be at most 1, got 1.1"):
        Ward((0.0, 0.5, 0.0), (0.9, 0.6, 0.9), 0.1, 0.2)
    with pytest.raises(ValueError, match="m_y must be greater than 0, got 0"):
        Ward(0.5, 0.2, 0.1, 0.0)


# --- fit ------------------------------------------------------------------------------------------------------------


def distance(kind, wide, ratio, degrees, azimuth, gain=1.0):
    """L1 of f cos of the lobe alone from what ``fit`` renders, as a share, and the albedo of that."""
    model = Ward(0.0, 1.0, wide, wide / ratio, kind=kind)
    wi, wo, solid_angle = facets(wide, wide / ratio, degrees, azimuth)
    fitted, f_cos = (f(wi, wo)[:, 0] * wi[:, 2] for f in (rendered(model, "fit"), model.evaluate))
    return np.abs(gain * fitted - f_cos) @ solid_angle / (f_cos @ solid_angle), fitted @ solid_angle


@pytest.mark.parametrize("wide", [0.02, 0.1, 0.2, 0.3, 0.45, 0.6])
@pytest.mark.parametrize("ratio", [1.0, 2.0, 5.0, 10.0])
def test_fit_is_near_the_bounded_form(wide, ratio):
    """L1 at most 5 % to 75 degrees and 9 % at 85, at every azimuth; a furnace sends back at most what arrives."""
    for degrees in (1.0, 20.0, 40.0, 60.0, 70.0, 75.0, 85.0):
        for azimuth in (0.0, 22.5, 45.0, 67.5, 90.0):
            l1, fitted = distance("bounded", wide, ratio, degrees, azimuth)
            assert l1 <= (0.05 if degrees <= 75.0 else 0.09), (degrees, azimuth, l1)
            assert fitted <= 1.0002, (degrees, azimuth, fitted)  # the grid blurs narrow lobes by 1e-4, as the model's


@pytest.mark.parametrize(("wide", "bar"), [(0.1, 0.05), (0.3, 0.07), (0.45, 0.07), (0.6, 0.11)])
@pytest.mark.parametrize("ratio", [1.0, 5.0])
def test_fit_is_near_the_form_of_1992(wide, bar, ratio):
    """L1 to 75 degrees, at every azimuth."""
    for degrees in (1.0, 30.0, 60.0, 75.0):
        for azimuth in (0.0, 45.0, 90.0):
            l1, _ = distance("ward_1992", wide, ratio, degrees, azimuth)
            assert l1 <= bar, (degrees, azimuth, l1)


def test_the_distance_sees_an_error():
    """Of 5 % in brightness."""
    assert distance("bounded", 0.3, 2.0, 40.0, 30.0, gain=1.05)[0] > 0.05
