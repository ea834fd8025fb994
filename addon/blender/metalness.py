# SPDX-License-Identifier: GPL-3.0-or-later
"""A metalness map: where it is white a metal shows, elsewhere a dielectric. One of the two is the material's preset.

The other is a node of ours with what the artist's material had: the same textures, and values where it had no texture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..models import principled
from . import roles, shader_nodes
from .links import feeder
from .origin import read as record_of

if TYPE_CHECKING:
    from bpy.types import Material, Node, NodeSocket

    from .textures import Textures

METAL, DIELECTRIC = "metal", "plastic"  # of shader_nodes.NODES
VALUES = ("Base Color", "Roughness", "IOR")  # that the other side keeps where nothing is linked


def other(made: Material) -> Node | None:
    """The node that is mixed with the preset's; None without a metalness map."""
    return roles.node(made, roles.METALNESS)


def mixes(made: Material) -> list[Node]:
    """The nodes that mix the two, one for each output."""
    node = other(made)
    linked = [link.to_node for link in node.outputs[0].links] if node is not None else []
    return [one for one in linked if one.bl_idname == "ShaderNodeMixShader"]


def source(made: Material) -> NodeSocket | None:
    """The map."""
    return next((feeder(mix.inputs[0]) for mix in mixes(made)), None)


def has_metal(made: Material) -> bool:
    """Whether the preset is the metal of the two."""
    record = record_of(made)
    return record is not None and record.preset.spec.has_fresnel and principled.is_metallic(record.preset)


def says(made: Material) -> str:
    """What shows where, in words."""
    if other(made) is None:
        return ""
    sides = (made.name, "plastic") if has_metal(made) else ("metal", made.name)
    return "{} where the metalness map is white, {} elsewhere".format(*sides)


def give(made: Material, found: Textures) -> None:
    """Mix the preset's node with the other side by the map of ``found``, whose textures that side gets as well."""
    assert found.metallic is not None  # noqa: S101 - whoever calls saw to it
    tree, node = made.node_tree, other(made) or _add(made)
    for name, value in found.values.items():
        if (socket := node.inputs.get(name)) is not None:
            socket.default_value = value
    for name, texture in found.inputs.items():
        socket = node.inputs.get(name)
        if socket is not None and not (socket.type == "VECTOR" and texture.type == "VALUE"):
            tree.links.new(texture, socket)
    for mix in mixes(made):
        tree.links.new(found.metallic, mix.inputs[0])


def _add(made: Material) -> Node:
    tree, model = made.node_tree, roles.node(made, roles.MODEL)
    assert model is not None  # noqa: S101 - as in give
    node = shader_nodes.add(tree, DIELECTRIC if has_metal(made) else METAL)
    node[roles.KEY] = roles.METALNESS
    node.location = model.location.x, model.location.y - 360
    for output in (*roles.nodes(made, roles.OUTPUT), *roles.nodes(made, roles.EEVEE)):
        surface, mix = output.inputs["Surface"], tree.nodes.new("ShaderNodeMixShader")
        mix.location = output.location.x - 180, output.location.y
        sides = (node.outputs[0], surface.links[0].from_socket)
        for side, shader in zip(mix.inputs[1:], sides if has_metal(made) else reversed(sides), strict=True):
            tree.links.new(shader, side)
        tree.links.new(mix.outputs[0], surface)
    return node
