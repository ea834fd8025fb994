# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacets of any distribution: D against mpmath, energy, sampling, and how near a few Beckmann terms come."""

import numpy as np
import pytest
from mpmath import mp, mpf, workdps

from vgroove.addon.reference import Conductor, CookTorrance, Dielectric, Schlick, albedo, rendered, spherical
from vgroove.addon.reference.facet_distribution import Distribution, Term
from vgroove.addon.reference.generator import Generator
from vgroove.addon.reference.generator_fit import beckmann_terms, distance, least_l1
from vgroove.addon.reference.quadrature import panels
from vgroove.lab.sidak import chance

from ..chi_square import chi_square, draw, viewer

U = 2.0**-53
WHITE = Schlick(1.0)
VIEWS = spherical(np.radians([0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.5]))
DRAWN = tuple(np.exp(-((np.linspace(0.0, 1.0, 32) ** 2 / 0.15) ** 2)) + 0.3 * (np.linspace(0.0, 1.0, 32) > 0.6))
TERMS = {
    "beckmann": Term("beckmann", (0.2,)),
    "narrow beckmann": Term("beckmann", (1e-3,)),
    "ggx": Term("ggx", (0.15,)),
    "exponential": Term("exponential", (0.3,)),
    "abc": Term("abc", (10482.133789, 0.816737)),
    "wide abc": Term("abc", (24.846296, 2.121997)),
    "log abc": Term("abc", (1e6, 1.0)),
    "points": Term("points", DRAWN),
    "two points": Term("points", (1.0, 0.0)),
}
SUMS = {name: Distribution((term,)) for name, term in TERMS.items()}
SUMS["two slopes"] = Distribution((Term("beckmann", (0.05,), 0.7), Term("beckmann", (0.4,), 0.3)))
EACH = pytest.mark.parametrize("of", SUMS.values(), ids=SUMS)


def exact(term, t):
    """D at 40 digits, not scaled but for what a formula says itself."""
    tan = mp.tan(t)
    if term.kind == "points":
        count = len(term.numbers) - 1
        place = mp.sqrt(t * 2 / mp.pi) * count
        k = min(int(place), count - 1)
        low, high = map(mpf, term.numbers[k : k + 2])
        return low + (place - k) * (high - low)
    if term.kind == "abc":
        B, C = map(mpf, term.numbers)
        return (1 + B * (1 - mp.cos(t))) ** -C
    m = mpf(term.numbers[0])
    front = 1 / (mp.pi * m**2 * mp.cos(t) ** 4)
    if term.kind == "beckmann":
        return front * mp.exp(-(tan**2) / m**2)
    if term.kind == "ggx":
        return front / (1 + tan**2 / m**2) ** 2
    return 3 * front * mp.exp(-mp.sqrt(6) * tan / m)


def area(term):
    """Integral of D cos over the hemisphere by mpmath's own quadrature."""
    if term.kind == "points":
        edges = [(mpf(k) / (len(term.numbers) - 1)) ** 2 * mp.pi / 2 for k in range(len(term.numbers))]
    else:
        first = max(mp.log10(mpf(SUMS_SLOPES[term])) - 3, -8)
        edges = [0, *(mpf(10) ** (first + k / mpf(2)) for k in range(20) if first + k / mpf(2) < 0), mp.pi / 2]
    return mp.quad(lambda t: 2 * mp.pi * exact(term, t) * mp.cos(t) * mp.sin(t), edges)


SUMS_SLOPES = {term: Distribution((term,)).slope for term in TERMS.values()}


@pytest.mark.parametrize("term", TERMS.values(), ids=TERMS)
def test_d_is_the_formula_scaled_to_unit_area(term):
    """1e-11, of which the exponents of narrow lobes take most: exp(-x) rounds by x 2^-53, x to 700."""
    with workdps(30):
        whole = area(term)
        if term.kind in {"beckmann", "ggx", "exponential"}:
            assert abs(whole - 1) < mpf("1e-12")
        for tan in np.geomspace(1e-6, 30.0, 60):
            t = mp.atan(mpf(float(tan)))
            expected = float(exact(term, t) / whole)
            got = Distribution((term,)).density(np.float64(mp.sin(t) ** 2), np.float64(mp.cos(t)))
            assert got == pytest.approx(expected, rel=1e-11, abs=1e-290)


@EACH
def test_facets_project_to_unit_area(of):
    """By Gauss's rule over the bins that facets are drawn from, as they follow D."""
    edges = np.arcsin(np.sqrt(of.bins))
    drawn = [np.linspace(0.0, 1.0, len(one.numbers)) ** 2 * np.pi / 2 for one in of.terms if one.kind == "points"]
    t, weight = panels(np.unique(np.concatenate([edges, *drawn])), 16)
    D = of(spherical(t))
    assert D.shape == t.shape
    assert 2.0 * np.pi * np.sum(D * np.cos(t) * np.sin(t) * weight) == pytest.approx(1.0, abs=1e-9)


def test_one_beckmann_term_is_cook_torrance():
    """f to the rounding of D; the albedo, by another quadrature, to 1e-9."""
    rng = np.random.default_rng(2000)
    wi, wo = (spherical(np.arccos(rng.uniform(0.01, 1.0, 200)), rng.uniform(0.0, 2.0 * np.pi, 200)) for _ in "io")
    for F in (Dielectric(1.5), Conductor((0.3, 0.9, 1.2), (3.6, 2.6, 2.3))):
        for m in (0.01, 0.3, 1.0):
            one, other = Generator(0.0, 1.0, Distribution((Term("beckmann", (m,)),)), F), CookTorrance(m, F)
            np.testing.assert_allclose(one.evaluate(wi, wo), other.evaluate(wi, wo), rtol=1e-11, atol=1e-290)
            np.testing.assert_allclose(albedo(one, VIEWS), albedo(other, VIEWS), rtol=1e-8)


@EACH
def test_it_is_reciprocal_and_no_more_leaves_than_arrives(of):
    """With F = 1, to 89.5 degrees: G2/G1 of a V-groove is at most 1 for any D of unit area."""
    model = Generator(0.0, 1.0, of, WHITE)
    rng = np.random.default_rng(1967)
    wi, wo = (spherical(np.arccos(rng.uniform(0.01, 1.0, 300)), rng.uniform(0.0, 2.0 * np.pi, 300)) for _ in "io")
    f = model.evaluate(wi, wo)
    assert f.shape == (300, 3)
    np.testing.assert_allclose(f, model.evaluate(wo, wi), rtol=1e-11, atol=1e-290)
    found = albedo(model, VIEWS)
    assert (found > 0.0).all()
    assert (found <= 1.0 + 1e-6).all()


@EACH
@pytest.mark.parametrize("degrees", [0.0, 60.0, 85.0])
def test_draws_are_distributed_as_pdf_says(of, degrees):
    """By chi-square; their mean weight is the albedo. Of the lobe alone: the cells of a cosine would not resolve it.

    The density is the same within a bin of facets and jumps between them: head-on at angles that panels begin at;
    elsewhere along curves, so there are more nodes.
    """
    model, wo = Generator(0.0, (0.2, 0.5, 0.7), of, Dielectric(1.5)), viewer(degrees)
    wi, weight = draw(model, wo, 100_000, 2000, list(SUMS.values()).index(of), int(degrees))
    jumps = {"kinks": 2.0 * np.arcsin(np.sqrt(of.bins[of.bins < 0.5]))} if degrees == 0.0 else {"nodes": 16}
    assert chi_square(model, wo, wi, **jumps) > chance(3 * len(SUMS))
    mean, error = weight[:, 1].mean(), weight[:, 1].std() / np.sqrt(len(weight))
    assert abs(mean - albedo(model, wo)[1]) < 4.5 * error  # of 30 tests one in 5000
    assert weight.max() < 8.0


@EACH
def test_no_facet_is_drawn_far_too_rarely(of):
    """D over what it is drawn by, the mirror's largest weight: at most 4, which rules out fireflies."""
    sin2 = np.concatenate([of.bins[:-1] + share * np.diff(of.bins) for share in (1e-9, 0.25, 0.5, 0.75, 1.0 - 1e-9)])
    h = np.stack([np.sqrt(sin2), np.zeros_like(sin2), np.sqrt(1.0 - sin2)], axis=-1)
    assert (of(h) / of.drawn_density(h)).max() < 4.0


@pytest.mark.parametrize("kind", ["beckmann", "ggx", "exponential"])
def test_facets_narrower_than_lobes_may_be_keep_their_light(kind):
    """Slope 1e-4 as 1e-3: the nearest lobes by L1 would have a twentieth of it."""
    narrow, least = (beckmann_terms(Distribution((Term(kind, (m,)),))) for m in (1e-4, 1e-3))
    assert narrow == least
    assert sum(weight for weight, _ in narrow) > 0.8


@pytest.mark.parametrize(
    ("name", "most"),
    [("beckmann", 1e-3), ("ggx", 0.02), ("exponential", 0.02), ("abc", 0.12), ("wide abc", 0.02), ("two slopes", 0.02)],
)
def test_a_few_beckmann_terms_come_near(name, most):
    """L1 distance of D; more terms are never farther; Beckmann's own is found again.

    But for how the absolute value is smoothed in the end: at 1e-3 of D, whose integral is 1.
    """
    of = SUMS[name]
    assert distance(of, beckmann_terms(of)) < most
    found = [distance(of, least_l1(of, count)) for count in (1, 2, 4)]
    assert found[0] + 1e-3 >= found[1]
    assert found[1] + 1e-3 >= found[2]
    if name == "beckmann":
        np.testing.assert_allclose(beckmann_terms(of), [(1.0, 0.2)], rtol=1e-3)


def test_what_fit_renders_has_lambert_and_the_colour():
    """A grey narrow lobe is as Cook-Torrance's fit; its albedo keeps the colour of a tinted one."""
    of = SUMS["beckmann"]
    wi, wo = spherical(0.5, np.pi), spherical(0.45)
    grey, other = Generator(0.2, 0.5, of, Schlick(0.04)), CookTorrance(0.2, Schlick(0.04))
    expected = 0.2 / np.pi + 0.5 * rendered(other, "fit")(wi, wo)
    np.testing.assert_allclose(rendered(grey, "fit")(wi, wo), expected, rtol=2e-3)  # the slope that is found
    tinted = Generator(0.0, (0.1, 0.2, 0.5), of, Schlick(0.5))
    got = rendered(tinted, "fit")(wi, wo)
    np.testing.assert_allclose(got / got[2], [0.2, 0.4, 1.0], rtol=2e-2)


@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (lambda: Term("cauchy", (0.1,)), 'distribution must be one of beckmann, .*points, got "cauchy"'),
        (lambda: Term("abc", (0.1,)), r"abc needs 2 numbers \(B, C\)"),
        (lambda: Term("ggx", (0.0,)), "m of ggx must be between 0.0001 and 10, got 0"),
        (lambda: Term("points", (1.0,) * 65), "points must be 2 to 64 numbers, got 65"),
        (lambda: Term("points", (0.0, 0.0, 1.0)), "points must not all be 0"),
        (lambda: Distribution(()), "a distribution has 1 to 6 terms, got 0"),
        (lambda: Distribution((Term("ggx", (0.1,), 0.0),)), "the weights of a distribution must not all be 0"),
    ],
)
def test_bad_distributions_are_refused(bad, message):
    """In one line, with the numbers."""
    with pytest.raises(ValueError, match=message):
        bad()
