# SPDX-License-Identifier: GPL-3.0-or-later
"""Three facets that stand for the directional albedo of Cook-Torrance: addon/reference/cook_torrance_albedo.toml.

python tools/fit_albedo.py           prints how far the committed table is off, for each slope
python tools/fit_albedo.py --write   makes it anew: Gauss's rule of each slope and view, polynomials through them, and
                                     least squares of the albedo itself over several Fresnel terms
"""

from __future__ import annotations

import sys

import numpy as np
from scipy.optimize import least_squares
from shares import to_powers

from vgroove.addon.reference import Dielectric, Schlick, spherical, vgroove_g
from vgroove.addon.reference import cook_torrance_albedo as quick

DEGREES = 6, 5  # in x and m
SLOPES = (0.001, 0.005, 0.01, 0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)
ANGLES = (*range(0, 80, 4), 80, 82, 84, 86, 87, 88, 88.5, 89, 89.3, 89.6, 89.8, 89.9, 89.97)
FRESNELS = {"eta 1.1": Dielectric(1.1), "eta 1.33": Dielectric(1.33), "eta 1.5": Dielectric(1.5),
            "eta 2.4": Dielectric(2.4), "Schlick 0": Schlick(0.0), "F = 1": Schlick(1.0)}  # fmt: skip
IMPORTANCE = np.array([1.0, 1.0, 1.0, 1.0, 1.0, 0.3])  # F = 1 couples with no base
RADII, TURNS = 96, 64


class Cell:
    """One slope and view: the cosines of its facets and how much light each sends on."""

    def __init__(self, m: float, degrees: float) -> None:
        self.m, self.wo = m, spherical(np.radians(degrees))
        radius, weight = np.polynomial.legendre.leggauss(RADII)
        radius, weight = 2.0 * m * (radius + 1.0), 2.0 * m * weight  # slopes to 4 m hold all but 1e-7 of the facets
        phi = (np.arange(TURNS) + 0.5) * np.pi / TURNS  # the other half mirrors this one
        p, q = radius[:, None] * np.cos(phi), radius[:, None] * np.sin(phi)
        nh = 1.0 / np.sqrt(1.0 + p * p + q * q)
        h = np.stack([p * nh, q * nh, nh], axis=-1)
        vh = h @ self.wo
        wi = 2.0 * vh[..., None] * h - self.wo
        lit = (vh > 1e-12) & (wi[..., 2] > 1e-12)
        wi = wi[lit] / np.linalg.norm(wi[lit], axis=-1, keepdims=True)
        # D (n.h)^4 is Gaussian in the slopes; f cos dwi = P G (v.h) / ((n.h) n.v) dp dq
        P = np.exp(-np.square(radius / m)) / (np.pi * m * m) * radius * weight * 2.0 * np.pi / TURNS
        share = (P[:, None] * vh / nh)[lit] * vgroove_g(wi, self.wo) / self.wo[2]
        self.cosine, self.share = vh[lit], share
        self.albedo = np.array([share @ fresnel(self.cosine)[:, 0] for fresnel in FRESNELS.values()])
        self.x = float(quick.grazing(self.wo, m))
        ladder = (
            np.polynomial.chebyshev.chebvander(2.0 * v - 1.0, d) for v, d in zip((self.x, m), DEGREES, strict=True)
        )
        self.basis = np.outer(*ladder).ravel()

    def gauss(self) -> tuple[np.ndarray, np.ndarray]:
        """Cosines and weights of the three-point rule, by the recurrence of its orthogonal polynomials."""
        before, now, b = np.zeros_like(self.cosine), np.ones_like(self.cosine), 0.0
        diagonal, beside = [], []
        for _ in range(3):
            size = self.share @ now**2
            a = self.share @ (self.cosine * now**2) / size
            before, now = now, (self.cosine - a) * now - b * before
            b = self.share @ now**2 / size
            diagonal.append(a)
            beside.append(np.sqrt(b))
        matrix = np.diag(diagonal) + np.diag(beside[:2], 1) + np.diag(beside[:2], -1)
        cosine, vectors = np.linalg.eigh(matrix)
        return cosine, self.share.sum() * vectors[0] ** 2


def coefficients(cells: list[Cell]) -> np.ndarray:
    """[cosine or weight, basis, facet] of Chebyshev polynomials in 2x - 1 and 2m - 1."""
    basis = np.array([cell.basis for cell in cells])
    m, upright = np.array([cell.m for cell in cells])[:, None], np.array([cell.wo[2] for cell in cells])[:, None]
    rules = [cell.gauss() for cell in cells]
    lean = np.array([(cosine - cell.wo[2]) / cell.m for cell, (cosine, _) in zip(cells, rules, strict=True)])
    start = [
        np.linalg.lstsq(basis * (m + 0.02), lean * (m + 0.02), rcond=None)[0],  # a small m forgives
        np.linalg.lstsq(basis, np.array([weight for _, weight in rules]), rcond=None)[0],
    ]
    exact = np.array([cell.albedo for cell in cells])

    def errors(flat: np.ndarray) -> np.ndarray:
        t, w = basis @ flat.reshape(2, -1, 3)
        cosine, weight = np.clip(upright + m * t, 0.0, 1.0), np.maximum(w, 0.0)
        found = np.stack([np.sum(F(cosine)[..., 0] * weight, axis=1) for F in FRESNELS.values()], axis=1)
        return ((found - exact) * IMPORTANCE).ravel()

    near = least_squares(errors, np.ravel(start), max_nfev=15).x
    # Fourth powers, to bring the largest down
    return least_squares(lambda flat: np.square(300.0 * errors(flat)), near, max_nfev=15).x.reshape(2, -1, 3)


def write(cells: list[Cell]) -> None:
    lines = [
        "# SPDX-License-Identifier: GPL-3.0-or-later",
        "# Made by tools/fit_albedo.py; meanings in cook_torrance_albedo.py",
    ]
    for name, grid in zip(("cosine", "weight"), coefficients(cells), strict=True):
        lines.append(f"{name} = [")
        for facet in grid.T.reshape(3, *(degree + 1 for degree in DEGREES)):
            powers = np.einsum("ab,aj,bk->jk", facet, *map(to_powers, DEGREES))
            lines += ["  [", *(f"    [{', '.join(f'{c:.9g}' for c in row)}]," for row in powers), "  ],"]
        lines.append("]")
    quick.TABLE.write_text("\n".join(lines) + "\n", encoding="utf-8")
    quick.table.cache_clear()


def report(cells: list[Cell]) -> None:
    """The largest difference from the integral over all views, in units of 0.001."""
    print("    m" + "".join(f"{name:>11}" for name in FRESNELS))
    for m in SLOPES:
        here = [cell for cell in cells if cell.m == m]
        off = [[quick.quick_albedo(c.wo, m, F)[0] - e for F, e in zip(FRESNELS.values(), c.albedo, strict=True)]
               for c in here]  # fmt: skip
        print(f"{m:5.2f}" + "".join(f"{1000.0 * worst:11.2f}" for worst in np.max(np.abs(off), axis=0)))


if __name__ == "__main__":
    every = [Cell(m, degrees) for m in SLOPES for degrees in ANGLES]
    if "--write" in sys.argv:
        write(every)
    report(every)
