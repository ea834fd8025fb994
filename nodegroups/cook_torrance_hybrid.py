# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``hybrid``: a share c of ``fit``, and the rest of the V-groove model, where it is positive, by ``mirror``.

c is chosen so that c times the mixture exceeds the model by no more than Bound of the directional albedo: beyond that
nothing is biased, and only the rest is noisy. Lamps of zero size get their rest as emission, signed and exact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import cook_torrance
from . import cook_torrance_direct as direct
from . import cook_torrance_fit as fit
from . import cook_torrance_mirror as mirror
from ._tree import maximum
from .fit_mixture import fit_mixture
from .hybrid import bound_input
from .lamp_beams import beam_interfaces
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = "VGroove Cook-Torrance Hybrid"
REVISION = 8


def build(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = cook_torrance.interface(tree, kind, native=True)  # Cycles clamps alpha to 1
    bound = bound_input(tree)
    beams = beam_interfaces(tree, lamps)
    N = specular_normal(tree, inputs.normal)
    c = fit.share(tree, inputs.m, N, bound)

    def carried(wi: Value, h: Value) -> Value:
        return c * fit_mixture(tree, wi, h, N, inputs.m)

    def rest(facet: mirror.Facet) -> Value:
        with tree.frame("What c times the mixture leaves of D G / (4 n.v)"):
            f_cos = inputs.density(tree, facet.h, N) * facet.G / (4.0 * facet.no)
            return maximum(1.0 - carried(facet.wi, facet.h) / f_cos, 0.0)

    shaders = [tree.weighted(fit.shader(tree, kind, inputs), c), mirror.facet(tree, kind, inputs, rest)]
    shaders += [direct.emission(tree, kind, inputs, beams, carried)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = cook_torrance.interface(tree, kind, native=True)
    bound = bound_input(tree)
    beams = beam_interfaces(tree, lamps)
    more = fit.for_script(tree, inputs) | {"bound": bound}
    shaders = [cook_torrance.script(tree, "hybrid", kind, inputs, **more).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams, "correction", **more)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
