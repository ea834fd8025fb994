# SPDX-License-Identifier: GPL-3.0-or-later
"""Cycles' own Oren-Nayar of roughness 1 as a formula: ``cycles_diffuse`` of the reference.

Source: Fujii, A tiny improvement of Oren-Nayar reflectance model; addon/reference/oren_nayar_fit.py.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from ..addon.reference.cycles import oren_nayar_power
from ..addon.reference.oren_nayar_fit import GRAZING_LOSS
from . import ensure
from ._tree import Tree, Value, dot, greater, length, less, maximum, minimum, scale, select
from .oren_nayar_table import MEAN

if TYPE_CHECKING:
    from collections.abc import Sequence

NAME = ".VGroove Cycles Diffuse"
REVISION = 3
A = 1.0 / (pi + GRAZING_LOSS)


def build(tree: Tree) -> None:
    wi, wo, N = (
        tree.input_vector(name, (0, 0, 1), low=-1.0, high=1.0, tip="Unit vector away from the surface")
        for name in ("To Light", "To Viewer", "N")
    )
    color = tree.input_color("Color", (0.8, 0.8, 0.8), tip="Color of the closure")
    light, view = dot(N, wi), dot(N, wo)
    lit = greater(light, 0.0)
    ni, no = maximum(light, 1e-7), maximum(view, 1e-7)
    across_i, across_o = wi - scale(N, light), wo - scale(N, view)
    with tree.frame("One bounce: A (1 + t)"):
        s = dot(across_i, across_o) + light * minimum(view, 0.0)  # where a map turns N away, Cycles takes n.v as 0
        once = A + A * select(less(0.0 * s, s), s / maximum(ni, no), s)
    with tree.frame("More: what one bounce loses, from both sides"):
        lost = [1.0 - _albedo(cos, length(across)) for cos, across in ((ni, across_i), (no, across_o))]
        again = lost[0] * lost[1] * (MEAN / (1.0 - MEAN) / pi)
    f = color * once + color ** oren_nayar_power() * again / (1.0 - color * (1.0 - MEAN))
    tree.output_color("f", f * lit, tip="The BRDF in 1/sr; 0 below the surface")


def _albedo(c: Value, s: Value) -> Value:
    """``fujii_albedo`` at roughness 1; the angle by its half's tangent, which keeps its digits."""
    grazing = s * c * (1.0 + s + s * s) / (1.0 + s)
    angle = 2.0 * c.tree.math("ARCTANGENT", s / (1.0 + c))
    return A * (pi + s * (angle - s * c) + 2.0 / 3.0 * (grazing - s))


def mixture(tree: Tree, colors: Sequence[Value], wi: Value, N: Value) -> Value:
    """f of both closures of ``fit`` from wi to the viewer: Lambert and this, of these colours."""
    wo = tree.geometry("Incoming")
    node = tree.group(ensure(NAME, REVISION, build), To_Light=wi, To_Viewer=wo, N=N, Color=colors[1])
    with tree.frame("And Lambert"):
        return Value(tree, node.outputs["f"]) + colors[0] * (greater(dot(N, wi), 0.0) / pi)
