# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply: the chosen preset for the selected objects, with the textures that they had. One undo step."""

from __future__ import annotations

import bpy

from ..blender import material, metalness, slots, textures
from ..blender.rebuild import UNCHANGED, rebuild
from ..library import families, presets
from ..library.errors import InputError
from . import course, memory
from .operators import chosen_estimator, in_one_line
from .properties import chosen_preset, matching


class VGROOVE_OT_apply(bpy.types.Operator):
    """Apply the preset to the active material slot of every selected object."""

    bl_idname = "vgroove.apply"
    bl_label = "Apply to Selected Objects"
    bl_description = "Apply the preset to the active material slot of every selected object"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not context.selected_objects:
            cls.poll_message_set("Select the objects that should get the material")
            return False
        if not matching(context.scene.vgroove):
            cls.poll_message_set("The family or the search lists no preset; choose another or clear the search")
            return False
        if context.scene.vgroove.backend == "osl" and not bpy.app.build_options.cycles_osl:
            cls.poll_message_set("This Blender was built without OSL; choose the backend Nodes")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings, in_parts = context.scene.vgroove, slots.in_parts(context)
        refused = [text for item in context.selected_objects if (text := slots.refusal(item))]
        able = [item for item in context.selected_objects if not slots.refusal(item)]
        if not able:
            self.report({"ERROR"}, in_one_line(refused))
            return {"CANCELLED"}
        if in_parts and not slots.parts_selected(context):
            self.report({"ERROR"}, "Select faces first, or leave Edit Mode")
            return {"CANCELLED"}
        try:
            preset, backend, estimator = chosen_preset(settings), settings.backend, chosen_estimator(context.scene)
            bound, disperses = settings.bound / 100.0, settings.disperses
            bounces = settings.bounces and families.gets_bounces(preset)
            play = course.play_of(context.scene) if preset.time and context.scene.vgroove_course.play else None
            same = {} if in_parts else {item: item.active_material for item in able if _is_of(item, preset)}
            lost = []
            for made in dict.fromkeys(same.values()):
                lost += rebuild(
                    made, context.scene, backend=backend, estimator=estimator, bound=bound, disperses=disperses,
                    bounces=bounces, play=play if preset.time else UNCHANGED,
                )  # fmt: skip
            others = [item for item in able if item not in same]
            if others:
                lamps = material.lamps_to_bind(context.scene, estimator, preset.model)
                choice = material.Choice(
                    backend, estimator, lamps, bound=bound, disperses=disperses, bounces=bounces, play=play
                )
                lost += _give(context, preset, choice, others)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        memory.used(preset.id)
        count = f"{len(able)} object{'s' * (len(able) > 1)}"
        text = f"{preset.name} applied to {'the selection in ' * in_parts}{count}"
        if also := [item.name for item in slots.sharing(able) if item not in able]:
            text += f" and to {', '.join(also)} (same mesh)"
        left = [
            slots.refusal(item) for item in context.selected_objects if item.type in slots.TYPES and item not in able
        ]
        self.report({"WARNING"} if left or lost else {"INFO"}, ". ".join([text, *lost, *left[:1]]))
        return {"FINISHED"}


def _give(
    context: bpy.types.Context, preset: presets.Preset, choice: material.Choice, items: list[bpy.types.Object]
) -> list[str]:
    """Give the preset to objects, with the textures that each had if wanted; returns what is lost of them."""
    if slots.in_parts(context):
        slots.give_to_parts(material.build(preset, choice), context)
        return []
    keep, lost = context.scene.vgroove.keep_textures, []
    before = {item: item.active_material for item in items}
    news: dict[bpy.types.Material | None, bpy.types.Material] = {}  # all are built before anything is given
    for source in dict.fromkeys(before.values()):
        if keep and textures.may_have(source):
            news[source], missing = textures.build(preset, choice, source)
            lost += [f"not carried over: {name}" for name in missing]
            lost += filter(None, [metalness.says(news[source])])
    if any(source not in news for source in before.values()):
        news |= dict.fromkeys(set(before.values()) - set(news), material.build(preset, choice))
    for source, new in news.items():
        slots.apply(new, [item for item, one in before.items() if one == source])
    return lost


def _is_of(item: bpy.types.Object, preset: presets.Preset) -> bool:
    """Whether an object's active material was built from exactly this preset and can be changed in place.

    Of a metal with a colour texture: from what took its place for that.
    """
    made = item.active_material
    if made is None or not material.is_ours(made) or material.locked(made):
        return False
    known = material.preset_of(made)
    wanted = {"id", "name", "model", "kind", "flags", "distribution", "parameters"}
    return any(
        all(getattr(known, name) == getattr(one, name) for name in wanted)
        for one in (preset, textures.taking_colour(preset))
    )


CLASSES = (VGROOVE_OT_apply,)
