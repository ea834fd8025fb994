# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E, E the irradiance across the beam.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import oren_nayar
from ._tree import Tree, Value, dot, output
from .lamp_beams import Beams, beam_interfaces
from .shading_normal import shading_normal, smoothing

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

NAME = "VGroove Oren-Nayar Direct"
REVISION = 4


def build(tree: Tree, kind: str, lamps: int) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission(tree, kind, inputs, beams), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission_osl(tree, kind, inputs, beams), tip="To the material's Surface")


def emission(
    tree: Tree, kind: str, inputs: oren_nayar.Inputs, beams: Beams, carried: Callable[[Value], Value] | None = None
) -> NodeSocket:
    """The radiance of all lamps, as an emission closure of plain nodes.

    ``carried``: what other closures send of it already, their f from wi; the emission is then what they lack, negative
    where they send too much.
    """
    N, wo = shading_normal(tree, inputs.normal), tree.geometry("Incoming")

    def lacking(wi: Value) -> Value:
        f = oren_nayar.brdf(tree, kind, inputs, N, wi, wo) * smoothing(tree, inputs.normal, wi)
        return f - carried(wi) if carried else f

    radiance: Value | int = sum(irradiance * lacking(wi) * dot(N, wi) for wi, irradiance in beams)
    emitted = tree.node("ShaderNodeEmission", Color=radiance if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")


def emission_osl(
    tree: Tree, kind: str, inputs: oren_nayar.Inputs, beams: Beams, shader: str = "direct", **more: Value
) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [
        oren_nayar.script(tree, shader, kind, inputs, ToLamp=wi, Irradiance=irradiance, **more)
        for wi, irradiance in beams
    ]
    return tree.add_shaders([node.outputs[0] for node in scripts])
