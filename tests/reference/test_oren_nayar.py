# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren-Nayar against a second transcription in the paper's own angles, the short form against the full, and the fit."""

import re
from functools import partial
from math import cos, pi, sin, tan
from pathlib import Path

import numpy as np
import pytest

from vgroove.addon.reference import OrenNayar, albedo, cycles, oren_nayar, oren_nayar_fit, spherical
from vgroove.addon.reference.oren_nayar_fit import oren_nayar_hybrid
from vgroove.addon.reference.quadrature import diffuse_albedo, panels

SIGMAS = (0.1, 0.3, 0.6, 1.0, np.pi / 2)
KINDS = [(False, "full"), (True, "qualitative")]
PAGE = Path(__file__).parents[2] / "docs" / "oren_nayar.md"


# --- the paper's equations once more ------------------------------------------------------------------------------


def radiance(theta_i, phi_i, theta_r, phi_r, rho, sigma):
    """L_r of eqs. 27 to 29 for E_0 = 1: one bounce and two."""
    alpha, beta = max(theta_r, theta_i), min(theta_r, theta_i)
    turn = cos(phi_r - phi_i)
    C1 = 1 - 0.5 * sigma**2 / (sigma**2 + 0.33)
    if turn >= 0:
        C2 = 0.45 * sigma**2 / (sigma**2 + 0.09) * sin(alpha)
    else:
        C2 = 0.45 * sigma**2 / (sigma**2 + 0.09) * (sin(alpha) - (2 * beta / pi) ** 3)
    C3 = 0.125 * (sigma**2 / (sigma**2 + 0.09)) * (4 * alpha * beta / pi**2) ** 2
    bracket = C1 + turn * C2 * tan(beta) + (1 - abs(turn)) * C3 * tan((alpha + beta) / 2)
    first = rho / pi * cos(theta_i) * bracket
    second = 0.17 * rho**2 / pi * cos(theta_i) * sigma**2 / (sigma**2 + 0.13) * (1 - turn * (2 * beta / pi) ** 2)
    return first + second


def qualitative_radiance(theta_i, phi_i, theta_r, phi_r, rho, sigma):
    """L_r of eq. 30 for E_0 = 1."""
    A = 1 - 0.5 * sigma**2 / (sigma**2 + 0.33)
    B = 0.45 * sigma**2 / (sigma**2 + 0.09)
    alpha, beta = max(theta_r, theta_i), min(theta_r, theta_i)
    return rho / pi * cos(theta_i) * (A + B * max(0, cos(phi_r - phi_i)) * sin(alpha) * tan(beta))


@pytest.mark.parametrize(("qualitative", "formula"), [(False, radiance), (True, qualitative_radiance)])
@pytest.mark.parametrize("sigma", [0.0, 0.05, 0.3, 0.6, 1.2])
def test_oren_nayar_is_the_papers_radiance(sigma, qualitative, formula):
    """L_r / cos(theta_i), at least 0, to 1e-12 up to 80 degrees, where angles and components carry the same digits."""
    rng = np.random.default_rng(1994)
    theta, phi, rho = (
        rng.uniform(0.0, np.deg2rad(80.0), (400, 2)),
        rng.uniform(-pi, pi, (400, 2)),
        np.array([0.1, 0.6, 1.0]),
    )
    got = oren_nayar(spherical(theta[:, 0], phi[:, 0]), spherical(theta[:, 1], phi[:, 1]), rho, sigma,
                     qualitative=qualitative)  # fmt: skip
    assert got.shape == (400, 3)
    expected = [
        [max(formula(i, p, r, q, float(one), sigma), 0.0) / cos(i) for one in rho]
        for (i, r), (p, q) in zip(theta.tolist(), phi.tolist(), strict=True)
    ]
    np.testing.assert_allclose(got, expected, rtol=1e-12)


# --- the short form against the full ------------------------------------------------------------------------------


def l1(degrees, f, g, nodes=24):
    """Integral over wi of |f - g| cos over that of g cos, in per cent, for each channel."""
    theta_o = np.deg2rad(degrees)
    theta, theta_weight = panels(np.unique([0.0, theta_o, np.pi / 2]), nodes)
    phi, phi_weight = panels(np.array([0.0, np.pi / 2, np.pi]), nodes)
    t, p = (axis.ravel() for axis in np.meshgrid(theta, phi, indexing="ij"))
    wi, wo = spherical(t, p), spherical(theta_o)
    weight = np.outer(theta_weight, phi_weight).ravel() * np.sin(t) * np.cos(t)
    exact = g(wi, wo)
    return 100.0 * (weight @ np.abs(f(wi, wo) - exact)) / (weight @ exact)


def table(heading):
    """Rows of the Markdown table under ``heading`` in docs/oren_nayar.md, as numbers."""
    text = PAGE.read_text(encoding="utf-8").split(heading)[1]
    rows = [line for line in text.split("\n\n## ")[0].splitlines() if re.match(r"\| [0-9]", line)]
    return [[float(cell) for cell in row.strip("| ").split("|")] for row in rows]


def test_the_short_form_is_as_far_from_the_full_as_the_page_says():
    """By sigma and view, the worst of albedos 0.2, 0.5, 0.8."""
    rho = (0.2, 0.5, 0.8)
    rows = table("## The qualitative form")
    assert [row[0] for row in rows] == [0.1, 0.3, 0.6, 1.0, 1.57]
    for sigma, row in zip(SIGMAS, rows, strict=True):
        full, short = OrenNayar(rho, sigma), OrenNayar(rho, sigma, qualitative=True)
        got = [l1(degrees, short.evaluate, full.evaluate).max() for degrees in (0.0, 20.0, 45.0, 70.0, 85.0)]
        np.testing.assert_allclose(got, row[1:], atol=0.06)


# --- Cycles' own model and the fit --------------------------------------------------------------------------------


SINCE = {cycles.UNTIL_5_2: "until Blender 5.2", cycles.SINCE_5_3: "from Blender 5.3 on"}


@pytest.fixture(params=cycles.VERSIONS)
def meant(request):
    """Each Cycles in turn."""
    with cycles.as_of(request.param):
        yield request.param


@pytest.mark.usefixtures("meant")
@pytest.mark.parametrize("roughness", [0.0, 0.3, 1.0])
def test_cycles_diffuse_keeps_the_energy_of_white(roughness):
    """What one bounce loses is returned: albedo 1 but for the rounded average, 2 pi - 5.6; f is reciprocal."""
    wo = spherical(np.deg2rad([0.0, 45.0, 85.0]))
    energy = diffuse_albedo(wo, lambda wi, view: oren_nayar_fit.cycles_diffuse(wi, view, 1.0, roughness), nodes=64)
    np.testing.assert_allclose(energy, 1.0, atol=1e-3)
    rng = np.random.default_rng(3)
    wi, wo = (spherical(rng.uniform(0, 1.5, 100), rng.uniform(0, 6, 100)) for _ in range(2))
    there, back = (oren_nayar_fit.cycles_diffuse(*pair, (0.2, 0.5, 1.0), roughness) for pair in ((wi, wo), (wo, wi)))
    assert there.shape == (100, 3)
    np.testing.assert_allclose(there, back, rtol=1e-13)


def test_fujii_albedo_is_the_integral_of_single_scattering():
    """For a colour so dark that light bounces once."""
    cosines = np.array([1.0, 0.7, 0.3, 0.02])
    got = diffuse_albedo(
        spherical(np.arccos(cosines)), lambda wi, wo: oren_nayar_fit.cycles_diffuse(wi, wo, 1e-9, 0.8), nodes=64
    )
    np.testing.assert_allclose(got[:, 0] / 1e-9, oren_nayar_fit.fujii_albedo(cosines, 0.8), rtol=1e-8)


@pytest.mark.parametrize(("qualitative", "kind"), KINDS)
@pytest.mark.parametrize("sigma", SIGMAS)
def test_fit_keeps_the_albedo_and_is_as_near_as_the_page_says(meant, sigma, qualitative, kind):
    """The model's albedo, or 1 where that is more, to 0.6 %; L1 by view; no weight negative."""
    for rho in ((0.05, 0.2, 0.5), (0.8, 0.9, 1.0)):
        wo = spherical(np.deg2rad([0.0, 30.0, 60.0, 80.0, 89.0, 89.99]))
        fitted = diffuse_albedo(
            wo,
            lambda wi, view, rho=rho: oren_nayar_fit.oren_nayar_fit(wi, view, rho, sigma, qualitative=qualitative),
            64,
        )
        np.testing.assert_allclose(fitted, np.minimum(albedo(OrenNayar(rho, sigma, qualitative), wo), 1.0), rtol=6e-3)
        assert (fitted <= 1.0 + 2e-5).all()
        assert (np.array(oren_nayar_fit.weights(wo[:, 2], rho, sigma, qualitative=qualitative)) >= 0.0).all()
    rho = (0.2, 0.5, 0.8)
    model = OrenNayar(rho, sigma, qualitative)
    row = table(f"## The fit {SINCE[meant]}, {kind}")[SIGMAS.index(sigma)]

    def mixture(wi, wo):
        return oren_nayar_fit.oren_nayar_fit(wi, wo, rho, sigma, qualitative=qualitative)

    def native(wi, wo):
        roughness = float(oren_nayar_fit.closure_roughness(sigma, qualitative=qualitative))
        return oren_nayar_fit.cycles_diffuse(wi, wo, rho, roughness)

    views = (0.0, 45.0, 70.0, 80.0, 89.0)
    got = [float(l1(degrees, f, model.evaluate).max()) for f in (mixture, native) for degrees in views]
    np.testing.assert_allclose(got, row[1:], atol=0.06)


@pytest.mark.parametrize("qualitative", [False, True])
def test_fit_is_lambert_without_roughness(qualitative):
    """sigma = 0: all weight on Lambert."""
    lambert, retro = oren_nayar_fit.weights([1.0, 0.5, 0.0], (0.1, 0.5, 1.0), 0.0, qualitative=qualitative)
    assert retro.tolist() == [[0.0] * 3] * 3
    assert lambert.tolist() == [[0.1, 0.5, 1.0]] * 3


@pytest.mark.usefixtures("meant")
@pytest.mark.parametrize("qualitative", [False, True])
@pytest.mark.parametrize("bound", [0.001, 0.005, 0.02, 0.05])
def test_hybrid_has_no_more_too_much_than_its_bound(qualitative, bound):
    """At sigmas, views and albedos off the tool's grid. The quadrature is good to 1e-4 of the albedo."""
    wo = spherical(np.radians([0.0, 25.0, 48.0, 65.0, 74.0, 81.0, 87.0, 89.0]))
    most = 0.0
    for sigma in (0.07, 0.28, 0.52, 0.83, 1.21, 1.5):
        for colors in ((1e-5, 0.3, 0.6), (0.75, 0.93, 1.0)):
            held = {"albedo": colors, "sigma": sigma, "qualitative": qualitative}
            energy = diffuse_albedo(wo, partial(oren_nayar, **held), 64)
            both = diffuse_albedo(wo, partial(oren_nayar_hybrid, bound=bound, **held), 64)
            most = max(most, float(np.max((both - energy) / energy)))
    assert most <= bound + 1e-4


def test_hybrid_is_the_model_where_the_share_carries_nothing_too_much():
    """Lambert is Cycles' own."""
    wi, wo = spherical(0.5, 1.0), spherical(0.9)
    np.testing.assert_allclose(oren_nayar_hybrid(wi, wo, 0.5, 0.0, 0.005), 0.5 / np.pi * np.ones(3), rtol=1e-12)
    with pytest.raises(ValueError, match="bound"):
        oren_nayar_hybrid(wi, wo, 0.5, 0.3, 0.5)
