# SPDX-License-Identifier: GPL-3.0-or-later
"""A metalness map: where it is white a metal shows, elsewhere a dielectric. One of the two is the material's preset.

The other is a node of ours with what the artist's material had: the same textures, and values where it had no texture.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..models import principled
from . import beside, roles, shader_nodes
from .origin import read as record_of

if TYPE_CHECKING:
    from bpy.types import Material, Node

    from .textures import Textures

METAL, DIELECTRIC = "metal", "plastic"  # of shader_nodes.NODES
VALUES = ("Base Color", "Roughness", "IOR")  # that the other side keeps where nothing is linked


def other(made: Material) -> Node | None:
    """The node that is mixed with the preset's; None without a metalness map."""
    return roles.node(made, roles.METALNESS)


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
    for mix in beside.joints(made, roles.METALNESS):
        tree.links.new(found.metallic, mix.inputs[0])


def _add(made: Material) -> Node:
    tree, model = made.node_tree, roles.node(made, roles.MODEL)
    assert model is not None  # noqa: S101 - as in give
    node = shader_nodes.add(tree, DIELECTRIC if has_metal(made) else METAL)
    node[roles.KEY] = roles.METALNESS
    node.location = model.location.x, model.location.y - 360
    for output in list(beside.outputs(made)):
        beside.join(tree, output, node.outputs[0], roles.METALNESS, first=has_metal(made))
    return node
