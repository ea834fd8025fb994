# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Beckmann glass, which has Smith's G in place of the V-groove's.

Smooth interfaces are exact. Of a thin sheet F is F82 fitted to the pane, and what goes straight on is 1 - F(n.v).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference.fresnel import F82_COSINE
from . import glass
from ._tree import Tree, clamp, dot, output, sqrt, vector
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = "VGroove Glass Closure"
REVISION = 4
# Blender's Glass BSDF has one colour for both lobes; only a smooth interface, a sheet and OSL keep them apart.
TINT_TIP = "Multiplies what passes; on rough glass as nodes also what is reflected"


def build(tree: Tree, *, thin: bool = False, smooth: bool = False, disperses: bool = False) -> None:
    """``thin``: a sheet, whose facets are panes. ``smooth``: m = 0, without Slope m. ``disperses``: by Abbe number."""
    if disperses and smooth:
        shader = glass.dispersive_interface(tree, glass.smooth_inputs(tree), 0.0)
    elif disperses:
        rough = glass.rough_inputs(tree, native=True, tint_tip=TINT_TIP)
        shader = glass.dispersive_interface(tree, rough, sqrt(rough.m))
    elif smooth:
        shader = glass.smooth_interface(tree, glass.smooth_inputs(tree), thin=thin)
    elif thin:
        shader = _sheet(tree, glass.rough_inputs(tree, native=True))
    else:
        shader = _glass(tree, glass.rough_inputs(tree, native=True, tint_tip=TINT_TIP))
    tree.output_shader("BSDF", shader, tip="To the material's Surface")


def build_osl(tree: Tree, *, thin: bool = False, smooth: bool = False) -> None:
    tip = "" if thin else TINT_TIP
    inputs = glass.smooth_inputs(tree) if smooth else glass.rough_inputs(tree, native=True, tint_tip=tip)
    tree.output_shader("BSDF", glass.script(tree, "closure", inputs, thin=thin), tip="To the material's Surface")


def _glass(tree: Tree, inputs: glass.RoughInputs) -> NodeSocket:
    given = {"Color": inputs.tint, "Roughness": sqrt(inputs.m), "IOR": inputs.eta, "Normal": inputs.normal}
    return output(tree.node("ShaderNodeBsdfGlass", distribution="BECKMANN", **given), "BSDF")


def _sheet(tree: Tree, inputs: glass.RoughInputs) -> NodeSocket:
    with tree.frame("F82 fitted to the pane head-on, at 82 degrees and grazing"):
        f0 = glass.reflectance(tree, 1.0, inputs.eta, thin=True)
        f82 = glass.reflectance(tree, F82_COSINE, inputs.eta, thin=True)
        tint = f82 / (f0 + (1.0 - f0) * (1.0 - F82_COSINE) ** 5)
    metallic = tree.node(
        "ShaderNodeBsdfMetallic", distribution="BECKMANN", fresnel_type="F82", Base_Color=vector(f0, f0, f0),
        Edge_Tint=vector(tint, tint, tint), Roughness=sqrt(inputs.m), Normal=inputs.normal,
    )  # fmt: skip
    N = specular_normal(tree, inputs.normal)
    T = 1.0 - glass.reflectance(tree, clamp(dot(N, tree.geometry("Incoming"))), inputs.eta, thin=True)
    straight = tree.node("ShaderNodeBsdfTransparent", Color=inputs.tint * vector(T, T, T))
    return tree.add_shaders([output(metallic, "BSDF"), output(straight, "BSDF")])
