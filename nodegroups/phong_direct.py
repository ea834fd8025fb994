# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E, E the irradiance across the beam.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import over_lambert, phong
from .lamp_beams import Beams, beam_interfaces

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Tree, Value

NAME = "VGroove Phong Direct"
REVISION = 2


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
    """As ``over_lambert.emission``, of this lobe."""

    def lobe(N: Value, wi: Value, wo: Value) -> Value:
        return of.value(tree, N, wi, wo, inputs.n)

    return over_lambert.emission(tree, inputs, beams, lobe, diffuse=diffuse, carried=carried)


def emission_osl(
    tree: Tree, of: phong.Lobe, inputs: phong.Inputs, beams: Beams, shader: str = "direct", **more: int
) -> NodeSocket:
    """The same from one script a lamp."""
    scripts = [
        phong.script(tree, shader, of, inputs, ToLamp=wi, Irradiance=irradiance, **more) for wi, irradiance in beams
    ]
    return tree.add_shaders([node.outputs[0] for node in scripts])
