# SPDX-License-Identifier: GPL-3.0-or-later
"""The models as Cycles shader node groups, built in code: one group a file, each reading like its reference.

``ensure`` is the one way to a group: it makes each group once a .blend and makes it again when it is out of date.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ._tree import Tree

if TYPE_CHECKING:
    from collections.abc import Callable

REVISION_KEY = "vgroove_revision"


def ensure(name: str, revision: int, build: Callable[[Tree], None]) -> bpy.types.ShaderNodeTree:
    """The node group ``name`` at ``revision``; built if this .blend has none, or only one of another revision.

    An older group keeps serving the materials that came with it; Blender gives the new one a numbered name.
    """
    for group in bpy.data.node_groups:
        if group.name.split(".")[0] == name and group.get(REVISION_KEY) == revision and group.library is None:
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
    tree.arrange()
    group[REVISION_KEY] = revision
    return group
