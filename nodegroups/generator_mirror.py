# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a facet is drawn for each sample as the V-groove shows it, then reflects like a mirror.

Lambert is Cycles' own. Facets are drawn from bins that follow D, and weigh D over what they are drawn by: unbiased,
``Generator.sample`` of the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import facet_density, fresnel, generator
from . import generator_direct as direct
from ._tree import Value, clamp, dot, maximum, minimum, output, scale, sqrt
from .lamp_beams import beam_interfaces
from .random_numbers import random_numbers, stream
from .shading_normal import specular_normal, typical_smoothing
from .visible_facet import visible_facet

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ..addon.reference.facet_distribution import Distribution
    from ._tree import Tree

NAME = "VGroove Generator Mirror"
REVISION = 3


def build(tree: Tree, kind: str, of: Distribution, lamps: int = 0) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = generator.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    color = inputs.albedo * typical_smoothing(tree, inputs.normal)  # Cycles' own is off, as facets lean
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0, Normal=inputs.normal)
    shaders = [output(diffuse, "BSDF"), facet(tree, kind, of, inputs)]
    shaders += [direct.emission(tree, kind, of, inputs, beams, diffuse=False)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, of: Distribution, lamps: int = 0) -> None:
    inputs = generator.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    shaders = [generator.script(tree, "mirror", kind, of, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, of, inputs, beams, diffused=0)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def facet(tree: Tree, kind: str, of: Distribution, inputs: generator.Inputs) -> NodeSocket:
    """A mirror about a random facet, weighted by what the facet's density leaves of the BRDF.

    The first number says how steep the facet is; the other two, its azimuth and side, are for ``visible_facet``.
    """
    N, wo = specular_normal(tree, inputs.normal), tree.geometry("Incoming")
    u, _, _ = random_numbers(tree, stream("FACET"))
    sin2, drawn_by = facet_density.drawn(tree, of, u)
    cos2 = maximum(1.0 - sin2, 1e-7)
    h = visible_facet(tree, N, wo, sqrt(sin2 / cos2), lambda _u, tan: tan)
    with tree.frame("Weight F G2/G1 D / what it is drawn by"):
        vh = clamp(dot(wo, h))
        wi = scale(h, 2.0 * vh) - wo
        nh, no, ni = sqrt(cos2), maximum(dot(N, wo), 0.0), maximum(dot(N, wi), 0.0)
        G1 = minimum(2.0 * nh * no / vh, 1.0)
        G2 = minimum(2.0 * nh * ni / vh, G1)
        share: Value = G2 / G1 * (facet_density.density(tree, of, sin2, nh) / drawn_by)
    F = fresnel.reflectance(tree, kind, inputs.fresnel, vh)
    weight = inputs.specular * F * share
    mirror = tree.node("ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=weight, Roughness=0.0, Normal=h)
    return output(mirror, "BSDF")
