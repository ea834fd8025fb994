# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Lambert, and Cycles' own Ashikhmin-Shirley, which has the mean of F over the highlight.

It sends as much light as the formula does, and head-on just so; toward grazing views F changes over the highlight.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import ashikhmin_shape
from . import ashikhmin_shirley as model
from ._tree import Value, dot, output, sqrt
from .shading_normal import shading_normal, specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ._tree import Tree

NAME = "VGroove Ashikhmin-Shirley Closure"
REVISION = 3
TIP = "To the material's Surface. Near the formula; toward grazing views it differs, the more the rougher it is"


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=entered(tree, inputs), Roughness=0.0, Normal=inputs.normal)
    color = inputs.amplitude * even(inputs, ashikhmin_shape.shape(tree, inputs).mean)
    shaders = [output(diffuse, "BSDF"), glossy(tree, inputs, color)]
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip=TIP)


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    node = model.script(tree, "closure", inputs, mean=ashikhmin_shape.shape(tree, inputs).mean)
    tree.output_shader("BSDF", node.outputs[0], tip=TIP)


def entered(tree: Tree, inputs: model.Inputs) -> Value:
    """Rd (1 - Rs) a(n.v), or over Lambert Rd."""
    if inputs.over_lambert:
        return inputs.deep
    facing = shading_normal(tree, inputs.normal)
    return inputs.deep * model.entering(dot(facing, tree.geometry("Incoming")))


def even(inputs: model.Inputs, mean: Value) -> Value:
    """The mean of F over the highlight, of that of (1 - v.h)^5."""
    return inputs.specular + (1.0 - inputs.specular) * mean


def glossy(tree: Tree, inputs: model.Inputs, color: Value) -> NodeSocket:
    """Cycles' own Ashikhmin-Shirley: slopes of r^2 / (1 + a) along the tangent and r^2 (1 + a) for a below 0."""
    node = tree.node(
        "ShaderNodeBsdfAnisotropic", distribution="ASHIKHMIN_SHIRLEY", Color=color, Roughness=inputs.roughness,
        Anisotropy=sqrt(inputs.narrow) - 1.0, Normal=inputs.normal,
        Tangent=inputs.turned_tangent(specular_normal(tree, inputs.normal)),
    )  # fmt: skip
    return output(node, "BSDF")
