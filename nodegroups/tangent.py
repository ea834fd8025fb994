# SPDX-License-Identifier: GPL-3.0-or-later
"""The tangent that a brushed surface is shaded with: linked, else of the UV map, or Blender's own around the Z axis.

Without a UV map Cycles takes one around the Z axis, too. What has no length, or is along the normal, gives way to some
direction along the surface. A group of few nodes, as each costs: none for what is not linked.
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
    hold,
    maximum,
    normalize,
    output,
    scale,
    select,
    sin,
)
from .shading_normal import LONGEST

if TYPE_CHECKING:
    import bpy

    from ._tree import Number

NAME = ".VGroove Tangent"
REVISION = 2
TIP = "Direction along the surface that Anisotropy is about, from a Tangent node"
SOME = (0.5403, 0.3102, 0.7823)  # a direction that hardly a normal has
TINY = 1e-6  # how much of it is added: an angle that turns nothing visibly, and more than float32 rounds


def interface(tree: Tree, *, radial: bool) -> Value:
    """The input "Tangent", hidden value. An unlinked group input reads (0, 0, 0)."""
    default = "around the object's Z axis" if radial else "the UV map's u axis, or around the Z axis without one"
    return tree.input_vector("Tangent", hide_value=True, tip=f"{TIP}; {default} if unlinked")


def build(tree: Tree, *, radial: bool) -> None:
    given = interface(tree, radial=radial)
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    rotation = tree.input_float("Rotation", 0.0, low=0.0, high=1.0, tip="In turns")
    with tree.frame("What is linked, or the surface's own"):
        held = hold(given, -LONGEST, LONGEST)
        linked = greater(dot(held, held), 1e-12)
        by_uv = None if radial else tree.node("ShaderNodeTangent", direction_type="UV_MAP")
        own = tree.geometry("Tangent") if by_uv is None else Value(tree, output(by_uv, "Tangent"))
        chosen = maximum(select(linked, normalize(held), own), -1.0)  # of UVs of no extent it is no number
    with tree.frame("At right angles to N; next to it, and where there is none, along the surface all the same"):
        across = tree.math("MULTIPLY_ADD", cross(N, SOME), (TINY, TINY, TINY), cross(N, chosen))
        B = normalize(across)
        T = cross(B, N)
    with tree.frame("Turned about N"):
        angle = 2.0 * pi * rotation
        T = scale(T, cos(angle)) + scale(B, sin(angle))
    tree.output_vector("T", T, tip="Unit tangent")
    tree.output_vector("Chosen", chosen, tip="Neither at right angles to N nor turned")


def tangent(tree: Tree, given: Value, N: Value, rotation: Number, *, radial: bool) -> Value:
    """T through the nested group."""
    node = tree.group(_group(radial=radial), Tangent=given, N=N, Rotation=rotation)
    return Value(tree, node.outputs["T"])


def chosen(tree: Tree, given: Value, *, radial: bool) -> Value:
    """For closures, which make it a unit vector at right angles to their normal, and turn it, themselves."""
    return Value(tree, tree.group(_group(radial=radial), Tangent=given).outputs["Chosen"])


def _group(*, radial: bool) -> bpy.types.ShaderNodeTree:
    return ensure(NAME + ", radial" * radial, REVISION, partial(build, radial=radial))
