# SPDX-License-Identifier: GPL-3.0-or-later
"""The models in the Shader Editor's Add menu, below Shader, where the search of that menu finds them too."""

from __future__ import annotations

import bpy

from ..blender import shader_nodes
from ..library.errors import InputError

MENUS = ("NODE_MT_category_shader_shader",)  # Add > Shader


class VGROOVE_OT_add_node(bpy.types.Operator):
    """Add a V-Groove shader to the node tree."""

    bl_idname = "vgroove.add_node"
    bl_label = "Add V-Groove Shader"
    bl_description = "Add a V-Groove shader to the node tree"
    bl_options = {"REGISTER", "UNDO"}

    shader: bpy.props.EnumProperty(
        name="Shader",
        description="The model",
        items=[(name, of.label, of.tip) for name, of in shader_nodes.NODES.items()],
    )

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        space = context.space_data
        tree = getattr(space, "edit_tree", None)
        if tree is None or not tree.is_editable or tree.bl_idname != "ShaderNodeTree" or space.shader_type != "OBJECT":
            cls.poll_message_set("Open a material in the Shader Editor")
            return False
        return True

    @classmethod
    def description(cls, _context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        return shader_nodes.NODES[properties.shader].tip

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        context.space_data.cursor_location_from_region(event.mouse_region_x, event.mouse_region_y)
        done = self.execute(context)
        if done == {"FINISHED"}:  # the node follows the mouse, as Blender's own do
            bpy.ops.node.translate_attach_remove_on_cancel("INVOKE_DEFAULT")
        return done

    def execute(self, context: bpy.types.Context) -> set[str]:
        tree = context.space_data.edit_tree
        try:
            node = shader_nodes.add(tree, self.shader)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for other in tree.nodes:
            other.select = other == node
        tree.nodes.active, node.location = node, context.space_data.cursor_location
        return {"FINISHED"}


class VGROOVE_MT_shaders(bpy.types.Menu):
    """The models, each as one node."""

    bl_label = "V-Groove"

    def draw(self, _context: bpy.types.Context) -> None:
        for name, of in shader_nodes.NODES.items():
            self.layout.operator("vgroove.add_node", text=f"{of.label} ({of.words})").shader = name


def _draw(menu: bpy.types.Menu, _context: bpy.types.Context) -> None:
    menu.layout.separator()
    menu.layout.menu("VGROOVE_MT_shaders")


def register() -> None:
    for name in MENUS:
        getattr(bpy.types, name).append(_draw)


def unregister() -> None:
    for name in MENUS:
        getattr(bpy.types, name).remove(_draw)


CLASSES = (VGROOVE_OT_add_node, VGROOVE_MT_shaders)
