# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input is turned away with a ValueError that names the argument, the value and what is allowed."""

from __future__ import annotations

import re

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
    cook_torrance,
    fresnel_conductor,
    fresnel_dielectric,
    oren_nayar,
    reflect,
    schlick,
    smith_g,
    spherical,
    vgroove_g,
    vgroove_g1,
)
from vgroove.addon.reference.directions import as_directions, as_pair, half_vector

UP = [0.0, 0.0, 1.0]
HALF = [0.5] * 4
ROUGH = CookTorrance(0.3, Schlick(0.5))
MODELS = [
    ROUGH,
    Smooth(Dielectric(1.5)),
    OrenNayar(0.5, 0.3),
    OrenNayar(0.5, 0.3, qualitative=True),
    Lambert(0.5),
    Sum(Lambert(0.5), ROUGH, 0.5, 0.5),
]
BY_NAME = [type(model).__name__ for model in MODELS]

BAD_DIRECTIONS = [
    (1.0, "must have shape (..., 3), got ()"),
    ([0.0, 1.0], "must have shape (..., 3), got (2,)"),
    ([[0.0, 0.0, 1.0, 0.0]], "must have shape (..., 3), got (1, 4)"),
    ([], "must have shape (..., 3), got (0,)"),
    ([0.0, 0.0, 2.0], "must have length 1 to within 1e-06, got length 2"),
    ([0.0, 0.0, 0.0], "must have length 1 to within 1e-06, got length 0"),
    ([0.0, 0.0, 1.0 + 2e-6], "must have length 1 to within 1e-06, got length 1.000002"),
    ([0.0, 0.0, 1.0 - 2e-6], "must have length 1 to within 1e-06, got length 0.999998"),
    ([[0.0, 0.0, 1.0], [0.0, 3.0, 4.0]], "must have length 1 to within 1e-06, got length 5"),
    ([0.0, 0.0, np.nan], "must be finite, got nan"),
    ([0.0, 0.0, np.inf], "must be finite, got inf"),
    ([0.0, -np.inf, 1.0], "must be finite, got -inf"),
    ("up", "must be numbers, got 'up'"),
    (["0", "0", "1"], "must be numbers, got ['0', '0', '1']"),
    (None, "must be numbers, got None"),
    ([0.0, None, 1.0], "must be numbers, got [0.0, None, 1.0]"),
    ([0.0, 0.0, 1j], "must be numbers, got [0.0, 0.0, 1j]"),
    ([[0.0, 0.0, 1.0], [0.0]], "must be numbers, got [[0.0, 0.0, 1.0], [0.0]]"),
    ({"x": 1}, "must be numbers, got {'x': 1}"),
]

# Functions of one direction and the name they give it.
TAKES_DIRECTION = [
    ("h", lambda w: beckmann_d(w, 0.3)),
    ("wi", lambda w: vgroove_g(w, UP)),
    ("wo", lambda w: vgroove_g(UP, w)),
    ("wo", lambda w: vgroove_g1(w, UP)),
    ("h", lambda w: vgroove_g1(UP, w)),
    ("wi", lambda w: smith_g(w, UP, 0.3)),
    ("wo", lambda w: smith_g(UP, w, 0.3)),
    ("wi", lambda w: cook_torrance(w, UP, 0.3, Schlick(0.5))),
    ("wo", lambda w: cook_torrance(UP, w, 0.3, Schlick(0.5))),
    ("wi", lambda w: oren_nayar(w, UP, 0.5, 0.3)),
    ("wo", lambda w: oren_nayar(UP, w, 0.5, 0.3)),
]


def refuses(text):
    """Expects a ValueError with exactly this message."""
    return pytest.raises(ValueError, match=f"^{re.escape(text)}$")


@pytest.mark.parametrize(("bad", "complaint"), BAD_DIRECTIONS, ids=repr)
@pytest.mark.parametrize(("name", "function"), TAKES_DIRECTION)
def test_functions_refuse_bad_directions(name, function, bad, complaint):
    """Wrong shapes, lengths and kinds of direction."""
    with refuses(f"{name} {complaint}"):
        function(bad)


@pytest.mark.parametrize(("bad", "complaint"), BAD_DIRECTIONS, ids=repr)
@pytest.mark.parametrize("model", MODELS, ids=BY_NAME)
def test_models_refuse_bad_directions(model, bad, complaint):
    """The same for every method of every model."""
    for method in (model.evaluate, model.pdf):
        with refuses(f"wi {complaint}"):
            method(bad, UP)
        with refuses(f"wo {complaint}"):
            method(UP, bad)
    with refuses(f"wo {complaint}"):
        model.sample(bad, HALF)
    with refuses(f"wo {complaint}"):
        albedo(model, bad)


@pytest.mark.parametrize("model", MODELS, ids=BY_NAME)
def test_models_refuse_directions_that_do_not_broadcast(model):
    """Two against three directions."""
    for method in (model.evaluate, model.pdf):
        with refuses("wi and wo must broadcast, got shapes (2, 3) and (3, 3)"):
            method([UP] * 2, [UP] * 3)
    with refuses("wo and u must broadcast, got shapes (2, 3) and (3, 4)"):
        model.sample([UP] * 2, [HALF] * 3)


@pytest.mark.parametrize(
    ("bad", "complaint"),
    [
        ([0.5, 0.5, 0.5, 1.0], "must be in [0, 1), got 1"),
        ([0.5, 0.5, 0.5, 1.0 + 1e-9], "must be between 0 and 1, got 1.000000001"),
        ([0.5, -0.1, 0.5, 0.5], "must be between 0 and 1, got -0.1"),
        ([0.5, np.nan, 0.5, 0.5], "must be finite, got nan"),
        ([np.inf, 0.5, 0.5, 0.5], "must be finite, got inf"),
        ([0.5, 0.5, 0.5], "must have shape (..., 4), got (3,)"),
        (0.5, "must have shape (..., 4), got ()"),
        ([[0.5] * 5], "must have shape (..., 4), got (1, 5)"),
        ("random", "must be numbers, got 'random'"),
        (None, "must be numbers, got None"),
    ],
    ids=repr,
)
@pytest.mark.parametrize("model", MODELS, ids=BY_NAME)
def test_sample_refuses_bad_random_numbers(model, bad, complaint):
    """u is in [0, 1) and ends in 4."""
    with refuses(f"u {complaint}"):
        model.sample(UP, bad)


BAD_SLOPES = [
    (0.0, "must be greater than 0, got 0"),
    (-0.3, "must be greater than 0, got -0.3"),
    (-5e-324, "must be greater than 0, got -4.94066e-324"),
    ([0.3, 0.0], "must be greater than 0, got 0"),
    (1e-101, "must be between 1e-100 and 1000000, got 1e-101"),
    (2e6, "must be between 1e-100 and 1000000, got 2000000"),
    (np.nan, "must be finite, got nan"),
    (np.inf, "must be finite, got inf"),
    ("0.3", "must be numbers, got '0.3'"),
    (None, "must be numbers, got None"),
]


@pytest.mark.parametrize(("bad", "complaint"), BAD_SLOPES, ids=repr)
def test_m_is_refused_unless_greater_than_0(bad, complaint):
    """A mirror has no facet density; the model says so when it is made."""
    for make in (
        lambda m: CookTorrance(m, Schlick(0.5)),
        lambda m: beckmann_d(UP, m),
        lambda m: smith_g(UP, UP, m),
        lambda m: cook_torrance(UP, UP, m, Schlick(0.5)),
    ):
        with refuses(f"m {complaint}"):
            make(bad)


NOT_NUMBERS = [
    (np.nan, "must be finite, got nan"),
    (-np.inf, "must be finite, got -inf"),
    ("0.5", "must be numbers, got '0.5'"),
    (None, "must be numbers, got None"),
]
NOT_RGB = [([0.5, 0.5], "must be one number or have shape (..., 3), got (2,)")]
NOT_SHARES = [
    *NOT_NUMBERS,
    (-0.1, "must be between 0 and 1, got -0.1"),
    (1.1, "must be between 0 and 1, got 1.1"),
    (1.0000001, "must be between 0 and 1, got 1.0000001"),
]


def in_a_colour(cases):
    """The same bad number as one of three channels."""
    return [([0.5, bad, 0.5], complaint) for bad, complaint in cases if isinstance(bad, float)]


@pytest.mark.parametrize(("bad", "complaint"), [*NOT_SHARES, *NOT_RGB, *in_a_colour(NOT_SHARES)], ids=repr)
def test_reflectances_are_refused_outside_0_to_1(bad, complaint):
    """F0 and albedo, one number or a colour."""
    with refuses(f"f0 {complaint}"):
        Schlick(bad)
    for make in (Lambert, lambda x: OrenNayar(x, 0.3), lambda x: oren_nayar(UP, UP, x, 0.3)):
        with refuses(f"albedo {complaint}"):
            make(bad)


@pytest.mark.parametrize(("bad", "complaint"), [*NOT_SHARES, *in_a_colour(NOT_SHARES)], ids=repr)
def test_schlick_refuses_f0_outside_0_to_1(bad, complaint):
    """The plain function too."""
    with refuses(f"f0 {complaint}"):
        schlick(0.5, bad)


BAD_ETAS = [
    *NOT_NUMBERS,
    (0.0, "must be greater than 0, got 0"),
    (-1.5, "must be greater than 0, got -1.5"),
    (1e51, "must be between 1e-50 and 1e+50, got 1e+51"),
]


@pytest.mark.parametrize(("bad", "complaint"), [*BAD_ETAS, *in_a_colour(BAD_ETAS)], ids=repr)
def test_eta_is_refused_unless_greater_than_0(bad, complaint):
    """A ratio of indices."""
    for make in (Dielectric, lambda x: fresnel_dielectric(0.5, x)):
        with refuses(f"eta {complaint}"):
            make(bad)


def test_eta_is_refused_unless_one_number_or_a_colour():
    """Two channels are none."""
    with refuses("eta must be one number or have shape (..., 3), got (2,)"):
        Dielectric([1.5, 1.5])


BAD_INDICES = [
    *NOT_NUMBERS,
    (-0.1, "must be between 0 and 1e+50, got -0.1"),
    (1e51, "must be between 0 and 1e+50, got 1e+51"),
]


@pytest.mark.parametrize(("bad", "complaint"), [*BAD_INDICES, *in_a_colour(BAD_INDICES)], ids=repr)
def test_n_and_k_are_refused_below_0(bad, complaint):
    """Both parts of the complex index."""
    for make in (Conductor, lambda n, k: fresnel_conductor(0.5, n, k)):
        with refuses(f"n {complaint}"):
            make(bad, 1.0)
        with refuses(f"k {complaint}"):
            make(1.0, bad)


@pytest.mark.parametrize(("n", "k"), [(0.0, 0.0), ([1.0, 0.0, 1.0], 0.0), (0.0, [1.0, 1.0, 0.0])])
def test_n_and_k_are_refused_when_both_are_0(n, k):
    """No medium has that index, in no channel."""
    for make in (Conductor, lambda n, k: fresnel_conductor(0.5, n, k)):
        with refuses("n and k must not both be 0 (no medium has that index), got n = 0, k = 0"):
            make(n, k)


@pytest.mark.parametrize(
    ("bad", "complaint"),
    [
        *NOT_NUMBERS,
        (1.1, "must be between -1.000001 and 1.000001, got 1.1"),
        (-1.1, "must be between -1.000001 and 1.000001, got -1.1"),
    ],
)
def test_cosines_are_refused_beyond_rounding(bad, complaint):
    """v.h of unit vectors."""
    for function in (
        lambda c: schlick(c, 0.5),
        lambda c: fresnel_dielectric(c, 1.5),
        lambda c: fresnel_conductor(c, 1.5, 1.0),
        Schlick(0.5),
        Dielectric(1.5),
        Conductor(1.5, 1.0),
    ):
        with refuses(f"cos {complaint}"):
            function(bad)


@pytest.mark.parametrize(
    ("bad", "complaint"),
    [
        *NOT_NUMBERS,
        (-0.1, "must be between 0 and 1.5707963267949, got -0.1"),
        (1.5708, "must be between 0 and 1.5707963267949, got 1.5708"),
        (20.0, "must be between 0 and 1.5707963267949, got 20"),
    ],
)
def test_sigma_is_refused_outside_a_quarter_turn(bad, complaint):
    """Radians; whoever passes degrees hears of it."""
    for make in (lambda s: OrenNayar(0.5, s), lambda s: oren_nayar(UP, UP, 0.5, s)):
        with refuses(f"sigma {complaint}"):
            make(bad)


@pytest.mark.parametrize(("bad", "complaint"), NOT_SHARES, ids=repr)
def test_sum_refuses_weights_outside_0_to_1(bad, complaint):
    """d and s each."""
    with refuses(f"d {complaint}"):
        Sum(Lambert(0.5), ROUGH, bad, 0.0)
    with refuses(f"s {complaint}"):
        Sum(Lambert(0.5), ROUGH, 0.0, bad)


@pytest.mark.parametrize(("d", "s", "got"), [(0.6, 0.5, "0.6 + 0.5"), (0.5, 0.5000001, "0.5 + 0.5000001")])
def test_sum_refuses_weights_above_1_together(d, s, got):
    """More light would leave than arrives."""
    with refuses(f"d + s must be at most 1 (more light would leave than arrives), got {got}"):
        Sum(Lambert(0.5), ROUGH, d, s)


@pytest.mark.parametrize(("d", "s"), [(0.0, 0.0), (1.0, 0.0), (0.3, 0.7), (0.1 + 0.2, 0.7), (0.5, 0.2)])
def test_sum_takes_weights_up_to_1_together(d, s):
    """Decimals whose binary sum is 1 to rounding are welcome: .1 + .2 + .7 is 1.0000000000000002 in float64."""
    assert Sum(Lambert(0.5), ROUGH, d, s).evaluate(UP, UP).shape == (3,)


@pytest.mark.parametrize("name", ["theta", "phi"])
@pytest.mark.parametrize(("bad", "complaint"), NOT_NUMBERS)
def test_spherical_refuses_what_is_no_angle(name, bad, complaint):
    """Both angles."""
    with refuses(f"{name} {complaint}"):
        spherical(**{"theta": 0.5, name: bad})


@pytest.mark.parametrize("off", [9e-7, -9e-7, 1e-12])
def test_directions_within_1e_6_are_scaled_to_unit_length(off):
    """A direction off by float32's rounding is taken, and counts as the unit vector it means."""
    unit = spherical([0.3, 1.2], [0.4, 2.0])
    got = as_directions(unit * (1 + off), "wi")
    assert got.shape == (2, 3)
    np.testing.assert_allclose(got, unit, rtol=4e-16)  # a product, a length and a quotient: three roundings of 1.1e-16


def test_unit_directions_are_taken_as_they_stand():
    """float64 unit vectors are not scaled: it would cost the digits that narrow lobes need."""
    unit = spherical(np.linspace(0, np.pi / 2, 1001), np.linspace(0, 50, 1001))
    got = as_directions(unit, "wi")
    assert got.shape == (1001, 3)
    assert (got == unit).all()


def test_integers_and_float32_are_taken_as_float64():
    """Results are float64 whatever comes in."""
    assert as_directions([0, 0, 1], "wi").dtype == np.float64
    assert as_directions(np.array([0, 0.6, 0.8], dtype=np.float32), "wi").dtype == np.float64


@pytest.mark.parametrize(
    ("left", "right", "shape"),
    [
        ((3,), (3,), (3,)),
        ((5, 3), (3,), (5, 3)),
        ((3,), (5, 3), (5, 3)),
        ((4, 1, 3), (5, 3), (4, 5, 3)),
        ((0, 3), (3,), (0, 3)),
    ],
)
def test_directions_broadcast(left, right, shape):
    """wi and wo broadcast over all but the last axis; so does every method of every model."""
    wi, wo = np.broadcast_to(spherical(0.4), left), np.broadcast_to(spherical(0.7, 2.0), right)
    assert [w.shape for w in as_pair(wi, wo)] == [shape, shape]
    for model in MODELS:
        assert model.evaluate(wi, wo).shape == shape
        assert model.pdf(wi, wo).shape == shape[:-1]
        assert albedo(model, wo).shape == right
        drawn, weight = model.sample(wo, HALF)
        assert drawn.shape == weight.shape == right


def test_half_vector_halves_the_angle():
    """h lies between wi and wo, of unit length; the normal where one of them is not above the surface."""
    theta = np.array([-1.2, 0.0, 0.3, 1.1])
    wi, wo = spherical(theta[:, None]), spherical(theta)
    h = half_vector(*as_pair(wi, wo))
    assert h.shape == (4, 4, 3)
    np.testing.assert_allclose(h, spherical((theta[:, None] + theta) / 2), atol=4e-16)
    assert half_vector(np.array([1.0, 0.0, 0.0]), np.array(UP)).tolist() == UP
    assert half_vector(np.array([0.0, 0.0, -1.0]), np.array(UP)).tolist() == UP


def test_reflect_mirrors_about_the_facet():
    """The mirrored direction has the facet normal as its half vector, and mirrors back."""
    wo, h = spherical(0.9, 0.3), spherical([0.0, 0.2, 0.5], [0.0, 1.0, 4.0])
    wi = reflect(wo, h)
    assert wi.shape == (3, 3)
    np.testing.assert_allclose(np.linalg.norm(wi, axis=-1), 1.0, rtol=4e-16)
    np.testing.assert_allclose(np.sum(wi * h, axis=-1), np.sum(wo * h, axis=-1), atol=1e-15)
    np.testing.assert_allclose(reflect(wi, h), np.broadcast_to(wo, (3, 3)), atol=2e-15)


@pytest.mark.parametrize("phi", [0.0, 1.0, -2.0])
def test_spherical_measures_from_the_normal(phi):
    """theta from z, phi from x; broadcast over both."""
    theta = np.array([[0.0], [0.4], [np.pi / 2]])
    w = spherical(theta, [phi, phi])
    assert w.shape == (3, 2, 3)
    np.testing.assert_allclose(np.arccos(w[..., 2]), np.broadcast_to(theta, (3, 2)), atol=3e-16)
    np.testing.assert_allclose(np.arctan2(w[1:, :, 1], w[1:, :, 0]), phi, atol=3e-16)
