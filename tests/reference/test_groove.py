# SPDX-License-Identifier: GPL-3.0-or-later
"""The walk within a V-groove: it loses no light, its first bounce is Cook & Torrance's, and mirrors lead it."""

import numpy as np
import pytest

from vgroove.addon.reference import CookTorrance, Schlick, groove, spherical
from vgroove.addon.reference.cook_torrance import visible_facet
from vgroove.addon.reference.directions import reflect
from vgroove.addon.reference.distributions import vgroove_g
from vgroove.addon.reference.groove import Groove, bounce_albedos, exits, further
from vgroove.lab.sidak import limit

WHITE, COLOURED = Schlick(1.0), Schlick((0.95, 0.6, 0.2))
SLOPES, VIEWS = (0.05, 0.3, 0.7, 1.0, 3.0), (0.0, 30.0, 60.0, 85.0, 89.0)


def seen(m, theta, count=4000, seed=1):
    """A view, and facets that it sees, (count, 3)."""
    wo = np.broadcast_to(spherical(np.radians(theta), 0.7), (count, 3))
    return wo, visible_facet(wo, m, np.random.default_rng(seed).random((count, 3)))


@pytest.mark.parametrize("m", SLOPES)
@pytest.mark.parametrize("theta", VIEWS)
def test_perfect_mirrors_send_back_all_light(m, theta):
    """Sample by sample, upward; and the shares of all ways out add up to 1. To a few roundings."""
    wo, h = seen(m, theta)
    wi, weight = Groove(m, WHITE).sample(wo, np.random.default_rng(2).random((len(wo), 4)))
    np.testing.assert_allclose(weight, 1.0, rtol=1e-14)
    np.testing.assert_allclose(np.linalg.norm(wi, axis=-1), 1.0, rtol=1e-14)
    assert (wi[:, 2] > 0.0).all()
    ways = list(exits(wo, h))
    np.testing.assert_allclose(sum(one.share for one in ways), 1.0, rtol=1e-13)
    assert all((one.share >= 0.0).all() for one in ways)


@pytest.mark.parametrize("m", SLOPES)
def test_there_are_no_more_bounces_than_the_groove_has_room_for(m):
    """A straight line turns by less than half a turn around the bottom, where each copy takes the groove's angle."""
    for theta in VIEWS:
        wo, h = seen(m, theta)
        most = np.pi / (np.pi - 2.0 * np.arccos(h[:, 2])) + 1.0
        for one in exits(wo, h):
            assert (one.bounces <= most[one.share > 1e-12]).all()


@pytest.mark.parametrize("m", SLOPES)
@pytest.mark.parametrize("theta", VIEWS)
def test_the_first_bounce_is_that_of_the_paper(m, theta):
    """What leaves after one bounce is min(G1(v), G1(l)) of the facet: the paper's G. Rounding grows by 1/G1."""
    wo, h = seen(m, theta)
    one = next(exits(wo, h))
    wi = reflect(wo, h)
    np.testing.assert_allclose(one.wi, wi, atol=1e-14)
    G1 = groove.vgroove_g1(wo, h)
    np.testing.assert_allclose(
        one.share * G1, vgroove_g(np.where(wi[:, 2:] > 0.0, wi, wo), wo) * (wi[:, 2] > 0.0), atol=1e-13
    )


def traced(wo, h, s):
    """Bounces (N,), wi (N, 3) and what ``COLOURED`` facets leave, by tracing rays from facet to facet.

    s: distance of the first point from the groove's bottom.
    """
    dual = h * [-1.0, -1.0, 1.0]
    aside = np.hypot(h[:, 0], h[:, 1])[:, None]
    flat = h * [1.0, 1.0, 0.0] / aside

    def top(normal, sign):  # of a facet of length 1, the bottom at the origin
        return aside * [0.0, 0.0, 1.0] - sign * normal[:, 2:] * flat

    facets = [(h, top(h, 1.0)), (dual, top(dual, -1.0))]
    place, wi, bounces = s[:, None] * facets[0][1], reflect(wo, h), np.ones(len(wo), int)
    live, left = np.ones(len(wo), bool), COLOURED(np.einsum("ij,ij->i", wo, h))
    for turn in range(1, 200):
        normal, upward = facets[turn % 2]
        toward = np.einsum("ij,ij->i", wi, normal)
        way = -np.einsum("ij,ij->i", place, normal) / np.where(toward < 0.0, toward, -1.0)
        at = place + way[:, None] * wi
        along = np.einsum("ij,ij->i", at, upward)
        live &= (toward < 0.0) & (along < 1.0)
        if not live.any():
            return bounces, wi, left
        place = np.where(live[:, None], at, place)
        left = left * np.where(live[:, None], COLOURED(np.clip(-toward, 0.0, 1.0)), 1.0)
        wi = np.where(live[:, None], reflect(-wi, normal), wi)
        bounces = bounces + live
    raise AssertionError


@pytest.mark.parametrize("m", [0.3, 1.0, 3.0])
@pytest.mark.parametrize("theta", [0.0, 30.0, 60.0, 85.0])
def test_the_unfolded_line_goes_where_mirrors_lead_it(m, theta):
    """Against a ray traced from facet to facet, at random places of each facet that are seen."""
    wo, h = seen(m, theta)
    place = np.random.default_rng(3).random(len(wo))
    s = 1.0 - groove.vgroove_g1(wo, h) * place  # the upper part is seen
    bounces, wi, left = traced(wo, h, s)
    before, off = np.zeros(len(wo)), 0
    for one in exits(wo, h):
        here = (place >= before) & (place < before + one.share)
        off += np.sum(here & (bounces != one.bounces))
        same = here & (bounces == one.bounces)
        np.testing.assert_allclose(one.wi[same], wi[same], atol=1e-9)
        np.testing.assert_allclose(one.mirrored(COLOURED)[same], left[same], rtol=1e-6)
        before = before + one.share
    assert off <= 2  # rays that just touch an edge


@pytest.mark.parametrize("bounces", [1, 2, 3, 4, 5])
def test_each_bounce_is_reciprocal(bounces):
    """f_k(wi, wo) = f_k(wo, wi), and the first is the model itself."""
    w = np.random.default_rng(4).normal(size=(2, 2000, 3))
    w[..., 2] = np.abs(w[..., 2]) + 0.02
    wi, wo = w / np.linalg.norm(w, axis=-1, keepdims=True)
    f = further(wi, wo, 0.8, COLOURED, bounces)
    assert f.max() > 0.0
    np.testing.assert_allclose(f, further(wo, wi, 0.8, COLOURED, bounces), rtol=1e-9, atol=1e-12)
    if bounces == 1:
        np.testing.assert_allclose(f, CookTorrance(0.8, COLOURED).evaluate(wi, wo), rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("m", [0.3, 0.7, 1.0])
@pytest.mark.parametrize("theta", [20.0, 60.0])
def test_samples_go_where_the_formula_says(m, theta):
    """Counts in cells of the disc (x, y) against the integral of f, by Z-tests; not at the mirror image, where f is
    infinite, and not at the rim. 20 x 20 points a cell; what they miss of f's corners is 2 % of a cell at most, and
    1 % of all cells together, which chance moves by 0.3 %."""
    wo = spherical(np.radians(theta), 0.0)
    count, cells, points = 200_000, 8, 20
    wi, _ = Groove(m, WHITE).sample(np.broadcast_to(wo, (count, 3)), np.random.default_rng(5).random((count, 4)))
    edges = np.linspace(-1.0, 1.0, cells + 1)
    counts, _, _ = np.histogram2d(wi[:, 0], wi[:, 1], bins=(edges, edges))
    x, y = np.meshgrid(*[(np.arange(cells * points) + 0.5) * 2.0 / cells / points - 1.0] * 2, indexing="ij")
    inside = x * x + y * y < 0.999
    light = np.stack([x, y, np.sqrt(np.where(inside, 1.0 - x * x - y * y, 1.0))], axis=-1)
    light = np.where(inside[..., None], light, [0.0, 0.0, 1.0])
    f = np.where(inside, np.nan_to_num(Groove(m, WHITE).evaluate(light, wo)[..., 0], posinf=0.0), 0.0)
    blocks = (cells, points, cells, points)
    expected = f.reshape(blocks).sum(axis=(1, 3)) * (2.0 / cells / points) ** 2 * count
    whole = inside.reshape(blocks).all(axis=(1, 3))
    centre = (edges[1:] + edges[:-1]) / 2.0
    far = np.hypot(centre[:, None] + wo[0], centre[None, :] + wo[1]) > 0.3
    use = whole & far & (expected > 25.0)
    assert use.sum() > 5
    error = np.sqrt(expected + (0.02 * expected) ** 2)
    assert np.abs((counts - expected)[use] / error[use]).max() < limit(use.sum() * 6)
    assert counts[use].sum() == pytest.approx(expected[use].sum(), rel=0.01)


@pytest.mark.parametrize("m", [0.3, 0.7, 1.0])
@pytest.mark.parametrize("theta", [20.0, 70.0])
def test_albedos_are_means_of_the_walk(m, theta):
    """Of every channel, and of what bounced once alone, by Z-tests; of F = 1 it is 1."""
    wo, count = spherical(np.radians(theta), 0.3), 200_000
    views = np.broadcast_to(wo, (count, 3))
    u = np.random.default_rng(6).random((count, 4))
    _, weight = Groove(m, COLOURED).sample(views, u)
    z = (weight.mean(axis=0) - Groove(m, COLOURED).directional_albedo(wo)) / weight.std(axis=0) * np.sqrt(count)
    assert np.abs(z).max() < limit(6 * 4)
    once = (u[:, 0] < next(exits(views, visible_facet(views, m, u[:, 1:]))).share).mean()
    E = CookTorrance(m, WHITE).directional_albedo(wo)[0]
    assert abs(once - E) / np.sqrt(E * (1.0 - E) / count) < limit(6 * 4)
    # Gauss's rules meet the corners of the shares anywhere: 1e-4 of them is lost at most
    np.testing.assert_allclose(bounce_albedos(wo, m, WHITE).sum(axis=-2), 1.0, atol=1e-4)


def test_more_bounces_saturate():
    """Copper's further light is of a deeper colour than its first: at least F^2 of the facets head-on, and below F."""
    F0 = np.array([0.95, 0.64, 0.54])
    by_bounce = bounce_albedos(spherical(0.3, 0.0), 0.7, Schlick(F0))
    white = bounce_albedos(spherical(0.3, 0.0), 0.7, WHITE)
    again = by_bounce[1] / white[1]
    assert (again >= F0**2).all()
    assert (again < F0).all()
