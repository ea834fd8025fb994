# SPDX-License-Identifier: GPL-3.0-or-later
"""How near the mixture of ``fit`` and Cycles' own closure are to the V-groove model, for docs/testing.md.

L1 in a view: the integral over wi of |f' - f| cos over that of f cos, for F = 1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ....addon.reference import Schlick, cook_torrance, smith_g, spherical
from ....addon.reference import beckmann_d as distribution
from ....addon.reference.cook_torrance_fit import mixture
from ....addon.reference.quadrature import gauss_legendre
from ..cells import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

SLOPES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0)
VIEWS = (0.0, 20.0, 40.0, 60.0, 75.0, 85.0)  # degrees
NODES, STEEPEST = 48, 3.2  # quadrature; slopes to 3.2 m hold all but 4e-5 of the facets


def tables() -> dict[str, Table]:
    rows = [[m, *(l1 for degrees in VIEWS for l1 in near(m, degrees))] for m in SLOPES]
    columns = ["m", *(f"{name} {view:g}" for view in VIEWS for name in ("closure", "fit"))]
    return {"l1": Table(columns, rows)}


def near(m: float, degrees: float) -> tuple[float, float]:
    """L1 of the closure and of the mixture."""
    wi, wo, h, solid_angle = facets(m, degrees)
    f_cos = cook_torrance(wi, wo, m, Schlick(1.0))[:, 0] * wi[:, 2]
    closure = distribution(h, m) * smith_g(wi, wo, m) / (4.0 * wo[2])
    energy = f_cos @ solid_angle
    off = (closure, mixture(wi, wo, m))
    return tuple(float(np.abs(one - f_cos) @ solid_angle / energy) for one in off)  # type: ignore[return-value]


def facets(m: float, degrees: float) -> tuple[NDArray[np.float64], ...]:
    """wi, wo, h and solid angle over facets by slope: dwi = 4 (v.h) dh, dh = (n.h)^3 dp dq; half for both."""
    wo = spherical(np.radians(degrees))
    x, weight = gauss_legendre(NODES)
    phi = (np.arange(NODES) + 0.5) * np.pi / NODES
    radius = STEEPEST * x[:, None]
    p, q = m * radius * np.cos(phi), m * radius * np.sin(phi)
    nh = 1.0 / np.sqrt(1.0 + p * p + q * q)
    h = np.stack([p * nh, q * nh, nh], axis=-1)
    vh = h @ wo
    wi = 2.0 * vh[..., None] * h - wo
    area = 2.0 * np.pi / NODES * m * m * radius * (STEEPEST * weight)[:, None]
    lit = (vh > 1e-9) & (wi[..., 2] > 1e-9)
    return wi[lit] / np.linalg.norm(wi[lit], axis=-1, keepdims=True), wo, h[lit], (4.0 * vh * nh**3 * area)[lit]
