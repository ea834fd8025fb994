# SPDX-License-Identifier: GPL-3.0-or-later
"""Shaders inside an artist's own node groups, taken out so that what feeds them can be linked to ours.

A link cannot cross the border of a group. So each group is copied, the copy gives what fed the shaders as outputs, and
copies of the shaders stand beside it. Textures, values and nested groups stay as the artist made them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...nodegroups import REVISION_KEY, versions
from .links import feeder

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, Node, NodeSocket, ShaderNodeTree

GROUP, ENTRY, EXIT = "ShaderNodeGroup", "NodeGroupInput", "NodeGroupOutput"
SOCKETS = {"VALUE": "NodeSocketFloat", "RGBA": "NodeSocketColor", "VECTOR": "NodeSocketVector",
           "INT": "NodeSocketInt", "BOOLEAN": "NodeSocketBool", "STRING": "NodeSocketString",
           "MENU": "NodeSocketMenu", "ROTATION": "NodeSocketRotation", "MATRIX": "NodeSocketMatrix"}  # fmt: skip


def is_grouped(made: Material | None) -> bool:
    """Whether a shader that a material shows comes out of an artist's group."""
    return any(_group_behind(socket) for socket in _surfaces(made))


def _surfaces(made: Material | None) -> Iterator[NodeSocket]:
    tree = versions.used_nodes(made) if made is not None else None
    if tree is None:
        return
    for target in ("CYCLES", "EEVEE"):
        if (output := tree.get_output_node(target)) is not None:
            yield output.inputs["Surface"]


def _group_behind(socket: NodeSocket) -> bool:
    found = feeder(socket)
    if found is None:
        return False
    return _is_artists(found.node) or any(_group_behind(one) for one in found.node.inputs if one.type == "SHADER")


def _is_artists(node: Node) -> bool:
    return node.bl_idname == GROUP and node.node_tree is not None and REVISION_KEY not in node.node_tree


def take_out(made: Material) -> list[ShaderNodeTree]:
    """Have every shader that ``made`` shows stand in its own tree; returns the copied groups."""
    copies: dict[str, ShaderNodeTree] = {}  # the groups that are the material's own by now, by their nodes
    for socket in list(_surfaces(made)):
        _take_out_behind(made.node_tree, socket, copies)
    for group in copies.values():
        _remove_shaders(group)
    return list(copies.values())


def _take_out_behind(tree: ShaderNodeTree, socket: NodeSocket, copies: dict[str, ShaderNodeTree]) -> None:
    """Have shaders of ``tree`` itself feed a shader input of it."""
    found = feeder(socket)
    while found is not None and _is_artists(found.node):
        node, identifier = found.node, found.identifier
        if node.name not in copies:
            node.node_tree = copies[node.name] = node.node_tree.copy()
        inner = feeder(next(one for one in _exit(node.node_tree).inputs if one.identifier == identifier))
        for link in list(socket.links):
            tree.links.remove(link)
        if inner is None:
            return
        _join(tree, node, inner, socket)
        found = feeder(socket)
    for one in found.node.inputs if found is not None else ():
        if one.type == "SHADER":
            _take_out_behind(tree, one, copies)


def _join(tree: ShaderNodeTree, node: Node, inner: NodeSocket, socket: NodeSocket) -> None:
    """Feed ``socket`` beside a group's ``node`` by ``inner``, which gives the same inside the group."""
    if inner.node.bl_idname == ENTRY:
        entry = next(one for one in node.inputs if one.identifier == inner.identifier)
        if (before := feeder(entry)) is not None:
            tree.links.new(before, socket)
            return
        if entry.type == "SHADER" or entry.hide_value:
            return
        if entry.type == socket.type:
            socket.default_value = entry.default_value
            return
    if inner.type == "SHADER":
        same = _copy(tree, node, inner.node)
        tree.links.new(next(one for one in same.outputs if one.identifier == inner.identifier), socket)
    else:
        tree.links.new(_given(node, inner), socket)


def _copy(tree: ShaderNodeTree, node: Node, shader: Node) -> Node:
    """A shader of a group beside the group's ``node``, fed by the same."""
    new = tree.nodes.new(shader.bl_idname)
    new.label = shader.label
    if shader.bl_idname == GROUP:
        new.node_tree = shader.node_tree
    inputs = {one.identifier: one for one in new.inputs}
    for theirs in shader.inputs:
        socket = inputs[theirs.identifier]
        if hasattr(theirs, "default_value"):
            socket.default_value = theirs.default_value
        if (inner := feeder(theirs)) is not None:
            _join(tree, node, inner, socket)
    return new


def _given(node: Node, inner: NodeSocket) -> NodeSocket:
    """The output of a group's ``node`` that gives ``inner``, a socket inside."""
    group = node.node_tree
    leave = _exit(group)
    given = next((one for one in leave.inputs if feeder(one) == inner and one.type == inner.type), None)
    if given is None:
        item = group.interface.new_socket(inner.name, in_out="OUTPUT", socket_type=SOCKETS[inner.type])
        given = next(one for one in leave.inputs if one.identifier == item.identifier)
        group.links.new(inner, given)
    return next(one for one in node.outputs if one.identifier == given.identifier)


def _exit(group: ShaderNodeTree) -> Node:
    """The Group Output that counts; an empty one where an artist deleted all."""
    leaves = [node for node in group.nodes if node.bl_idname == EXIT and node.is_active_output]
    return leaves[0] if leaves else group.nodes.new(EXIT)


def _remove_shaders(group: ShaderNodeTree) -> None:
    """What gives or takes a shader at the border, and inside what then leads nowhere."""
    for item in [one for one in group.interface.items_tree if getattr(one, "socket_type", "") == "NodeSocketShader"]:
        group.interface.remove(item)
    while idle := [node for node in group.nodes if node.outputs and all(
            one.type == "SHADER" and not one.is_linked for one in node.outputs)]:  # fmt: skip
        for node in idle:
            group.nodes.remove(node)
