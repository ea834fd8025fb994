# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for ``corrected`` and ``hybrid``: ``fit``, and what it lacks of the V-groove model.

Under a sun of zero size both are the formula itself, free of noise. Under a sun with an angle or a white sky they are
noisy, and no formula gives the variance of Cycles' choice between closures: it is taken from many seeds, or from the
pixels of one theta_o, which are alike in all but their noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from . import gonio
from .check import (
    CLOSURE_SLOPES,
    SETUPS,
    THETAS,
    WINDOW,
    Row,
    Setup,
    View,
    closure_bar,
    disc,
    fresnel_approximation,
    materials,
    measure,
    pool,
)
from .reference import albedo, cook_torrance
from .reference.cook_torrance_fit import cook_torrance_fit, cook_torrance_hybrid
from .reference.directions import dot
from .reference.quadrature import gauss_legendre

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from .reference import Fresnel

ESTIMATORS = ("corrected", "hybrid")
BOUND = 0.005
FURNACE_SLOPES = (0.1, 0.3, 0.6, 1.0)
FURNACE_SAMPLES, FURNACE_SEEDS = 256, 4
SUN_SLOPES = (0.3,)
SUN_ANGLE = 10.0
SUN_THETAS = (20.0, 70.0)
SUN_SAMPLES, SUN_SEEDS = 256, 32
NOISY_ROWS = 13  # rows of the plan that are judged by Z-tests; a test holds it to the plan


def lamp_row(estimator: str, setup: Setup, fresnel: str, m: float) -> Row:
    """Under a sun of zero size: the V-groove model itself.

    The bar is that of the native lobes, as a share of the larger of model and mixture: where the model is next to 0
    the mixture may not be, and what float32 rounds of it remains.
    """
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    row = Row(estimator, setup, fresnel, m)
    approximate = fresnel_approximation(setup, fresnel)
    for theta_i in THETAS:
        for window in (0.0, WINDOW):
            geometry = gonio.Geometry(theta_i, window)
            wi, wo = geometry.wi(), geometry.wo()
            expected = cook_torrance(wi, wo, m, F)
            of = materials()["white"].reference_fresnel() if approximate else F
            lobe = max(float(np.max(model(wi, wo, m, of))) for model in (cook_torrance, cook_torrance_fit))
            peak = float(np.max(cook_torrance(wi, wi * [-1.0, -1.0, 1.0], m, of)))
            scale = max(lobe, 2.0**-64 * peak)  # below there is only what exp() leaves of its underflow
            measured = measure(preset, setup, estimator, geometry)
            bar = approximate or closure_bar(m)
            if np.min(measured) >= -bar * scale:  # a difference of two equal numbers may round to below 0
                measured = np.maximum(measured, 0.0)
            row.views.append(View(geometry, measured, expected, bar, scale))
    return row


def furnace_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``hybrid`` under a uniform white world: the directional albedo of ``cook_torrance_hybrid``."""
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
    cosine = geometry.wo()[:, 0, 2]
    wo = np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)
    coarse, fine = (np.stack([clipped(view, m, F, BOUND, nodes) for view in wo]) for nodes in (72, 100))
    shape = np.ones((32, 32, 3))
    expected = (albedo(preset.reference(), wo) + fine)[:, None] * shape
    images = np.stack(
        [measure(preset, setup, "hybrid", geometry, FURNACE_SAMPLES, seed) for seed in range(FURNACE_SEEDS)]
    )
    # All pixels of a row look at the same theta_o. Two grids apart by as much say how well the reference is known.
    variance = np.var(images, axis=(0, 2), ddof=1) / FURNACE_SEEDS + np.square(fine - coarse)
    view = View(geometry, images.mean(axis=0), expected, variance=variance[:, None] * shape)
    return Row("hybrid, furnace", setup, fresnel, m, [view])


def clipped(wo: NDArray[np.float64], m: float, fresnel: Fresnel, bound: float, nodes: int) -> NDArray[np.float64]:
    """What ``hybrid`` has too much of: the integral of (c f_fit - f)+ cos over wi, (3,), on a grid of facets.

    wo: in the plane of x and z, so that half of the grid does for both.
    """
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
    solid_angle = (4.0 * vh * nh**3 * area)[lit]
    excess = cook_torrance_hybrid(wi, wo, m, fresnel, bound) - cook_torrance(wi, wo, m, fresnel)
    return np.asarray((solid_angle * wi[:, 2]) @ excess)


def sun_row(estimator: str, setup: Setup, fresnel: str, m: float) -> Row:
    """Under a sun of 10 degrees: the mean of f over its disc, weighted by the cosine."""
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    evaluate: Callable[[Any, Any], NDArray[np.float64]] = (
        (lambda wi, wo: cook_torrance(wi, wo, m, F))
        if estimator == "corrected"
        else (lambda wi, wo: cook_torrance_hybrid(wi, wo, m, F, BOUND))
    )
    row = Row(f"{estimator}, sun", setup, fresnel, m)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, window=20.0, resolution=(16, 16), sun_angle=SUN_ANGLE)
        wo = geometry.wo()
        expected = np.zeros_like(wo)
        # The disc has the radiance that lights a facing plane with 1/cos(theta_i).
        radiance = 1.0 / np.cos(np.radians(theta_i)) / (np.pi * np.sin(np.radians(SUN_ANGLE / 2)) ** 2)
        for wi, weight in zip(*disc(geometry), strict=True):
            expected += weight * radiance * evaluate(wi, wo) * max(wi[2], 0.0)
        images = np.stack([measure(preset, setup, estimator, geometry, SUN_SAMPLES, seed) for seed in range(SUN_SEEDS)])
        # Where hybrid's mirror has to find the sun by itself, a count of N hits has skewness N^-1/2, and Student's t of
        # n such counts a mean of -(N n)^-1/2 / 2: pixels are judged together until all seeds expect 400, and that is
        # 2.5 % of a standard error.
        hits = 0.2 * SUN_SAMPLES * SUN_SEEDS * expected[..., 0] / radiance
        pooled = np.stack([pool(image, hits, 400.0) for image in images])
        variance = np.var(pooled, axis=0, ddof=1) / SUN_SEEDS
        mean = pooled.mean(axis=0)
        row.views.append(View(geometry, mean, pool(expected, hits, 400.0), variance=variance, degrees=SUN_SEEDS - 1))
    return row


def plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """Every row, as the function that measures it and its arguments."""
    rows: list[tuple[Callable[..., Row], tuple[Any, ...]]] = []
    for setup in SETUPS:
        for estimator in ESTIMATORS:
            slopes = (0.3,) if setup is SETUPS[1] else CLOSURE_SLOPES  # nodes run as OSL take long to compile
            rows += [(lamp_row, (estimator, setup, "schlick", m)) for m in slopes]
            rows += [(lamp_row, (estimator, setup, fresnel, 0.3)) for fresnel in ("dielectric", "conductor")]
        rows += [(furnace_row, (setup, "white", m)) for m in ((0.3,) if setup is SETUPS[1] else FURNACE_SLOPES)]
        if setup is not SETUPS[1]:  # nodes run as OSL draw the very same: the furnace shows it
            rows += [(sun_row, (estimator, setup, "schlick", m)) for estimator in ESTIMATORS for m in SUN_SLOPES]
    return rows
