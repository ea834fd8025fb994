# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit`` as the shaders take it: vectors with one component a lobe. Needs no Blender."""

from __future__ import annotations

from ..addon.reference.cook_torrance_fit import ALONE, HALF_CLIPPED, table
from .polynomial import function_text, share_text

Vector = tuple[float, float, float]
CENTRED = "float y = 2 * x - 1, n = 2 * m - 1;"


def count() -> int:
    """How many lobes the mixture has; three at most."""
    return len(table()["weight"])


def by_lobe(name: str) -> list[list[Vector]]:
    """Coefficients [j][k] of (2x - 1)^j (2m - 1)^k of one function."""
    numbers = table()[name]
    padded = [[[float(c) for c in row] for row in lobe] for lobe in numbers]
    padded += [[[0.0] * len(row) for row in padded[0]] for _ in range(3 - len(padded))]
    first, second, third = padded
    return [list(zip(*rows, strict=True)) for rows in zip(first, second, third, strict=True)]


def shared(name: str) -> list[list[float]]:
    """The same of a function that all lobes share."""
    (rows,) = table()[name]
    return [[float(c) for c in row] for row in rows]


def share() -> list[list[list[float]]]:
    """Coefficients [j][k][l] of (2x - 1)^j (2m - 1)^k b^l of ``hybrid``'s share; b by ``polynomial.bound_line``."""
    return [[[float(c) for c in powers] for powers in row] for row in table()["share"]]


def header() -> str:
    """OSL text: the polynomials as functions ``fit_NAME(x, m)`` by Horner's rule, and ``fit_share_at(y, n, bound)``."""
    arguments = "float x, float m"
    functions = []
    for name in ("weight", "anisotropy", "tilt"):
        rows = [[f"vector({a:.9g}, {b:.9g}, {c:.9g})" for a, b, c in row] for row in by_lobe(name)]
        functions.append(function_text("vector", f"fit_{name}", arguments, rows, CENTRED))
    rows = [[f"{c:.9g}" for c in row] for row in shared("across")]
    functions.append(function_text("float", "fit_across", arguments, rows, CENTRED))
    functions.append(share_text("fit_share_at", share()))
    numbers = {"LOBES": count(), "ALONE": ALONE, "HALF_CLIPPED": HALF_CLIPPED}
    return "\n".join([*(f"#define FIT_{name} {number}" for name, number in numbers.items()), "", *functions])
