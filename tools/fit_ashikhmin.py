# SPDX-License-Identifier: GPL-3.0-or-later
"""Find the numbers of addon/reference/ashikhmin_shirley_fit.toml, or print how near estimator ``fit`` comes.

    python tools/fit_ashikhmin.py            L1 of f cos over all wi, in per cent, by exponent and view
    python tools/fit_ashikhmin.py --write    finds the numbers (minutes)

For views and exponents the part of the highlight that Schlick's F adds, A (1 - v.h)^5, is compared with what stands for
it: weight B (1 - v.h)^5 + more A, A the highlight without F and B a Beckmann lobe that is k times as wide within the
plane of view. k, weight and more are 1 + x p, 1 + x p and (1 - n.v)^5 x p, with polynomials p in x = w / (w + n.v) and
m; see ``shape``. Least is the sum of (L1 / aim)^3, L1 being a share of the highlight of Rs = 0.04.
"""

from __future__ import annotations

import sys
from itertools import product

import numpy as np
from scipy.optimize import least_squares

from vgroove.addon.reference import ashikhmin_shirley_fit as fit
from vgroove.addon.reference import spherical
from vgroove.addon.reference.ashikhmin_shirley import SPREAD, AshikhminShirley
from vgroove.addon.reference.cook_torrance_fit import smith_lobe
from vgroove.addon.reference.quadrature import panels

RS = 0.04
EXPONENTS = 0.5, 1.0, 3.0, 6.0, 10.0, 17.0, 30.0, 60.0, 100.0, 300.0, 1e3, 1e4, 1e5
VIEWS = {0: 5, 20: 5, 35: 5, 48: 5, 58: 5, 65: 5, 70: 5, 75: 5, 80: 9, 85: 14, 88: 20}  # degrees, aim in per cent
ROUGHER = ((30.0, 1.0), (10.0, 1.5), (3.0, 2.0), (0.0, 3.0))  # from an exponent on, times the aim
SHAPE = 3, 4  # powers of x and of m
NAMES = "within", "weight", "more"
SHOWN = (10.0, 30.0, 60.0, 100.0, 300.0, 1e3, 1e4), (0.0, 30.0, 45.0, 60.0, 70.0, 75.0, 80.0, 85.0)


class Cell:
    """One exponent and view in the plane of x and z: facets, and the highlight that each of them sends."""

    def __init__(self, n: float, degrees: float, nodes: int = 4) -> None:
        self.m, self.wo = float((2.0 / (n + 2.0)) ** 0.5), spherical(np.radians(degrees))
        s, _, self.c = (float(part) for part in self.wo)
        grazing = np.arctan2(self.c, s) * np.array([-3.0, -1.0, -0.3, -0.1, 0.0, 0.1, 0.3, 1.0, 3.0])
        edges = np.concatenate([np.arange(5) * np.pi / 4, np.pi / 2 + grazing[np.abs(grazing) < 1.2]])
        psi, psi_weight = panels(np.unique(np.clip(edges, 0.0, np.pi)), nodes)
        toward = np.cos(psi)[:, None]
        equal, last = np.maximum(np.arctan2(s * toward, self.c), 0.0), 0.5 * np.arctan2(self.c, -s * toward)
        spread = np.minimum(SPREAD / (n + 1.0) ** 0.5, last)
        t, weight = panels(np.sort(np.concatenate([spread, np.minimum(equal, last), last], axis=-1), axis=-1), nodes)
        h = np.stack([np.sin(t) * toward, np.sin(t) * np.sin(psi)[:, None], np.cos(t)], axis=-1)
        vh = h @ self.wo
        wi = 2.0 * vh[..., None] * h - self.wo
        lit = (vh > 1e-9) & (wi[..., 2] > 1e-9)
        self.h, self.vh, self.wi = h[lit], np.minimum(vh[lit], 1.0), wi[lit]
        self.solid_angle = (8.0 * vh * np.sin(t) * weight * psi_weight[:, None])[lit]  # dwi = 4 (v.h) dh, both sides
        self.A = AshikhminShirley(0.0, 1.0, n, n).density(self.h) / (4.0 * self.vh)
        self.A *= np.minimum(self.wi[:, 2] / self.c, 1.0)
        self.risen = (1.0 - self.vh) ** 5
        self.albedo = RS * self.A @ self.solid_angle + (1.0 - RS) * (self.A * self.risen) @ self.solid_angle
        self.x, self.rise = self.m * s / (self.m * s + self.c), (1.0 - self.c) ** 5
        self.powers = np.array([self.x**j * self.m**k for j, k in product(*map(range, SHAPE))])

    def lobe(self, k: float) -> np.ndarray:
        """f cos of the Beckmann lobe, k times as wide within the plane of view."""
        parts = (tuple(np.moveaxis(w, -1, 0)) for w in (self.wi, self.wo, self.h))
        return smith_lobe(*parts, np.float64(self.m * k), np.float64(self.m))

    def numbers(self, coefficients: np.ndarray) -> tuple[float, float, float]:
        """k, weight, more."""
        k, weight, more = coefficients @ self.powers * self.x
        return float(np.clip(1.0 + k, 0.1, 1.0)), max(float(1.0 + weight), 0.0), max(float(self.rise * more), 0.0)

    def distance(self, coefficients: np.ndarray) -> float:
        """L1 over the albedo of the highlight."""
        k, weight, more = self.numbers(coefficients)
        difference = self.risen * (weight * self.lobe(k) - self.A) + more * self.A
        return float((1.0 - RS) * np.abs(difference) @ self.solid_angle / self.albedo)

    def flat(self, coefficients: np.ndarray) -> float:
        """What the Beckmann lobe sends without F, over what the highlight does."""
        k, weight, _ = self.numbers(coefficients)
        return float(weight * self.lobe(k) @ self.solid_angle / (self.A @ self.solid_angle))


def found() -> dict[str, np.ndarray]:
    """Coefficients [j][k] by name."""
    cells = [(Cell(n, degrees), aim / 100.0 * next(by for start, by in ROUGHER if n >= start))
             for n, (degrees, aim) in product(EXPONENTS, VIEWS.items())]  # fmt: skip
    start = np.zeros((3, *SHAPE))
    start[:, 0, 0] = -0.5, -0.5, 0.5

    def residuals(flat: np.ndarray) -> np.ndarray:
        coefficients = flat.reshape(3, -1)
        off = [(cell.distance(coefficients) / aim) ** 1.5 for cell, aim in cells]
        return np.concatenate([off, 3e-4 * flat])  # large coefficients that cancel would cost float32 its digits

    best = least_squares(residuals, start.ravel(), max_nfev=300, diff_step=1e-4).x.reshape(3, -1)
    return completed([cell for cell, _ in cells], best)


def completed(cells: list[Cell], best: np.ndarray) -> dict[str, np.ndarray]:
    """With what the light of either lobe says by itself: flat = 1 + x p, and mean = (1 - n.v + m p)^5."""
    of_flat, of_mean = (np.array([by * cell.powers for by, cell in zip(scale, cells, strict=True)])
                        for scale in ([cell.x for cell in cells], [cell.m for cell in cells]))  # fmt: skip
    flat = np.linalg.lstsq(of_flat, np.array([cell.flat(best) - 1.0 for cell in cells]), rcond=None)[0]
    means = np.array([(cell.A * cell.risen) @ cell.solid_angle / (cell.A @ cell.solid_angle) for cell in cells])
    mean = np.linalg.lstsq(of_mean, means**0.2 - np.array([1.0 - cell.c for cell in cells]), rcond=None)[0]
    return {name: of.reshape(SHAPE) for name, of in zip((*NAMES, "flat", "mean"), (*best, flat, mean), strict=True)}


def text(tables: dict[str, np.ndarray]) -> str:
    """As TOML."""
    lines = ["# SPDX-License-Identifier: GPL-3.0-or-later", "# Written by tools/fit_ashikhmin.py"]
    for name, rows in tables.items():
        written = [f"    [{', '.join(f'{number:.6g}' for number in row)}]," for row in rows.tolist()]
        lines += ["", f"{name} = [", *written, "]"]
    return "\n".join(lines) + "\n"


def l1(model: AshikhminShirley, degrees: float, azimuth: float = 0.0, nodes: int = 48) -> np.ndarray:
    """Integral of |f_fit - f| cos over that of f cos, (3,): over facets, and over wi where the highlight is not."""
    wo = spherical(np.radians(degrees), np.radians(azimuth))
    x, weight = np.polynomial.legendre.leggauss(nodes)
    u, v = 0.5 * (x + 1.0), (np.arange(2 * nodes) + 0.5) / (2 * nodes)
    u1 = -np.expm1(-16.0 * u**2)  # even in the facet's slope, to exp(-16) of the lobe
    area = (0.5 * weight * 32.0 * u * np.exp(-16.0 * u**2))[:, None] / (2 * nodes)
    h = model.facet(np.stack(np.broadcast_arrays(u1[:, None], v), axis=-1))
    vh = h @ wo
    wi = 2.0 * vh[..., None] * h - wo
    lit = (vh > 1e-9) & (wi[..., 2] > 1e-9)
    wi, solid_angle = wi[lit], (area * 4.0 * vh / model.density(h))[lit]
    wi = wi / np.linalg.norm(wi, axis=-1, keepdims=True)
    f, shown = (of(wi, wo) * wi[:, 2:] for of in (model.evaluate, model.rendered("fit", 0.0)))
    return solid_angle @ np.abs(shown - f) / (solid_angle @ f)


def main() -> int:
    """See above."""
    if sys.argv[1:] == ["--write"]:
        fit.PATH.write_text(text(found()), encoding="utf-8", newline="\n")
        fit.table.cache_clear()
    for color in ((RS,) * 3, (1.0, 0.77, 0.34)):
        print(f"Rs = {color}, view in degrees", *(f"{degrees:5.0f}" for degrees in SHOWN[1]))
        for n in SHOWN[0]:
            off = [100.0 * l1(AshikhminShirley(0.0, color, n, n), degrees).max() for degrees in SHOWN[1]]
            print(f"n = {n:6g}", *(f"{one:5.1f}" for one in off))
    return 0


if __name__ == "__main__":
    sys.exit(main())
