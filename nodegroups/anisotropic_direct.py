# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, as of ``cook_torrance_direct``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import anisotropic
from . import cook_torrance_direct as direct
from .lamp_beams import beam_interfaces

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Anisotropic Direct"
REVISION = 2


def build(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", direct.emission(tree, kind, inputs, beams), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    tree.output_shader("Emission", direct.emission_osl(tree, kind, inputs, beams), tip="To the material's Surface")
