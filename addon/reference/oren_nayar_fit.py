# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren-Nayar 1994 as a mixture of two diffuse closures that Cycles has: Lambert, and its own Oren-Nayar.

The 1994 model depends on sigma through three factors alone, each times a function of the directions. So do the weights,
by polynomials in tan(theta_o/2): nothing is tabulated over sigma. ``tools/fit_oren_nayar.py`` computes the numbers.

Sources:
    Oren & Nayar 1994, Generalization of Lambert's Reflectance Model, SIGGRAPH, doi:10.1145/192161.192213
    Fujii, A tiny improvement of Oren-Nayar reflectance model, https://mimosa-pudica.net/improved-oren-nayar.html
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import cycles, hybrid
from .directions import above, as_directions, as_pair, as_range, as_rgb, dot
from .oren_nayar import oren_nayar

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .directions import Floats

GRAZING_LOSS = (
    np.pi / 2 - 2.0 / 3.0
)  # Fujii's albedo at grazing angles over that from above, less 1, per unit of roughness
# Cycles' rounded average of Fujii's albedo, over A and per unit of roughness; exactly it is within 1e-3 of this.
AVERAGE = (2.0 * np.pi - 5.6) / 3.0
# Roughness below which Cycles' Diffuse BSDF is Lambert's. There float32 has 0 for the light that a bounce leaves out,
# by which it divides; the OSL closure, and in 4.5 the node run as OSL, do so all the same, and are black.
LAMBERT = 1e-5


@dataclass(frozen=True)
class Table:
    """Numbers of one kind. Polynomials in tan(theta_o/2), lowest power first, and ``roughness`` k, c.

    albedo: P of the single bounce's albedo C1 + s2/(s2 + 0.09) P. retro: W of the second closure's colour
    rho s2/(s2 + 0.09) W. native: single scattering's albedo of Cycles' Oren-Nayar at roughness 1. share: of ``hybrid``,
    as ``hybrid_share`` has it.
    """

    albedo: tuple[float, ...]
    retro: tuple[float, ...]
    native: tuple[float, ...]
    roughness: tuple[float, float]
    share: tuple[tuple[tuple[float, ...], ...], ...]


def load(path: Path) -> dict[str, dict[str, Table]]:
    """Both kinds' numbers for each Cycles from ``oren_nayar_fit.toml``."""
    with path.open("rb") as file:
        data: dict[str, Any] = tomllib.load(file)
    return {
        version: {kind: Table(**{name: tuple(found) for name, found in data[version][kind].items()}) for kind in KINDS}
        for version in cycles.VERSIONS
    }


KINDS = ("full", "qualitative")
TABLES = load(Path(__file__).with_suffix(".toml"))


def table(kind: str) -> Table:
    """The numbers of one kind for the current version of Cycles."""
    return TABLES[cycles.version()][kind]


def fujii_albedo(cos: ArrayLike, roughness: ArrayLike) -> Floats:
    """Albedo of white single scattering in Cycles' Oren-Nayar at cosine ``cos`` in [0, 1], ``roughness`` in [0, 1].

    A pi + B [s (t - s c) + 2/3 (s/c (1 - s^3) - s)], A = 1/(pi + (pi/2 - 2/3) roughness), B = roughness A, t the polar
    angle, c and s its cosine and sine.
    """
    c, r = as_range(cos, "cos", 0.0, 1.0), as_range(roughness, "roughness", 0.0, 1.0)
    s = np.sqrt((1.0 - c) * (1.0 + c))
    grazing = s * c * (1.0 + s + s * s) / (1.0 + s)  # s/c (1 - s^3) without its cancelling at c = 0
    return (np.pi + r * (s * (np.arccos(c) - s * c) + 2.0 / 3.0 * (grazing - s))) / (np.pi + GRAZING_LOSS * r)


def cycles_diffuse(wi: ArrayLike, wo: ArrayLike, color: ArrayLike, roughness: ArrayLike) -> Floats:
    """The BRDF of Cycles' Diffuse BSDF and ``oren_nayar_diffuse_bsdf``, in 1/sr, RGB.

    f = color (A + B t) + color^p/pi Ea/(1 - Ea) (1 - E(wi)) (1 - E(wo)) / (1 - color (1 - Ea)),
    t = s/max(n.l, n.v) where s = l.v - (n.l)(n.v) > 0, else s; E = ``fujii_albedo``, Ea its average. The second term
    returns what the first loses, coloured as light that bounced more than once; p is 3 until Blender 5.2, then 2.

    wi, wo: unit vectors (..., 3). color: scalar or RGB in [0, 1]. roughness: in [0, 1]. 0 below the surface.
    Source: Fujii's improved model; the second term as measured in Cycles to 1e-6.
    """
    wi, wo = as_pair(wi, wo)
    rho = as_rgb(color, "color", 0.0, 1.0) * np.ones(3)
    r = as_range(roughness, "roughness", 0.0, 1.0)
    lit = above(wi, wo)
    ni, no = np.where(lit, wi[..., 2], 1.0), np.where(lit, wo[..., 2], 1.0)
    A = 1.0 / (np.pi + GRAZING_LOSS * r)
    s = dot(wi[..., :2], wo[..., :2])
    once = A * (1.0 + r * np.where(s > 0, s / np.maximum(ni, no), s))
    Ea = A * (np.pi + AVERAGE * r)
    lost = (1.0 - fujii_albedo(np.minimum(ni, 1.0), r)) * (1.0 - fujii_albedo(np.minimum(no, 1.0), r))
    again = np.where(r > 0, Ea / np.where(r > 0, 1.0 - Ea, 1.0), 0.0) * lost / np.pi
    f = rho * once[..., None] + rho ** cycles.oren_nayar_power() * again[..., None] / (
        1.0 - rho * (1.0 - Ea)[..., None]
    )
    return np.where(lit[..., None], f, 0.0)


def closure_roughness(sigma: ArrayLike, *, qualitative: bool = False) -> Floats:
    """Roughness of Cycles' own Oren-Nayar that is nearest to ``sigma``: min(1, k s2/(s2 + c)); 0 below ``LAMBERT``."""
    s2 = np.square(as_range(sigma, "sigma", 0.0, np.pi / 2))
    k, c = table(KINDS[qualitative]).roughness
    roughness = np.minimum(1.0, k * s2 / (s2 + c))
    return np.where(roughness < LAMBERT, 0.0, roughness)


def weights(
    cos_o: ArrayLike, albedo: ArrayLike, sigma: ArrayLike, *, qualitative: bool = False
) -> tuple[Floats, Floats]:
    """Colours (..., 3) of the Lambertian closure and of Cycles' Oren-Nayar of roughness 1.

    The second carries the retro-reflection; the first is the 1994 model's albedo, at most 1, less the second's.
    cos_o: n.v in [0, 1], (...). albedo: scalar or RGB in [0, 1]. sigma: radians, in [0, pi/2].
    """
    x = half_tangent(as_range(cos_o, "cos_o", 0.0, 1.0))[..., None]
    rho = as_rgb(albedo, "albedo", 0.0, 1.0) * np.ones(3)
    s2 = np.square(as_range(sigma, "sigma", 0.0, np.pi / 2))[..., None]
    of = table(KINDS[qualitative])
    facing = s2 / (s2 + 0.09)
    once = 1.0 - 0.5 * s2 / (s2 + 0.33) + facing * polynomial(of.albedo, x)
    twice = 0.0 if qualitative else 0.17 * s2 / (s2 + 0.13)  # its cos p averages out
    retro = rho * facing * polynomial(of.retro, x)
    energy = np.minimum(rho * (once + rho * twice), 1.0)
    return np.maximum(energy - native_albedo(of, x, retro), 0.0), retro


def native_albedo(of: Table, x: Floats, color: Floats) -> Floats:
    """Directional albedo of Cycles' Oren-Nayar of roughness 1 and ``color``: the integral of ``cycles_diffuse``."""
    single = polynomial(of.native, x)
    again = color ** cycles.oren_nayar_power() * MEAN * (1.0 - single) / (1.0 - color * (1.0 - MEAN))
    return color * single + again


MEAN = (np.pi + AVERAGE) / (np.pi + GRAZING_LOSS)  # Ea at roughness 1


def half_tangent(cos: Floats) -> Floats:
    """tan(theta/2): at both ends smooth in the angle, as cos is not at the normal nor sin at the horizon."""
    return np.sqrt((1.0 - cos) / (1.0 + cos))


def polynomial(coefficients: tuple[float, ...], x: Floats) -> Floats:
    """Lowest power first."""
    return np.asarray(np.polynomial.polynomial.polyval(x, coefficients), dtype=np.float64)


def oren_nayar_fit(
    wi: ArrayLike, wo: ArrayLike, albedo: ArrayLike, sigma: ArrayLike, *, qualitative: bool = False
) -> Floats:
    """The fitted BRDF in 1/sr, RGB (..., 3), as estimator ``fit`` renders it; parameters as ``oren_nayar``."""
    wi, wo = as_pair(wi, wo)
    lambert, retro = weights(np.clip(wo[..., 2], 0.0, 1.0), albedo, sigma, qualitative=qualitative)
    return lambert / np.pi * above(wi, wo)[..., None] + cycles_diffuse(wi, wo, retro, 1.0)


def hybrid_share(wo: ArrayLike, sigma: ArrayLike, bound: ArrayLike, *, qualitative: bool = False) -> Floats:
    """c, the share of the fit that ``hybrid`` leaves to Cycles' own closures, (...), from 0 to 1.

    The largest c for which the integral of (c f_fit - f)+ cos over wi is at most ``bound`` times that of f cos, for
    every albedo. A polynomial in 2x - 1, x = tan(theta_o/2), in 2 s2/(s2 + 0.09) - 1 and in the logarithm of the bound
    that lies below all of these (tools/fit_oren_nayar.py).

    wo: unit vectors (..., 3); sigma: [0, pi/2]; bound: 0.001 to 0.05. Raises ValueError outside these ranges.
    """
    x = half_tangent(np.clip(as_directions(wo, "wo")[..., 2], 0.0, 1.0))
    s2 = np.square(as_range(sigma, "sigma", 0.0, np.pi / 2))
    of = table(KINDS[qualitative])
    return hybrid.share(np.array(of.share), 2.0 * x - 1.0, 2.0 * s2 / (s2 + 0.09) - 1.0, bound)


def oren_nayar_hybrid(
    wi: ArrayLike, wo: ArrayLike, albedo: ArrayLike, sigma: ArrayLike, bound: ArrayLike, *, qualitative: bool = False
) -> Floats:
    """The BRDF that ``hybrid`` renders, max(f, c f_fit) with c = ``hybrid_share``, in 1/sr, RGB (..., 3)."""
    c = hybrid_share(wo, sigma, bound, qualitative=qualitative)[..., None]
    near = oren_nayar_fit(wi, wo, albedo, sigma, qualitative=qualitative)
    return np.maximum(oren_nayar(wi, wo, albedo, sigma, qualitative=qualitative), c * near)
