# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world by EEVEE's own lobe (``eevee``)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import cook_torrance, cook_torrance_albedo, cook_torrance_direct, eevee
from ._tree import minimum, vector
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = ".VGroove Cook-Torrance EEVEE"
REVISION = 1


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind)
    N = specular_normal(tree, inputs.normal)
    output_formula(tree, kind, inputs, N, cook_torrance_albedo.albedo(tree, kind, inputs, N))


def output_formula(tree: Tree, kind: str, inputs: cook_torrance.Inputs, N: Value, E: Value) -> None:
    """The outputs of a formula's group. E: the share of the world's light that is sent back to the viewer."""
    m = minimum(inputs.m, eevee.WIDEST)
    E = minimum(E if E.is_vector else vector(E, E, E), 1.0)
    world = eevee.world(tree, eevee.mirrored(tree, N, m), m)
    wi = eevee.to_light(tree)
    shown = cook_torrance_direct.radiance(tree, kind, inputs, N, wi, eevee.received(tree, wi))
    eevee.output_formula(tree, E * world.radiance, world.alpha, Glossy=shown - E * world.factor)
