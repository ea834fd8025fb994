# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world mostly by Lambert (``eevee``).

Lambert's color is the least that the formula has of any light, so that the rest is positive; what the albedo lacks of
the world is seen through a wide lobe about the normal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import eevee, oren_nayar
from ._tree import dot, maximum, output
from .oren_nayar_fit import albedo
from .shading_normal import shading_normal, smoothing

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Oren-Nayar EEVEE"
REVISION = 2
FORWARD = 0.86  # the formula's C2 tan(b) away from the viewer is at most about this times sin^2 of the view's angle


def build(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    N, wo, wi = shading_normal(tree, inputs.normal), tree.geometry("Incoming"), eevee.to_light(tree)
    with tree.frame("The least of any light"):
        s2, no = inputs.sigma * inputs.sigma, maximum(dot(N, wo), 0.0)
        forward = s2 / (s2 + 0.09) * FORWARD * (1.0 - no * no) if kind == "full" else 0.0
        least = inputs.albedo * maximum(oren_nayar.C1(s2) - forward, 0.0)
    rest = maximum(albedo(tree, kind, inputs) - least, 0.0)
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=least, Normal=N)
    world = eevee.world(tree, N, eevee.WIDEST)
    lambert, _ = eevee.radiance(tree, output(diffuse, "BSDF"))
    f = oren_nayar.brdf(tree, kind, inputs, N, wi, wo)
    with tree.frame("f cos, less what both show of the light"):
        shown = f * (smoothing(tree, inputs.normal, wi) * dot(N, wi) * eevee.received(tree, wi))
        added = shown - least * eevee.factor(tree, N) - rest * world.factor
    eevee.output_formula(tree, lambert + rest * world.radiance, world.alpha, Diffuse=added)
