# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world as ``over_lambert`` has it."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from . import over_lambert, ward
from ._tree import dot, maximum
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Ward EEVEE"
REVISION = 2


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial)
    # What closure sends back: of the form of 1992, less toward grazing views
    E = maximum(dot(specular_normal(tree, inputs.normal), tree.geometry("Incoming")), 0.0) if kind != "bounded" else 1.0
    over_lambert.output_formula(tree, inputs, partial(inputs.lobe, tree), inputs.m, E)
