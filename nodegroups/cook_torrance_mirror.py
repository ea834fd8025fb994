# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a facet is drawn for each sample as the V-groove shows it, then reflects like a mirror.

Unbiased: the weight F G2 / G1 is what is left of the BRDF once the facet's density is divided out.
Source: Heitz & d'Eon 2014, V-cavity model; ``visible_facet`` and ``CookTorrance.sample`` of the reference.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import cook_torrance, fresnel
from . import cook_torrance_direct as direct
from ._tree import (
    Tree,
    clamp,
    cos,
    dot,
    less,
    log,
    maximum,
    minimum,
    normalize,
    scale,
    select,
    sin,
    sqrt,
    tangents,
    vector,
)
from .random_numbers import random_numbers
from .shading_normal import shading_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = "VGroove Cook-Torrance Mirror"
REVISION = 1
STREAM = 1


def build(tree: Tree, kind: str, lamps: int = 0) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = cook_torrance.interface(tree, kind, m_high=10.0)
    beams = direct.beam_interfaces(tree, lamps)
    shaders = [facet(tree, kind, inputs)] + ([direct.emission(tree, kind, inputs, beams)] if beams else [])
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=10.0)
    beams = direct.beam_interfaces(tree, lamps)
    shaders = [cook_torrance.script(tree, "mirror", kind, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def facet(tree: Tree, kind: str, inputs: cook_torrance.Inputs) -> NodeSocket:
    """A mirror about a random facet, weighted by what the facet's density leaves of the BRDF."""
    N = shading_normal(tree, inputs.normal)
    wo = tree.geometry("Incoming")
    u1, u2, u3 = random_numbers(tree, STREAM)
    with tree.frame("Facet h by D(h) (n.h), and its dual across the groove"):
        T, B = tangents(N)
        tan = inputs.m * sqrt(-log(maximum(1.0 - u1, 1e-7)))  # u1 may round to 1
        phi = 2.0 * pi * u2
        lean = scale(T, tan * cos(phi)) + scale(B, tan * sin(phi))
        h, dual = normalize(N + lean), normalize(N - lean)
    with tree.frame("The side that the view sees"):
        seen, dual_seen = maximum(dot(wo, h), 0.0), maximum(dot(wo, dual), 0.0)
        h = select(less(u3 * (seen + dual_seen), seen), h, dual)
    with tree.frame("Weight F G2 / G1"):
        vh = clamp(dot(wo, h))
        wi = scale(h, 2.0 * vh) - wo
        nh, no, ni = dot(N, h), maximum(dot(N, wo), 0.0), maximum(dot(N, wi), 0.0)
        G1 = minimum(2.0 * nh * no / vh, 1.0)
        G2 = minimum(2.0 * nh * ni / vh, G1)
        share = G2 / G1
        F = fresnel.reflectance(tree, kind, inputs.fresnel, vh)
        weight = F * vector(share, share, share) if F.is_vector else F * share
    mirror = tree.node("ShaderNodeBsdfAnisotropic", weight, 0.0, distribution="BECKMANN")
    tree.connect(h, mirror.inputs["Normal"])
    return mirror.outputs["BSDF"]
