# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: Lambert, and for each sample a facet that reflects like a mirror, weighted by the table.

Facets are drawn from bins that follow the table (``Measured`` of addon/measured) as the V-groove shows them; the weight
is f cos over the density, so the mean is the table, whatever the bins.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import facet_density, measured, shading_normal
from . import measured_direct as direct
from ._tree import clamp, dot, greater, maximum, minimum, output, scale, sqrt
from .lamp_beams import beam_interfaces
from .random_numbers import random_numbers, stream
from .visible_facet import visible_facet

if TYPE_CHECKING:
    import bpy

    from ..addon.measured.model import Measured
    from ._tree import Tree, Value

NAME = "VGroove Measured Mirror"
REVISION = 2


def build(tree: Tree, of: Measured, kind: str, lamps: int = 0) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    normal, texture = shading_normal.interface(tree), measured.image(of, kind)
    beams = beam_interfaces(tree, lamps)
    albedo = measured.colour(tree, of, measured.LAMBERT)
    smoothed = shading_normal.typical_smoothing(tree, normal)  # Cycles' own is off, as facets lean
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=albedo * smoothed, Roughness=0.0, Normal=normal)
    shaders = [output(diffuse, "BSDF"), facet(tree, of, texture, normal, albedo)]
    shaders += [direct.emission(tree, of, texture, normal, beams, diffuse=False)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


build_osl = build  # the same nodes, run as OSL: a script could not read the packed image


def facet(tree: Tree, of: Measured, texture: bpy.types.Image, normal: Value, albedo: Value) -> bpy.types.NodeSocket:
    """A mirror about a random facet. Its density of wi is G1 D / (4 n.v), D what the facet is drawn by."""
    N, wo = shading_normal.specular_normal(tree, normal), tree.geometry("Incoming")
    u, _, _ = random_numbers(tree, stream("FACET"))
    sin2, drawn_by = facet_density.drawn(tree, of.distribution, u)
    cos2 = maximum(1.0 - sin2, 1e-7)
    h = visible_facet(tree, N, wo, sqrt(sin2 / cos2), lambda _u, tan: tan)
    with tree.frame("Weight (f - Lambert) n.l / density"):
        vh = maximum(clamp(dot(wo, h)), 1e-7)
        wi = scale(h, 2.0 * vh) - wo
        nh, no, ni = sqrt(cos2), maximum(dot(N, wo), 0.0), maximum(dot(N, wi), 0.0)
        masked = minimum(2.0 * nh * no / vh, 1.0)
        share = 4.0 * no * ni / maximum(masked * drawn_by, 1e-12) * greater(no, 0.0)
        rest = maximum(measured.reflectance(tree, of, texture, N, wi, wo) - albedo * (1.0 / pi), 0.0)
    weight = rest * share
    mirror = tree.node("ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=weight, Roughness=0.0, Normal=h)
    return output(mirror, "BSDF")
