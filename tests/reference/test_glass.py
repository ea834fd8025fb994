# SPDX-License-Identifier: GPL-3.0-or-later
"""Glass: refraction against a second transcription at 50 digits, reciprocity, energy, sampling, thin panes."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from mpmath import mp, mpf, workdps
from scipy import stats

from vgroove.addon.reference import (
    CookTorrance,
    Dielectric,
    Glass,
    Pane,
    albedo,
    fresnel_dielectric,
    fresnel_transmittance,
    glass,
    glass_btdf,
    refract,
    spherical,
    visible_facet,
)
from vgroove.addon.reference.directions import dot
from vgroove.addon.reference.quadrature import vgroove_mean
from vgroove.lab import sidak

ETAS = [1.33, 1.5, 2.42, 1 / 1.5, 0.1, 10.0]
SLOPES = [0.1, 0.3, 0.6, 1.0]
U = 2.0**-53  # largest relative error of one float64 operation
DOWN = np.array([1.0, 1.0, -1.0])


def share(_F, _R, T):
    return T


# --- the value ------------------------------------------------------------------------------------------------------


def exact_btdf(wi, wo, m, eta):
    """Walter et al. 2007, eq. 21 times eta^2, with F from the tangents and sines of Fresnel's own form.

    The facet is built from the plane of both rays, not from their weighted sum: h is the direction in that plane whose
    angles to both obey Snell's law, tan(c) = eta sin(d) / (1 - eta cos(d)) with d the angle by which the ray turns.
    """
    wi, wo, m, eta = [mpf(float(x)) for x in wi], [mpf(float(x)) for x in wo], mpf(float(m)), mpf(float(eta))
    down = [-x for x in wi]
    cos_d = sum(x * y for x, y in zip(wo, down, strict=True))
    along = [x - cos_d * y for x, y in zip(down, wo, strict=True)]  # at right angles to wo
    sin_d = mp.sqrt(sum(x * x for x in along))
    # angle between wo and +-h: sin(c) = eta sin(c + d) taken along ``along``, for h = cos(c) wo + sin(c) along
    c = mp.atan2(eta * sin_d, 1 - eta * cos_d)
    h = [mp.cos(c) * x - mp.sin(c) * y / sin_d for x, y in zip(wo, along, strict=True)]
    h = [-x for x in h] if h[2] < 0 else h
    vh = sum(x * y for x, y in zip(wo, h, strict=True))
    lh = -sum(x * y for x, y in zip(wi, h, strict=True))
    if vh <= 0 or lh <= 0:
        return mpf(0)
    a = mp.acos(vh)
    b = mp.asin(mp.sin(a) / eta)
    F = (mp.sin(a - b) ** 2 / mp.sin(a + b) ** 2 + mp.tan(a - b) ** 2 / mp.tan(a + b) ** 2) / 2
    tan2 = (h[0] ** 2 + h[1] ** 2) / h[2] ** 2
    D = mp.exp(-tan2 / m**2) / (mp.pi * m**2 * h[2] ** 4)
    seen, lit = (min(mpf(1), 2 * h[2] * z / x) for z, x in ((wo[2], vh), (-wi[2], lh)))
    G = max(seen + lit - 1, mpf(0))
    return (1 - F) * D * G * vh * lh / (wo[2] * -wi[2]) * eta**2 / (vh - eta * lh) ** 2


def refracted(m, eta, count, seed):
    """Pairs that facets of slope m connect, from views at every height."""
    rng = np.random.default_rng(seed)
    wo = spherical(np.arccos(rng.uniform(0.02, 1.0, count)), rng.uniform(0, 6.28, count))
    h = visible_facet(wo, m, rng.random((count, 3)))
    wi = refract(wo, h, eta)
    kept = (wi[:, 2] < 0) & (dot(wo, h) ** 2 + eta**2 - 1 > 0)
    return wi[kept], wo[kept], h[kept]


@pytest.mark.parametrize("eta", [*ETAS, 1.001])
@pytest.mark.parametrize("m", [1e-4, 0.02, 0.3, 1.0, 3.0])
def test_btdf_agrees_with_walter_at_fifty_digits(m, eta):
    """To 1e-12 on the components as they stand, and 0 where the equation gives 0."""
    wi, wo, h = refracted(m, eta, 60, [21, round(1e4 * m), round(100 * eta)])
    got = glass_btdf(wi, wo, m, eta)
    assert got.shape == wi.shape[:1]
    with workdps(50):
        expected = [exact_btdf(*pair, m, eta) for pair in zip(wi, wo, strict=True)]
    # h rounds by 3 U of each component: D by that times 2 t^2/m^2 with t the facet's slope, at most 49 of it, and
    # v.h, l.h by 3 U absolute, relative to whichever is the smaller cosine; G2t is a difference of numbers near 1.
    least = np.minimum(dot(wo, h), -dot(wi, h))
    for value, exact, small in zip(got, expected, least, strict=True):
        if exact < mpf("1e-250"):
            assert value <= 1e-250
        else:
            assert abs(mpf(float(value)) / exact - 1) < 1e-12 + 100 * U / small**2


@pytest.mark.parametrize("eta", ETAS)
def test_facet_of_a_refracted_ray_is_the_one_that_refracted_it(eta):
    """``refraction_facet`` undoes ``refract``; Snell's law holds on the way."""
    wi, wo, h = refracted(0.5, eta, 500, 3)
    found, length = glass.refraction_facet(wi, wo, eta)
    assert found.shape == h.shape
    assert (length > 0).all()
    np.testing.assert_allclose(found, h, atol=2e-14 / abs(eta - 1) * max(1.0, eta))
    sin_o, sin_i = (np.linalg.norm(np.cross(w, h), axis=-1) for w in (wo, wi))
    np.testing.assert_allclose(sin_o, eta * sin_i, atol=4 * U * max(1.0, eta))
    np.testing.assert_allclose(np.linalg.norm(wi, axis=-1), 1.0, rtol=4 * U)


@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("m", SLOPES)
def test_radiance_over_the_square_of_the_index_is_reciprocal(m, eta):
    """f(wi, wo) / eta^2 from outside is f(wo, wi) from inside, where the index is 1/eta and the normal turned."""
    wi, wo, _ = refracted(m, eta, 300 if eta > 0.5 else 30_000, 5)
    outside, inside = glass_btdf(wi, wo, m, eta), glass_btdf(wo * DOWN, wi * DOWN, m, 1 / eta)
    assert outside.shape == inside.shape == wi.shape[:1]
    assert (outside > 0).sum() > min(20, 0.1 * len(wi))
    # The facet's rounding, 3 U, moves D by 2 t^2/m^2 <= 30 of it, G2t next to its zero by an absolute 10 U.
    np.testing.assert_allclose(outside / eta**2, inside, rtol=1e-9, atol=1e-14)


@pytest.mark.parametrize("eta", [*ETAS, 1 + 1e-9, 0.999])
def test_transmittance_of_a_facet_is_one_minus_f(eta):
    """Without cancelling, from both cosines, and the same from either side."""
    c = np.linspace(0.0, 1.0, 1001)[1:]
    g = glass.refracted_cosine(c, eta)
    T = np.where(g > 0, fresnel_transmittance(c, np.where(g > 0, g, 1.0), eta), 0.0)
    assert T.shape == c.shape
    np.testing.assert_allclose(T, 1 - fresnel_dielectric(c, eta), atol=4e-16 * 8)
    through = g > 0
    back = fresnel_transmittance(g[through] / eta, c[through] / eta, 1 / eta)
    np.testing.assert_allclose(back, T[through], rtol=1e-14)


def test_total_reflection_sends_nothing_through():
    """From inside glass, beyond the critical angle of every facet that counts."""
    wo = spherical(np.deg2rad(80.0))
    inside = Glass(0.05, 1 / 1.5)
    assert inside.transmittance(wo).max() < 1e-12
    wi, weight = inside.sample(wo, np.random.default_rng(1).random((2000, 4)))
    assert (wi[weight[:, 0] > 0][:, 2] > 0).all()
    assert Glass(0.0, 1 / 1.5).transmittance(wo).tolist() == [0.0] * 3
    assert Glass(0.0, 1 / 1.5).reflectance(wo).tolist() == [1.0] * 3


def test_reflection_is_cook_torrance():
    """To the last digit, in value and albedo; tint leaves it alone."""
    wi, wo = spherical(np.linspace(0, 1.5, 20), 0.3), spherical(0.7, 2.0)
    rough = CookTorrance(0.3, Dielectric(1.5))
    tinted = Glass(0.3, 1.5, tint=(0.2, 0.5, 1.0))
    assert (tinted.evaluate(wi, wo) == rough.evaluate(wi, wo)).all()
    assert (tinted.reflectance(wo) == albedo(rough, wo)).all()
    clear = Glass(0.3, 1.5)
    np.testing.assert_allclose(tinted.evaluate(-wi, wo), clear.evaluate(-wi, wo) * [0.2, 0.5, 1.0], rtol=4 * U)
    np.testing.assert_allclose(tinted.transmittance(wo), clear.transmittance(wo) * [0.2, 0.5, 1.0], rtol=4 * U)


# --- energy ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("eta", [*ETAS, 1.0])
@pytest.mark.parametrize("thin", [False, True])
def test_a_smooth_interface_loses_nothing(eta, thin):
    """R + T = 1 to rounding at m = 0, and within 1e-4 at m = 1e-4 where no groove hides another."""
    wo = spherical(np.deg2rad([0.0, 30.0, 60.0, 85.0]))
    np.testing.assert_allclose(albedo(Glass(0.0, eta, thin=thin), wo), np.ones((4, 3)), atol=1e-12)
    np.testing.assert_allclose(albedo(Glass(1e-4, eta, thin=thin), wo), np.ones((4, 3)), atol=1e-4)


@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("m", [1e-4, *SLOPES, 3.0, 10.0])
def test_roughness_only_loses_energy(m, eta):
    """R + T is at most 1, also seen at grazing angles."""
    wo = spherical(np.deg2rad([0.0, 30.0, 60.0, 85.0, 89.99]))
    for thin in (False, True):
        total = albedo(Glass(m, eta, thin=thin), wo)
        assert total.shape == (5, 3)
        assert (total > 0).all()
        assert (total <= 1 + 1e-6).all()


@pytest.mark.parametrize(("m", "degrees"), [(1e-4, 60.0), (0.1, 89.9), (0.5, 85.0), (1.0, 40.0), (3.0, 0.0)])
@pytest.mark.parametrize("eta", [*ETAS, 1 + 1e-9, 0.999])
def test_transmittance_is_converged(eta, m, degrees):
    """40 nodes on each panel in place of 16 change nothing above 1e-6."""
    wo = spherical(np.deg2rad(degrees), 0.7)
    got = Glass(m, eta).transmittance(wo)
    finer = vgroove_mean(wo, m, eta, lambda F, _R, T: (1 - F) * T, nodes=40)
    assert got.shape == finer.shape == (3,)
    np.testing.assert_allclose(got, finer, rtol=5e-7, atol=1e-15)


@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("m", [0.02, 0.3, 1.0, 3.0])
@pytest.mark.parametrize("degrees", [0.0, 40.0, 85.0, 89.9])
def test_means_over_facets_agree_with_the_albedo_of_reflection(m, eta, degrees):
    """The facets that are seen add up to 1, and F R is what ``vgroove_albedo`` integrates with other panels."""
    wo = spherical(np.deg2rad(degrees))
    assert vgroove_mean(wo, m, eta, lambda F, _R, _T: np.ones_like(F))[0] == pytest.approx(1.0, abs=1e-9)
    reflected = vgroove_mean(wo, m, eta, lambda F, R, _T: F * R)
    np.testing.assert_allclose(reflected, albedo(CookTorrance(m, Dielectric(eta)), wo), rtol=1e-6)


@pytest.mark.parametrize(
    ("eta", "m", "degrees"), [(1.5, 0.3, 30.0), (1.5, 1.0, 80.0), (2.42, 0.6, 60.0), (0.7, 0.3, 20.0)]
)
def test_transmittance_is_the_integral_of_the_btdf(eta, m, degrees):
    """The same from ``evaluate`` over directions below, on panels that know nothing of facets."""
    wo = spherical(np.deg2rad(degrees))
    x, weight = np.polynomial.legendre.leggauss(400)
    theta, phi = np.pi / 2 + np.pi / 4 * (x + 1), np.pi / 2 * (x + 1)
    wi = spherical(theta[:, None], phi)
    f = Glass(m, eta).evaluate(wi, wo)
    total = 2 * np.einsum("tpc,t,p->c", f, weight * np.pi / 4 * np.sin(theta) * -np.cos(theta), weight * np.pi / 2)
    # Kinks of G2t cross the panels; 200 and 400 nodes differ by up to 2e-4.
    np.testing.assert_allclose(total, Glass(m, eta).transmittance(wo), rtol=2e-4)


# --- sampling -------------------------------------------------------------------------------------------------------

CASES = [(m, eta, view) for m in (0.1, 0.3, 1.0) for eta in (1.5, 2.42, 1 / 1.5) for view in (0.0, 30.0, 70.0)]
EDGES = 12


def draw(model, view, count, seed):
    wo = spherical(np.deg2rad(view), np.pi)
    wi, weight = model.sample(wo, np.random.default_rng(seed).random((count, 4)))
    assert wi.shape == weight.shape == (count, 3)
    return wo, wi, weight


def chi_square(model, view, sample_seed):
    """p-value of 2e5 draws that weigh something, in cells of both hemispheres, under ``pdf``.

    A cell is a rectangle in the light's horizontal components (y, x), between quantiles of a pilot draw: there pdf per
    area is pdf/|cos|. Directions that no groove lets out weigh 0; they make one more cell with all that is not seen.
    """
    wo, pilot, weight = draw(model, view, 40_000, 7)
    _, wi, carried = draw(model, view, 200_000, sample_seed)
    observed, expected = [], []
    for side in (1.0, -1.0):
        part = pilot[(np.sign(pilot[:, 2]) == side) & (weight[:, 0] > 0)]
        if len(part) < 500:
            continue
        found = wi[(np.sign(wi[:, 2]) == side) & (carried[:, 0] > 0)]
        theta = np.quantile(np.arccos(side * part[:, 2]), np.linspace(0.01, 0.98, EDGES))
        phi = np.quantile(np.arctan2(part[:, 1], part[:, 0]), np.linspace(0.01, 0.99, EDGES))
        counts = np.histogram2d(np.arccos(side * found[:, 2]), np.arctan2(found[:, 1], found[:, 0]), [theta, phi])[0]
        x, w = np.polynomial.legendre.leggauss(24)
        t, p = (e[:-1, None] + np.diff(e)[:, None] * (x + 1) / 2 for e in (theta, phi))
        at = spherical(t[:, None, :, None], p[None, :, None, :]) * [1.0, 1.0, side]
        density = model.pdf(at, wo) * (model.evaluate(at, wo)[..., 0] > 0)
        area = np.diff(theta)[:, None] * np.diff(phi) / 4
        mass = np.einsum("abtp,at,t,p->ab", density, np.sin(t), w, w) * area
        observed.append(counts.ravel())
        expected.append(len(wi) * mass.ravel())
    observed, expected = np.concatenate(observed), np.concatenate(expected)
    observed, expected = np.append(observed, len(wi) - observed.sum()), np.append(expected, len(wi) - expected.sum())
    small = expected < 10
    observed = np.append(observed[~small], observed[small].sum())
    expected = np.append(expected[~small], max(expected[small].sum(), 1e-9))
    kept = expected > 1
    assert kept.sum() > 50
    return stats.chi2.sf(np.sum((observed - expected)[kept] ** 2 / expected[kept]), kept.sum() - 1)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_samples_are_distributed_as_pdf_says(case):
    """Above and below, each in 121 cells."""
    m, eta, view = case
    assert chi_square(Glass(m, eta), view, [1982, CASES.index(case)]) > sidak.chance(len(CASES))


@pytest.mark.parametrize("case", CASES, ids=str)
def test_weight_is_f_cos_over_pdf(case):
    """G2/G1 and G2t/G1 are what ``evaluate`` and ``pdf`` make of the same direction."""
    m, eta, view = case
    model = Glass(m, eta, tint=(0.3, 0.9, 1.0))
    wo, wi, weight = draw(model, view, 5_000, [3, CASES.index(case)])
    density = model.pdf(wi, wo)
    live = (weight[:, 2] > 1e-6) & (density > 1e-250)
    assert live.sum() > 2_000
    expected = model.evaluate(wi, wo)[live] * (np.abs(wi[live, 2]) / density[live])[:, None]
    np.testing.assert_allclose(weight[live], expected, rtol=1e-9, atol=1e-13)
    assert (weight >= 0).all()
    assert (weight <= 1 + 1e-15).all()


@pytest.mark.parametrize("thin", [False, True])
@pytest.mark.parametrize("case", [*CASES, (0.0, 1.5, 60.0), (0.0, 1 / 1.5, 30.0)], ids=str)
def test_mean_weight_is_reflectance_and_transmittance(case, thin):
    """Each on its own, over 1e5 draws (Z-test)."""
    m, eta, view = case
    model = Glass(m, eta, tint=(0.3, 0.9, 1.0), thin=thin)
    wo, wi, weight = draw(model, view, 100_000, [5, round(10 * m), round(view)])
    limit = sidak.limit(4 * (len(CASES) + 2))
    for side, expected in ((wi[:, 2] > 0, model.reflectance(wo)), (wi[:, 2] < 0, model.transmittance(wo))):
        values = weight[:, 1] * side
        spread = values.std() / np.sqrt(len(values))
        assert abs(values.mean() - expected[1]) < limit * spread + 1e-6


def test_second_moments_agree_with_monte_carlo():
    """What the Z-tests in Cycles take their variances from."""
    wo, eta, m = spherical(1.2), 1.5, 0.6
    h = visible_facet(np.broadcast_to(wo, (200_000, 3)), m, np.random.default_rng(9).random((200_000, 3)))
    F, T = (
        fresnel_dielectric(dot(wo, h), eta),
        glass.transmitted_g(refract(wo, h, eta), wo, h) / glass.vgroove_g1(wo, h),
    )
    values = np.square((1 - F) * T)
    expected = vgroove_mean(wo, m, eta, lambda F, _R, T: np.square((1 - F) * T))[0]
    assert abs(values.mean() - expected) < 4 * values.std() / np.sqrt(len(values))


# --- deliberate errors ----------------------------------------------------------------------------------------------


def with_one_percent(monkeypatch, name):
    original = getattr(glass, name)
    monkeypatch.setattr(glass, name, lambda *arguments: 1.01 * original(*arguments))


@pytest.mark.once
@pytest.mark.parametrize("name", ["beckmann_d", "transmitted_g", "fresnel_transmittance"])
@pytest.mark.parametrize("m", SLOPES)
def test_one_percent_in_a_term_turns_the_checks_red(monkeypatch, name, m):
    """D, G2t and 1 - F in ``evaluate``: the 50 digits, and the integral against the mean over slopes."""
    eta = 1.5
    wi, wo, _ = refracted(m, eta, 20, 1)
    with_one_percent(monkeypatch, name)
    with pytest.raises(AssertionError):
        test_btdf_agrees_with_walter_at_fifty_digits(m, eta)
    if m >= 0.3:
        with pytest.raises(AssertionError):
            test_transmittance_is_the_integral_of_the_btdf(eta, m, 30.0)
    assert (glass_btdf(wi, wo, m, eta) >= 0).all()


@pytest.mark.once
def test_a_swapped_index_turns_the_checks_red(monkeypatch):
    """1/eta in place of eta, where a ray looks for its facet."""
    original = glass.refraction_facet
    monkeypatch.setattr(glass, "refraction_facet", lambda wi, wo, eta: original(wi, wo, 1 / np.asarray(eta)))
    with pytest.raises(AssertionError):
        test_btdf_agrees_with_walter_at_fifty_digits(0.3, 1.5)
    with pytest.raises(AssertionError):
        test_transmittance_is_the_integral_of_the_btdf(1.5, 0.3, 30.0)


@pytest.mark.once
@pytest.mark.parametrize("m", SLOPES)
def test_one_percent_of_shadow_in_the_weight_turns_the_means_red(monkeypatch, m):
    """In ``sample`` alone."""
    model, wo = Glass(m, 1.5), spherical(0.5)
    with_one_percent(monkeypatch, "transmitted_g")
    wi, weight = model.sample(wo, np.random.default_rng(2).random((200_000, 4)))
    values = weight[:, 0] * (wi[:, 2] < 0)
    limit = sidak.limit(4 * (len(CASES) + 2))
    assert abs(values.mean() - model.transmittance(wo)[0]) > limit * values.std() / np.sqrt(len(values)) + 1e-6


# --- thin panes, limits, bad input ------------------------------------------------------------------------------------


@pytest.mark.parametrize("eta", [1.33, 1.5, 2.42])
def test_a_pane_is_the_sum_of_all_its_reflections(eta):
    """F (1 + (1-F)^2 (1 + F^2 + F^4 ...)) of the first 2000 round trips, and T = (1-F)^2 (1 + F^2 ...) beside it."""
    c = np.linspace(0.02, 1.0, 50)
    F = fresnel_dielectric(c, eta)
    trips = sum(F ** (2 * n) for n in range(2000))
    got = Pane(eta)(c)
    assert got.shape == (50, 3)
    np.testing.assert_allclose(got[:, 0], F + (1 - F) ** 2 * F * trips, rtol=1e-12)
    np.testing.assert_allclose(1 - got[:, 0], (1 - F) ** 2 * trips, rtol=1e-9)


def test_a_thin_sheet_lets_light_go_straight():
    """Its transmitted directions are -wo exactly; the BTDF has no density."""
    wo = spherical(0.9, 0.2)
    sheet = Glass(0.4, 1.5, tint=(0.5, 1.0, 0.2), thin=True)
    wi, weight = sheet.sample(wo, np.random.default_rng(3).random((500, 4)))
    straight = wi[:, 2] < 0
    lost = weight[:, 0] == 0
    assert straight.sum() > 300
    assert (wi[straight & ~lost] == -wo).all()
    assert (weight[straight & ~lost] == [0.5, 1.0, 0.2]).all()
    assert sheet.evaluate(-wo, wo).tolist() == [0.0] * 3
    assert sheet.pdf(-wo, wo) == 0


@pytest.mark.parametrize("thin", [False, True])
@pytest.mark.parametrize(("m", "eta"), [*product([0.0, 1e-4, 0.3, 10.0], [0.1, 1 - 1e-12, 1.0, 1 + 1e-12, 10.0])])
def test_glass_stays_finite_and_not_negative(m, eta, thin):
    """At every slope and index, also grazing, all but tangent and from below."""
    theta = np.deg2rad([0.0, 1e-9, 30.0, 89.9999999, 90.0, 120.0, 180.0])
    wi, wo = spherical(theta[:, None], 0.3), spherical(theta, 2.0)
    model = Glass(m, eta, thin=thin)
    with np.errstate(all="raise", under="ignore"):
        f, p = model.evaluate(wi, wo), model.pdf(wi, wo)
        opposite = model.evaluate(-wo, wo)
        lit, weight = model.sample(wo, np.random.default_rng(1).random((64, 7, 4)))
        total = albedo(model, wo)
    assert f.shape == (7, 7, 3)
    assert p.shape == (7, 7)
    for values in (f, p, opposite, lit, weight, total):
        assert np.isfinite(values).all()
    for values in (f, p, weight, total):
        assert values.min() >= 0
    assert (total <= 1 + 1e-6).all()
    assert (weight[:, 5:] == 0).all()
    assert (f[:, 5:] == 0).all()


def test_an_index_of_one_bends_nothing():
    """What does not pass straight on is hidden from one side or the other."""
    wo = spherical(1.3, 0.5)
    wi, weight = Glass(0.5, 1.0).sample(wo, np.random.default_rng(4).random((300, 4)))
    np.testing.assert_allclose(wi, np.broadcast_to(-wo, wi.shape), atol=4 * U)
    assert 0 < weight.mean() < 1
    assert Glass(0.5, 1.0).evaluate(-wo, wo).tolist() == [0.0] * 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((-0.1, 1.5), "m must be greater than 0"),
        ((0.1, 0.0), "eta must be greater than 0"),
        (([0.1, 0.2], 1.5), "m must be one number"),
        ((0.1, [1.5] * 3), "eta must be one number"),
        ((0.1, 1.5, 1.5), "tint must be between 0 and 1"),
    ],
)
def test_bad_parameters_are_named(arguments, said):
    """ValueError says which and why."""
    with pytest.raises(ValueError, match=said):
        Glass(*arguments)
