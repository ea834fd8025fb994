# SPDX-License-Identifier: GPL-3.0-or-later
"""What ``sample`` draws is distributed as ``pdf`` says, and weighs f cos / pdf.

Distribution: chi-square over cells of the hemisphere; mean weight: Z-test against the quadrature's albedo. Both at 1 %
for all cases of a test together (Sidak), with fixed seeds.
"""

from __future__ import annotations

import numpy as np
import pytest

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
    vgroove_g1,
    visible_facet,
)
from vgroove.addon.reference.directions import half_vector
from vgroove.lab import sidak

from ..chi_square import CELLS, chi_square, draw, gauss_panels, grid, probabilities, viewer

FRESNEL = Schlick((0.04, 0.5, 1.0))
SLOPES = [0.02, 0.1, 0.3, 0.6, 1.0, 3.0]
VIEWS = [0.0, 30.0, 60.0, 85.0]
ROUGH = [(CookTorrance(m, FRESNEL), view) for m in SLOPES for view in VIEWS]
DIFFUSE = [
    (model, view)
    for model in (Lambert(0.5), OrenNayar(0.5, 0.4), OrenNayar(0.5, 0.4, qualitative=True))
    for view in (0.0, 45.0, 85.0)
]
MIXED = [
    (Sum(OrenNayar(0.5, 0.3), CookTorrance(m, FRESNEL), d, s), view)
    for m, d, s in ((0.1, 0.7, 0.3), (0.4, 0.2, 0.5))
    for view in (0.0, 45.0, 85.0)
]
CASES = [*ROUGH, *DIFFUSE, *MIXED]


def name(case):
    model, view = case
    slope = getattr(getattr(model, "specular", model), "m", "")
    return f"{type(model).__name__}{slope}-{view:g}"


def seed(case):
    """A fixed one for each case."""
    return [1982, CASES.index(case)]


@pytest.mark.parametrize("case", CASES, ids=name)
def test_samples_are_distributed_as_pdf_says(case):
    """2e5 draws in 257 cells, the last of them below the surface."""
    model, view = case
    wo = viewer(view)
    wi, _ = draw(model, wo, 200_000, *seed(case))
    assert wi.shape == (200_000, 3)
    assert chi_square(model, wo, wi) > sidak.chance(len(CASES))


@pytest.mark.parametrize("case", [CASES[1], CASES[7], CASES[14], CASES[19], MIXED[2]], ids=name)
def test_cells_are_integrated_finely_enough(case):
    """Twice the nodes move no cell's expected count by more than a fifth of its standard deviation."""
    model, view = case
    wo = viewer(view)
    grids = grid(model, wo)
    expected = 200_000 * probabilities(model, wo, *grids)
    finer = 200_000 * probabilities(model, wo, *grids, nodes=10)
    assert expected.shape == finer.shape == (CELLS, CELLS)
    assert (np.abs(expected - finer) < 0.2 * np.sqrt(np.maximum(finer, 10.0))).all()


# With d ln p / d ln m = 2 (r^2/m^2 - 1), of variance 4, a slope wrong by e adds N 4 e^2 to chi-square, whose own
# spread is sqrt(2 * 256) = 23: 1280 for 4 % of 2e5 draws, 400 for 1 % of 1e6. Lobes cut off by the horizon show less:
# with m = 3 from 0 and 30 degrees 1 % stays unseen.
@pytest.mark.parametrize("case", ROUGH, ids=name)
def test_chi_square_sees_a_slope_wrong_by_four_percent(case):
    """The test above turns red when the draws come from another m, at every m and view it claims."""
    model, view = case
    wo = viewer(view)
    wi, _ = draw(CookTorrance(model.m * 1.04, FRESNEL), wo, 200_000, *seed(case))
    assert chi_square(model, wo, wi) < sidak.chance(len(CASES))


@pytest.mark.parametrize("case", [ROUGH[1], ROUGH[13]], ids=name)
def test_chi_square_sees_a_slope_wrong_by_one_percent(case):
    """With 1e6 draws also 1 % in m."""
    model, view = case
    wo = viewer(view)
    wi, _ = draw(CookTorrance(model.m * 1.01, FRESNEL), wo, 1_000_000, *seed(case))
    assert chi_square(model, wo, wi) < sidak.chance(len(CASES))
    wi, _ = draw(model, wo, 1_000_000, *seed(case))
    assert chi_square(model, wo, wi) > sidak.chance(len(CASES))


class WithoutDual(CookTorrance):
    """A sampler that forgets the groove's other side."""

    def sample(self, wo, u):
        return super().sample(wo, np.asarray(u) * [1, 1, 1, 0])


class Diluted(CookTorrance):
    """A density that is 1 % too low everywhere, as if D or G1 were."""

    def pdf(self, wi, wo):
        return 0.99 * super().pdf(wi, wo)


@pytest.mark.parametrize("wrong", [WithoutDual, Diluted])
@pytest.mark.parametrize(("m", "view"), [(0.3, 60.0), (0.6, 85.0), (1.0, 60.0)])
def test_chi_square_sees_a_missing_dual_and_a_lost_percent(m, view, wrong):
    """Other mistakes than in m: the dual facet left out, a density that does not add up to 1."""
    model, wo = wrong(m, FRESNEL), viewer(view)
    wi, _ = draw(model, wo, 200_000, 3)
    assert chi_square(model, wo, wi) < sidak.chance(len(CASES))


# --- weights --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("fresnel", [FRESNEL, Dielectric((1.5, 0.5, 3.0)), Conductor(0.2, 3.9)], ids=repr)
@pytest.mark.parametrize("case", ROUGH, ids=name)
def test_rough_weight_is_f_cos_over_pdf(case, fresnel):
    """F G2/G1 of the sampler is what ``evaluate`` and ``pdf`` make of the same direction, to rounding."""
    model, view = CookTorrance(case[0].m, fresnel), case[1]
    wo = viewer(view)
    wi, weight = draw(model, wo, 5_000, *seed(case))
    assert wi.shape == weight.shape == (5_000, 3)
    density = model.pdf(wi, wo)
    assert density.shape == (5_000,)
    inside = density > 1e-290  # a facet out in the tail of D can have none that float64 holds to the last digit
    assert inside.sum() > 500  # m = 3 seen from above sends 9 of 10 draws below the surface
    expected = model.evaluate(wi, wo)[inside] * (wi[inside, 2] / density[inside])[:, None]
    # wi is the rounded mirror image of wo (5 U = 6e-16), so its half vector is h turned by up to 5 U/|wi + wo|. With it
    # v.h = |wi + wo|/2 moves, relatively by up to twice that, and F G by up to 5 times as much as v.h: 50 U/|wi + wo|.
    length = np.linalg.norm(wi[inside] + wo, axis=-1)[:, None]
    allowed = 6e-15 / length
    if isinstance(fresnel, Dielectric):  # next to the critical angle F goes as g, the root of g^2 = c^2 - (1 - eta^2)
        eta = np.asarray(fresnel.eta)
        g = np.sqrt(np.abs(length**2 / 4 - (1 - eta**2)))
        allowed = allowed + np.where(eta < 1, 1e-14 / (g + 1e-8), 0.0)
    assert (np.abs(weight[inside] - expected) <= allowed * expected).all()
    assert (weight[wi[:, 2] <= 0] == 0).all()


@pytest.mark.parametrize("case", [*DIFFUSE, *MIXED], ids=name)
def test_weight_is_f_cos_over_pdf(case):
    """The same for the diffuse models and sums."""
    model, view = case
    wo = viewer(view)
    wi, weight = draw(model, wo, 5_000, *seed(case))
    density = model.pdf(wi, wo)
    assert wi.shape == weight.shape == (5_000, 3)
    assert density.shape == (5_000,)
    inside = density > 0
    expected = model.evaluate(wi, wo)[inside] * (wi[inside, 2] / density[inside])[:, None]
    np.testing.assert_allclose(weight[inside], expected, rtol=1e-15 * 4, atol=0)  # a handful of roundings of 1.1e-16
    assert (weight[~inside] == 0).all()


WEIGHED = [
    *CASES,
    *((Sum(Lambert(0.5), Smooth(Dielectric(1.5)), 0.6, 0.4), view) for view in (0.0, 85.0)),
    *((Sum(OrenNayar(0.5, 0.3), CookTorrance(0.4, FRESNEL), 1.0, 0.8, coupled=True), view) for view in (0.0, 85.0)),
    (Sum(Lambert(0.5), Smooth(Dielectric(1.5)), 1.0, 1.0, coupled=True), 85.0),
]


@pytest.mark.parametrize("index", range(len(WEIGHED)), ids=[name(case) for case in WEIGHED])
def test_mean_weight_is_the_albedo(index):
    """Over 1e5 draws, each channel, within the spread of the mean (Z-test)."""
    model, view = WEIGHED[index]
    wo = viewer(view)
    _, weight = draw(model, wo, 100_000, 11, index)
    assert weight.shape == (100_000, 3)
    expected = albedo(model, wo)
    assert expected.shape == (3,)
    spread = weight.std(axis=0) / np.sqrt(len(weight))
    limit = sidak.limit(3 * len(WEIGHED))
    # Rounding of the mean and the quadrature's 1e-6 for constant weights (Lambert: all draws weigh the same).
    assert (np.abs(weight.mean(axis=0) - expected) < limit * spread + 1e-6 * expected).all()


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_mean_weight_shows_a_percent_in_the_weight(factor):
    """The Z-test above turns red when every weight is 1 % off, as with 1 % in G2/G1."""
    model, wo = CookTorrance(0.6, FRESNEL), viewer(60.0)
    _, weight = draw(model, wo, 200_000, 5)
    spread = weight.std(axis=0) / np.sqrt(len(weight))
    limit = sidak.limit(3 * len(WEIGHED))
    assert (np.abs(factor * weight.mean(axis=0) - albedo(model, wo)) > limit * spread)[1:].all()


# --- facets ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("m", [0.1, 0.6])
@pytest.mark.parametrize("view", [0.0, 60.0, 85.0])
def test_visible_facets_have_the_moments_of_their_density(m, view):
    """Mean of n.h and of x under G1 D (v.h)+/(n.v), integrated over slopes here, against 2e5 facets."""
    wo = viewer(view)
    h = visible_facet(np.broadcast_to(wo, (200_000, 3)), m, np.random.default_rng([4, int(view)]).random((200_000, 3)))
    assert h.shape == (200_000, 3)
    np.testing.assert_allclose(np.linalg.norm(h, axis=-1), 1.0, rtol=5e-16)
    assert (h @ wo > 0).all()
    theta, theta_weight = gauss_panels(np.arctan(m * np.linspace(0, 7, 40)), 8)
    phi, phi_weight = gauss_panels(np.linspace(-np.pi, np.pi, 40), 8)
    facet = spherical(theta[:, None], phi)
    seen = np.maximum(facet @ wo, 0.0)
    density = vgroove_g1(wo, facet) * beckmann_d(facet, m) * seen / wo[2]
    mass = density * (theta_weight * np.sin(theta))[:, None] * phi_weight
    assert mass.shape == (theta.size, phi.size)
    assert mass.sum() == pytest.approx(1.0, abs=1e-4)  # kinks at v.h = 0 and G1 = 1 cross the panels
    for quantity in (lambda w: w[..., 2], lambda w: w[..., 0], lambda w: w[..., 0] ** 2):
        values = quantity(h)
        expected = np.sum(quantity(facet) * mass)
        limit = sidak.limit(18)
        assert abs(values.mean() - expected) < limit * values.std() / np.sqrt(len(values)) + 1e-4 * m


def test_mirrored_samples_have_their_facet_as_half_vector():
    """wi is the mirror image about the facet drawn, for views from any side."""
    rng = np.random.default_rng(6)
    wo = spherical(rng.uniform(0, 1.5, 1000), rng.uniform(0, 6, 1000))
    u = rng.random((1000, 4))
    wi, _ = CookTorrance(0.2, FRESNEL).sample(wo, u)
    h = visible_facet(wo, 0.2, u[:, 1:])
    up = wi[:, 2] > 0
    assert up.sum() > 800
    length = np.linalg.norm(wi[up] + wo[up], axis=-1)[:, None]
    assert (
        np.abs(half_vector(wi[up], wo[up]) - h[up]) < 1e-15 / length
    ).all()  # wi and the sum: 4 roundings of 1.1e-16


def test_samples_broadcast():
    """Views and random numbers broadcast over all but the last axis."""
    for model in (CookTorrance(0.3, FRESNEL), OrenNayar(0.5, 0.3), Smooth(FRESNEL), MIXED[0][0]):
        wi, weight = model.sample(np.broadcast_to(viewer(30.0), (4, 1, 3)), np.full((5, 4), 0.3))
        assert wi.shape == weight.shape == (4, 5, 3)
        single, one = model.sample(viewer(30.0), [0.3] * 4)
        np.testing.assert_allclose(wi, np.broadcast_to(single, (4, 5, 3)), rtol=1e-15)
        np.testing.assert_allclose(weight, np.broadcast_to(one, (4, 5, 3)), rtol=1e-15)
