# SPDX-License-Identifier: GPL-3.0-or-later
"""Polynomials of the fits' tables, as nodes and as OSL text, by Horner's rule. Lowest degree first everywhere."""

from __future__ import annotations

from functools import partial
from math import log
from typing import TYPE_CHECKING

from ..addon.reference.hybrid import BOUNDS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ._tree import Number, Tree, Value

    Row = Sequence[Number]

REVISION = 1
NESTED = 4  # coefficients from which a nested group takes less of a file than the nodes that it holds


def horner(coefficients: Row, x: Value) -> Value:
    """Sum of c_k x^k; three at once where the coefficients are triples."""
    *rest, before, last = coefficients
    result = x.tree.math("MULTIPLY_ADD", x, last, before)
    for number in reversed(rest):
        result = x.tree.math("MULTIPLY_ADD", x, result, number)
    return result


def polynomial(coefficients: Row, x: Value) -> Value:
    """``horner``, of many coefficients through a nested group, which a file has once for each number of them."""
    if len(coefficients) < NESTED:
        return horner(coefficients, x)
    vector = any(isinstance(one, tuple) or getattr(one, "is_vector", False) for one in (x, *coefficients))
    degree = len(coefficients) - 1
    given = {f"c{k}": number for k, number in enumerate(coefficients)}
    name, build_group = f"Polynomial {degree}{' Vector' * vector}", partial(build, degree=degree, vector=vector)
    return x.tree.nested_value(name, REVISION, build_group, x=x, **given)


def build(tree: Tree, degree: int, *, vector: bool) -> None:
    def number(name: str, tip: str) -> Value:
        if vector:
            return tree.input_vector(name, tip=tip)
        return tree.input_float(name, 0.0, low=-1e30, high=1e30, tip=tip)

    x, *coefficients = number("x", "Variable"), *(number(f"c{k}", f"Of x^{k}") for k in range(degree + 1))
    give = tree.output_vector if vector else tree.output_float
    give("Sum", horner(coefficients, x), tip="By Horner's rule")


def horner2(rows: Sequence[Row], y: Value, n: Value) -> Value:
    """Sum of c_jk y^j n^k; what depends on n alone comes first, for Cycles to fold it where n is constant."""
    return horner([polynomial(row, n) for row in rows], y)


def share(rows: Sequence[Sequence[Row]], y: Value, n: Value, bound: Value) -> Value:
    """Sum of c_jkl y^j n^k b^l, held to 0..1: ``share`` of the reference's hybrid."""
    from ._tree import clamp, log  # here, as tables need this module without Blender

    line, start = bound_line()
    b = line * log(bound) + start
    return clamp(horner([polynomial([horner(powers, b) for powers in row], n) for row in rows], y))


def bound_line() -> tuple[float, float]:
    """a and d of b = a log(bound) + d, which is -1 at the lowest bound and 1 at the highest."""
    low, high = (log(bound) for bound in BOUNDS)
    return 2.0 / (high - low), -(high + low) / (high - low)


# OSL


def horner_text(coefficients: Sequence[str], x: str) -> str:
    """c_0 + x (c_1 + x (...))."""
    return "(" + f" + {x} * (".join(coefficients) + ")" * len(coefficients)


def function_text(kind: str, name: str, arguments: str, rows: Sequence[Sequence[str]], start: str) -> str:
    """An OSL function: sum of c_jk y^j n^k, y and n defined by ``start``."""
    lines = [f"{kind} {name}({arguments})", "{", f"    {start}", f"    {kind} p = 0;"]
    lines += [f"    p = p * y + {horner_text(row, 'n')};" for row in reversed(rows)]
    return "\n".join([*lines, "    return p;", "}", ""])


def share_text(name: str, rows: Sequence[Sequence[Sequence[float]]]) -> str:
    """OSL function ``NAME(y, n, bound)``, not yet held to 0..1."""
    slope, start = bound_line()
    written = [[horner_text([f"{c:.9g}" for c in powers], "b") for powers in row] for row in rows]
    b = f"float b = {slope:.9g} * log(bound) + {start:.9g};"
    return function_text("float", name, "float y, float n, float bound", written, b)
