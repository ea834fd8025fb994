# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``hybrid``: a share c of ``fit``, and the rest of the 1994 model, where it is positive, by ``mirror``.

As ``cook_torrance_hybrid``: nothing is biased beyond Bound of the directional albedo.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import oren_nayar
from . import oren_nayar_direct as direct
from . import oren_nayar_fit as fit
from . import oren_nayar_mirror as mirror
from .cycles_diffuse import mixture
from .hybrid import bound_input
from .lamp_beams import beam_interfaces
from .shading_normal import average_smoothing, shading_normal

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = "VGroove Oren-Nayar Hybrid"
REVISION = 7


def build(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = oren_nayar.interface(tree)
    bound = bound_input(tree)
    beams = beam_interfaces(tree, lamps)
    N = shading_normal(tree, inputs.normal)
    # Averaged, the fit sends too much where Cycles' bump smoothing takes most: less of it, so that at most 3 % is wrong
    c = fit.share(tree, kind, inputs, N, bound) * average_smoothing(tree, inputs.normal) ** 2
    closures, colors = fit.closures(tree, kind, inputs, averaged=True)

    def carried(wi: Value) -> Value:
        return mixture(tree, colors, wi, N) * c

    shaders = [tree.weighted(closures, c), mirror.ray(tree, kind, inputs, carried)]
    shaders += [direct.emission(tree, kind, inputs, beams, carried)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = oren_nayar.interface(tree)
    bound = bound_input(tree)
    beams = beam_interfaces(tree, lamps)
    shaders = [oren_nayar.script(tree, "hybrid", kind, inputs, bound=bound).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams, "correction", bound=bound)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
