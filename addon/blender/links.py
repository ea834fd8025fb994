# SPDX-License-Identifier: GPL-3.0-or-later
"""Links of node trees as renderers follow them."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bpy.types import NodeSocket

MOST_STEPS = 1000  # of reroutes and muted nodes, which may go in a circle


def feeder(socket: NodeSocket) -> NodeSocket | None:
    """What feeds an input, through reroutes and muted nodes; None where nothing does."""
    for _ in range(MOST_STEPS):
        link = next((link for link in socket.links if not link.is_muted), None)
        if link is None:
            return None
        node, found = link.from_node, link.from_socket
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            inner = next((one for one in node.internal_links if one.to_socket == found), None)
            if inner is None:
                return None
            socket = inner.from_socket
        else:
            return found
    return None
