# SPDX-License-Identifier: GPL-3.0-or-later
"""``fit`` as Cycles renders it, against the V-groove model itself: how near, how smooth, and head-on.

That it is the reference's mixture, ``test_check`` shows to float32 rounding; here nothing is taken from the mixture.
"""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio
from vgroove.addon.reference import Schlick, cook_torrance
from vgroove.addon.reference.cook_torrance_fit import cook_torrance_fit
from vgroove.addon.reference.quadrature import panels
from vgroove.lab.check.cook_torrance import materials
from vgroove.lab.check.rows import SETUPS
from vgroove.lab.check.views import FURNACE_SIZE, closure_bar, furnace, measure
from vgroove.lab.sidak import limit

pytestmark = pytest.mark.blender

NODES, _, OSL = SETUPS
WHITE = "white"
ROWS, COLUMNS = 27, 256  # of theta_o, 1.7 to 88.3 degrees, 85 among them; of phi_o
STEP = 1.0 / 255.0  # of an 8-bit picture


def white(m):
    return materials()[WHITE].with_parameters(m=m)


def distances(setup, m, gain=1.0):
    """L1 from the model and the albedo's relative error for each theta_o, from pictures under a sun that goes round."""
    wide = panels(np.linspace(0.0, np.pi / 2, 11), 6)
    off, lost, energy = np.zeros(ROWS), np.zeros(ROWS), np.zeros(ROWS)
    for theta_i, weight in zip(*wide, strict=True):
        geometry = gonio.Geometry(min(float(np.degrees(theta_i)), 89.99), resolution=(COLUMNS, ROWS))
        f = cook_torrance(geometry.wi(), geometry.wo(), m, Schlick(1.0))[..., 0]
        seen = gain * measure(white(m), setup, "fit", geometry)[..., 0]
        solid_angle = weight * np.sin(theta_i) * np.cos(theta_i) * 2.0 * np.pi / COLUMNS
        off += solid_angle * np.abs(seen - f).sum(axis=1)
        lost += solid_angle * (seen - f).sum(axis=1)
        energy += solid_angle * f.sum(axis=1)
    return off / energy, lost / energy


# OSL is the nodes' equal at every slope (fit_row of vgroove check), and slow to compile: two slopes show it here.
@pytest.mark.parametrize(
    ("setup", "m"), [*((NODES, m) for m in (0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)), (OSL, 0.2), (OSL, 0.8)], ids=str
)
def test_rendered_fit_is_near_the_vgroove_model(instrument, setup, m):
    """L1 at most 4 % up to m = 0.4 and 8.5 % up to 1, albedo within 1 %, at every view to 85 degrees.

    The quadrature over suns, 60 by 256, is good to 0.1 % of the albedo, and to 0.4 % at 85 degrees for m <= 0.3, where
    a lobe is as narrow as m cos(85 degrees) (120 by 1024 move it by less).
    """
    off, lost = distances(setup, m)
    views = (np.arange(ROWS) + 0.5) * 90.0 / ROWS
    to_85 = views < 85.1
    assert off[to_85].max() <= (0.04 if m <= 0.4 else 0.085)
    assert np.abs(lost[to_85]).max() <= 0.01


@pytest.mark.once
def test_the_distance_sees_an_error(instrument):
    """A fit 5 % too bright is red in both measures."""
    off, lost = distances(NODES, 0.4, gain=1.05)
    assert off.max() > 0.04
    assert lost.max() > 0.01


@pytest.mark.parametrize("setup", [NODES, OSL], ids=str)
@pytest.mark.parametrize("m", [0.02, 0.1, 0.3, 0.6, 1.0])
def test_a_white_furnace_never_brightens(instrument, setup, m):
    """What a white ``fit`` sends back under a white sky is at most what arrives, at every view.

    The mixture is held to 0.9998 of it, and Cycles' sums of samples round by less. Slopes to 0.3 send back so much that
    1 % more would be red.
    """
    images = [measure(white(m), setup, "fit", furnace(), 256, seed)[..., 0] for seed in range(4)]
    sent = np.mean(images, axis=(0, 2))
    noise = np.std(images, axis=(0, 2), ddof=1) / np.sqrt(4 * FURNACE_SIZE)
    most = 1.0 + limit(sent.size) * noise
    assert (sent <= most).all()
    if m <= 0.3:
        assert (1.01 * sent > most).any()


def bend(image, seen):
    """The largest second difference of neighbouring pixels, over the brightest pixel."""
    largest = 0.0
    for axis in (0, 1):
        size = image.shape[axis]
        inside = np.all([seen.take(range(k, size - 2 + k), axis) for k in range(3)], axis=0)
        largest = max(largest, float(np.abs(np.diff(image, 2, axis=axis))[inside].max()))
    return largest / float(image[seen].max())


@pytest.mark.parametrize("setup", [NODES, OSL], ids=str)
@pytest.mark.parametrize("m", [0.1, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("theta_i", [20.0, 70.0])
def test_no_band_shows_on_a_ball(instrument, setup, m, theta_i):
    """On a ball 1025 pixels wide the shading bends by less from pixel to pixel than one step of an 8-bit picture.

    A jump in the mixture would be a bend of its own height, wherever it is: one of 1 % of the light is red.
    """
    with headless.quiet():
        radiance, normal = gonio.measure_sphere(
            white(m), setup.backend, "fit", theta_i, size=1025, shading_osl=setup.shading_osl
        )
    # Not the rim, where a pixel spans ever more of the surface, nor the edge of the light itself.
    seen = (normal[..., 2] > 0.2) & (normal @ gonio.Geometry(theta_i).wi() > 0.05)
    image = np.where(seen, radiance[..., 0], 0.0).astype(np.float64)
    assert bend(image, seen) < STEP
    brightest = normal[np.unravel_index(np.argmax(image), image.shape)]
    assert bend(image * np.where(normal @ brightest > 0.9999, 1.01, 1.0), seen) > STEP


@pytest.mark.parametrize("setup", [NODES, OSL], ids=str)
@pytest.mark.parametrize("m", [0.1, 0.3, 0.6, 1.0])
@pytest.mark.parametrize("theta_i", [20.0, 70.0, 85.0])
def test_no_step_from_view_to_view(instrument, setup, m, theta_i):
    """Nearly to the rim: from 0 to 89 degrees in 2025 steps, f bends by less than one step of an 8-bit picture.

    Beyond, where a ball's radius has less than 0.02 % left, the mixture turns faster than that.
    """
    geometry = gonio.Geometry(theta_i, resolution=(16, 2048))
    image = measure(white(m), setup, "fit", geometry)[: int(2048 * 89 / 90)]
    across = np.abs(np.diff(image[..., 0], 2, axis=0))
    assert across.max() < STEP * image.max()
    row, column = np.unravel_index(np.argmax(image[..., 0]), image.shape[:2])
    image[row:, column] *= 1.01
    assert np.abs(np.diff(image[..., 0], 2, axis=0)).max() > STEP * image.max()


@pytest.mark.parametrize("setup", [NODES, OSL], ids=str)
@pytest.mark.parametrize("m", [0.1, 0.3, 1.0])
def test_head_on_the_tangent_vanishes_and_the_value_is_right(instrument, setup, m):
    """An orthographic view straight down: every lobe is round there, so that no direction across is needed."""
    with headless.quiet():
        radiance, normal = gonio.measure_sphere(
            white(m), setup.backend, "fit", 20.0, size=65, shading_osl=setup.shading_osl
        )
    assert normal[32, 32].tolist() == [0.0, 0.0, 1.0]
    wi, up = gonio.Geometry(20.0).wi(), np.array([0.0, 0.0, 1.0])
    expected = cook_torrance_fit(wi, up, m, Schlick(1.0)) * wi[2]
    np.testing.assert_allclose(radiance[32, 32], expected, rtol=closure_bar(m))
