# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a facet of the elliptical Gaussian is drawn for each sample and reflects; Lambert is Cycles'.

Unbiased: the weight is what is left of the lobe once the density is divided out, as ``Ward._draw`` of the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import over_lambert, ward
from . import ward_direct as direct
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = "VGroove Ward Mirror"
REVISION = 2


def build(tree: Tree, kind: str, lamps: int = 0, *, radial: bool) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = ward.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)

    def draw() -> tuple[Value, Value]:
        return inputs.draw(tree, specular_normal(tree, inputs.normal), tree.geometry("Incoming"))

    shaders = over_lambert.mirror(tree, inputs, draw)
    shaders += [direct.emission(tree, inputs, beams, diffuse=False)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    shaders = [ward.script(tree, "mirror", inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, inputs, beams, diffused=0)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
