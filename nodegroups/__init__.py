# SPDX-License-Identifier: GPL-3.0-or-later
"""The models as Cycles shader node groups, built in code: one group a file, each reading like its reference.

``ensure`` is the one way to a group: it makes each group once a .blend and makes it again when it is out of date.
Names of groups that models hold inside begin with a dot: Blender's Add menu and lists leave them out.
"""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING

import bpy

from ..addon.reference import cycles
from ._layout import arrange
from ._tree import Tree

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Node, NodeSocket

REVISION_KEY = "vgroove_revision"
CYCLES_KEY = "vgroove_cycles"  # which Cycles a group was built for; older files do not say it
SOCKETS_KEY = "vgroove_sockets"  # a group's sockets as they were built, as JSON: identifier -> type and name


def ensure(name: str, revision: int, build: Callable[[Tree], None]) -> bpy.types.ShaderNodeTree:
    """The node group ``name`` at ``revision`` for the Cycles that runs; built if this .blend has none such.

    Another group of that name, or one whose sockets an artist renamed or removed, keeps serving the materials that use
    it; Blender gives the new one a numbered name.
    """
    for group in bpy.data.node_groups:
        if not group.name.startswith(name):  # most are others, and this is quick
            continue
        same = (
            re.sub(r"\.\d+$", "", group.name) == name and group.get(REVISION_KEY) == revision and group.library is None
        )
        if same and cycles_of(group) == cycles.version() and _as_built(group) == _sockets(group):
            return group
    return make(name, revision, build)


def make(name: str, revision: int, build: Callable[[Tree], None]) -> bpy.types.ShaderNodeTree:
    """A new group, also where there is one of that name; none stays behind if ``build`` fails."""
    group = bpy.data.node_groups.new(name, "ShaderNodeTree")
    tree = Tree(group)
    try:
        build(tree)
    except Exception:
        bpy.data.node_groups.remove(group)
        raise
    arrange(group)
    group[REVISION_KEY], group[CYCLES_KEY], group[SOCKETS_KEY] = revision, cycles.version(), json.dumps(_sockets(group))
    return group


def cycles_of(group: bpy.types.ShaderNodeTree) -> str:
    """Which Cycles a group was built for, one of ``cycles.VERSIONS``."""
    return str(group.get(CYCLES_KEY, cycles.UNTIL_5_2))


def remove_unused(group: bpy.types.ShaderNodeTree) -> None:
    """Remove a group of ours that nothing uses, with the groups and scripts inside that nothing else uses."""
    if group.users or REVISION_KEY not in group or group.library is not None:
        return
    groups = {node.node_tree.name for node in group.nodes if node.bl_idname == "ShaderNodeGroup" and node.node_tree}
    texts = {node.script for node in group.nodes if node.bl_idname == "ShaderNodeScript"}
    bpy.data.node_groups.remove(group)
    for name in groups:
        if (inner := bpy.data.node_groups.get(name)) is not None:  # it may have gone with another
            remove_unused(inner)
    for text in texts - {None}:
        if text.users <= text.use_fake_user:
            bpy.data.texts.remove(text)


def inputs(node: Node) -> dict[str, NodeSocket]:
    """The inputs of a group node by the names that we gave them, also where an artist renamed them in the group."""
    built = _as_built(node.node_tree)
    added = {socket.name: socket for socket in node.inputs if socket.identifier not in built}
    return added | {name_of(socket): socket for socket in node.inputs if socket.identifier in built}


def name_of(socket: NodeSocket) -> str:
    """The name that we gave a socket of a group node."""
    built = _as_built(socket.node.node_tree)
    return built[socket.identifier].partition(" ")[2] if socket.identifier in built else str(socket.name)


def _sockets(group: bpy.types.ShaderNodeTree) -> dict[str, str]:
    items = [item for item in group.interface.items_tree if item.item_type == "SOCKET"]
    return {item.identifier: f"{item.socket_type} {item.name}" for item in items}


def _as_built(group: bpy.types.ShaderNodeTree) -> dict[str, str]:
    built = group.get(SOCKETS_KEY, "{}")
    found: dict[str, str] = json.loads(built) if isinstance(built, str) else built.to_dict()  # as in older files
    return found
