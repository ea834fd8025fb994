# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E, E the irradiance across the beam.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import oren_nayar
from ._tree import Tree, Value, dot
from .lamp_beams import Beams, beam_interfaces
from .shading_normal import shading_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = "VGroove Oren-Nayar Direct"
REVISION = 1


def build(tree: Tree, kind: str, lamps: int) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission(tree, kind, inputs, beams), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", emission_osl(tree, kind, inputs, beams), tip="To the material's Surface")


def emission(tree: Tree, kind: str, inputs: oren_nayar.Inputs, beams: Beams) -> NodeSocket:
    """The radiance of all lamps, as an emission closure of plain nodes."""
    N, wo = shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    radiance: Value | int = sum(
        irradiance * oren_nayar.brdf(tree, kind, inputs, N, wi, wo) * dot(N, wi) for wi, irradiance in beams
    )
    return tree.node("ShaderNodeEmission", radiance if beams else (0.0, 0.0, 0.0)).outputs["Emission"]


def emission_osl(tree: Tree, kind: str, inputs: oren_nayar.Inputs, beams: Beams) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [
        oren_nayar.script(tree, "direct", kind, inputs, ToLamp=wi, Irradiance=irradiance) for wi, irradiance in beams
    ]
    return tree.add_shaders([node.outputs[0] for node in scripts])
