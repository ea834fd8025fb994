# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected``: ``fit``, and at bound lamps the signed difference from the formula, as emission.

As ``cook_torrance_corrected``: bound lamps are exact; world and bounces are as ``fit`` has them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import anisotropic, cook_torrance
from . import anisotropic_fit as fit
from . import cook_torrance_direct as direct
from .anisotropic_fit_mixture import fit_mixture
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Anisotropic Corrected"
REVISION = 2


def build(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    N = specular_normal(tree, inputs.normal)
    shaders = [fit.shader(tree, kind, inputs)]
    if beams:
        shaders.append(direct.emission(tree, kind, inputs, beams, lambda wi, h: fit_mixture(tree, wi, h, N, inputs)))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    mixture = fit.for_script(tree, inputs)
    shaders = [cook_torrance.script(tree, "fit", kind, inputs, **mixture).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams, "correction", **mixture)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
