# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit`` as the shaders take it: vectors with one component a lobe. Needs no Blender."""

from __future__ import annotations

from ..addon.reference.cook_torrance_fit import FUNCTIONS, table

Vector = tuple[float, float, float]


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


def header() -> str:
    """OSL text: the polynomials as functions ``fit_NAME(x, m)`` by Horner's rule."""
    return "\n".join([f"#define FIT_LOBES {count()}", "", *(_function(name) for name in FUNCTIONS)])


def _function(name: str) -> str:
    lines = [
        f"vector fit_{name}(float x, float m)",
        "{",
        "    float y = 2 * x - 1, n = 2 * m - 1;",
        "    vector p = 0;",
    ]
    for row in reversed(by_lobe(name)):
        of_m = " + n * (".join(f"vector({a:.9g}, {b:.9g}, {c:.9g})" for a, b, c in row)
        lines.append(f"    p = p * y + ({of_m}" + ")" * len(row) + ";")
    return "\n".join([*lines, "    return p;", "}", ""])
