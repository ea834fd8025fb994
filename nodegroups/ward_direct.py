# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import over_lambert, ward
from .lamp_beams import Beams, beam_interfaces

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Number, Tree, Value

NAME = "VGroove Ward Direct"
REVISION = 2


def build(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial)
    shader = emission(tree, inputs, beam_interfaces(tree, lamps))
    tree.output_shader("Emission", shader, tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial)
    shader = emission_osl(tree, inputs, beam_interfaces(tree, lamps))
    tree.output_shader("Emission", shader, tip="To the material's Surface")


def emission(
    tree: Tree, inputs: ward.Inputs, beams: Beams, *, diffuse: bool = True, diffused: Value | None = None,
    carried: Callable[[Value], tuple[Value, Value | float]] | None = None,
) -> NodeSocket:  # fmt: skip
    """As ``over_lambert.emission``, of Ward's lobe."""

    def lobe(N: Value, wi: Value, wo: Value) -> Value:
        return inputs.lobe(tree, N, wi, wo)

    return over_lambert.emission(tree, inputs, beams, lobe, diffuse=diffuse, diffused=diffused, carried=carried)


def emission_osl(tree: Tree, inputs: ward.Inputs, beams: Beams, shader: str = "direct", **more: Number) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [ward.script(tree, shader, inputs, ToLamp=wi, Irradiance=irradiance, **more) for wi, irradiance in beams]
    return tree.add_shaders([node.outputs[0] for node in scripts])
