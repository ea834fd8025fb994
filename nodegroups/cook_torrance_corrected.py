# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected``: ``fit``, and at bound lamps the signed difference from the formula, as emission.

Emission may be negative, unlike a closure's weight: so what the mixture has too much of is taken back, no light counts
twice, and bound lamps are exact. World and bounces are as ``fit`` has them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import cook_torrance
from . import cook_torrance_direct as direct
from . import cook_torrance_fit as fit
from .fit_mixture import fit_mixture
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Cook-Torrance Corrected"
REVISION = 6


def build(tree: Tree, kind: str, lamps: int) -> None:
    inputs = cook_torrance.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    N = specular_normal(tree, inputs.normal)
    shaders = [fit.shader(tree, kind, inputs)]
    if beams:
        shaders.append(direct.emission(tree, kind, inputs, beams, lambda wi, h: fit_mixture(tree, wi, h, N, inputs.m)))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int) -> None:
    inputs = cook_torrance.interface(tree, kind)
    beams = beam_interfaces(tree, lamps)
    mixture = fit.for_script(tree, inputs)
    shaders = [cook_torrance.script(tree, "fit", kind, inputs, **mixture).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams, "correction", **mixture)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
