# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the nodes of a group stand, so that it reads from left to right."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bpy.types import Node, ShaderNodeTree

COLUMN_WIDTH = 190


def arrange(tree: ShaderNodeTree) -> None:
    """Place nodes in columns, each just before what it feeds, so that the group reads from left to right."""
    nodes = [node for node in tree.nodes if node.bl_idname != "NodeFrame"]
    fed: dict[Node, set[Node]] = {node: set() for node in nodes}
    for link in tree.links:
        fed[link.from_node].add(link.to_node)
    steps: dict[Node, int] = {}

    def steps_to_end(node: Node) -> int:
        if node not in steps:
            steps[node] = 1 + max((steps_to_end(other) for other in fed[node]), default=-1)
        return steps[node]

    first = max(map(steps_to_end, nodes))
    for node in nodes:
        if node.bl_idname == "NodeGroupInput":
            steps[node] = first
    for node in tree.nodes:
        _tidy(node)
    top = 0.0
    for frame in (None, *(node for node in tree.nodes if node.bl_idname == "NodeFrame")):
        bottom: dict[int, float] = {}  # of each column in this frame's band
        for node in nodes:
            if node.parent == frame:
                column = first - steps[node]
                node.location = (column * COLUMN_WIDTH, bottom.get(column, top))
                bottom[column] = node.location.y - _height(node) - 20
        top = min(bottom.values(), default=top) - 80


def _tidy(node: Node) -> None:
    """Deselect what Blender selects as new; fold away what a Geometry node does not give here."""
    node.select = False
    if node.bl_idname == "ShaderNodeNewGeometry":
        for socket in node.outputs:
            socket.hide = not socket.is_linked


def _height(node: Node) -> float:
    """About how tall Blender draws a node; it knows only once it has drawn it."""
    shown = [socket for socket in (*node.inputs, *node.outputs) if socket.enabled and not socket.hide]
    vectors = sum(s.type == "VECTOR" and not s.is_output and not s.is_linked and not s.hide_value for s in shown)
    menus = sum(hasattr(node, name) for name in ("operation", "distribution", "fresnel_type", "data_type"))
    return 40 + 22 * (len(shown) + 3 * vectors) + 26 * menus
