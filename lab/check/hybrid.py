# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for ``corrected`` and ``hybrid``: ``fit``, and what it lacks of the V-groove model.

Under a sun of zero size both are the formula itself, free of noise. Under a sun with an angle or a white sky they are
noisy.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import erfc

from ...addon.blender import gonio
from ...addon.reference import albedo, cook_torrance
from ...addon.reference.cook_torrance_fit import (
    Lobes,
    cook_torrance_hybrid,
    hybrid_share,
    lobes,
    turned,
    weighted_lobes,
)
from ...addon.reference.directions import dot, half_vector
from ...addon.reference.hybrid import DEFAULT_BOUND
from ...addon.reference.quadrature import gauss_legendre
from ...nodegroups import versions
from .rows import CLOSURE_SLOPES, SETUPS, Row, Setup, materials, native_row, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from ...addon.reference import Fresnel

ESTIMATORS = ("corrected", "hybrid")
FURNACE_SLOPES = (0.1, 0.3, 0.6, 1.0)
SUN_SLOPES = (0.3,)
SUN_ANGLE = 20.0
SUN_THETAS = (20.0, 70.0)
SUN_SAMPLES = {"corrected": 512, "hybrid": 2048}
MIRRORED = 0.2  # of hybrid at that slope, at least
# A test holds what such lobes do in the mean over views to ``versions.LEANING``. Slopes to NARROW do so at
# grazing views alone, which are noisy and weigh next to nothing in a row.
NARROW = 0.3
NOISY_ROWS = 13  # rows of the plan that are judged by Z-tests; a test holds it to the plan


def furnace_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``hybrid`` under a uniform white world: the directional albedo of what it renders."""
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    coarse, fine = furnace_excess(F, m)
    wo = furnace_directions()
    expected = albedo(preset.reference(), wo) + fine
    more = versions.LEANING * m if m > NARROW else 0.0
    leaning = 0.5 * more * hybrid_share(wo, m, DEFAULT_BOUND)[:, None] * expected  # half of it, and as much for doubt
    # Two grids apart by as much say how well the reference is known.
    view = furnace_view(preset, setup, "hybrid", expected + leaning, doubt=np.hypot(fine - coarse, leaning))
    return Row("hybrid, furnace", setup, fresnel, m, [view], noisy_rows=NOISY_ROWS)


@cache
def furnace_excess(fresnel: Fresnel, m: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """``excess`` for each ``furnace_directions``, (32, 3), on a coarse and on a fine grid."""
    wo = furnace_directions()
    coarse, fine = (np.stack([excess(view, m, fresnel, DEFAULT_BOUND, nodes) for view in wo]) for nodes in (72, 100))
    return coarse, fine


def excess(wo: NDArray[np.float64], m: float, fresnel: Fresnel, bound: float, nodes: int) -> NDArray[np.float64]:
    """What ``hybrid`` sends back under a white sky beyond the model, (3,), on a grid of facets.

    The integral of (c f_fit - f)+ cos over wi, and what Cycles' sampling makes of c f_fit (``sampled_share``).
    wo: in the plane of x and z, so that half of the grid does for both.
    """
    wi, solid_angle = _mirrored(wo, m, nodes)
    clipped = cook_torrance_hybrid(wi, wo, m, fresnel, bound) - cook_torrance(wi, wo, m, fresnel)
    mixture = lobes(wo, m)
    native = hybrid_share(wo, m, bound) * weighted_lobes(wi, wo, mixture) @ (sampled_share(wo, mixture) - 1.0)
    F = fresnel(dot(wi, half_vector(wi, wo)))
    return np.asarray((solid_angle * wi[:, 2]) @ clipped + (solid_angle * native) @ F)


def sent_by_lobes(wo: NDArray[np.float64], m: float, nodes: int) -> float:
    """The directional albedo of ``fit`` with F = 1, as Cycles samples its lobes; wo and nodes as in ``excess``."""
    wi, solid_angle = _mirrored(wo, m, nodes)
    mixture = lobes(wo, m)
    return float(solid_angle @ (weighted_lobes(wi, wo, mixture) @ sampled_share(wo, mixture)))


def _mirrored(wo: NDArray[np.float64], m: float, nodes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """wi (n, 3) to which a grid of facets mirrors wo, above the surface, and the solid angle of each (n,)."""
    x, weight = gauss_legendre(nodes)
    slope = 4.0 * m * x  # slopes to 4 m hold all but 1e-7 of the facets
    phi = (np.arange(nodes) + 0.5) * np.pi / nodes
    p, q = slope[:, None] * np.cos(phi), slope[:, None] * np.sin(phi)
    nh = 1.0 / np.sqrt(1.0 + p * p + q * q)
    h = np.stack([p * nh, q * nh, nh], axis=-1)
    vh = dot(h, wo)
    wi = 2.0 * vh[..., None] * h - wo
    lit = (vh > 1e-9) & (wi[..., 2] > 1e-9)
    wi = wi[lit] / np.linalg.norm(wi[lit], axis=-1, keepdims=True)
    # dwi = 4 (v.h) dh, dh = (n.h)^3 dp dq; twice for the mirrored half
    area = (2.0 * np.pi / nodes * 4.0 * m * slope * weight)[:, None] * np.ones(nodes)
    return wi, (4.0 * vh * nh**3 * area)[lit]


def sampled_share(wo: NDArray[np.float64], mixture: Lobes) -> NDArray[np.float64]:
    """What Cycles' sampling of a native lobe gives over what its formula does, (lobes,): within 0.33 % of 1.

    It draws the visible facets of Smith's exact G1, and divides by the density with G1 of the rational Lambda.
    """
    across, toward, up = turned(0.0 * wo[:1], np.hypot(wo[:1], wo[1:2]), wo[2:], mixture.tilt)
    a = up / np.maximum(np.hypot(across * mixture.across, toward * mixture.within), 1e-12)
    exact = 0.5 * (np.exp(-a * a) / (a * np.sqrt(np.pi)) - erfc(a))
    rational = (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a)
    return np.asarray((1.0 + np.where(a < 1.6, rational, 0.0)) / (1.0 + exact))


def sun_row(estimator: str, setup: Setup, fresnel: str, m: float) -> Row:
    """Under a sun of 20 degrees: the mean of f over its disc, weighted by the cosine."""
    preset = materials()[fresnel].with_parameters(m=m)
    row = Row(f"{estimator}, sun", setup, fresnel, m, noisy_rows=NOISY_ROWS)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, window=20.0, resolution=(16, 16), sun_angle=SUN_ANGLE)
        row.views.append(sun_view(preset, setup, estimator, geometry, SUN_SAMPLES[estimator], MIRRORED))
    return row


def plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """Every row, as the function that measures it and its arguments."""
    rows: list[tuple[Callable[..., Row], tuple[Any, ...]]] = []
    for setup in SETUPS:
        for estimator in ESTIMATORS:
            slopes = (0.3,) if setup is SETUPS[1] else CLOSURE_SLOPES  # nodes run as OSL take long to compile
            rows += [(native_row, (estimator, setup, "schlick", m)) for m in slopes]
            rows += [(native_row, (estimator, setup, fresnel, 0.3)) for fresnel in ("dielectric", "conductor")]
        rows += [(furnace_row, (setup, "white", m)) for m in ((0.3,) if setup is SETUPS[1] else FURNACE_SLOPES)]
        if setup is not SETUPS[1]:  # nodes run as OSL draw the very same: the furnace shows it
            rows += [(sun_row, (estimator, setup, "schlick", m)) for estimator in ESTIMATORS for m in SUN_SLOPES]
    return side_by_side(rows)
