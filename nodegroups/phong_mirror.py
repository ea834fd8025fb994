# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a direction of the lobe is drawn for each sample, and a mirror sends the ray there.

Lambert is Cycles' own. Unbiased: the weight is what is left of the lobe once the density is divided out, as ``_draw``
of the reference has it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import over_lambert, phong
from . import phong_direct as direct
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = "VGroove Phong Mirror"
REVISION = 2


def build(tree: Tree, of: phong.Lobe, lamps: int = 0) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = phong.interface(tree, of)
    beams = beam_interfaces(tree, lamps)

    def draw() -> tuple[Value, Value]:
        return of.draw(tree, specular_normal(tree, inputs.normal), tree.geometry("Incoming"), inputs.n)

    shaders = over_lambert.mirror(tree, inputs, draw)
    shaders += [direct.emission(tree, of, inputs, beams, diffuse=False)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, of: phong.Lobe, lamps: int = 0) -> None:
    inputs = phong.interface(tree, of)
    beams = beam_interfaces(tree, lamps)
    shaders = [phong.script(tree, "mirror", of, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, of, inputs, beams, diffused=0)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
