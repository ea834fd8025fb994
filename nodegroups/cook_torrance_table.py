# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit`` as the shaders take it: vectors with one component a lobe. Needs no Blender."""

from __future__ import annotations

from math import log

from ..addon.reference.cook_torrance_fit import BOUNDS, table

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


def share() -> list[list[list[float]]]:
    """Coefficients [j][k][l] of (2x - 1)^j (2m - 1)^k b^l of ``hybrid``'s share; b by ``bound_line``."""
    return [[[float(c) for c in powers] for powers in row] for row in table()["share"]]


def bound_line() -> tuple[float, float]:
    """a and d of b = a log(bound) + d, which is -1 at the lowest bound and 1 at the highest."""
    low, high = (log(bound) for bound in BOUNDS)
    return 2.0 / (high - low), -(high + low) / (high - low)


def header() -> str:
    """OSL text: the polynomials as functions ``fit_NAME(x, m)`` by Horner's rule."""
    functions = [
        _function("vector", name, [[f"vector({a:.9g}, {b:.9g}, {c:.9g})" for a, b, c in row] for row in by_lobe(name)])
        for name in ("weight", "anisotropy", "tilt")
    ]
    functions.append(_function("float", "across", [[f"{c:.9g}" for c in row] for row in shared("across")]))
    functions.append(_share())
    return "\n".join([f"#define FIT_LOBES {count()}", "", *functions])


def _share() -> str:
    slope, start = bound_line()
    rows = [
        "("
        + " + n * (".join("(" + " + b * (".join(f"{c:.9g}" for c in powers) + ")" * len(powers) for powers in row)
        + ")" * len(row)
        for row in reversed(share())
    ]
    lines = ["float fit_share(float x, float m, float bound)", "{"]
    lines.append(f"    float y = 2 * x - 1, n = 2 * m - 1, b = {slope:.9g} * log(bound) + {start:.9g}, p = 0;")
    return "\n".join([*lines, *(f"    p = p * y + {row};" for row in rows), "    return clamp(p, 0, 1);", "}", ""])


def _function(kind: str, name: str, rows: list[list[str]]) -> str:
    lines = [
        f"{kind} fit_{name}(float x, float m)",
        "{",
        "    float y = 2 * x - 1, n = 2 * m - 1;",
        f"    {kind} p = 0;",
    ]
    lines += [f"    p = p * y + ({' + n * ('.join(row)}" + ")" * len(row) + ";" for row in reversed(rows)]
    return "\n".join([*lines, "    return p;", "}", ""])
