# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E, E the irradiance across the beam.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import ensure, facet_density, fresnel, generator, vgroove_g
from ._tree import Value, dot, greater, length, maximum, normalize, output
from .lamp_beams import Beams, beam_interfaces
from .shading_normal import lit, shading_normal, smoothing, specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ..addon.reference.facet_distribution import Distribution
    from ._tree import Tree

NAME = "VGroove Generator Direct"
REVISION = 3


def build(tree: Tree, kind: str, of: Distribution, lamps: int) -> None:
    inputs = generator.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission(tree, kind, of, inputs, beams), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, of: Distribution, lamps: int) -> None:
    inputs = generator.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission_osl(tree, kind, of, inputs, beams), tip="To the material's Surface")


def emission(
    tree: Tree, kind: str, of: Distribution, inputs: generator.Inputs, beams: Beams, *, diffuse: bool = True
) -> NodeSocket:
    """The radiance of all lamps, as an emission closure of plain nodes. diffuse: whether Lambert is sent, too."""
    N, facing, wo = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    radiance: Value | int = 0
    for wi, irradiance in beams:
        f_cos, vh = mirrored(tree, of, N, wi, wo)
        seen = greater(dot(N, wi), 0.0) * greater(dot(N, wo), 0.0) * lit(tree, inputs.normal, wi)
        F = fresnel.reflectance(tree, kind, inputs.fresnel, vh)
        sends = inputs.specular * F * (f_cos * seen)
        if diffuse:
            facing_light = maximum(dot(facing, wi), 0.0) * smoothing(tree, inputs.normal, wi)
            sends = sends + inputs.albedo * (facing_light * (1.0 / pi))
        radiance = radiance + irradiance * sends
    emitted = tree.node("ShaderNodeEmission", Color=radiance if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")


def mirrored(tree: Tree, of: Distribution, N: Value, wi: Value, wo: Value) -> tuple[Value, Value]:
    """f cos of the lobe with F = 1, D G / (4 (n.v)), and v.h, without asking whether both are above."""
    with tree.frame("Half vector and cosines"):
        both = wi + wo
        h, vh = normalize(both), 0.5 * length(both)  # dot(wo, h) would lose a hundredfold at grazing angles
        sin2, nh = facet_density.sin2_and_cos(h, N)
        no, ni = dot(N, wo), dot(N, wi)
    group = ensure(vgroove_g.NAME, vgroove_g.REVISION, vgroove_g.build)
    G = tree.group(group, **{"n.h": nh, "n.v": no, "n.l": ni, "v.h": vh})
    D = facet_density.density(tree, of, sin2, nh)
    return D * Value(tree, G.outputs["G"]) / (4.0 * maximum(no, 1e-7)), vh


def emission_osl(
    tree: Tree, kind: str, of: Distribution, inputs: generator.Inputs, beams: Beams, **more: int
) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [
        generator.script(tree, "direct", kind, of, inputs, ToLamp=wi, Irradiance=irradiance, **more)
        for wi, irradiance in beams
    ]
    return tree.add_shaders([node.outputs[0] for node in scripts])
