# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Lambert and Cycles' own Beckmann lobe with Ward's slopes, which differs at grazing views.

The form of 1992 darkens as the cosine of the view, and so does its lobe here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import over_lambert, ward
from ._tree import dot, maximum, minimum, output
from .shading_normal import shading_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Ward Closure"
REVISION = 2


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial, native=True)  # Cycles clamps alpha to 1
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=inputs.albedo, Roughness=0.0, Normal=inputs.normal)
    color = inputs.specular
    if kind == "ward_1992":
        color = color * maximum(dot(shading_normal(tree, inputs.normal), tree.geometry("Incoming")), 0.0)
    slopes = minimum(inputs.m / inputs.aspect, 1.0), inputs.m * inputs.aspect
    lobe = over_lambert.glossy(tree, color, slopes, inputs.normal, inputs.T)
    tree.output_shader("BSDF", tree.add_shaders([output(diffuse, "BSDF"), lobe]), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    node = ward.script(tree, "closure", ward.interface(tree, kind, radial=radial, native=True))
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")
