# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: Lambert, and Cook-Torrance's ``fit`` for each of a few Beckmann distributions in place of D.

Their weights and slopes are those of ``beckmann_terms`` of the reference; each has the G correction of its own slope.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference.fresnel import F82_COSINE
from ..addon.reference.generator_fit import beckmann_terms
from . import cook_torrance, fresnel, generator
from . import cook_torrance_closure as native
from . import cook_torrance_fit as fit
from ._tree import Value, maximum, minimum, output, sqrt, vector
from .shading_normal import typical_smoothing

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ..addon.reference.facet_distribution import Distribution
    from ._tree import Tree

NAME = "VGroove Generator Fit"
REVISION = 1
TIP = "To the material's Surface"


def build(tree: Tree, kind: str, of: Distribution) -> None:
    build_lobes(tree, kind, of, "fit", osl=False)


def build_osl(tree: Tree, kind: str, of: Distribution) -> None:
    build_lobes(tree, kind, of, "fit", osl=True)


def build_lobes(tree: Tree, kind: str, of: Distribution, estimator: str, *, osl: bool) -> None:
    inputs = generator.interface(tree, kind)
    color = inputs.albedo * typical_smoothing(tree, inputs.normal) if estimator == "fit" else inputs.albedo
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0, Normal=inputs.normal)
    share, terms = native_fresnel(tree, kind, inputs)
    shaders = [output(diffuse, "BSDF")]
    for weight, m in beckmann_terms(of):
        part = cook_torrance.Inputs(terms, constant(tree, m), inputs.normal)
        shaders.append(tree.weighted(_lobe(tree, estimator, part, osl=osl), share * weight))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip=TIP)


def _lobe(tree: Tree, estimator: str, inputs: cook_torrance.Inputs, *, osl: bool) -> NodeSocket:
    if osl:
        more = fit.for_script(tree, inputs) if estimator == "fit" else {}
        return cook_torrance.script(tree, estimator, "f82", inputs, **more).outputs[0]
    if estimator == "fit":
        return fit.shader(tree, "f82", inputs)
    return native.lobe(tree, "f82", inputs.fresnel, sqrt(inputs.m), inputs.normal)


def constant(tree: Tree, number: float) -> Value:
    node = tree.node("ShaderNodeValue")
    node.outputs[0].default_value = number
    return Value(tree, node.outputs[0])


def native_fresnel(tree: Tree, kind: str, inputs: generator.Inputs) -> tuple[Value, dict[str, Value]]:
    """``native_fresnel`` of the reference: the largest channel of Specular Color, and F82 for its colour times F."""
    with tree.frame("Specular Color times F: a weight, and F82 that is equal head-on and at 82 degrees"):
        red, green, blue = inputs.specular.rgb
        share = maximum(maximum(red, green), blue)
        color = inputs.specular / vector(*[maximum(share, 1e-9)] * 3)
        f0, edge = (color * fresnel.reflectance(tree, kind, inputs.fresnel, at) for at in (1.0, F82_COSINE))
        grazing = (1.0 - F82_COSINE) ** 5
        tint = minimum(edge / (f0 * (1.0 - grazing) + grazing), 1.0)
    return share, {"f0": f0, "f82_tint": tint}
