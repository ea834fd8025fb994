# SPDX-License-Identifier: GPL-3.0-or-later
"""What ``hybrid`` sends back of a white sky: the model, and how far it and Cycles' sampling of lobes exceed it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.special import erfc

from ...addon.reference import cook_torrance
from ...addon.reference.cook_torrance_fit import (
    Lobes,
    cook_torrance_hybrid,
    hybrid_share,
    lobes,
    turned,
    weighted_lobes,
)
from ...addon.reference.directions import dot, half_vector
from ...addon.reference.quadrature import gauss_legendre

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...addon.reference import Fresnel


def excess(wo: NDArray[np.float64], m: float, fresnel: Fresnel, bound: float, nodes: int) -> NDArray[np.float64]:
    """What ``hybrid`` sends back under a white sky beyond the model, (3,), on a grid of facets.

    The integral of (c f_fit - f)+ cos over wi, and what Cycles' sampling makes of c f_fit (``sampled_share``).
    wo: any direction above the surface, (3,); the model is isotropic.
    """
    wo = _in_plane(wo)
    wi, solid_angle = _mirrored(wo, m, nodes)
    clipped = cook_torrance_hybrid(wi, wo, m, fresnel, bound) - cook_torrance(wi, wo, m, fresnel)
    mixture = lobes(wo, m)
    native = hybrid_share(wo, m, bound) * weighted_lobes(wi, wo, mixture) @ (sampled_share(wo, mixture) - 1.0)
    F = fresnel(dot(wi, half_vector(wi, wo)))
    return np.asarray((solid_angle * wi[:, 2]) @ clipped + (solid_angle * native) @ F)


def sent_by_lobes(wo: NDArray[np.float64], m: float, nodes: int) -> float:
    """The directional albedo of ``fit`` with F = 1, as Cycles samples its lobes; wo and nodes as in ``excess``."""
    wo = _in_plane(wo)
    wi, solid_angle = _mirrored(wo, m, nodes)
    mixture = lobes(wo, m)
    return float(solid_angle @ (weighted_lobes(wi, wo, mixture) @ sampled_share(wo, mixture)))


def _in_plane(wo: NDArray[np.float64]) -> NDArray[np.float64]:
    """``wo`` turned about the normal into the plane of x and z, where half of a grid of facets mirrors the other."""
    return np.array([np.hypot(wo[0], wo[1]), 0.0, wo[2]])


def _mirrored(wo: NDArray[np.float64], m: float, nodes: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """wi (n, 3) to which a grid of facets mirrors wo, above the surface, and the solid angle of each (n,).

    wo: in the plane of x and z, (3,).
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
