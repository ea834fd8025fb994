# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute the table of ``addon/reference/groove_fit.py``: what one bounce leaves of the light, by slope and view.

    python tools/fit_groove.py

Albedos with F = 1 by Gauss-Legendre rules over the facets' slopes; of the V-groove's first bounce by
``vgroove_albedo``. Takes ten minutes, and prints what the table misses half way between its nodes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vgroove.addon.reference.cook_torrance_fit import PLACES, mixture
from vgroove.addon.reference.directions import dot, half_vector, reflect
from vgroove.addon.reference.distributions import beckmann_d, smith_g
from vgroove.addon.reference.groove import WHITE, bounce_albedos
from vgroove.addon.reference.groove_fit import NAMES, TABLE, slope
from vgroove.addon.reference.quadrature import vgroove_albedo

if TYPE_CHECKING:
    from collections.abc import Callable

    from vgroove.addon.reference.directions import Floats

EDGES = np.array([0.0, 0.5, 1.0, 1.6, 2.4, 3.5, 8.0])  # of panels in tan(t) / m
HEAD = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Made by tools/fit_groove.py; meanings in groove_fit.py\n"
LOWEST = 1e-3  # cosine of the view that stands for grazing


def over_facets(wo: Floats, m: float, f_cos: Callable[[Floats, Floats], Floats], nodes: tuple[int, int]) -> float:
    """Integral of f cos over wi, by facets h: dwi = 4 (v.h) dh."""
    (x, of_x), (y, of_y) = (np.polynomial.legendre.leggauss(count) for count in nodes)
    width = np.diff(EDGES * m)[:, None]
    tan, of_tan = ((EDGES[:-1, None] * m + width * (x + 1.0) / 2.0).ravel(), (width * of_x / 2.0).ravel())
    phi, of_phi = np.pi * (y + 1.0) / 2.0, np.pi * of_y / 2.0
    t, p = np.meshgrid(tan, phi, indexing="ij")
    z = 1.0 / np.sqrt(1.0 + t * t)
    h = np.stack([t * np.cos(p), t * np.sin(p), np.ones_like(t)], axis=-1) * z[..., None]
    views = np.broadcast_to(wo, h.shape)
    vh, wi = dot(views, h), reflect(views, h)
    sent = (vh > 0.0) & (wi[..., 2] > 0.0)
    f = np.where(sent, f_cos(np.where(sent[..., None], wi, views), views), 0.0)
    return float(2.0 * np.sum(f * 4.0 * np.maximum(vh, 0.0) * t * z**3 * of_tan[:, None] * of_phi))


def smith(m: float) -> Callable[[Floats, Floats], Floats]:
    """f cos of Cycles' Beckmann closure with F = 1."""
    return lambda wi, wo: beckmann_d(half_vector(wi, wo), m) * smith_g(wi, wo, m) / (4.0 * wo[..., 2])


def numbers(m: float, u: float, nodes: tuple[int, int] = (32, 128)) -> tuple[float, ...]:
    """Each of ``NAMES`` at one slope and view; c of u = m (1 - c) / (c + m)."""
    c = max(m * (1.0 - u) / (m + u), LOWEST)
    wo, narrow = np.array([np.sqrt(1.0 - c * c), 0.0, c]), float(slope(m))
    own = over_facets(wo, narrow, smith(narrow), nodes)
    firsts = (
        float(vgroove_albedo(wo, m, WHITE)[0]),
        over_facets(wo, m, lambda wi, wo: mixture(wi, wo, m), nodes),
        over_facets(wo, m, smith(m), nodes),
    )
    again = bounce_albedos(wo, m, WHITE)[1:, 0]
    third = again[1:].sum() / again.sum() if again.sum() > 1e-9 else 0.0
    return *(max(0.0, (1.0 - E) / own) for E in firsts), float(third)


def main() -> None:
    roots, views = PLACES
    found = np.array([[numbers(float(root) ** 2, float(u)) for u in views] for root in roots])
    with TABLE.open("w", encoding="utf-8") as file:
        file.write(HEAD)
        for index, name in enumerate(NAMES):
            rows = (", ".join(f"{value:.4g}" for value in np.round(row, 4)) for row in found[..., index])
            file.write(f"{name} = [\n" + "".join(f"  [{row}],\n" for row in rows) + "]\n")
    for j in range(5, len(roots) - 1, 3):
        m = float(0.5 * (roots[j] + roots[j + 1])) ** 2
        lacks = [
            found[j : j + 2, k : k + 2, :3].mean(axis=(0, 1)) - numbers(m, float(0.5 * (views[k] + views[k + 1])))[:3]
            for k in range(0, len(views) - 3, 5)
        ]
        print(f"m {m:.3f}: off by up to", np.abs(lacks).max(axis=0).round(4))


if __name__ == "__main__":
    main()
