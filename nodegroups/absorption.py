# SPDX-License-Identifier: GPL-3.0-or-later
"""What a transparent body takes from light on its way through: after d metres exp(-a d) is left (Beer-Lambert).

Cycles' own volume, which needs a closed surface; sheets have no inside.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._tree import maximum, output, vector

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Absorption"
REVISION = 2


def build(tree: Tree) -> None:
    tip = "Of red, green and blue light, in 1/m: after d metres exp(-a d) of it is left"
    a = tree.input_color("Absorption", (0.0, 0.0, 0.0), tip=tip, high=1e5, held=True)
    with tree.frame("a = (1 - Color) Density"):
        r, g, b = a.xyz
        density = maximum(maximum(maximum(r, g), b), 1e-6)
        color = 1.0 - a / vector(density, density, density)
    volume = tree.node("ShaderNodeVolumeAbsorption", Color=color, Density=density)
    tree.output_shader("Volume", output(volume, "Volume"), tip="To the material's Volume")
