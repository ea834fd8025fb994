# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin & Shirley's model against Radiance and mpmath, its albedo, sampling, and how near ``fit`` comes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf, workdps

from vgroove.addon.reference import albedo, rendered, spherical
from vgroove.addon.reference.ashikhmin_shirley import AshikhminShirley, entering
from vgroove.addon.reference.ashikhmin_shirley_fit import LAMBERT, toon
from vgroove.addon.reference.directions import reflect
from vgroove.addon.reference.quadrature import diffuse_albedo
from vgroove.lab import sidak

from ..chi_square import chi_square, draw, viewer

TABLE = Path(__file__).parents[1] / "data" / "radiance_ashikhmin.csv"
COLOR, RD = (0.04, 0.5, 1.0), (0.9, 0.4, 0.1)
EXPONENTS = [(1.0, 1.0), (10.0, 10.0), (5.0, 500.0), (300.0, 20.0), (1e4, 1e2), (1e5, 1e5)]
BOTH = pytest.mark.parametrize(("n_u", "n_v"), EXPONENTS)
VIEWS = spherical(np.radians([0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.5]), 0.7)


def directions(count=400):
    """wi and wo over the upper hemisphere, (count, 3)."""
    z, phi = np.random.default_rng(2000).random((2, 2, count))
    return (spherical(np.arccos(0.01 + 0.99 * z[k]), 2.0 * np.pi * phi[k]) for k in range(2))


def relative_errors(**changes):
    """Of each row of Radiance's table, for the model with some numbers changed."""
    lines = [line for line in TABLE.read_text().splitlines() if line and not line.startswith("#")]
    found = []
    for line in lines[1:]:
        *w, n_u, n_v, f0, f = map(float, line.split(","))
        model = replace(AshikhminShirley(0.0, f0, n_u, n_v), **changes)
        found.append(abs(model.evaluate(w[:3], w[3:])[0] / f - 1.0))
    return np.array(found)


def test_the_highlight_agrees_with_radiance():
    """At least 200 rows, exponents from 1 to 8000 and to 100:1, every azimuth, to grazing: to 1e-11 relative."""
    errors = relative_errors()
    assert errors.size >= 200
    # A facet that leans by t = 0.02 or more costs Radiance n t^2/2 of 1e-16 / t^2, and each side 1e-16 n t^2/2.
    assert errors.max() < 1e-11


def test_the_table_sees_small_errors():
    """An exponent off by 1e-6, and a tangent off by 1e-6."""
    assert np.mean(relative_errors(n_u=1.000001) > 1e-9) > 0.5
    assert np.mean(relative_errors(azimuth=1e-6) > 1e-9) > 0.5


@BOTH
def test_near_the_normal_the_power_keeps_its_digits(n_u, n_v):
    """At 50 digits by the printed formula, down to facets that lean by 1e-9: within 1e-12."""
    model = AshikhminShirley(0.0, 1.0, n_u, n_v)
    for lean, phi in ((1e-9, 0.3), (1e-7, 1.2), (1e-4, 2.0), (0.003, 4.0)):
        h = spherical(lean, phi)
        with workdps(50):
            x, y, z = (mpf(float(part)) for part in h)
            x, y, z = (part / mp.sqrt(x * x + y * y + z * z) for part in (x, y, z))
            power = z ** ((n_u * x * x + n_v * y * y) / (1 - z * z))
            expected = float(mp.sqrt((mpf(n_u) + 1) * (mpf(n_v) + 1)) / (2 * mp.pi) * power)
        assert model.density(h) == pytest.approx(expected, rel=1e-12, abs=1e-280)
    assert model.density(np.array([0.0, 0.0, 1.0])) == pytest.approx(((n_u + 1) * (n_v + 1)) ** 0.5 / (2 * np.pi))


@BOTH
def test_light_and_view_may_be_exchanged(n_u, n_v):
    """f(wi, wo) = f(wo, wi)."""
    wi, wo = directions()
    model = AshikhminShirley(RD, COLOR, n_u, n_v, 0.7)
    np.testing.assert_allclose(model.evaluate(wi, wo), model.evaluate(wo, wi), rtol=1e-13, atol=1e-300)


@BOTH
def test_the_tangent_turns_the_model(n_u, n_v):
    """By a right angle as both exponents exchanged; with light and view, as if not."""
    wi, wo = directions()
    model = AshikhminShirley(RD, COLOR, n_u, n_v)
    # The right angle is rounded by 6e-17, times n tan of up to 1e7.
    f, exchanged = (
        of.evaluate(wi, wo) for of in (replace(model, azimuth=np.pi / 2), AshikhminShirley(RD, COLOR, n_v, n_u))
    )
    np.testing.assert_allclose(f, exchanged, rtol=1e-8, atol=1e-12 * f.max())


SCALED = {"amplitude": (0.1, 0.6, 0.5), "over_lambert": True}  # over RD


@BOTH
def test_over_lambert_the_highlight_is_scaled(n_u, n_v):
    """f = amplitude f_s + Rd/pi, f_s the paper's; reciprocal; as much light by the albedo's quadrature."""
    wi, wo = directions()
    paper, scaled = AshikhminShirley(0.0, COLOR, n_u, n_v, 0.7), AshikhminShirley(RD, COLOR, n_u, n_v, 0.7, **SCALED)
    expected = np.array(SCALED["amplitude"]) * paper.evaluate(wi, wo) + np.array(RD) / np.pi
    np.testing.assert_allclose(scaled.evaluate(wi, wo), expected, rtol=1e-14)
    np.testing.assert_allclose(scaled.evaluate(wo, wi), expected, rtol=1e-13)
    found = np.array(SCALED["amplitude"]) * albedo(paper, VIEWS) + np.array(RD)
    np.testing.assert_allclose(albedo(scaled, VIEWS), found, rtol=1e-14)
    assert found.max() <= 1.0


@pytest.mark.parametrize("f0", [0.0, 0.05, 0.5, 1.0])
def test_no_view_gets_more_light_than_arrives(f0):
    """With a white diffuse part, to 89.5 degrees, exponents 0 to 1e5, ratios to 1000:1."""
    for n_u, n_v in (*EXPONENTS, (0.0, 0.0), (1e5, 1e3), (0.0, 1e3)):
        for azimuth in (0.0, 0.8, np.pi / 2):
            assert albedo(AshikhminShirley(1.0, f0, n_u, n_v, azimuth), VIEWS).max() <= 1.0 + 1e-9


def test_the_diffuse_part_is_normalised():
    """2 times the integral of c a(c) is 23/28, so that all light that enters leaves; by the generic quadrature too."""
    with workdps(30):
        whole = mp.quad(lambda c: 2 * c * (1 - (1 - c / 2) ** 5), [0, 1])
        assert abs(whole - mpf(23) / 28) < mpf("1e-25")
    of = AshikhminShirley(RD, 0.0, 0.0, 0.0)
    flat = replace(of, albedo=0.0)
    below = albedo(of, VIEWS) - albedo(flat, VIEWS)
    np.testing.assert_allclose(below, entering(VIEWS)[:, None] * RD, rtol=1e-12)
    found = diffuse_albedo(VIEWS, lambda wi, wo: of.evaluate(wi, wo) - flat.evaluate(wi, wo))
    np.testing.assert_allclose(found, below, rtol=1e-9)


@pytest.mark.parametrize(("n_u", "n_v"), [(10.0, 10.0), (2.0, 40.0), (0.0, 0.0)])
def test_the_albedo_is_the_integral_of_f_cos(n_u, n_v):
    """By 300 x 300 even cells of (cos theta, phi), which resolve such lobes to 2e-3."""
    z, phi = (np.arange(300) + 0.5) / 300, (np.arange(300) + 0.5) / 300 * 2.0 * np.pi
    wi = spherical(np.arccos(z)[:, None], phi)
    model = AshikhminShirley(RD, COLOR, n_u, n_v, 0.3)
    for wo in VIEWS[:6]:
        whole = np.sum(model.evaluate(wi, wo) * z[:, None, None], axis=(0, 1)) * 2.0 * np.pi / 300**2
        np.testing.assert_allclose(albedo(model, wo), whole, rtol=2e-3)


@pytest.mark.parametrize(("n_u", "n_v"), [*EXPONENTS, (1e5, 1e3)])
def test_the_quadrature_is_converged(n_u, n_v):
    """40 nodes a panel in place of 12: to 1e-5."""
    model = AshikhminShirley(0.0, COLOR, n_u, n_v, 0.3)
    np.testing.assert_allclose(model.moment(VIEWS), model.moment(VIEWS, nodes=40), rtol=1e-5)


CASES = [(n, view) for n in [*EXPONENTS, (0.0, 0.0)] for view in (0.0, 60.0, 85.0)]


@pytest.mark.parametrize("case", CASES, ids=str)
def test_samples_are_distributed_as_pdf_says(case):
    """Of the highlight, 1e5 draws; its weight is F min(1, (n.l)/(n.v)) <= 1, and its mean the albedo."""
    (n_u, n_v), view = case
    model, wo = AshikhminShirley(0.0, COLOR, n_u, n_v, 0.4), viewer(view)
    wi, weight = draw(model, wo, 100_000, 2000, CASES.index(case))
    assert chi_square(model, wo, wi) > sidak.chance(len(CASES))
    assert weight.max() <= 1.0 + 1e-9
    E, spread = albedo(model, wo), weight.std(axis=0) / np.sqrt(len(weight))
    assert (np.abs(weight.mean(axis=0) - E) < sidak.limit(3 * len(CASES)) * spread + 1e-5 * E).all()


@pytest.mark.parametrize("factor", [(1.12, 1.0), (1.0, 1.12)])
@pytest.mark.parametrize(("n_u", "n_v"), [(10.0, 10.0), (5.0, 500.0)])
def test_chi_square_sees_one_exponent_wrong(n_u, n_v, factor):
    """By 12 %, which is 6 % of a slope, at 45 degrees."""
    model, wo = AshikhminShirley(0.0, COLOR, n_u, n_v, 0.4), viewer(45.0)
    wrong = AshikhminShirley(0.0, COLOR, n_u * factor[0], n_v * factor[1], 0.4)
    wi, _ = draw(wrong, wo, 200_000, 3)
    assert chi_square(model, wo, wi) < sidak.chance(len(CASES))


def test_bad_numbers_are_refused():
    """Colours beyond white, exponents below 0."""
    with pytest.raises(ValueError, match=r"specular must be between 0 and 1, got 1\.5"):
        AshikhminShirley(0.5, 1.5, 10.0, 10.0)
    with pytest.raises(ValueError, match="exponents must be between 0 and 100000000, got -1"):
        AshikhminShirley(0.5, 0.5, 10.0, -1.0)
    with pytest.raises(ValueError, match=r"albedo \+ amplitude must be at most 1, got 1\.1"):
        AshikhminShirley(0.5, 0.5, 10.0, 10.0, amplitude=0.6, over_lambert=True)


# --- Cycles' closures -------------------------------------------------------------------------------------------------


def l1(model, degrees, azimuth=0.0, estimator="fit", nodes=48):
    """Integral of |f_estimator - f| cos over that of f cos in per cent, (3,), over facets to exp(-16) of the lobe."""
    wo = spherical(np.radians(degrees), np.radians(azimuth))
    x, weight = np.polynomial.legendre.leggauss(nodes)
    u, v = 0.5 * (x + 1.0), (np.arange(2 * nodes) + 0.5) / (2 * nodes)
    area = (16.0 * weight * u * np.exp(-16.0 * u**2))[:, None] / (2 * nodes)
    h = model.facet(np.stack(np.broadcast_arrays(-np.expm1(-16.0 * u**2)[:, None], v), axis=-1))
    vh = h @ wo
    wi = reflect(np.broadcast_to(wo, h.shape), h)
    lit = (vh > 1e-9) & (wi[..., 2] > 1e-9)
    wi, solid_angle = wi[lit], (area * 4.0 * vh / model.density(h))[lit]
    f, shown = (of(wi, wo) * wi[:, 2:] for of in (model.evaluate, rendered(model, estimator)))
    return 100.0 * solid_angle @ np.abs(shown - f) / (solid_angle @ f)


ROUGH = [(10.0, 9.0, 17.5), (30.0, 7.0, 11.0), (60.0, 5.0, 9.0), (300.0, 5.0, 11.0), (1e4, 5.0, 11.0)]


@pytest.mark.parametrize(("n", "bar", "grazing"), ROUGH)
def test_fit_is_as_near_as_its_file_says(n, bar, grazing):
    """nodegroups/ashikhmin_shirley_fit.py: the highlight alone, of Rs = 0.04 and brighter, to 75 degrees and at 85."""
    for f0 in (0.04, 0.3, 0.9):
        model = AshikhminShirley(0.0, f0, n, n)
        assert max(l1(model, degrees)[0] for degrees in (0.0, 30.0, 45.0, 60.0, 70.0, 75.0)) <= bar
        assert l1(model, 85.0)[0] <= grazing


@pytest.mark.parametrize(("n_u", "n_v"), [(60.0, 300.0), (60.0, 1500.0), (1000.0, 100.0)])
def test_fit_is_as_near_at_every_azimuth(n_u, n_v):
    """Ratios of exponents to 25:1, which is 5:1 of slopes."""
    for azimuth in (0.0, 30.0, 60.0, 90.0):
        model = AshikhminShirley(0.0, 0.04, n_u, n_v)
        assert max(l1(model, degrees, azimuth)[0] for degrees in (0.0, 45.0, 60.0, 75.0)) <= 5.5
        assert l1(model, 85.0, azimuth)[0] <= 12.0


def test_fit_of_a_colored_metal_is_near_in_each_channel():
    """Gold's color: 5.3 % to 75 degrees for n from 100 on."""
    for n in (100.0, 1000.0):
        model = AshikhminShirley(0.0, (1.0, 0.77, 0.34), n, n)
        assert max(l1(model, degrees).max() for degrees in (0.0, 30.0, 45.0, 60.0, 75.0)) <= 5.3


def test_fit_of_a_coloured_amplitude_is_near_in_each_channel():
    """The dimmest channel as ever; what the others have more has the mean of F, which is ``closure``'s error."""
    for amplitude, bar in (((0.0366, 0.0277, 0.0244), 5.5), ((0.108, 0.0733, 0.0559), 8.0)):
        model = AshikhminShirley(0.0, 0.0949, 300.0, 300.0, amplitude=amplitude, over_lambert=True)
        found = np.array([l1(model, degrees) for degrees in (0.0, 45.0, 75.0)])
        assert found.max() <= bar
        even = l1(replace(model, amplitude=amplitude[2]), 75.0)
        np.testing.assert_allclose(found[-1, 2], even[2], rtol=1e-12)


def test_the_distance_tells_closure_from_fit():
    """Whose highlight has no more than the mean of F: exact where F is flat, beyond the bar at 75 degrees."""
    model = AshikhminShirley(0.0, 0.04, 300.0, 300.0)
    assert l1(replace(model, specular=1.0), 75.0, estimator="closure")[0] < 1e-9
    assert l1(model, 75.0, estimator="closure")[0] > 20.0


@pytest.mark.parametrize("estimator", ["fit", "closure"])
@pytest.mark.parametrize("n", [3.0, 100.0])
def test_closures_send_back_no_more_than_arrives(estimator, n):
    """White above white, by even cells of (cos theta, phi), whose own error stands in the bar; to 85 degrees."""
    z, phi = (np.arange(300) + 0.5) / 300, (np.arange(600) + 0.5) / 600 * 2.0 * np.pi
    wi = spherical(np.arccos(z)[:, None], phi)
    for f0 in (0.0, 0.04, 1.0):
        model = AshikhminShirley(1.0, f0, n, n)
        for wo in spherical(np.radians([0.0, 45.0, 75.0, 85.0])):
            whole = np.sum(rendered(model, estimator)(wi, wo)[..., 0] * z[:, None]) * 2.0 * np.pi / (300 * 600)
            assert whole <= 1.0 + 2e-3


def test_lambert_and_toon_make_the_diffuse_part():
    """L1 of c a(c), scaled, from their mixture: 2.2 %, where Lambert alone is off by 15.5; the albedo is kept."""
    x, weight = np.polynomial.legendre.leggauss(400)
    z, weight = 0.5 * (x + 1.0), np.pi * weight
    exact = z * entering(np.stack([0 * z, 0 * z, z], axis=-1)) * 28.0 / 23.0 / np.pi
    mixture = LAMBERT * z / np.pi + (1.0 - LAMBERT) * toon(z)
    assert weight @ mixture == pytest.approx(1.0, abs=1e-4)
    assert weight @ np.abs(mixture - exact) == pytest.approx(0.022, abs=1e-3)
    assert weight @ np.abs(z / np.pi - exact) == pytest.approx(0.155, abs=1e-3)
