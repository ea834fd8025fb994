# SPDX-License-Identifier: GPL-3.0-or-later
"""max(a . b, 0)^n of unit vectors: exp(-n/2 log(1 + tan^2)), ``cosine_power`` of the reference.

A cosine near 1 has few digits in float32, and a high power loses those: the tangent has them all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import ensure
from ._tree import Value, dot, exp, greater, less, log, maximum, scale, select

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Cosine Power"
REVISION = 2


def build(tree: Tree) -> None:
    a, b = (tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("a", "b"))
    n = tree.input_float("n", 50.0, low=0.0, high=1e4, tip="Exponent")
    with tree.frame("tan^2 by components: 1 - cos^2 would cancel"):
        cos = dot(a, b)
        ahead = maximum(cos, 1e-4)
        across = a - scale(b, cos)
        tan2 = dot(across, across) / (ahead * ahead)
    with tree.frame("log(1 + tan^2), by a series where 1 + tan^2 would round: y = tan^2 / (2 + tan^2)"):
        y = tan2 / (2.0 + tan2)
        y2 = y * y
        small = y * (2.0 + y2 * (2.0 / 3.0 + y2 * 0.4))
        logarithm = select(less(tan2, 0.1), small, log(1.0 + tan2))
    tree.output_float("Power", exp(n * logarithm * -0.5) * greater(cos, 0.0), tip="cos^n, 0 beyond 90 degrees")


def cosine_power(tree: Tree, a: Value, b: Value, n: Value) -> Value:
    """max(a . b, 0)^n through the nested group."""
    node = tree.group(ensure(NAME, REVISION, build), a=a, b=b, n=n)
    return Value(tree, node.outputs["Power"])
