# SPDX-License-Identifier: GPL-3.0-or-later
"""The lobe of a BRDF as a surface: its directions, its scale, and what it shows of the models."""

import numpy as np
import pytest

from vgroove.addon.reference import (
    Anisotropic,
    Conductor,
    CookTorrance,
    Lambert,
    OrenNayar,
    Schlick,
    Sum,
    cook_torrance,
    lobe,
    spherical,
)
from vgroove.addon.reference.phong import Phong

COPPER = Schlick((0.95, 0.64, 0.54))
ANGLES = [(0.0, 0.0), (30.0, 200.0), (75.0, 10.0), (89.95, 90.0)]


@pytest.mark.parametrize(("theta", "phi"), ANGLES)
def test_directions_go_from_the_mirror_direction_to_the_horizon(theta, phi):
    """Unit vectors, none below the surface; the first ring is the mirror direction, the last the horizon."""
    wi = spherical(np.radians(theta), np.radians(phi))
    wo = lobe.directions(wi)
    assert wo.shape == (lobe.RINGS, lobe.AROUND, 3)
    np.testing.assert_allclose(np.linalg.norm(wo, axis=-1), 1.0, atol=1e-15)
    assert (wo[..., 2] > 0.0).all()
    mirror = wi * [-1.0, -1.0, 1.0]
    # Nearer the horizon than LOWEST the rings are around LOWEST.
    np.testing.assert_allclose(wo[0], np.broadcast_to(mirror, wo[0].shape), atol=1e-15 if theta < 89.9 else 9e-4)
    assert wo[-1, :, 2].max() < np.pi * 1.0001e-6  # a share of 1 - RIM of at most half a turn is left


@pytest.mark.parametrize(("theta", "phi"), ANGLES[:3])
def test_the_triangles_cover_the_hemisphere_once(theta, phi):
    """Of a lobe of radius 1 they enclose half a ball, with normals outward."""
    wo = lobe.directions(spherical(np.radians(theta), np.radians(phi)), rings=192, around=384)
    corners = wo.reshape(-1, 3)[lobe.triangles(192, 384)]
    volumes = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6.0
    assert (volumes > -1e-15).all()
    # A triangle of sides up to s lies at most s^2/6 below the ball, so V is at least (1 - s^2/6)^3 of the ball's.
    side = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1).max()
    ball = 2.0 * np.pi / 3.0
    assert (1.0 - side**2 / 6.0) ** 3 * ball < volumes.sum() < ball
    assert side < 0.1
    outward = np.einsum("...i,...i", lobe.normals(wo), wo)
    assert (outward[1:] > 0.99).all()


def test_the_lobe_holds_f_times_the_cosines():
    wi = spherical(0.8, 0.3)
    copper = CookTorrance(0.3, COPPER)
    f = {times: lobe.lobe(copper.evaluate, wi, times) for times in lobe.TIMES}
    wo = f["one"].wo
    expected = cook_torrance(wi, wo, 0.3, COPPER)
    np.testing.assert_array_equal(f["one"].rgb, expected)
    np.testing.assert_array_equal(f["cos_o"].rgb, expected * wo[..., 2:])
    np.testing.assert_allclose(f["cos_io"].rgb, expected * wo[..., 2:] * wi[2], rtol=1e-15)


@pytest.mark.parametrize("model", [CookTorrance(0.3, COPPER), OrenNayar(0.8, 0.5), Anisotropic(0.5, 0.1, COPPER, 0.7)])
def test_one_side_of_an_isotropic_lobe_is_as_the_other(model):
    """Which evaluates half of it; a brushed one is not isotropic."""
    wi = spherical(0.8, 0.3)
    whole = lobe.lobe(model.evaluate, wi).rgb
    mirrored = lobe.lobe(model.evaluate, wi, isotropic=True).rgb
    same = np.allclose(mirrored, whole, rtol=1e-9, atol=1e-12)
    assert same == lobe.is_isotropic(model)
    assert not lobe.is_isotropic(Sum(Lambert(0.5), Anisotropic(0.5, 0.1, COPPER), 0.5, 0.5))


def test_vertices_are_as_far_as_f_is_large():
    """The peak at 1, linear; four decades below it at 0, logarithmic."""
    found = lobe.lobe(CookTorrance(0.3, COPPER).evaluate, spherical(0.5))
    values = found.values("luminance")
    peak = values.max()
    far = np.linalg.norm(found.vertices("luminance", peak, log=False), axis=-1)
    np.testing.assert_allclose(far, values / peak, atol=1e-15)
    assert lobe.radii(np.array([1.0, 1e-2, 1e-4, 0.0]), 1.0, log=True).tolist() == [1.0, 0.5, 0.0, 0.0]
    assert lobe.radii(np.array([0.0]), 0.0, log=True).tolist() == [0.0]  # black


def test_channels_are_those_of_rec709():
    rgb = np.array([0.2, 0.5, 0.9])
    assert [lobe.channel_of(rgb, one) for one in ("red", "green", "blue")] == rgb.tolist()
    assert lobe.channel_of(np.ones(3), "luminance") == pytest.approx(1.0, abs=1e-15)
    found = lobe.Lobe(np.zeros((1, 2, 3)), np.array([[[0.5, 1.0, 0.25], [0.0, 0.0, 0.0]]]))
    assert found.colors().tolist() == [[[0.5, 1.0, 0.25], [1.0, 1.0, 1.0]]]


def test_a_narrow_lobe_is_resolved():
    """At m = 0.01 at least eight rings are within the half width of the peak, head-on: tan = m sqrt(ln 2) by facets."""
    found = lobe.lobe(CookTorrance(0.01, COPPER).evaluate, spherical(0.0))
    values = found.values("luminance")[:, 0]
    assert (values > 0.5 * values[0]).sum() >= 4


def test_cook_torrance_peaks_off_the_mirror_direction_at_grazing_light():
    """Farther from the normal than the mirror direction is (Torrance & Sparrow 1967)."""
    wi = spherical(np.radians(65.0))
    found = lobe.lobe(CookTorrance(0.3, Conductor(0.27, 3.4)).evaluate, wi)
    peak = found.wo.reshape(-1, 3)[found.values("luminance").argmax()]
    assert peak[0] < 0.0
    assert np.degrees(np.arccos(peak[2])) > 70.0


def test_oren_nayar_scatters_back():
    """More toward the light than toward the mirror direction."""
    wi = spherical(np.radians(60.0))
    found = lobe.lobe(OrenNayar(0.8, 0.5).evaluate, wi)
    back = found.wo.reshape(-1, 3)[found.values("red").argmax()]
    assert back[0] > 0.0


@pytest.mark.parametrize(
    "model",
    [
        CookTorrance(0.3, COPPER),
        Anisotropic(0.5, 0.1, COPPER, 0.7),
        Sum(Lambert(0.5), CookTorrance(0.2, COPPER), 0.5, 1.0, coupled=True),
    ],
    ids=["round", "brushed", "coupled"],
)
def test_terms_make_up_the_specular_part(model):
    """f = F D G / (4 cos theta_i cos theta_o)."""
    wi = spherical(0.8, 0.3)
    wo = lobe.directions(wi, 12, 16)
    terms = {name: term(wi, wo) for name, term in lobe.terms(model).items()}
    product = terms["D"] * terms["G"] * terms["F"] / (4.0 * wi[2] * wo[..., 2:])
    specular = getattr(model, "specular", model)
    np.testing.assert_allclose(product, specular.evaluate(wi, wo), rtol=1e-12)


@pytest.mark.parametrize("model", [Lambert(0.5), Phong(0.3, 0.2, 50.0), OrenNayar(0.5, 0.2)])
def test_models_without_facets_have_no_terms(model):
    assert lobe.terms(model) == {}
