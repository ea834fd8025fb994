# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected``: ``closure``, and at bound lamps the signed difference from the formula, as emission.

As ``cook_torrance_corrected``: bound lamps are exact, world and bounces are as ``closure`` has them. Lambert is in both
alike and drops out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import phong
from . import phong_closure as closure
from . import phong_direct as direct
from .lamp_beams import beam_interfaces

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Phong Corrected"
REVISION = 2


def build(tree: Tree, of: phong.Lobe, lamps: int) -> None:
    inputs = phong.interface(tree, of)
    beams = beam_interfaces(tree, lamps)
    native = closure.native(tree, of, inputs)
    shaders = [closure.closures(tree, inputs, native)]
    if beams:
        lacking = direct.emission(
            tree, of, inputs, beams, diffuse=False, carried=lambda wi: closure.carried(tree, native, wi)
        )
        shaders.append(lacking)
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, of: phong.Lobe, lamps: int) -> None:
    inputs = phong.interface(tree, of)
    beams = beam_interfaces(tree, lamps)
    shaders = [phong.script(tree, "closure", of, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, of, inputs, beams, "correction")] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
