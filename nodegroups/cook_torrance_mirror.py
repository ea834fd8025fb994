# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a facet is drawn for each sample as the V-groove shows it, then reflects like a mirror.

Unbiased: the weight F G2 / G1 is what is left of the BRDF once the facet's density is divided out.
Source: Heitz & d'Eon 2014, V-cavity model; ``visible_facet`` and ``CookTorrance.sample`` of the reference.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import cook_torrance, fresnel
from . import cook_torrance_direct as direct
from ._tree import Tree, clamp, dot, maximum, minimum, output, scale, vector
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Value

NAME = "VGroove Cook-Torrance Mirror"
REVISION = 6


def build(tree: Tree, kind: str, lamps: int = 0) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = cook_torrance.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    shaders = [facet(tree, kind, inputs)] + ([direct.emission(tree, kind, inputs, beams)] if beams else [])
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = cook_torrance.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    shaders = [cook_torrance.script(tree, "mirror", kind, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


@dataclass(frozen=True)
class Facet:
    """A drawn facet: its normal, where its mirror sends the view, n.v and G."""

    h: Value
    wi: Value
    no: Value
    G: Value


def facet(
    tree: Tree, kind: str, inputs: cook_torrance.Inputs, rest: Callable[[Facet], Value] | None = None
) -> NodeSocket:
    """A mirror about a random facet, weighted by what the facet's density leaves of the BRDF.

    ``rest``: of that, the share which no other closure carries.
    """
    N = specular_normal(tree, inputs.normal)
    wo = tree.geometry("Incoming")
    h = inputs.facet(tree, N, wo)
    with tree.frame("Weight F G2 / G1"):
        vh = clamp(dot(wo, h))
        wi = scale(h, 2.0 * vh) - wo
        nh, no, ni = dot(N, h), maximum(dot(N, wo), 0.0), maximum(dot(N, wi), 0.0)
        G1 = minimum(2.0 * nh * no / vh, 1.0)
        G2 = minimum(2.0 * nh * ni / vh, G1)
        share = G2 / G1
    if rest is not None:
        share = share * rest(Facet(h, wi, no, G2))
    with tree.frame("Times F"):
        F = fresnel.reflectance(tree, kind, inputs.fresnel, vh)
        weight = F * vector(share, share, share) if F.is_vector else F * share
    mirror = tree.node("ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=weight, Roughness=0.0, Normal=h)
    return output(mirror, "BSDF")
