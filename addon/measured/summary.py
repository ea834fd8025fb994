# SPDX-License-Identifier: GPL-3.0-or-later
"""What a measured BRDF is like, in a few numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from ..reference.directions import dot, norm, spherical

if TYPE_CHECKING:
    from ..reference.directions import Floats
    from .table import Table

ANGLES = (0, 15, 30, 45, 60, 75, 85)  # degrees, of the light
AZIMUTHS = (0, 45, 90, 135)  # degrees, of the light on anisotropic surfaces
PAIRS, SEED = 4096, 1
NODES = 48, 96  # of theta_h and phi_h


@dataclass(frozen=True)
class Summary:
    """Numbers over all channels, from pairs of directions drawn by the cosine and from the albedo's quadrature."""

    least: float  # f in 1/sr
    greatest: float
    above_one: float  # share of the drawn pairs whose f is above 1/sr in some channel
    reciprocity: float  # mean |f(a, b) - f(b, a)| over the mean of both
    albedo: tuple[tuple[float, float, float], ...]  # RGB at each of ANGLES

    @property
    def gains(self) -> tuple[int, ...]:
        """The angles at which the surface would reflect more light than it receives, in some channel."""
        return tuple(angle for angle, rgb in zip(ANGLES, self.albedo, strict=True) if max(rgb) > 1.0)


def summarize(table: Table) -> Summary:
    """A table's ``Summary``. The albedo is good to some 1e-3 of itself for lobes that the file's grid resolves."""
    a, b = _drawn()
    there, back = table.evaluate(a, b), table.evaluate(b, a)
    seen = [there, back]
    albedo = []
    for angle in ANGLES:
        turns = AZIMUTHS[:1] if table.contents.isotropic else AZIMUTHS
        each = []
        for azimuth in turns:
            wo, weight = reflected(spherical(np.radians(angle), np.radians(azimuth)))
            seen.append(table.evaluate(spherical(np.radians(angle), np.radians(azimuth)), wo))
            each.append(weight @ seen[-1])
        albedo.append(tuple(float(one) for one in np.mean(each, axis=0)))
    total = float((there + back).sum())
    return Summary(
        least=float(min(np.min(one) for one in seen)),
        greatest=float(max(np.max(one) for one in seen)),
        above_one=float((there > 1.0).any(axis=-1).mean()),
        reciprocity=2.0 * float(np.abs(there - back).sum()) / total if total else 0.0,
        albedo=tuple(albedo),  # type: ignore[arg-type]
    )


@cache
def _drawn() -> tuple[Floats, Floats]:
    """Pairs of directions by the cosine, the same each time."""
    u = np.random.default_rng(SEED).random((2, PAIRS, 2))
    a, b = spherical(np.arcsin(np.sqrt(u[..., 0])), 2.0 * np.pi * u[..., 1])
    return a, b


@cache
def _half_vectors() -> tuple[Floats, Floats]:
    """Half vectors and their solid angles: Gauss-Legendre in sqrt(theta_h), for narrow lobes, and even azimuths."""
    x, weight = np.polynomial.legendre.leggauss(NODES[0])
    s = (x + 1.0) / 2.0
    theta, phi = s**2 * np.pi / 2, (np.arange(NODES[1]) + 0.5) * 2.0 * np.pi / NODES[1]
    ring = weight / 2.0 * np.pi * s * np.sin(theta) * 2.0 * np.pi / NODES[1]
    return spherical(theta[:, None], phi).reshape(-1, 3), np.repeat(ring, NODES[1])


def reflected(wi: Floats) -> tuple[Floats, Floats]:
    """Mirrored directions wo (n, 3) above the horizon, and cos times solid angle: d wo = 4 (wi . h) dh."""
    h, solid = _half_vectors()
    cosine = dot(wi, h)
    wo = 2.0 * cosine[:, None] * h - wi
    up = (cosine > 0) & (wo[:, 2] > 0)
    wo, cosine, solid = wo[up], cosine[up], solid[up]
    return wo / norm(wo)[:, None], 4.0 * cosine * solid * wo[:, 2]
