# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the table itself at lamps bound to the material, sent out as emission."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import measured, shading_normal
from ._tree import Value, dot, greater, maximum, output
from .lamp_beams import Beams, beam_interfaces

if TYPE_CHECKING:
    import bpy

    from ..addon.measured.model import Measured
    from ._tree import Tree

NAME = "VGroove Measured Direct"
REVISION = 2


def build(tree: Tree, of: Measured, kind: str, lamps: int) -> None:
    normal, texture = shading_normal.interface(tree), measured.image(of, kind)
    shader = emission(tree, of, texture, normal, beam_interfaces(tree, lamps))
    tree.output_shader("Emission", shader, tip="To the material's Surface")


build_osl = build  # the same nodes, run as OSL: a script could not read the packed image


def emission(
    tree: Tree, of: Measured, texture: bpy.types.Image, normal: Value, beams: Beams, *, diffuse: bool = True
) -> bpy.types.NodeSocket:
    """The radiance of all lamps. diffuse: whether Lambert is sent, too."""
    N, wo = shading_normal.specular_normal(tree, normal), tree.geometry("Incoming")
    radiance: Value | int = 0
    lambert = None if diffuse else measured.colour(tree, of, measured.LAMBERT) * (1.0 / pi)
    for wi, irradiance in beams:
        f = measured.reflectance(tree, of, texture, N, wi, wo)
        if lambert is not None:
            f = maximum(f - lambert, 0.0)
        ni = maximum(dot(N, wi), 0.0)
        seen = greater(dot(N, wo), 0.0) * shading_normal.lit(tree, normal, wi)
        radiance = radiance + irradiance * f * (ni * seen)
    emitted = tree.node("ShaderNodeEmission", Color=radiance if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")
