# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: as ``closure``, with a Beckmann lobe for what F adds, and a diffuse part of its own.

As of the reference. Nothing is random, and nothing leans: all closures stand on the shading normal. L1 of f cos over
all wi, in per cent, of the highlight alone, with a Specular Color of 0.04, head-on to 75 degrees and at 85: n = 10, 9
and 17; n = 30, 7 and 11; n from 60 on, 5 and 10. Of the diffuse part alone: 2.2. ``tools/fit_ashikhmin.py`` has more.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference import ashikhmin_shirley_fit as fit
from . import ashikhmin_shape
from . import ashikhmin_shirley as model
from . import ashikhmin_shirley_closure as closure
from ._tree import maximum, minimum, output

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ._tree import Tree, Value

NAME = "VGroove Ashikhmin-Shirley Fit"
REVISION = 3


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    shape = ashikhmin_shape.shape(tree, inputs)
    tree.output_shader("BSDF", shader(tree, inputs, shape), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    node = model.script(tree, "fit", inputs, **ashikhmin_shape.shape(tree, inputs).parameters)
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")


def split(inputs: model.Inputs, of: ashikhmin_shape.Shape) -> tuple[Value, Value, Value]:
    """Color of the Glossy BSDF, F0 of the Beckmann lobe, and its weight: ``split`` of the reference."""
    rest = 1.0 - inputs.specular
    r, g, b = inputs.specular.rgb
    least, highest = minimum(minimum(r, g), b), maximum(maximum(r, g), b)
    most = maximum(1.0 - least, 1e-7)
    fused = rest.tree.fused
    share = of.rise / (of.rise + fused(highest - least, fit.COLORED, 1e-6))
    added = fused(share, of.more - of.mean, of.mean)
    color = fused(rest, added, inputs.specular - (inputs.specular - least) * (share * of.flat))
    red, green, blue = inputs.amplitude.rgb
    dimmest = minimum(minimum(red, green), blue)
    color = color * dimmest + (inputs.amplitude - dimmest) * closure.even(inputs, of.mean)
    return color, 1.0 - rest / most, dimmest * most * share * of.weight


def shader(tree: Tree, inputs: model.Inputs, of: ashikhmin_shape.Shape) -> NodeSocket:
    """All four closures. Metallic BSDF with a white edge has Schlick's F."""
    entered = closure.entered(tree, inputs)
    color, f0, weight = split(inputs, of)
    evenly = entered if inputs.over_lambert else entered * fit.LAMBERT
    below = [tree.node("ShaderNodeBsdfDiffuse", Color=evenly, Roughness=0.0, Normal=inputs.normal)]
    if not inputs.over_lambert:
        toon = tree.node(
            "ShaderNodeBsdfToon", component="DIFFUSE", Color=entered * model.toon_color(), Size=fit.TOON_SIZE,
            Smooth=fit.TOON_SMOOTH, Normal=inputs.normal,
        )  # fmt: skip
        below.append(toon)
    lobe = tree.node(
        "ShaderNodeBsdfMetallic", distribution="BECKMANN", fresnel_type="F82", Base_Color=f0, Edge_Tint=(1.0, 1.0, 1.0),
        Roughness=of.roughness, Anisotropy=of.anisotropy, Normal=inputs.normal, Tangent=of.tangent,
    )  # fmt: skip
    shaders = [*(output(one, "BSDF") for one in below), closure.glossy(tree, inputs, color)]
    return tree.add_shaders([*shaders, tree.weighted(output(lobe, "BSDF"), weight)])
