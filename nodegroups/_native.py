# SPDX-License-Identifier: GPL-3.0-or-later
"""Sockets of Blender's own nodes by their identifiers, which a new Blender may rename or take away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..addon.library.errors import InputError

if TYPE_CHECKING:
    from bpy.types import Node, NodeSocket


class NativeError(InputError):
    """One of Blender's own nodes lacks the socket that is wired here."""


def output(node: Node, name: str) -> NodeSocket:
    """The output of one of Blender's own nodes, by its identifier ('_' for a blank); NativeError if it has none."""
    found = named(node.outputs, name)
    if found is None:
        raise NativeError(unlike(node, f"output {name.replace('_', ' ')!r}"))
    return found


def named(sockets: bpy.types.bpy_prop_collection[NodeSocket], name: str) -> NodeSocket | None:
    """The one of this identifier, '_' for a blank; None if there is none."""
    names = name, name.replace("_", " ")
    return next((socket for socket in sockets if socket.identifier in names), None)


def unlike(node: Node, what: str) -> str:
    """What NativeError says of a node without ``what``."""
    return (
        f"the node {node.bl_label} of Blender {bpy.app.version_string} has no {what}; "
        "take a Blender that vgroove is tested with, or a newer vgroove"
    )
