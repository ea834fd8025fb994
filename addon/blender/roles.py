# SPDX-License-Identifier: GPL-3.0-or-later
"""Which part each node of a material plays: a property that the builder sets, whatever the node is called."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...nodegroups import REVISION_KEY
from ...nodegroups.trajectory import AGE, OFFSET, RATE

if TYPE_CHECKING:
    from bpy.types import Material, Node

KEY = "vgroove"  # custom property: on a node its role, on a material what it was built from (origin.py)
MODEL, LIGHT, ABSORPTION, TRAJECTORY = "model", "light", "absorption", "trajectory"  # node groups of ours
OUTPUT, EEVEE = "output", "eevee"  # material outputs: the one that Cycles renders, and EEVEE's own
GLOW, CLEAR = "glow", "clear"  # the Emission and the Transparent beside the model
METALNESS = "metalness"  # the node that a metalness map mixes with the model's
EXPORT = "export"  # what is there while glTF is written
GROUPS = (MODEL, LIGHT, ABSORPTION, TRAJECTORY)


def nodes(material: Material, role: str) -> list[Node]:
    """The nodes of this role. Of copies that an artist made, those that are in use come first.

    A group node whose group was deleted or replaced by one of the artist's own has no role any more.
    """
    tree = material.node_tree
    told = guess if is_format_1(material) else role_of
    found = [node for node in tree.nodes if told(node) == role] if tree else []
    return sorted(found, key=lambda node: not any(socket.is_linked for socket in node.outputs))


def node(material: Material, role: str) -> Node | None:
    """The first of ``nodes``."""
    return next(iter(nodes(material, role)), None)


def role_of(node: Node) -> str:
    """The role of a node; empty for an artist's own."""
    if node.bl_idname != "ShaderNodeGroup":
        return str(node.get(KEY, ""))
    if node.node_tree is None or REVISION_KEY not in node.node_tree:
        return ""
    return str(node.get(KEY, ""))


def is_format_1(material: Material) -> bool:
    """Whether a material was made before nodes had roles: what it was built from is a list then."""
    return str(material.get(KEY, "")).startswith("[")


def guess(node: Node) -> str:
    """The role of a node in a material of format 1, which kept none: by the sockets of its group."""
    if node.bl_idname == "ShaderNodeOutputMaterial":
        return EEVEE if node.target == "EEVEE" else OUTPUT
    if node.bl_idname != "ShaderNodeGroup" or node.node_tree is None or REVISION_KEY not in node.node_tree:
        return ""
    if "To Lamp" in node.outputs:
        return LIGHT
    if "Volume" in node.outputs:
        return ABSORPTION
    return TRAJECTORY if {AGE, RATE, OFFSET} <= {socket.name for socket in node.inputs} else MODEL
