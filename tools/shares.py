# SPDX-License-Identifier: GPL-3.0-or-later
"""The polynomial by which ``hybrid`` takes its share of ``fit``; for the tools that write the tables."""

import numpy as np
from scipy.optimize import linprog

from vgroove.addon.reference.hybrid import BOUNDS, bound_coordinate

SHARE_BOUNDS = np.geomspace(*BOUNDS, 9)


def highest_share(points: np.ndarray, limits: np.ndarray, degrees: tuple[int, int, int]) -> np.ndarray:
    """Coefficients [j][k][l] of the highest polynomial in y, n and b that lies below all ``limits``, by 2 %.

    And that grows with the bound, as they do. points: y and n, (N, 2); limits: (N, bounds), of ``SHARE_BOUNDS``.
    """
    ladder = [np.polynomial.chebyshev.chebvander(v, d) for v, d in zip((*points.T, b()), degrees, strict=True)]
    basis = np.einsum("nj,nk,bl->nbjkl", *ladder).reshape(*limits.shape, -1)
    size = basis.shape[-1]
    below = np.concatenate([basis.reshape(-1, size), (basis[:, :-1] - basis[:, 1:]).reshape(-1, size)])
    most = np.concatenate([0.98 * limits.ravel(), np.zeros(limits[:, 1:].size)])  # 2 % lower, for what is between
    solved = linprog(-basis.sum(axis=(0, 1)), A_ub=below, b_ub=most, bounds=(None, None), method="highs")
    print(f"share: {solved.message} mean {np.mean(limits):.3f}, of the polynomial {np.mean(basis @ solved.x):.3f}")
    grid = solved.x.reshape([degree + 1 for degree in degrees])
    return np.einsum("abc,aj,bk,cl->jkl", grid, *map(to_powers, degrees))


def b() -> np.ndarray:
    """The coordinate of ``SHARE_BOUNDS``."""
    return bound_coordinate(SHARE_BOUNDS)


def to_powers(degree: int) -> np.ndarray:
    """Row a: the powers of y in the Chebyshev polynomial T_a(y)."""
    rows = np.zeros((degree + 1, degree + 1))
    for a in range(degree + 1):
        chebyshev = np.polynomial.Chebyshev.basis(a)
        rows[a, : a + 1] = chebyshev.convert(kind=np.polynomial.Polynomial).coef
    return rows
