# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E, E the irradiance across the beam.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import ashikhmin_shirley as model
from ._tree import dot, maximum, output
from .lamp_beams import Beams, beam_interfaces
from .shading_normal import lit, shading_normal, smoothing, specular_normal

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Number, Tree, Value

    Carried = Callable[[Value, Value, Value], tuple[Value, Value | float]]

NAME = "VGroove Ashikhmin-Shirley Direct"
REVISION = 3


def build(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    shader = emission(tree, inputs, beam_interfaces(tree, lamps))
    tree.output_shader("Emission", shader, tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    shader = emission_osl(tree, inputs, beam_interfaces(tree, lamps))
    tree.output_shader("Emission", shader, tip="To the material's Surface")


def emission(tree: Tree, inputs: model.Inputs, beams: Beams, carried: Carried | None = None) -> NodeSocket:
    """The radiance of all lamps, as an emission closure of plain nodes.

    ``carried``: what other closures send of it already, from (wi, the highlight without F, v.h): f cos of the highlight
    with F, and pi f of the diffuse part; the emission is then what they lack, negative where they send too much.
    """
    N, facing, wo = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    T, enters = inputs.turned_tangent(N), model.entered(inputs, dot(facing, wo))
    radiance: Value | int = 0
    for wi, irradiance in beams:
        f_cos, vh = model.lobe(tree, inputs, N, T, wi)
        mirrored = inputs.amplitude * model.reflectance(tree, inputs.specular, vh) * f_cos
        ni = maximum(dot(facing, wi), 0.0)
        scattered = model.scattered(inputs, enters, ni)
        if carried is not None:
            already, below = carried(wi, f_cos, vh)
            mirrored, scattered = mirrored - already, scattered - below
        sends = mirrored * lit(tree, inputs.normal, wi)
        if scattered != 0.0:  # not of Lambert, which the closures have
            sends = sends + inputs.deep * (scattered * ni * (1.0 / pi) * smoothing(tree, inputs.normal, wi))
        radiance = radiance + irradiance * sends
    emitted = tree.node("ShaderNodeEmission", Color=radiance if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")


def emission_osl(tree: Tree, inputs: model.Inputs, beams: Beams, shader: str = "direct", **more: Number) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [model.script(tree, shader, inputs, ToLamp=wi, Irradiance=irradiance, **more) for wi, irradiance in beams]
    return tree.add_shaders([node.outputs[0] for node in scripts])
