# SPDX-License-Identifier: GPL-3.0-or-later
"""What a transparent body takes from light on its way through: after d metres exp(-a d) is left (Beer-Lambert).

Cycles' own volume, which needs a closed surface; sheets have no inside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.models.glass import ABSORPTION
from ._tree import maximum, output
from .parameters import add_input

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Absorption"
REVISION = 3


def build(tree: Tree) -> None:
    a = add_input(tree, ABSORPTION)
    with tree.frame("a = (1 - Color) Density"):
        r, g, b = a.xyz
        density = maximum(maximum(maximum(r, g), b), 1e-6)
        color = 1.0 - a / density
    volume = tree.node("ShaderNodeVolumeAbsorption", Color=color, Density=density)
    tree.output_shader("Volume", output(volume, "Volume"), tip="To the material's Volume")
