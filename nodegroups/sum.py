# SPDX-License-Identifier: GPL-3.0-or-later
"""A rough diffuse part under a specular one: f = d f_diffuse + s f_specular, by any estimator that both have.

The parts are nested groups; what both ask for (the normal, the lamps) is one input.
Source: Cook & Torrance 1982, R = d R_d + s R_s with d + s = 1; ``Sum`` of the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import bpy

    from ._tree import Tree

NAME = "VGroove Sum"
REVISION = 1


def build(tree: Tree, diffuse: bpy.types.ShaderNodeTree, specular: bpy.types.ShaderNodeTree) -> None:
    tip = "Share of the {} part; both together at most 1, or more light leaves than arrives"
    d = tree.input_float("Diffuse", 0.5, low=0.0, high=1.0, subtype="FACTOR", tip=tip.format("diffuse"))
    s = tree.input_float("Specular", 0.5, low=0.0, high=1.0, subtype="FACTOR", tip=tip.format("specular"))
    shaders = []
    for part, weight in ((diffuse, d), (specular, s)):
        tree.inputs_of(part)
        with tree.frame(part.name):
            node = tree.node("ShaderNodeGroup", node_tree=part, label=part.name)
            for socket in node.inputs:
                tree.connect(tree.given(socket.name), socket)
            shaders.append(tree.weighted(node.outputs[0], weight))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
