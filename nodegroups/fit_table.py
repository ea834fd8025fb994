# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit``, as an image."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..addon.reference.cook_torrance_fit import FUNCTIONS, tables
from .image_table import FIRST, ImageTable

if TYPE_CHECKING:
    from ._tree import Tree, Value


def pixels() -> np.ndarray:
    """(3 slopes, views, 4) float32, three blocks over each other, each of m^(1/2) from 0 to 1 by views.

    First the weights of all lobes and the first one's roughness; then roughness, anisotropy and tilt of the second, and
    of the third. Not more than 128 either way, to which Simplify may scale textures down.
    """
    weight, roughness, anisotropy, tilt = (tables()[name] for name in FUNCTIONS)
    blocks = [[*weight, roughness[0]]]
    blocks += [[roughness[k], anisotropy[k], tilt[k], np.zeros_like(tilt[k])] for k in (1, 2)]
    return np.concatenate([np.stack(block, axis=-1) for block in blocks]).astype(np.float32)


TABLE = ImageTable(FIRST, 2, pixels)


def look_up(tree: Tree, over: Value, under: Value, root: Value) -> list[tuple[Value, Value]]:
    """Colour and alpha of each block at u = over - under and m^(1/2), both from 0 to 1, linear between nodes.

    What depends on m alone, ``under`` and ``root``, is folded by Cycles.
    """
    (width, height), found = TABLE.ensure().size, []
    slopes, wide = height // 3, (width - 1) / width
    shifted = tree.math("MULTIPLY_ADD", under, (-wide, 0.0, 0.0), (0.5 / width, 0.5 / height, 0.0))
    for block in range(3):
        # From the centre of a block's first pixel to that of its last, so that none bleeds into another.
        start = tree.math("MULTIPLY_ADD", root, (0.0, (slopes - 1) / height, 0.0), shifted)
        start = tree.math("ADD", start, (0.0, slopes * block / height, 0.0))
        found.append(TABLE.node(tree, tree.math("MULTIPLY_ADD", over, (wide, 0.0, 0.0), start)))
    return found
