# SPDX-License-Identifier: GPL-3.0-or-later
"""Phong and Blinn-Phong against mpmath, their exact scale, sampling, and how near ``closure`` comes."""

import numpy as np
import pytest
from mpmath import mp, mpf, workdps

from vgroove.addon.reference import albedo, rendered, spherical
from vgroove.addon.reference.directions import half_vector
from vgroove.addon.reference.phong import BlinnPhong, Phong
from vgroove.addon.reference.quadrature import diffuse_albedo, panels
from vgroove.lab.sidak import chance

from ..chi_square import chi_square, draw, viewer

BOTH = pytest.mark.parametrize("model", [Phong, BlinnPhong])
EXPONENTS = (0.0, 0.5, 3.0, 50.0, 1e4)
VIEWS = spherical(np.radians([0.0, 20.0, 45.0, 60.0, 75.0, 85.0, 89.5]))
U = 2.0**-53


def exact_lobe(model, wi, wo, n):
    """At 50 digits, from the cosine itself."""
    wi, wo = ([mpf(float(part)) for part in w] for w in (wi, wo))
    if model is Phong:
        scale, a, b = (n + 2) / (2 * mp.pi), wi, [-wo[0], -wo[1], wo[2]]
    else:
        scale = (n + 2) * (n + 4) / (8 * mp.pi * (mpf(2) ** (-n / 2) + n))
        a, b = [x + y for x, y in zip(wi, wo, strict=True)], [mpf(0), mpf(0), mpf(1)]
    lengths = mp.sqrt(sum(x * x for x in a) * sum(x * x for x in b))
    cosine = sum(x * y for x, y in zip(a, b, strict=True)) / lengths
    return scale * cosine**n if cosine > 0 else mpf(0)


@BOTH
@pytest.mark.parametrize("n", EXPONENTS)
def test_the_lobe_is_the_formula(model, n):
    """Within (8n + 30 + 4n/cos) 2^-53: so is log f moved by 3.5 of these in each component and 4 in the cosine."""
    rng = np.random.default_rng(1975)
    wo = spherical(np.arccos(rng.uniform(0.01, 1.0, 60)), rng.uniform(0, 2 * np.pi, 60))
    near, far = wo * [-1.0, -1.0, 1.0] + rng.normal(0.0, 1.0 / np.sqrt(n + 2.0), wo.shape), rng.normal(size=wo.shape)
    for wi in (near, far):
        wi = wi / np.linalg.norm(wi, axis=-1, keepdims=True) * np.sign(wi[:, 2:])  # noqa: PLW2901
        got = model(0.0, 1.0, n).lobe(wi, wo)
        assert got.shape == (60,)
        with workdps(50):
            expected = np.array([float(exact_lobe(model, i, o, mpf(n))) for i, o in zip(wi, wo, strict=True)])
        cosine = np.abs(np.sum(wi * wo * [-1.0, -1.0, 1.0], axis=-1)) if model is Phong else half_vector(wi, wo)[:, 2]
        allowed = (8.0 * n + 30.0 + 4.0 * n / cosine) * U
        assert (np.abs(got - expected) <= allowed * expected + 1e-290).all()


@BOTH
@pytest.mark.parametrize("n", [0.0, 1.0, 7.5, 50.0, 1e4])
def test_the_lobe_sends_back_all_of_it_head_on(model, n):
    """For every exponent: by mpmath's own quadrature of the formula, and by the reference's."""
    turn = 1 if model is Phong else 2  # the half vector turns half as far
    with workdps(30):
        scale = exact_lobe(model, (0, 0, 1), (0, 0, 1), mpf(n))
        wide = [0, *(turn * k / mp.sqrt(mpf(n) + 1) for k in (1, 3, 8) if turn * k / mp.sqrt(n + 1) < 1.5), mp.pi / 2]
        whole = mp.quad(lambda t: 2 * mp.pi * scale * mp.cos(t / turn) ** n * mp.cos(t) * mp.sin(t), wide)
        assert abs(whole - 1) < mpf("1e-14")
    np.testing.assert_allclose(albedo(model(0.0, 1.0, n), VIEWS[0]), 1.0, atol=1e-12)


@BOTH
@pytest.mark.parametrize("n", [2.0, 40.0])
def test_the_albedo_is_the_integral_of_f_cos(model, n):
    """By a quadrature that knows nothing of the lobe: 160 nodes an angle resolve it to 1e-5 at n = 40."""
    of = model((0.1, 0.2, 0.3), (0.2, 0.4, 0.7), n)
    np.testing.assert_allclose(albedo(of, VIEWS), diffuse_albedo(VIEWS, of.evaluate), rtol=2e-5)


@BOTH
def test_no_view_gets_more_than_the_one_head_on(model):
    """To 89.5 degrees, at exponents from 0 to 10 000; narrow lobes fall as cos or cos^2 of the view."""
    for n in (0.0, 0.1, 0.5, 1.0, 2.0, 5.0, 20.0, 100.0, 1e3, 1e4):
        found = albedo(model(0.0, 1.0, n), VIEWS)[:, 0]
        assert found.max() <= 1.0 + 1e-12
        assert (np.diff(found) <= 1e-12).all()
    power = 1 if model is Phong else 2
    np.testing.assert_allclose(found[:5], VIEWS[:5, 2] ** power, atol=2e-4)  # 2/n


def test_scales_that_are_often_printed_send_back_more_than_arrives():
    """(n + 8)/(8 pi) by up to 7.5 %, (n + 2)/(2 pi) by up to 4 times: why neither is rendered."""
    n = np.geomspace(0.01, 1e6, 4000)
    exact = np.array([BlinnPhong(0.0, 1.0, float(one)).scale for one in n])
    assert np.max((n + 8.0) / (8.0 * np.pi) / exact) == pytest.approx(1.075, abs=1e-3)
    assert np.max((n + 2.0) / (2.0 * np.pi) / exact) == pytest.approx(4.0, abs=1e-3)


@BOTH
@pytest.mark.parametrize("n", [0.0, 4.0, 2000.0])
@pytest.mark.parametrize("degrees", [0.0, 60.0, 85.0])
def test_draws_are_distributed_as_pdf_says(model, n, degrees):
    """Of the lobe alone, by chi-square. Weights are at most 2 for Phong and 4 for Blinn-Phong; 1 in the limit."""
    of, wo = model(0.0, 1.0, n), viewer(degrees)
    wi, weight = draw(of, wo, 100_000, 1977, int(n), int(degrees))
    assert chi_square(of, wo, wi) > chance(18)
    most = (n + 2.0) / (n + 1.0) if model is Phong else (n + 4.0) / (n + 2.0 ** (-n / 2.0))
    assert weight.max() <= most * (1.0 + 1e-9)
    mean, error = weight[:, 0].mean(), weight[:, 0].std() / np.sqrt(len(weight))
    assert abs(mean - albedo(of, wo)[0]) < 4.0 * error + 1e-12


def l1(model, n, degrees, nodes=120):
    """Integral of |f_closure - f| cos over that of f cos, in per cent, of the lobe alone."""
    of, axis = model(0.0, 1.0, n), np.radians(degrees)
    a, d_a = panels(np.array([0.0, 0.5, 1.0, 2.0, 4.0]) * min(2.5 * of.slope, np.pi / 4), nodes // 4)
    phi = (np.arange(nodes) + 0.5) / nodes * 2.0 * np.pi
    ring = np.cos(phi)[:, None] * spherical(axis + np.pi / 2, np.pi) + np.sin(phi)[:, None] * [0.0, 1.0, 0.0]
    wi = np.cos(a)[:, None, None] * spherical(axis, np.pi) + np.sin(a)[:, None, None] * ring
    weight = ((d_a * np.sin(a))[:, None] * np.maximum(wi[..., 2], 0.0)).ravel()
    wi, wo = wi.reshape(-1, 3), spherical(axis)
    exact = of.evaluate(wi, wo)[:, 0]
    return 100.0 * weight @ np.abs(rendered(of, "closure")(wi, wo)[:, 0] - exact) / (weight @ exact)


@pytest.mark.parametrize(
    ("model", "n", "errors"),
    [
        (Phong, 3.0, (7, 7, 14, 28)), (Phong, 30.0, (3, 3, 5, 16)), (Phong, 100.0, (2, 2, 3, 7)),
        (BlinnPhong, 10.0, (10, 8, 10, 20)), (BlinnPhong, 100.0, (3, 3, 5, 9)), (BlinnPhong, 1000.0, (1, 1, 1, 2)),
    ],
)  # fmt: skip
def test_closure_is_as_near_as_its_file_says(model, n, errors):
    """nodegroups/phong_closure.py, to 75 degrees; 0.5 is the rounding there, and 0.1 the quadrature's."""
    got = [l1(model, n, degrees) for degrees in (0.0, 30.0, 60.0, 75.0)]
    np.testing.assert_allclose(got, errors, atol=0.6)


@BOTH
def test_bad_numbers_are_refused(model):
    """Colours that add up to more than 1, and exponents below 0."""
    with pytest.raises(ValueError, match=r"albedo \+ specular must be at most 1, got 1.1"):
        model((0.0, 0.5, 0.0), (0.9, 0.6, 0.9), 10.0)
    with pytest.raises(ValueError, match="exponent must be between 0 and 1000000, got -1"):
        model(0.5, 0.2, -1.0)
