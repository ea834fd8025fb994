# SPDX-License-Identifier: GPL-3.0-or-later
"""The tangent that a brushed surface is shaded with: linked, else of the UV map, else Blender's own around the Z axis.

What is nearly along the normal, or has no length, gives way to any direction along the surface.
"""

from __future__ import annotations

from functools import partial
from math import pi
from typing import TYPE_CHECKING

from . import ensure
from ._tree import (
    Tree,
    Value,
    cos,
    cross,
    dot,
    greater,
    maximum,
    minimum,
    normalize,
    output,
    scale,
    select,
    sin,
    tangents,
)
from .shading_normal import LONGEST

if TYPE_CHECKING:
    from ._tree import Number

NAME = ".VGroove Tangent"
REVISION = 1
TIP = "Direction along the surface that Anisotropy is about, from a Tangent node"
SHORTEST = 1e-6  # squared sine of the angle to the normal below which a tangent has no direction


def interface(tree: Tree, *, radial: bool) -> Value:
    """The input "Tangent", hidden value. An unlinked group input reads (0, 0, 0)."""
    default = "around the object's Z axis" if radial else "the UV map's u axis, or around the Z axis without one"
    return tree.input_vector("Tangent", hide_value=True, tip=f"{TIP}; {default} if unlinked")


def build(tree: Tree, *, radial: bool) -> None:
    given = interface(tree, radial=radial)
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    rotation = tree.input_float("Rotation", 0.0, low=0.0, high=1.0, tip="In turns")
    with tree.frame("The first that has a length"):
        chosen = _finite(tree.geometry("Tangent"))
        if not radial:
            by_uv = tree.node("ShaderNodeTangent", direction_type="UV_MAP")
            chosen = _first(Value(tree, output(by_uv, "Tangent")), chosen)
        chosen = normalize(_first(given, chosen))
    with tree.frame("At right angles to N"):
        across = cross(N, chosen)
        usable = greater(dot(across, across), SHORTEST)
        B = select(usable, normalize(across), tangents(N)[1])
        T = cross(B, N)
    with tree.frame("Turned about N"):
        angle = 2.0 * pi * rotation
        T = scale(T, cos(angle)) + scale(B, sin(angle))
    tree.output_vector("T", T, tip="Unit tangent")


def _finite(w: Value) -> Value:
    return minimum(maximum(w, -LONGEST), LONGEST)


def _first(w: Value, other: Value) -> Value:
    held = _finite(w)
    return select(greater(dot(held, held), 1e-12), held, other)


def tangent(tree: Tree, given: Value, N: Value, rotation: Number, *, radial: bool) -> Value:
    """T through the nested group."""
    name = NAME + ", radial" * radial
    node = tree.group(ensure(name, REVISION, partial(build, radial=radial)), Tangent=given, N=N, Rotation=rotation)
    return Value(tree, node.outputs["T"])
