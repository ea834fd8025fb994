# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own anisotropic Beckmann closure, which has Smith's G in place of the V-groove's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import anisotropic, cook_torrance, tangent
from . import cook_torrance_closure as closure
from ._tree import sqrt

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Anisotropic Closure"
REVISION = 2


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial, native=True)  # Cycles clamps alpha to 1
    leaning = inputs.anisotropy, tangent.chosen(tree, inputs.tangent, radial=radial)
    native = closure.lobe(tree, kind, inputs.fresnel, sqrt(inputs.m), inputs.normal, *leaning)
    tree.wire(native.node, "Rotation", inputs.rotation)
    tree.output_shader("BSDF", native, tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial, native=True)
    node = cook_torrance.script(tree, "closure", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")
