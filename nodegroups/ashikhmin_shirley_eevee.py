# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light (``eevee``).

The world is seen through two lobes, one about the mirrored view and a wide one about the normal, as Lambert would hold
more of a light near the horizon than the paper's diffuse part has. Where that is Lambert's, as ``over_lambert`` has it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from math import pi
from typing import TYPE_CHECKING

from . import ashikhmin_shape, eevee, over_lambert
from . import ashikhmin_shirley as model
from ._tree import dot, maximum, minimum
from .ashikhmin_shirley_closure import entered, even
from .shading_normal import shading_normal, smoothing, specular_normal

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = ".VGroove Ashikhmin-Shirley EEVEE"
REVISION = 2


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    E = even(inputs, ashikhmin_shape.shape(tree, inputs).mean)
    if inputs.over_lambert:
        scaled = replace(inputs, specular=inputs.amplitude)
        over_lambert.output_formula(tree, scaled, partial(_lobe, inputs), inputs.roughness**2, E)
    else:
        _output_formula(tree, inputs, inputs.amplitude * E)


def _lobe(inputs: model.Inputs, N: Value, wi: Value, _wo: Value) -> Value:
    """The highlight over its amplitude, in 1/sr."""
    tree = N.tree
    f_cos, vh = model.lobe(tree, inputs, N, inputs.turned_tangent(N), wi)
    return model.reflectance(tree, inputs.specular, vh) * (f_cos / maximum(dot(N, wi), 1e-7))


def _output_formula(tree: Tree, inputs: model.Inputs, E: Value) -> None:
    N, facing = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal)
    wi = eevee.to_light(tree)
    slope = minimum(inputs.roughness**2, eevee.WIDEST)
    above = eevee.world(tree, eevee.mirrored(tree, N, slope), slope)
    below = eevee.world(tree, facing, eevee.WIDEST)
    deep, received = entered(tree, inputs), eevee.received(tree, wi)
    with tree.frame("f cos, less what both show of the light"):
        f_cos, vh = model.lobe(tree, inputs, N, inputs.turned_tangent(N), wi)
        F = inputs.amplitude * model.reflectance(tree, inputs.specular, vh)
        ni = maximum(dot(facing, wi), 0.0)
        kept = 28.0 / 23.0 / pi * model.entering(ni) * ni * smoothing(tree, inputs.normal, wi)
        lights = {
            "Diffuse": deep * (kept * received - below.factor),
            "Glossy": F * (f_cos * received) - E * above.factor,
        }
    eevee.output_formula(tree, E * above.radiance + deep * below.radiance, above.alpha, **lights)
