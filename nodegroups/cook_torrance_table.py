# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit`` as the shaders take it: vectors with one component a lobe. Needs no Blender."""

from __future__ import annotations

from ..addon.reference.cook_torrance_fit import table

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


def shared(name: str) -> list[list[float]]:
    """The same of a function that all lobes share."""
    (rows,) = table()[name]
    return [[float(c) for c in row] for row in rows]


def header() -> str:
    """OSL text: the polynomials as functions ``fit_NAME(x, m)`` by Horner's rule."""
    functions = [
        _function("vector", name, [[f"vector({a:.9g}, {b:.9g}, {c:.9g})" for a, b, c in row] for row in by_lobe(name)])
        for name in ("weight", "anisotropy", "tilt")
    ]
    functions.append(_function("float", "across", [[f"{c:.9g}" for c in row] for row in shared("across")]))
    return "\n".join([f"#define FIT_LOBES {count()}", "", *functions])


def _function(kind: str, name: str, rows: list[list[str]]) -> str:
    lines = [
        f"{kind} fit_{name}(float x, float m)",
        "{",
        "    float y = 2 * x - 1, n = 2 * m - 1;",
        f"    {kind} p = 0;",
    ]
    lines += [f"    p = p * y + ({' + n * ('.join(row)}" + ")" * len(row) + ";" for row in reversed(rows)]
    return "\n".join([*lines, "    return p;", "}", ""])
