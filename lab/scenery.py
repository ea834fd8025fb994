# SPDX-License-Identifier: GPL-3.0-or-later
"""What the laboratory's scenes are built of: nodes, materials, objects, and pictures in full precision."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any

import bpy

from ..nodegroups import versions

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import Material, Mesh, Node, NodeSocket, NodeTree, Object, Scene, World


def add_node(tree: NodeTree, kind: str, **given: Any) -> Node:
    """A new shader node: ``Capitalised`` names are inputs, as of ``wire``, '_' for a blank; others are settings."""
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in given.items():
        if not name[0].isupper():
            setattr(node, name, value)
    for name, value in given.items():
        if name[0].isupper():
            names = {name, name.replace("_", " ")}
            wire(tree, value, next(one for one in node.inputs if names & {one.identifier, one.name}))
    return node


def wire(tree: NodeTree, value: Any, socket: NodeSocket) -> None:
    """Give an input a value, an output, or the first output of a node. A colour may lack its alpha."""
    if isinstance(value, bpy.types.Node):
        value = value.outputs[0]
    if isinstance(value, bpy.types.NodeSocket):
        tree.links.new(value, socket)
    else:
        socket.default_value = (*value, 1.0) if socket.type == "RGBA" and len(value) == 3 else value


def surface(name: str, shader: Callable[[NodeTree], Node], socket: str = "Surface") -> Material:
    """A material that shows the node which ``shader`` adds to its tree."""
    made = versions.empty_material(name)
    add_node(made.node_tree, "OutputMaterial", **{socket: shader(made.node_tree)})
    return made


def background(world: World) -> Node:
    return next(node for node in world.node_tree.nodes if node.bl_idname == "ShaderNodeBackground")


def checker(tree: NodeTree, one: Sequence[float], other: Sequence[float], scale: float = 3.0, **given: Any) -> Node:
    """A checkered colour."""
    return add_node(tree, "TexChecker", Color1=one, Color2=other, Scale=scale, **given)


def add_object(
    shown: Scene, name: str, data: Any, at: Sequence[float] = (0, 0, 0), turned: Sequence[float] = (0, 0, 0)
) -> Object:
    """An object in the scene; turned: degrees about x, y and z."""
    item = bpy.data.objects.new(name, data)
    item.location, item.rotation_euler = at, [radians(angle) for angle in turned]
    shown.collection.objects.link(item)
    return item


def light_data(name: str, kind: str, **settings: Any) -> bpy.types.Light:
    data = bpy.data.lights.new(name, kind)
    for setting, value in settings.items():
        setattr(data, setting, value)
    return data


def quad(name: str, side: float) -> Mesh:
    """A square with UVs."""
    half, mesh = side / 2.0, bpy.data.meshes.new(name)
    mesh.from_pydata([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for corner, place in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
        corner.uv = place
    return mesh


def write_exact(shown: Scene, size: int) -> None:
    """Have pictures written as ``size`` x ``size`` pixels of float32."""
    shown.render.resolution_x = shown.render.resolution_y = size
    shown.render.image_settings.file_format, shown.render.image_settings.color_depth = "OPEN_EXR", "32"
