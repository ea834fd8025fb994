# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: Lambert, and Cook-Torrance's ``fit`` for each of a few Beckmann distributions in place of D.

Their weights and slopes are those of ``beckmann_terms`` of the reference; each has the G correction of its own slope.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference.fresnel import F82_COSINE
from ..addon.reference.generator_fit import HIGHEST, LOWEST, beckmann_terms
from . import cook_torrance, ensure, fresnel, generator, shading_normal
from . import cook_torrance_closure as native
from . import cook_torrance_fit as fit
from ._tree import Value, maximum, minimum, output, sqrt
from .shading_normal import typical_smoothing

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ..addon.reference.facet_distribution import Distribution
    from ._tree import Tree

NAME = "VGroove Generator Fit"
REVISION = 3
LOBE_NAME = ".VGroove Generator Fit Lobe"
LOBE_REVISION = 2
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
        shaders.append(tree.weighted(_lobe(tree, estimator, terms, m, inputs.normal, osl=osl), share * weight))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip=TIP)


def _lobe(tree: Tree, estimator: str, terms: dict[str, Value], m: float, normal: Value, *, osl: bool) -> NodeSocket:
    if estimator == "fit" and not osl:
        group = ensure(LOBE_NAME, LOBE_REVISION, build_lobe)
        return tree.group(group, F0=terms["f0"], Edge_Tint=terms["f82_tint"], m=m, Normal=normal).outputs["BSDF"]
    inputs = cook_torrance.Inputs(terms, constant(tree, m), normal)
    if osl:
        more = fit.for_script(tree, inputs) if estimator == "fit" else {}
        return cook_torrance.script(tree, estimator, "f82", inputs, **more).outputs[0]
    return native.lobe(tree, "f82", inputs.fresnel, sqrt(inputs.m), inputs.normal)


def build_lobe(tree: Tree) -> None:
    """Cook-Torrance's ``fit`` with F82, which the materials of all distributions share."""
    white = (1.0, 1.0, 1.0)
    terms = {
        "f0": tree.input_color("F0", white, tip="Reflectance head-on"),
        "f82_tint": tree.input_color("Edge Tint", white, tip="At 82 degrees, over Schlick's"),
    }
    m = tree.input_float("m", 0.3, low=LOWEST, high=HIGHEST, tip="RMS slope of Beckmann's distribution")
    inputs = cook_torrance.Inputs(terms, m, shading_normal.interface(tree))
    tree.output_shader("BSDF", fit.shader(tree, "f82", inputs), tip="All that the facets mirror")


def constant(tree: Tree, number: float) -> Value:
    node = tree.node("ShaderNodeValue")
    node.outputs[0].default_value = number
    return Value(tree, node.outputs[0])


def native_fresnel(tree: Tree, kind: str, inputs: generator.Inputs) -> tuple[Value, dict[str, Value]]:
    """``native_fresnel`` of the reference: the largest channel of Specular Color, and F82 for its colour times F."""
    with tree.frame("Specular Color times F: a weight, and F82 that is equal head-on and at 82 degrees"):
        red, green, blue = inputs.specular.rgb
        share = maximum(maximum(red, green), blue)
        color = inputs.specular / maximum(share, 1e-9)
        f0, edge = (color * fresnel.reflectance(tree, kind, inputs.fresnel, at) for at in (1.0, F82_COSINE))
        grazing = (1.0 - F82_COSINE) ** 5
        tint = minimum(edge / (f0 * (1.0 - grazing) + grazing), 1.0)
    return share, {"f0": f0, "f82_tint": tint}
