# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected``: ``fit``, and at bound lamps the signed difference from the formula, as emission.

As ``cook_torrance_corrected``: bound lamps are exact, world and bounces are as ``fit`` has them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import oren_nayar
from . import oren_nayar_direct as direct
from . import oren_nayar_fit as fit
from .cycles_diffuse import mixture
from .lamp_beams import beam_interfaces
from .shading_normal import shading_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Oren-Nayar Corrected"
REVISION = 5


def build(tree: Tree, kind: str, lamps: int) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    N = shading_normal(tree, inputs.normal)
    closures, colors = fit.closures(tree, kind, inputs, averaged=True)
    shaders = [closures]
    if beams:
        shaders.append(direct.emission(tree, kind, inputs, beams, lambda wi: mixture(tree, colors, wi, N)))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    shaders = [oren_nayar.script(tree, "fit", kind, inputs, averaged=1).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams, "correction")] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
