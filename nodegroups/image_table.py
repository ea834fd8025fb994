# SPDX-License-Identifier: GPL-3.0-or-later
"""Tables as small images of floats, which Cycles interpolates faster than any formula.

They are packed: saved, appended and linked with what uses them. All materials of a .blend share one of each.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy

from . import REVISION_KEY
from ._native import output
from ._tree import Tree, Value

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from bpy.types import Image, ShaderNodeTexImage

TABLE_KEY = "vgroove_table"  # which table a node reads
FIRST = "VGroove Fit Table"  # that of older nodes, which do not say it


@dataclass(frozen=True)
class ImageTable:
    """pixels: (height, width, 4) float32, the first row at the bottom."""

    name: str
    revision: int
    pixels: Callable[[], np.ndarray]

    def find(self) -> Image | None:
        """The image at this revision; None if this .blend has none, or only one of another revision."""
        for image in bpy.data.images:
            same = image.name.split(".")[0] == self.name and image.get(REVISION_KEY) == self.revision
            if same and image.library is None:
                return image
        return None

    def ensure(self) -> Image:
        """The image at this revision, made where there is none."""
        return self.find() or self._make()

    def nodes_without(self) -> list[ShaderNodeTexImage]:
        """Nodes whose image an artist deleted; materials render pink without it."""
        groups = [group for group in bpy.data.node_groups if REVISION_KEY in group and group.library is None]
        textures = [node for group in groups for node in group.nodes if node.bl_idname == "ShaderNodeTexImage"]
        return [node for node in textures if node.image is None and self._reads(node)]

    def restore(self) -> None:
        """Restore the table in those nodes."""
        for node in self.nodes_without():
            node.image = self.ensure()

    def node(self, tree: Tree, place: Value) -> tuple[Value, Value]:
        """Colour and alpha at ``place``, linear between pixels."""
        image = self.ensure()
        node = tree.node("ShaderNodeTexImage", image=image, interpolation="Linear", extension="EXTEND", Vector=place)
        node[REVISION_KEY], node[TABLE_KEY] = self.revision, self.name
        return Value(tree, output(node, "Color")), Value(tree, output(node, "Alpha"))

    def _reads(self, node: ShaderNodeTexImage) -> bool:
        return node.get(REVISION_KEY) == self.revision and node.get(TABLE_KEY, FIRST) == self.name

    def _make(self) -> Image:
        numbers = self.pixels()
        height, width, _ = numbers.shape
        image = bpy.data.images.new(self.name, width, height, alpha=True, float_buffer=True, is_data=True)
        image.alpha_mode = "CHANNEL_PACKED"  # the fourth number is one like the others
        image.pixels.foreach_set(numbers.ravel())
        image.update()
        image.pack()
        image[REVISION_KEY] = self.revision
        return image
