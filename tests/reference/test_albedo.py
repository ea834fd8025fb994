# SPDX-License-Identifier: GPL-3.0-or-later
"""Directional albedo is good to 1e-6: against more nodes, against other integrals, against Monte Carlo."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate, special

from vgroove.addon.reference import (
    Conductor,
    CookTorrance,
    Dielectric,
    Lambert,
    OrenNayar,
    Schlick,
    Smooth,
    Sum,
    albedo,
    beckmann_d,
    spherical,
)
from vgroove.addon.reference.quadrature import diffuse_albedo, gauss_legendre, panels, vgroove_albedo
from vgroove.lab import sidak

PROMISED = 1e-6  # what albedo's docstring says

# Three media at once as three channels. Smooth ones; with a critical angle; next to index 1; metals; nearly critical.
FRESNELS = {
    "schlick": Schlick((0.02, 0.54, 1.0)),
    "dielectric": Dielectric((1.5, 0.5, 10.0)),
    "weak": Dielectric((1 + 1e-9, 0.999, 1.001)),
    "metal": Conductor((0.2, 0.05, 3.0), (3.9, 20.0, 3.0)),
    "absorbing": Conductor(0.5, 1e-3),
}


@pytest.mark.parametrize("m", [0.02, 0.1, 0.3, 0.6, 1.0, 3.0, 10.0])
def test_beckmann_facets_project_to_unit_area(m):
    """All facets together cast the area of the flat surface below them."""
    # The integrand's scales in tan(theta) are m and 1; beyond 7 m lies exp(-49) = 5e-22 of the area.
    slopes = np.concatenate([m * np.linspace(0, 7, 15), np.geomspace(0.01, 100, 30)])
    theta, weight = panels(np.arctan(np.unique(slopes[slopes <= 7 * m])), 16)
    D = beckmann_d(spherical(theta), m)
    assert D.shape == theta.shape == weight.shape
    area = 2 * np.pi * np.sum(weight * D * np.cos(theta) * np.sin(theta))
    # 16 and 32 nodes a panel agree to 2e-15 (8 and 16 to 3e-9): what is left is rounding.
    assert area == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("nodes", [8, 16, 40])
def test_panels_integrate_what_ends_in_a_square_root(nodes):
    """The substitution 3 s^2 - 2 s^3 flattens square roots at both ends of a panel; weights add up to its width."""
    x, weight = gauss_legendre(nodes)
    assert x.shape == weight.shape == (nodes,)
    assert weight.sum() == pytest.approx(1.0, rel=1e-14)
    # sqrt(x (1 - x)) becomes smooth but for s^3: Gauss-Legendre then falls like nodes^-8 and better.
    assert np.sum(weight * np.sqrt(x * (1 - x))) == pytest.approx(np.pi / 8, rel=1e-6 if nodes < 16 else 1e-9)
    points, widths = panels(np.array([[0.0, 1.0, 1.0, 3.0], [0.0, 0.0, 2.0, 5.0]]), nodes)
    assert points.shape == widths.shape == (2, 3 * nodes)
    np.testing.assert_allclose(np.sum(widths * points**2, axis=-1), [9.0, 125 / 3], rtol=1e-13)


@pytest.mark.parametrize(("m", "degrees"), [(1e-3, 45.0), (0.1, 89.9), (0.5, 85.0), (3.0, 0.0), (3.0, 30.0)])
@pytest.mark.parametrize("fresnel", FRESNELS.values(), ids=FRESNELS)
def test_cook_torrance_albedo_is_converged(fresnel, m, degrees):
    """40 nodes on each panel in place of 16 change nothing above 1e-6."""
    wo = spherical(np.deg2rad(degrees), 0.7)
    got, finer = albedo(CookTorrance(m, fresnel), wo), vgroove_albedo(wo, m, fresnel, nodes=40)
    assert got.shape == finer.shape == (3,)
    assert (got > 0).all()
    np.testing.assert_allclose(got, finer, rtol=0.5 * PROMISED, atol=0)


def over_the_hemisphere(function, theta_edges, phi_edges):
    """Twice the integral of ``function(wi) cos`` over half the hemisphere, by SciPy's adaptive rule.

    Each box between the edges is integrated on its own to 1e-8 of 1. The code under test integrates over facet slopes.
    """

    def integrand(points):
        wi = spherical(points[:, 0], points[:, 1])
        return function(wi) * (np.cos(points[:, 0]) * np.sin(points[:, 0]))[:, None]

    total = 0.0
    for low, high in pairwise(theta_edges):
        for left, right in pairwise(phi_edges):
            found = integrate.cubature(
                integrand, [low, left], [high, right], rtol=1e-7, atol=1e-8, max_subdivisions=3000
            )
            assert found.status == "converged"
            total = total + 2 * found.estimate
    return total


DIRECT = [FRESNELS["schlick"], Dielectric((1.333, 1.5, 10.0)), FRESNELS["metal"]]
DIRECT_CASES = [(fresnel, m, degrees) for fresnel in DIRECT for m in (0.3, 1.0) for degrees in (30.0, 80.0)]


# With a critical angle (eta = 0.5) SciPy takes up to half a minute; these two cases it does in a second.
@pytest.mark.parametrize(
    ("fresnel", "m", "degrees"), [*DIRECT_CASES, (Dielectric(0.5), 0.3, 60.0), (Dielectric(0.5), 0.3, 80.0)], ids=repr
)
def test_cook_torrance_albedo_is_the_integral_of_f_cos(fresnel, m, degrees):
    """The same number comes from ``evaluate``, integrated over wi with SciPy."""
    theta = np.deg2rad(degrees)
    wo, model = spherical(theta), CookTorrance(m, fresnel)
    edges = np.unique([0.0, theta, np.pi / 4, np.pi / 2])
    direct = over_the_hemisphere(lambda wi: model.evaluate(wi, wo), edges, np.array([0.0, np.pi / 2, np.pi]))
    got = albedo(model, wo)
    assert got.shape == direct.shape == (3,)
    # Up to six boxes of 1e-8, doubled: 1.2e-7 absolute by SciPy's cautious estimates; seen: 4e-8 relative.
    np.testing.assert_allclose(got, direct, rtol=1e-6, atol=2e-8)


@pytest.mark.parametrize("m", [1e-4, 1e-2, 0.3])
def test_cook_torrance_albedo_from_above_is_a_single_integral(m):
    """Along the normal no groove hides another below 60 degrees; with F = 1 what is lost can be given in one dimension.

    v = n: n.h = v.h = cos(d), G1 = 1, G2 = min(1, 2 n.l) = min(1, 2 cos(2d)), and D cos(d) sin(d) dd 2 pi =
    exp(-t/m^2)/m^2 dt with t = tan^2(d), cos(2d) = (1 - t)/(1 + t):
    E = 1 - exp(-(1/3)/m^2) + integral from 1/3 to 1 of 2 (1 - t)/(1 + t) exp(-t/m^2)/m^2 dt.
    """
    tail, _ = integrate.quad(
        lambda t: 2 * (1 - t) / (1 + t) * np.exp(-t / m**2) / m**2, 1 / 3, 1, epsabs=1e-12, points=[1 / 3 + m**2]
    )
    expected = -np.expm1(-1 / (3 * m**2)) + tail
    got = albedo(CookTorrance(m, Schlick(1.0)), [0.0, 0.0, 1.0])
    assert got.shape == (3,)
    np.testing.assert_allclose(got, expected, rtol=1e-9)


@pytest.mark.parametrize("m", [1.0, 10.0])
def test_cook_torrance_albedo_from_above_is_exponential_integrals(m):
    """The integral of the test above in closed form: 2 (1 - t)/(1 + t) = 4/(1 + t) - 2, and E1 for the first part."""
    a = 1 / m**2
    first = 4 * a * np.exp(a) * (special.exp1(4 * a / 3) - special.exp1(2 * a))
    second = 2 * (np.exp(-a / 3) - np.exp(-a))
    got = albedo(CookTorrance(m, Schlick(1.0)), [0.0, 0.0, 1.0])
    np.testing.assert_allclose(got, 1 - np.exp(-a / 3) + first - second, rtol=1e-9)


@pytest.mark.parametrize(("sigma", "qualitative"), [(0.1, False), (1.0, False), (np.pi / 2, False), (0.3, True)])
def test_oren_nayar_albedo_is_converged(sigma, qualitative):
    """300 nodes in place of 160 change nothing above 1e-6, also where the full fit is cut at 0."""
    model = OrenNayar((0.05, 0.2, 1.0), sigma, qualitative)
    wo = spherical(np.deg2rad([20.0, 80.0, 89.99]))
    got, finer = albedo(model, wo), diffuse_albedo(wo, model.evaluate, nodes=300)
    assert got.shape == finer.shape == (3, 3)
    np.testing.assert_allclose(got, finer, rtol=0.5 * PROMISED, atol=0)


@pytest.mark.parametrize("qualitative", [False, True])
@pytest.mark.parametrize("degrees", [0.0, 40.0, 80.0])
def test_oren_nayar_albedo_is_the_integral_of_f_cos(degrees, qualitative):
    """SciPy's adaptive rule over wi gives the same."""
    theta = np.deg2rad(degrees)
    wo, model = spherical(theta), OrenNayar((0.05, 0.5, 1.0), 0.4, qualitative)
    edges = np.unique([0.0, theta, np.pi / 2])
    direct = over_the_hemisphere(lambda wi: model.evaluate(wi, wo), edges, np.array([0.0, np.pi / 2, np.pi]))
    got = albedo(model, wo)
    assert got.shape == direct.shape == (3,)
    np.testing.assert_allclose(got, direct, rtol=PROMISED, atol=2e-8)


def test_oren_nayar_albedo_from_above_is_a_closed_form():
    """Along the normal b = 0, cos p has no effect and C3 = 0: E = rho C1 + 0.17 rho^2 s2/(s2 + 0.13)."""
    s2, rho = 0.4**2, np.array([0.05, 0.5, 1.0])
    expected = rho * (1 - 0.5 * s2 / (s2 + 0.33)) + 0.17 * rho**2 * s2 / (s2 + 0.13)
    got = albedo(OrenNayar(rho, 0.4), [0.0, 0.0, 1.0])
    assert got.shape == (3,)
    np.testing.assert_allclose(got, expected, rtol=1e-9)


def test_lambert_albedo_is_its_albedo():
    """Exactly, for every view above the surface."""
    got = albedo(Lambert((0.1, 0.5, 1.0)), spherical(np.array([0.0, 0.5, 1.5])))
    assert got.tolist() == [[0.1, 0.5, 1.0]] * 3


def test_albedo_depends_on_the_height_alone():
    """Turning the viewer about the normal changes nothing."""
    phi = np.array([0.0, 1.0, 2.0, -3.0])
    for model in (CookTorrance(0.4, Schlick(0.5)), OrenNayar(0.5, 0.4), Smooth(Dielectric(1.5))):
        got = albedo(model, spherical(1.0, phi))
        assert got.shape == (4, 3)
        np.testing.assert_allclose(got, np.broadcast_to(got[0], (4, 3)), rtol=1e-14)


def test_albedo_takes_a_slope_for_each_direction():
    """m as an array broadcasts against the views."""
    m, wo = np.array([0.1, 0.5]), spherical(np.array([0.3, 1.2]))
    got = albedo(CookTorrance(m, Schlick(0.5)), wo)
    assert got.shape == (2, 3)
    for index in range(2):
        assert (got[index] == albedo(CookTorrance(m[index], Schlick(0.5)), wo[index])).all()


CASES = [(m, degrees) for m in (0.02, 0.3, 1.0, 3.0) for degrees in (0.0, 60.0, 85.0)]


@pytest.mark.parametrize("moment", [1, 2])
@pytest.mark.parametrize(("m", "degrees"), CASES)
def test_moments_of_the_weight_agree_with_monte_carlo(m, degrees, moment):
    """The mean of weight^moment over 1e5 draws; the second moment gives the variance of a sample under a white sky."""
    fresnel = Schlick((0.04, 0.5, 1.0))
    wo = spherical(np.deg2rad(degrees), 0.3)
    u = np.random.default_rng(round(1000 * m + degrees)).random((100_000, 4))
    _, weight = CookTorrance(m, fresnel).sample(wo, u)
    powers = weight**moment
    expected = vgroove_albedo(wo, m, fresnel, moment=moment)
    assert powers.shape == (100_000, 3)
    assert expected.shape == (3,)
    spread = powers.std(axis=0) / np.sqrt(len(powers))
    # Two-sided at 1 % for all cases, moments and channels together (Sidak): 4.4 standard deviations. Where nearly
    # every weight is 1 the spread is 0 but for what 1e5 draws do not find, at most 1 in 1e5; then 5 of those.
    limit = sidak.limit(2 * 3 * len(CASES))
    assert (np.abs(powers.mean(axis=0) - expected) < limit * spread + 5 / len(powers)).all()


@pytest.mark.parametrize("specular", [CookTorrance(0.3, Schlick(0.5)), Smooth(Dielectric(1.5))])
def test_sum_albedo_is_the_sum_of_albedos(specular):
    """Weighted by d and s."""
    wo = spherical(np.array([0.2, 1.3]))
    got = albedo(Sum(OrenNayar(0.5, 0.3), specular, 0.25, 0.5), wo)
    assert got.shape == (2, 3)
    np.testing.assert_allclose(got, 0.25 * albedo(OrenNayar(0.5, 0.3), wo) + 0.5 * albedo(specular, wo), rtol=1e-15)
