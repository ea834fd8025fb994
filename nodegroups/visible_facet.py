# SPDX-License-Identifier: GPL-3.0-or-later
"""A facet normal for each sample, drawn as the V-groove shows it to the view: ``visible_facet`` of the reference.

Source: Heitz & d'Eon 2014, V-cavity model.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from ._tree import cos, dot, less, log, maximum, normalize, scale, select, sin, sqrt, tangents
from .random_numbers import random_numbers, stream

if TYPE_CHECKING:
    from collections.abc import Callable

    from ._tree import Tree, Value


def beckmann_tangent(u: Value, m: Value) -> Value:
    """tan of a facet's angle, drawn by Beckmann's D(h) (n.h)."""
    return m * sqrt(-log(maximum(1.0 - u, 1e-7)))  # u may round to 1


def visible_facet(
    tree: Tree, N: Value, wo: Value, m: Value, tangent: Callable[[Value, Value], Value] = beckmann_tangent,
    *, axes: tuple[Value, Value] | None = None,
) -> Value:  # fmt: skip
    """h by D(h) (n.h), swapped for its dual across the groove where the view rather sees that.

    tangent: (u, m) -> tan of the angle between h and N, of another D. axes: along the surface, each as long as its
    slope is in units of m; any two unit vectors if left out.
    """
    u1, u2, u3 = random_numbers(tree, stream("FACET"))
    with tree.frame("Facet h by D(h) (n.h), and its dual across the groove"):
        T, B = axes or tangents(N)
        tan = tangent(u1, m)
        phi = 2.0 * pi * u2
        lean = scale(T, tan * cos(phi)) + scale(B, tan * sin(phi))
        h, dual = normalize(N + lean), normalize(N - lean)
    with tree.frame("The side that the view sees"):
        seen, dual_seen = maximum(dot(wo, h), 0.0), maximum(dot(wo, dual), 0.0)
        return select(less(u3 * (seen + dual_seen), seen), h, dual)
