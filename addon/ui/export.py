# SPDX-License-Identifier: GPL-3.0-or-later
"""Our materials for other programs: with Principled, with maps baked from it, and as USD exports read them.

glTF exports find their hook in the extension's root (``glTF2ExportUserExtension``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from ...nodegroups import versions
from ..blender import convert
from ..library.errors import InputError
from .panels import InSidebar
from .text import lines

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..blender.convert import Converted

ABOUT = "glTF and USD exports carry these materials as they are. For other formats, and for game engines:"


class _Conversion:
    """What both operators share: a material of its own for each of ours on the selected objects, or none at all."""

    bl_options = {"REGISTER", "UNDO"}
    if TYPE_CHECKING:
        report: Callable[[set[str], str], None]
        poll_message_set: Callable[[str], None]

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not convert.in_slots(context.selected_objects):
            cls.poll_message_set("Select objects with a V-Groove material")
            return False
        if context.mode != "OBJECT":
            cls.poll_message_set("Switch to Object Mode first")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        found, done = convert.in_slots(context.selected_objects), {}
        refused = [text for items in found.values() for item in items if (text := self.flaw(item))]
        if refused:
            self.report({"ERROR"}, refused[0])
            return {"CANCELLED"}
        images = set(bpy.data.images)
        try:
            for made, items in found.items():
                done[made] = convert.convert(made)
                done[made].left.extend(self.finish(done[made], made, items))
        except InputError as error:
            for one in done.values():
                bpy.data.materials.remove(one.material)
            for image in set(bpy.data.images) - images:
                bpy.data.images.remove(image)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for made, items in found.items():
            convert.give(made, done[made].material, items)
        left = [f"{one.material.name} leaves out {text}" for one in done.values() for text in one.left]
        names = ", ".join(one.material.name for one in done.values())
        self.report({"WARNING"} if left else {"INFO"}, ". ".join([f"Made: {names}", *left]))
        return {"FINISHED"}

    @staticmethod
    def flaw(item: bpy.types.Object) -> str:  # noqa: ARG004 - of the subclass
        """Why it cannot be done for an object, and what to do; empty if it can."""
        return ""

    def finish(self, _of: Converted, _made: bpy.types.Material, _items: list[bpy.types.Object]) -> list[str]:
        """What is done beyond; returns what was left out."""
        return []


class VGROOVE_OT_to_principled(_Conversion, bpy.types.Operator):
    """Replace the V-Groove materials of the selected objects by Principled BSDF."""

    bl_idname = "vgroove.to_principled"
    bl_label = "Convert to Principled"
    bl_description = (
        "Give the selected objects copies of their V-Groove materials made with Principled BSDF. Textures stay linked. "
        "The V-Groove materials stay in the file"
    )


class VGROOVE_OT_bake(_Conversion, bpy.types.Operator):
    """Replace the V-Groove materials of the selected objects by Principled BSDF with baked image maps."""

    bl_idname = "vgroove.bake"
    bl_label = "Bake to Principled"
    bl_description = (
        "Give the selected objects copies of their V-Groove materials made with Principled BSDF, whose textures are "
        "baked to image maps over the active UV map. What does not vary becomes a plain value. "
        "The V-Groove materials stay in the file"
    )

    size: bpy.props.IntProperty(
        name="Size",
        description="Width and height of each image map, in pixels",
        default=1024,
        min=convert.SIZES[0],
        max=convert.SIZES[1],
        subtype="PIXEL",
    )

    @staticmethod
    def flaw(item: bpy.types.Object) -> str:
        from ..blender import bake  # what few sessions need is not read as Blender starts

        return bake.flaw(item)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        return context.window_manager.invoke_props_dialog(self, confirm_text="Bake")

    def finish(self, of: Converted, made: bpy.types.Material, items: list[bpy.types.Object]) -> list[str]:
        from ..blender import bake

        return bake.bake(of, made, items, self.size)


class VGROOVE_PT_export(InSidebar, bpy.types.Panel):
    """What the materials become in other programs."""

    bl_label = "Export"
    bl_parent_id = "VGROOVE_PT_material"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: bpy.types.Context) -> None:
        lines(self.layout, ABOUT, context.region.width)
        self.layout.operator("vgroove.bake", icon="RENDER_STILL")
        self.layout.operator("vgroove.to_principled", icon="NODE_MATERIAL")


class _ToUSD:
    """Called by Blender's USD exporter, for each material that it writes."""

    bl_idname = "vgroove_usd"
    bl_label = "V-Groove"

    @staticmethod
    def on_material_export(context: Any, made: bpy.types.Material, usd_material: Any) -> bool:
        from ..blender import usd

        return usd.write(context, made, usd_material)


HOOKS = (type("VGROOVE_USD", (_ToUSD, versions.USD_HOOK), {}),) if versions.USD_HOOK else ()
CLASSES = (VGROOVE_OT_to_principled, VGROOVE_OT_bake, VGROOVE_PT_export, *HOOKS)
