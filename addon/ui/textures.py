# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of maps for the active material, in one undo step."""

from __future__ import annotations

from pathlib import Path

import bpy

from ..blender import metalness, textures
from ..blender.rebuild import as_preset
from ..library.errors import InputError
from .operators import ours


class VGROOVE_OT_add_image_set(bpy.types.Operator):
    """Link the maps of a folder to the active material, by their names."""

    bl_idname = "vgroove.add_image_set"
    bl_label = "Add Image Set"
    bl_description = (
        "Link the maps of a folder to the active material by the usual names, such as wall_color.png, "
        "wall_roughness.png, wall_normal.png"
    )
    bl_options = {"REGISTER", "UNDO"}

    directory: bpy.props.StringProperty(
        name="Folder", description="The folder with the maps", subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )  # fmt: skip
    filter_folder: bpy.props.BoolProperty(default=True, options={"HIDDEN"})
    filter_image: bpy.props.BoolProperty(default=True, options={"HIDDEN"})

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if ours(context) is None:
            cls.poll_message_set("Apply a preset first")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        from ..blender import image_set  # not read as Blender starts

        made = ours(context)
        assert made is not None  # noqa: S101 - poll saw to it
        try:
            maps = image_set.find(Path(bpy.path.abspath(self.directory)))
            found = image_set.load(made.node_tree, maps)
            lost = list(found.lost)
            if "Base Color" in maps:
                lost += as_preset(made, context.scene, textures.taking_colour)
            lost += textures.give(made, found)
        except (InputError, OSError, RuntimeError) as error:  # Blender raises RuntimeError for a file that is not there
            self.report({"ERROR"}, str(error).strip())
            return {"CANCELLED"}
        count = len(maps)
        texts = [f"{count} map{'s' * (count > 1)} found for {made.name}", metalness.says(made)]
        texts += [f"not used: {one}" for one in lost]
        self.report({"WARNING"} if lost else {"INFO"}, ". ".join(filter(None, texts)))
        return {"FINISHED"}


CLASSES = (VGROOVE_OT_add_image_set,)
