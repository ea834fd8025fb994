# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E = F D G / (4 (n.v)) E, E the irradiance across the beam; n.l cancels.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import cook_torrance, ensure, fresnel, vgroove_g
from ._tree import Number, Tree, Value, dot, greater, length, maximum, normalize, output
from .lamp_beams import Beams, beam_interfaces
from .shading_normal import lit, specular_normal

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

NAME = "VGroove Cook-Torrance Direct"
REVISION = 4


def build(tree: Tree, kind: str, lamps: int) -> None:
    inputs = cook_torrance.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission(tree, kind, inputs, beams), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int) -> None:
    inputs = cook_torrance.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission_osl(tree, kind, inputs, beams), tip="To the material's Surface")


def emission(
    tree: Tree,
    kind: str,
    inputs: cook_torrance.Inputs,
    beams: Beams,
    carried: Callable[[Value, Value], Value] | None = None,
) -> NodeSocket:
    """The radiance of all lamps, as an emission closure of plain nodes.

    ``carried``: what other closures send of it already, f cos with F = 1 from (wi, h); the emission is then what they
    lack, negative where they send too much.
    """
    N = specular_normal(tree, inputs.normal)
    total = sum(radiance(tree, kind, inputs, N, wi, irradiance, carried) for wi, irradiance in beams)
    emitted = tree.node("ShaderNodeEmission", Color=total if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")


def emission_osl(
    tree: Tree, kind: str, inputs: cook_torrance.Inputs, beams: Beams, shader: str = "direct", **more: Number
) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [
        cook_torrance.script(tree, shader, kind, inputs, ToLamp=wi, Irradiance=irradiance, **more)
        for wi, irradiance in beams
    ]
    return tree.add_shaders([node.outputs[0] for node in scripts])


def radiance(
    tree: Tree, kind: str, inputs: cook_torrance.Inputs, N: Value, wi: Value, irradiance: Value,
    carried: Callable[[Value, Value], Value] | None = None,
) -> Value:  # fmt: skip
    """F D G / (4 (n.v)) E of one lamp, less what is ``carried``."""
    f_cos, vh = lobe(tree, inputs, N, wi, carried)
    with tree.frame("Times F"):
        F = fresnel.reflectance(tree, kind, inputs.fresnel, vh)
        return irradiance * F * f_cos


def lobe(
    tree: Tree, inputs: cook_torrance.Inputs, N: Value, wi: Value,
    carried: Callable[[Value, Value], Value] | None = None,
) -> tuple[Value, Value]:  # fmt: skip
    """D G / (4 (n.v)) where view and light are above the surface, else 0, less what is ``carried``; and v.h."""
    wo = tree.geometry("Incoming")
    with tree.frame("Half vector and cosines"):
        both = wi + wo
        h = normalize(both)
        nh, vh = dot(N, h), 0.5 * length(both)  # dot(wo, h) would lose a hundredfold in float32 at grazing angles
        no, ni = dot(N, wo), dot(N, wi)
        seen = greater(ni, 0.0) * greater(no, 0.0) * lit(tree, inputs.normal, wi)
    with tree.frame("D G / (4 n.v)"):
        G = tree.group(
            ensure(vgroove_g.NAME, vgroove_g.REVISION, vgroove_g.build), **{"n.h": nh, "n.v": no, "n.l": ni, "v.h": vh}
        )
        f_cos = inputs.density(tree, h, N) * Value(tree, G.outputs["G"]) / (4.0 * maximum(no, 1e-7))
    if carried is not None:
        f_cos = f_cos - carried(wi, h)
    return f_cos * seen, vh
