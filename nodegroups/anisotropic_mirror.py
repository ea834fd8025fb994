# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a random facet of the elliptical distribution reflects, as of ``cook_torrance_mirror``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import anisotropic, cook_torrance
from . import cook_torrance_direct as direct
from . import cook_torrance_mirror as mirror
from .lamp_beams import beam_interfaces

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Anisotropic Mirror"
REVISION = 2


def build(tree: Tree, kind: str, lamps: int = 0, *, radial: bool) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = anisotropic.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    shaders = [mirror.facet(tree, kind, inputs)]
    shaders += [direct.emission(tree, kind, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    shaders = [cook_torrance.script(tree, "mirror", kind, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
