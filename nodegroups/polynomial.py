# SPDX-License-Identifier: GPL-3.0-or-later
"""Polynomials of the fits' tables, as nodes and as OSL text: in Chebyshev's basis, or in powers by Horner's rule.

Lowest degree first everywhere. Chebyshev's basis is for high degrees, whose powers float32 would round too much.
"""

from __future__ import annotations

from math import log
from typing import TYPE_CHECKING

from ..addon.reference.hybrid import BOUNDS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ._tree import Number, Tree, Value

    Row = Sequence[Number]


def horner(coefficients: Row, x: Value) -> Value:
    """Sum of c_k x^k."""
    *rest, last = coefficients
    result = x * last
    for number in reversed(rest[1:]):
        result = (result + number) * x
    return result + rest[0]


def horner2(rows: Sequence[Row], y: Value, n: Value) -> Value:
    """Sum of c_jk y^j n^k; what depends on n alone comes first, for Cycles to fold it where n is constant."""
    return _in_y([horner(row, n) for row in rows], y)


def chebyshev(x: Value, degree: int) -> list[Value]:
    """U_1 to U_degree at x, Chebyshev's polynomials T_k but for a sign: U_k = -T_k where k mod 4 is 2 or 3.

    With it T_(k+1) = 2 x T_k - T_(k-1) needs one node a degree: U_(k+1) = -+2 x U_k + U_(k-1).
    """
    twice = 2.0 * x
    factors = (-twice, twice)
    found = [x, x.tree.math("MULTIPLY_ADD", factors[0], x, 1.0)]
    while len(found) < degree:
        factor = factors[(len(found) + 1) % 2]
        found.append(x.tree.math("MULTIPLY_ADD", factor, found[-1], found[-2]))
    return found[:degree]


def of_signs(rows: Sequence[Sequence[Number]]) -> list[list[Number]]:
    """c_jk T_j(y) T_k(n) as coefficients of U_j(y) U_k(n)."""
    sign = (1.0, 1.0, -1.0, -1.0)

    def turned(c: Number, by: float) -> Number:
        return tuple(by * part for part in c) if isinstance(c, tuple) else by * c  # type: ignore[return-value]

    return [[turned(c, sign[j % 4] * sign[k % 4]) for k, c in enumerate(row)] for j, row in enumerate(rows)]


def series(coefficients: Sequence[Number], U: Sequence[Value]) -> Value:
    """Sum of c_k U_k, U from U_1 on."""
    result, *rest = coefficients
    for number, of in zip(rest, U, strict=True):
        result = of.tree.math("MULTIPLY_ADD", number, of, result)
    return result  # type: ignore[return-value]  # a Value once a term is added


def series2(rows: Sequence[Row], U_y: Sequence[Value], U_n: Sequence[Value]) -> Value:
    """Sum of c_jk T_j(y) T_k(n); what depends on n alone comes first, for Cycles to fold it where n is constant."""
    return series([series(row, U_n) for row in of_signs(rows)], U_y)


def share(rows: Sequence[Sequence[Row]], y: Value, n: Value, bound: Value) -> Value:
    """Sum of c_jkl y^j n^k b^l, held to 0..1: ``share`` of the reference's hybrid."""
    from ._tree import clamp, log  # here, as tables need this module without Blender

    line, start = bound_line()
    b = line * log(bound) + start
    return clamp(_in_y([horner([horner(powers, b) for powers in row], n) for row in rows], y))


def bound_line() -> tuple[float, float]:
    """a and d of b = a log(bound) + d, which is -1 at the lowest bound and 1 at the highest."""
    low, high = (log(bound) for bound in BOUNDS)
    return 2.0 / (high - low), -(high + low) / (high - low)


def _in_y(coefficients: Sequence[Value], y: Value) -> Value:
    tree: Tree = y.tree
    *rest, result = coefficients
    for coefficient in reversed(rest):
        result = tree.math("MULTIPLY_ADD", result, y, coefficient)
    return result


# OSL

CHEBYSHEV = 9  # length of the shaders' arrays of T_0 to T_8


def horner_text(coefficients: Sequence[str], x: str) -> str:
    """c_0 + x (c_1 + x (...))."""
    return "(" + f" + {x} * (".join(coefficients) + ")" * len(coefficients)


def function_text(kind: str, name: str, arguments: str, rows: Sequence[Sequence[str]], start: str) -> str:
    """An OSL function: sum of c_jk y^j n^k, y and n defined by ``start``."""
    lines = [f"{kind} {name}({arguments})", "{", f"    {start}", f"    {kind} p = 0;"]
    lines += [f"    p = p * y + {horner_text(row, 'n')};" for row in reversed(rows)]
    return "\n".join([*lines, "    return p;", "}", ""])


def series_text(kind: str, name: str, rows: Sequence[Sequence[str]]) -> str:
    """OSL function ``NAME(Ty, Tn)``: the sum of c_jk T_j(y) T_k(n), arrays from T_0 on."""
    size = f"float Ty[{CHEBYSHEV}], float Tn[{CHEBYSHEV}]"
    terms = [" + ".join(f"Tn[{k}] * {c}" for k, c in enumerate(row)) for row in rows]
    lines = [f"{kind} {name}({size})", "{", f"    {kind} p = 0;"]
    lines += [f"    p += Ty[{j}] * ({term});" for j, term in enumerate(terms)]
    return "\n".join([*lines, "    return p;", "}", ""])


def share_text(name: str, rows: Sequence[Sequence[Sequence[float]]]) -> str:
    """OSL function ``NAME(y, n, bound)``, not yet held to 0..1."""
    slope, start = bound_line()
    written = [[horner_text([f"{c:.9g}" for c in powers], "b") for powers in row] for row in rows]
    b = f"float b = {slope:.9g} * log(bound) + {start:.9g};"
    return function_text("float", name, "float y, float n, float bound", written, b)
