# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit`` as the shaders take it: vectors with one component a lobe. Needs no Blender."""

from __future__ import annotations

from ..addon.reference.cook_torrance_fit import ALONE, HALF_CLIPPED, MOST_LEAN, table
from .polynomial import CHEBYSHEV, series_text, share_text

Vector = tuple[float, float, float]


def count() -> int:
    """How many lobes the mixture has; three at most."""
    return len(table()["weight"])


def by_lobe(name: str) -> list[list[Vector]]:
    """Coefficients [j][k] of T_j(2x - 1) T_k(2m - 1) of one function."""
    numbers = table()[name]
    padded = [[[float(c) for c in row] for row in lobe] for lobe in numbers]
    padded += [[[0.0] * len(row) for row in padded[0]] for _ in range(3 - len(padded))]
    first, second, third = padded
    return [list(zip(*rows, strict=True)) for rows in zip(first, second, third, strict=True)]


def shared(name: str) -> list[list[Vector]]:
    """The same of a function that all lobes share: in the first component."""
    (rows,) = table()[name]
    return [[(float(c), 0.0, 0.0) for c in row] for row in rows]


def share() -> list[list[list[float]]]:
    """Coefficients [j][k][l] of (2x - 1)^j (2m - 1)^k b^l of ``hybrid``'s share; b by ``polynomial.bound_line``."""
    return [[[float(c) for c in powers] for powers in row] for row in table()["share"]]


def header() -> str:
    """OSL text: the polynomials as functions ``fit_NAME(Ty, Tn)``, and ``fit_share_at(y, n, bound)``."""
    functions = []
    for name in ("weight", "anisotropy", "tilt"):
        rows = [[f"vector({a:.9g}, {b:.9g}, {c:.9g})" for a, b, c in row] for row in by_lobe(name)]
        functions.append(series_text("vector", f"fit_{name}", rows))
    rows = [[f"{c:.9g}" for c, *_ in row] for row in shared("across")]
    functions.append(series_text("float", "fit_across", rows))
    functions.append(share_text("fit_share_at", share()))
    numbers = {"LOBES": count(), "ALONE": ALONE, "HALF_CLIPPED": HALF_CLIPPED}
    numbers |= {"CHEBYSHEV": CHEBYSHEV, "MOST_LEAN": MOST_LEAN}
    return "\n".join([*(f"#define FIT_{name} {number}" for name, number in numbers.items()), "", *functions])
