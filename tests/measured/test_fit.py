# SPDX-License-Identifier: GPL-3.0-or-later
"""Lobes fitted to measured BRDFs."""

import numpy as np
import pytest

from vgroove.addon.library.files import FileError
from vgroove.addon.library.presets import parse
from vgroove.addon.library.writing import dumps
from vgroove.addon.measured import Merl, fit, lobes, tabulate
from vgroove.addon.measured.utia import read_utia
from vgroove.addon.reference import CookTorrance, Lambert, Schlick, spherical
from vgroove.addon.reference.ward import Ward

from .makers import utia_bytes

HEAD = 'name = "Test"\n'
SOURCE = '[source]\ndata = "made for a test"\n'
SUM = (
    'model = "sum"\nalbedo = [0.6, 0.4, 0.2]\nsigma = 0.0\nd = 0.5\ns = 0.4\nm = {m}\n[fresnel]\nf0 = [0.6, 0.4, 0.2]\n'
)
TWO = """model = "car_paint"
albedo = [0.3, 0.2, 0.1]
sigma = 0.4
[[lobes]]
s = 0.2
m = 0.04
f0 = [0.3, 0.35, 0.4]
f82_tint = [1.0, 0.9, 0.8]
[[lobes]]
s = 0.3
m = 0.25
f0 = [0.6, 0.4, 0.2]
f82_tint = [0.9, 0.9, 0.9]
"""
ABC = """model = "generator"
albedo = [0.1, 0.05, 0.02]
specular = [0.8, 0.6, 0.4]
[fresnel]
eta = 1.8
[[distribution]]
abc = [2000.0, 1.2]
"""

WARD = """model = "ward"
albedo = [0.3, 0.2, 0.1]
specular = [0.2, 0.3, 0.4]
m = {m}
anisotropy = 0.0
"""


def made(text):
    return parse(HEAD + text + SOURCE, "tests/made", "made")


def table_of(preset):
    return Merl(tabulate(preset.reference().evaluate))


def fitted(preset, count, metric, kind="cook_torrance"):
    return fit.fit(table_of(preset), "Test", "test", count, kind, metric).preset.parameters


@pytest.mark.parametrize("metric", ["log", "l1"])
@pytest.mark.parametrize("m", [0.05, 0.3])
def test_a_sum_is_found_again(m, metric):
    """Within the 1 % that published fits reach on such data. d and albedo are one number there: their product."""
    of = fitted(made(SUM.format(m=m)), 1, metric)
    assert of["albedo"] == pytest.approx([0.3, 0.2, 0.1], rel=0.01)
    assert (of["s_1"], of["m_1"]) == pytest.approx((0.4, m), rel=0.01)
    assert of["f0_1"] == pytest.approx([0.6, 0.4, 0.2], rel=0.01)
    assert of["f82_tint_1"] == pytest.approx([1.0] * 3, rel=0.01)


@pytest.mark.parametrize("metric", ["log", "l1"])
def test_two_lobes_are_found_again(metric):
    """Each number within 1 %, from narrow to wide."""
    wanted = made(TWO)
    of = fitted(wanted, 2, metric)
    assert of.keys() == wanted.parameters.keys()
    for name, value in wanted.parameters.items():
        assert of[name] == pytest.approx(value, rel=0.01), name


@pytest.mark.parametrize("metric", ["log", "l1"])
def test_a_distribution_is_found_again(metric):
    """Each number of the generator within 1 %."""
    wanted = made(ABC)
    best = fit.fit(table_of(wanted), "Test", "test", 1, "generator", metric).preset
    for name, value in wanted.parameters.items():
        assert best.parameters[name] == pytest.approx(value, rel=0.01), name
    assert best.distribution[0].numbers == pytest.approx((2000.0, 1.2), rel=0.01)


@pytest.mark.parametrize("metric", ["log", "l1"])
@pytest.mark.parametrize("m", [0.05, 0.3])
def test_wards_gaussian_is_found_again(m, metric):
    """Each number within 1 %, and it stays round."""
    wanted = made(WARD.format(m=m))
    of = fitted(wanted, 1, metric, "ward")
    assert of.keys() == wanted.parameters.keys()
    for name, value in wanted.parameters.items():
        assert of[name] == pytest.approx(value, rel=0.01), name


def test_pairs_evaluate_as_the_reference_does():
    """To rounding: F D G over the same pairs, one by its factors at few angles and one by itself."""
    pairs = lobes.Pairs()
    of = CookTorrance(0.1, Schlick([0.6, 0.4, 0.2]))
    found = lobes.Lobe().evaluate(pairs, np.array([np.log(0.1), 0.5, 0.6, 0.4, 0.2, 1.0, 1.0, 1.0]))
    expected = 0.5 * of.evaluate(pairs.wi, pairs.wo)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * expected.max())  # tan^2 of 88 degrees in exp()
    found = lobes.Gaussian().evaluate(pairs, np.array([0.6, 0.4, 0.2, np.log(0.1)]))
    expected = Ward([0.0] * 3, [0.6, 0.4, 0.2], 0.1, 0.1).evaluate(pairs.wi, pairs.wo)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * expected.max())


def test_pairs_weigh_what_a_white_surface_reflects():
    """The weights are solid angles: the mean of cos theta_d^2 over them against a quadrature of its own.

    Midpoints of 5 degrees in theta_d and 30 in phi_d, with a rim at 80 degrees, are good to a per cent or so.
    """
    pairs = lobes.Pairs()
    z = np.linspace(np.cos(lobes.GRAZING), 1.0, 200)
    mean_z = (z * z).mean() / z.mean()  # E[cos] under the weight cos, on either side: independent
    assert float(pairs.weight.sum()) == pytest.approx(1.0)
    assert float(pairs.weight @ pairs.wi[:, 2]) == pytest.approx(mean_z, rel=0.02)
    squared = ((1.0 + (pairs.wi * pairs.wo).sum(axis=1)) / 2.0) @ pairs.weight  # cos^2 theta_d; azimuths cancel
    assert squared == pytest.approx((1.0 + mean_z**2) / 2.0, rel=0.02)


def test_more_lobes_come_nearer():
    """Two lobes to a sum of two; the residual of one is that of its own preset."""
    of = table_of(made(TWO))
    one, two = fit.fits(of, "Test", "test", 2)
    assert one.residual == fit.residual(of, one.preset.reference().evaluate)
    assert one.mean > 0.1
    assert two.mean < 0.02  # the grid's own error between its nodes is .0026 at most there


def test_the_residual_is_the_light_that_differs():
    """Of Lambert against one with three quarters of its albedo: a quarter, whatever the angle."""
    of = Merl(tabulate(Lambert(0.4).evaluate))
    assert fit.residual(of, Lambert(0.3).evaluate) == pytest.approx([0.25] * len(fit.ANGLES))


@pytest.mark.parametrize("kind", lobes.KINDS)
def test_what_is_written_reads_back(kind):
    """White data that mirror as well: lobes and base share what there is, as the model wants it.

    The generator's own rule is about light head-on alone.
    """
    white = Lambert(0.9)
    shiny = CookTorrance(0.2, Schlick(0.5))
    of = Merl(tabulate(lambda wi, wo: white.evaluate(wi, wo) + 0.4 * shiny.evaluate(wi, wo)))
    best = fit.fit(of, "Test", "test", 1, kind).preset
    text = dumps(best)
    assert parse(text, best.id, "test") == best
    if kind == "cook_torrance":
        assert best.reference().directional_albedo(spherical(np.radians([0.0, 45.0, 80.0]))).max() <= 1.0


def test_anisotropic_and_black_data_are_refused():
    with pytest.raises(FileError, match="anisotropic"):
        fit.fit(read_utia(utia_bytes(Lambert(0.5).evaluate)), "Test", "test")
    with pytest.raises(FileError, match="black"):
        fit.fit(Merl(tabulate(Lambert(0.0).evaluate)), "Test", "test")
