# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world as ``over_lambert`` has it.

The world is seen as through Beckmann's distribution half of whose facets lean as little.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import cook_torrance, cook_torrance_albedo, fresnel, generator, over_lambert
from ._tree import dot, maximum, minimum
from .generator_direct import mirrored
from .generator_fit import constant
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ..addon.reference.facet_distribution import Distribution
    from ._tree import Tree, Value

NAME = ".VGroove Generator EEVEE"
REVISION = 2


def build(tree: Tree, kind: str, of: Distribution) -> None:
    inputs = generator.interface(tree, kind)
    m = constant(tree, min(of.slope, 1.0))
    alike = cook_torrance.Inputs(inputs.fresnel, m, inputs.normal)
    E = minimum(cook_torrance_albedo.albedo(tree, kind, alike, specular_normal(tree, inputs.normal)), 1.0)

    def lobe(N: Value, wi: Value, wo: Value) -> Value:
        f_cos, vh = mirrored(tree, of, N, wi, wo)
        return fresnel.reflectance(tree, kind, inputs.fresnel, vh) * (f_cos / maximum(dot(N, wi), 1e-7))

    over_lambert.output_formula(tree, inputs, lobe, m, E)
