# SPDX-License-Identifier: GPL-3.0-or-later
"""The lobe that stands for further bounces: as much light as the walk has, and of its colour; the shape is coarser."""

import numpy as np
import pytest

from vgroove.addon.library import presets
from vgroove.addon.reference import CookTorrance, groove_fit, spherical
from vgroove.addon.reference.cook_torrance_fit import interpolated, view_coordinate
from vgroove.addon.reference.groove import WHITE, bounce_albedos, further
from vgroove.addon.reference.groove_fit import NAMES, bounced, colour, tables

VIEWS = spherical(np.radians([0.0, 30.0, 60.0, 75.0, 85.0]), 0.4)


@pytest.mark.parametrize("m", [0.3, 0.5, 0.7, 1.0])
@pytest.mark.parametrize("name", ["gold", "copper"])
def test_metals_have_the_colour_of_the_walk(name, m):
    """What docs/estimators.md says: by channel within 0.008 of the arriving light."""
    F = presets.find(f"metals/{name}").reference_fresnel()
    numbers = interpolated(tables(), view_coordinate(VIEWS, m), np.sqrt(m))
    missing = 1.0 - CookTorrance(m, WHITE).directional_albedo(VIEWS)
    lobe = missing * colour(VIEWS, numbers[:, NAMES.index("third")], F)
    walk = bounce_albedos(VIEWS, m, F)[:, 1:].sum(axis=1)
    assert np.abs(lobe - walk).max() < 8e-3
    assert np.abs(walk).max() > 0.02


def disc(rings=60):
    """Directions of equal projected solid angle, (rings * 4 rings, 3), and that angle."""
    radius = np.sqrt((np.arange(rings) + 0.5) / rings)[:, None]
    phi = (np.arange(4 * rings) + 0.37) / (4 * rings) * 2.0 * np.pi
    x, y = radius * np.cos(phi), radius * np.sin(phi)
    wi = np.stack([x, y, np.sqrt(1.0 - radius**2) + 0.0 * x], axis=-1).reshape(-1, 3)
    return wi, np.pi / len(wi)


@pytest.mark.parametrize(
    ("m", "degrees", "without", "with_lobe"),
    [(0.5, 5.0, 0.11, 0.04), (0.5, 60.0, 0.11, 0.06), (1.0, 30.0, 0.47, 0.27), (0.7, 80.0, 0.05, 0.06)],
)
def test_the_shape_is_as_far_from_the_walk_as_the_page_says(m, degrees, without, with_lobe):
    """L1 over all light, F = 1; a grid of a quarter as many points, which meets the infinite line elsewhere: 0.015."""
    wi, area = disc()
    wo = np.broadcast_to(spherical(np.radians(degrees), 0.0), wi.shape)
    walk = sum(np.nan_to_num(further(wi, wo, m, WHITE, k)[:, 0], posinf=0.0) for k in range(2, 7))
    lobe = bounced(wi, wo, m, WHITE, "mirror")[:, 0]
    assert walk.sum() * area == pytest.approx(without, abs=0.015)
    assert np.abs(walk - lobe).sum() * area == pytest.approx(with_lobe, abs=0.015)


@pytest.mark.parametrize("estimator", ["fit", "corrected", "closure", "mirror", "hybrid"])
def test_every_estimator_has_its_weight(estimator):
    """Never negative, and 0 below the surface."""
    wi, _ = disc(12)
    f = bounced(wi, wi[::-1], 0.6, WHITE, estimator)
    assert (f >= 0.0).all()
    assert f.max() > 0.0
    assert not bounced(wi * [1.0, 1.0, -1.0], wi, 0.6, WHITE, estimator).any()


def test_the_table_is_what_its_tool_computes():
    """At a few places, to the digits that it keeps. The tool imports nothing of Blender."""
    from importlib.util import module_from_spec, spec_from_file_location
    from pathlib import Path

    from vgroove.addon.reference.cook_torrance_fit import PLACES

    spec = spec_from_file_location("fit_groove", Path(__file__).parents[2] / "tools" / "fit_groove.py")
    tool = module_from_spec(spec)
    spec.loader.exec_module(tool)
    for j, k in ((8, 40), (17, 5), (24, 60)):
        numbers = tool.numbers(float(PLACES[0][j]) ** 2, float(PLACES[1][k]))
        np.testing.assert_allclose(groove_fit.tables()[:, j, k], numbers, atol=6e-5)
