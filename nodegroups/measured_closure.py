# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Lambert and a Beckmann lobe of the table's width and albedo, by Cycles' own closures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import measured, shading_normal
from ._native import output

if TYPE_CHECKING:
    from ..addon.measured.model import Measured
    from ._tree import Tree

NAME = "VGroove Measured Closure"
REVISION = 3


def build(tree: Tree, of: Measured, kind: str) -> None:  # noqa: ARG001 (as of the others)
    normal = shading_normal.interface(tree)
    *_, m = of.closure
    beside, color = (measured.colour(tree, of, which) for which in (measured.BESIDE, measured.LOBE))
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=beside, Roughness=0.0, Normal=normal)
    lobe = tree.node("ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=color, Roughness=m**0.5, Normal=normal)
    shaders = [output(one, "BSDF") for one in (diffuse, lobe)]
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


build_osl = build
