# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world as ``cook_torrance_eevee`` has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import anisotropic, cook_torrance_albedo, cook_torrance_eevee
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Anisotropic EEVEE"
REVISION = 2


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial)
    N = specular_normal(tree, inputs.normal)
    E = cook_torrance_albedo.albedo(tree, kind, inputs.round_from_here(tree, N), N)
    cook_torrance_eevee.output_formula(tree, kind, inputs, cook_torrance_eevee.seen(tree, inputs, N), E)
