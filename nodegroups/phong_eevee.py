# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world as ``over_lambert`` has it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import over_lambert, phong
from ._tree import minimum
from .phong_closure import native

if TYPE_CHECKING:
    from ._tree import Tree, Value

NAME = ".VGroove Phong EEVEE"
REVISION = 2


def build(tree: Tree, of: phong.Lobe) -> None:
    inputs = phong.interface(tree, of)

    def lobe(N: Value, wi: Value, wo: Value) -> Value:
        return of.value(tree, N, wi, wo, inputs.n)

    over_lambert.output_formula(tree, inputs, lobe, of.slope(inputs.n), minimum(native(tree, of, inputs).weight, 1.0))
