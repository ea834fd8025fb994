# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected``: ``fit``, and at bound lamps the signed difference from the formula, as emission.

As ``cook_torrance_corrected``: bound lamps are exact; world and bounces are as ``fit`` has them. Lambert differs only
where a bump or normal map is linked, by its smoothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import ward
from . import ward_direct as direct
from . import ward_fit as fit
from ._tree import normalize
from .anisotropic_fit_mixture import fit_mixture
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal, typical_smoothing

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = "VGroove Ward Corrected"
REVISION = 2


def build(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    N, wo = specular_normal(tree, inputs.normal), tree.geometry("Incoming")

    narrowed, share = fit.effective(tree, inputs, N, inputs.T)

    def carried(wi: Value) -> tuple[Value, float]:
        return fit_mixture(tree, wi, normalize(wi + wo), N, narrowed, fit.TABLES[kind]) * share, 0.0

    shaders = [fit.shader(tree, inputs)]
    if beams:
        diffused = typical_smoothing(tree, inputs.normal)
        shaders.append(direct.emission(tree, inputs, beams, diffused=diffused, carried=carried))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    lobes = fit.for_script(tree, inputs)
    shaders = [fit.shader_osl(tree, inputs)]
    shaders += [direct.emission_osl(tree, inputs, beams, "correction", **lobes)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
