# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light (``eevee``).

The world is seen through two lobes, one about the mirrored view and a wide one about the normal. Lambert would hold
more of a light near the horizon than the diffuse part has.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import ashikhmin_shape, eevee
from . import ashikhmin_shirley as model
from ._tree import dot, maximum, minimum
from .ashikhmin_shirley_closure import entered
from .shading_normal import shading_normal, smoothing, specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Ashikhmin-Shirley EEVEE"
REVISION = 1


def build(tree: Tree, *, radial: bool) -> None:
    inputs = model.interface(tree, radial=radial)
    N, facing = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal)
    wi = eevee.to_light(tree)
    slope = minimum(inputs.roughness**2, eevee.WIDEST)
    above = eevee.world(tree, eevee.mirrored(tree, N, slope), slope)
    below = eevee.world(tree, facing, eevee.WIDEST)
    E = inputs.specular + (1.0 - inputs.specular) * ashikhmin_shape.shape(tree, inputs).mean
    deep, received = entered(tree, inputs), eevee.received(tree, wi)
    with tree.frame("f cos, less what both show of the light"):
        f_cos, vh = model.lobe(tree, inputs, N, inputs.turned_tangent(N), wi)
        mirrored = model.reflectance(tree, inputs, vh) * (f_cos * received) - E * above.factor
        ni = maximum(dot(facing, wi), 0.0)
        kept = 28.0 / 23.0 / pi * model.entering(ni) * ni * smoothing(tree, inputs.normal, wi)
        scattered = deep * (kept * received - below.factor)
    seen = E * above.radiance + deep * below.radiance
    eevee.output_formula(tree, seen, above.alpha, Diffuse=scattered, Glossy=mirrored)
