# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of estimator ``fit`` as one small image of floats, which Cycles interpolates faster than any formula.

It is packed: saved, appended and linked with what uses it. All materials of a .blend share one.
"""

from __future__ import annotations

import bpy
import numpy as np

from ..addon.reference.cook_torrance_fit import FUNCTIONS, tables
from . import REVISION_KEY
from ._tree import Tree, Value, output

NAME = "VGroove Fit Table"
REVISION = 2


def find() -> bpy.types.Image | None:
    """The image at this revision; None if this .blend has none, or only one of another revision."""
    for image in bpy.data.images:
        if image.name.split(".")[0] == NAME and image.get(REVISION_KEY) == REVISION and image.library is None:
            return image
    return None


def ensure() -> bpy.types.Image:
    """The image at this revision, made where there is none."""
    return find() or _make()


def nodes_without_table() -> list[bpy.types.ShaderNodeTexImage]:
    """Nodes whose image an artist deleted; materials render pink without it."""
    groups = [group for group in bpy.data.node_groups if REVISION_KEY in group and group.library is None]
    textures = [node for group in groups for node in group.nodes if node.bl_idname == "ShaderNodeTexImage"]
    return [node for node in textures if node.image is None and node.get(REVISION_KEY) == REVISION]


def restore() -> None:
    """Restore the table in those nodes."""
    for node in nodes_without_table():
        node.image = ensure()


def _make() -> bpy.types.Image:
    numbers = pixels()
    height, width, _ = numbers.shape
    image = bpy.data.images.new(NAME, width, height, alpha=True, float_buffer=True, is_data=True)
    image.alpha_mode = "CHANNEL_PACKED"  # the fourth number is one like the others
    image.pixels.foreach_set(numbers.ravel())
    image.update()
    image.pack()
    image[REVISION_KEY] = REVISION
    return image


def pixels() -> np.ndarray:
    """(3 slopes, views, 4) float32, three blocks over each other, each of m^(1/2) from 0 to 1 by views.

    First the weights of all lobes and the first one's roughness; then roughness, anisotropy and tilt of the second, and
    of the third. Not more than 128 either way, to which Simplify may scale textures down.
    """
    weight, roughness, anisotropy, tilt = (tables()[name] for name in FUNCTIONS)
    blocks = [[*weight, roughness[0]]]
    blocks += [[roughness[k], anisotropy[k], tilt[k], np.zeros_like(tilt[k])] for k in (1, 2)]
    return np.concatenate([np.stack(block, axis=-1) for block in blocks]).astype(np.float32)


def look_up(tree: Tree, over: Value, under: Value, root: Value) -> list[tuple[Value, Value]]:
    """Colour and alpha of each block at u = over - under and m^(1/2), both from 0 to 1, linear between nodes.

    What depends on m alone, ``under`` and ``root``, is folded by Cycles.
    """
    image = ensure()
    (width, height), found = image.size, []
    slopes, wide = height // 3, (width - 1) / width
    shifted = tree.math("MULTIPLY_ADD", under, (-wide, 0.0, 0.0), (0.5 / width, 0.5 / height, 0.0))
    for block in range(3):
        # From the centre of a block's first pixel to that of its last, so that none bleeds into another.
        start = tree.math("MULTIPLY_ADD", root, (0.0, (slopes - 1) / height, 0.0), shifted)
        start = tree.math("ADD", start, (0.0, slopes * block / height, 0.0))
        place = tree.math("MULTIPLY_ADD", over, (wide, 0.0, 0.0), start)
        node = tree.node("ShaderNodeTexImage", image=image, interpolation="Linear", extension="EXTEND", Vector=place)
        node[REVISION_KEY] = REVISION
        found.append((Value(tree, output(node, "Color")), Value(tree, output(node, "Alpha"))))
    return found
