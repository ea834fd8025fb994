# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E, E the irradiance across the beam.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import phong
from ._tree import Value, dot, greater, maximum, output
from .lamp_beams import Beams, beam_interfaces
from .shading_normal import lit, shading_normal, smoothing, specular_normal

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Tree

NAME = "VGroove Phong Direct"
REVISION = 1


def build(tree: Tree, of: phong.Lobe, lamps: int) -> None:
    inputs = phong.interface(tree, of)
    tree.output_shader(
        "Emission", emission(tree, of, inputs, beam_interfaces(tree, lamps)), tip="To the material's Surface"
    )


def build_osl(tree: Tree, of: phong.Lobe, lamps: int) -> None:
    inputs = phong.interface(tree, of)
    shader = emission_osl(tree, of, inputs, beam_interfaces(tree, lamps))
    tree.output_shader("Emission", shader, tip="To the material's Surface")


def emission(
    tree: Tree, of: phong.Lobe, inputs: phong.Inputs, beams: Beams, *, diffuse: bool = True,
    carried: Callable[[Value], tuple[Value, Value | float]] | None = None,
) -> NodeSocket:  # fmt: skip
    """The radiance of all lamps, as an emission closure of plain nodes.

    diffuse: whether Lambert is sent, too. carried: (f cos, f of Lambert) that other closures send from wi already for
    a white Specular Color; the emission is then what they lack, negative where they send too much.
    """
    N, facing, wo = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    radiance: Value | int = 0
    for wi, irradiance in beams:
        ni, no = dot(N, wi), dot(N, wo)
        seen = greater(ni, 0.0) * greater(no, 0.0) * lit(tree, inputs.normal, wi)
        f_cos, lambert = of.value(tree, N, wi, wo, inputs.n) * ni, inputs.albedo * (1.0 / pi) if diffuse else None
        if carried is not None:
            sent, under = carried(wi)
            f_cos = f_cos - sent
            lambert = inputs.specular * -under if isinstance(under, Value) else None
        sends = inputs.specular * (f_cos * seen)
        if lambert is not None:
            sends = sends + lambert * (maximum(dot(facing, wi), 0.0) * smoothing(tree, inputs.normal, wi))
        radiance = radiance + irradiance * sends
    emitted = tree.node("ShaderNodeEmission", Color=radiance if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")


def emission_osl(
    tree: Tree, of: phong.Lobe, inputs: phong.Inputs, beams: Beams, shader: str = "direct", **more: int
) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [
        phong.script(tree, shader, of, inputs, ToLamp=wi, Irradiance=irradiance, **more) for wi, irradiance in beams
    ]
    return tree.add_shaders([node.outputs[0] for node in scripts])
