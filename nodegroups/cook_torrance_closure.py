# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Beckmann closure, which has Smith's G in place of the V-groove's."""

import bpy

from . import cook_torrance
from ._tree import Tree, sqrt

NAME = "VGroove Cook-Torrance Closure"
REVISION = 1


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=1.0)  # Cycles clamps alpha to 1
    metallic = tree.node("ShaderNodeBsdfMetallic", distribution="BECKMANN")
    tree.connect(sqrt(inputs.m), metallic.inputs["Roughness"])
    tree.connect(inputs.normal, metallic.inputs["Normal"])
    if kind == "schlick":
        metallic.fresnel_type = "F82"  # with a white edge tint it is Schlick's formula
        tree.connect(inputs.fresnel["f0"], metallic.inputs["Base Color"])
        tree.connect((1.0, 1.0, 1.0), metallic.inputs["Edge Tint"])
    else:
        metallic.fresnel_type = "PHYSICAL_CONDUCTOR"
        if kind == "conductor":
            tree.connect(inputs.fresnel["n"], metallic.inputs["IOR"])
            tree.connect(inputs.fresnel["k"], metallic.inputs["Extinction"])
        else:
            tree.connect(inputs.fresnel["eta"], metallic.inputs["IOR"])
            tree.connect((0.0, 0.0, 0.0), metallic.inputs["Extinction"])
    tree.output_shader("BSDF", metallic.outputs["BSDF"], tip="To the material's Surface")


def build_osl(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=1.0)
    node = cook_torrance.script(tree, "closure", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")
