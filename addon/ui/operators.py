# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply a preset to the selected objects, and mend what is wrong with the scene. One undo step each."""

from __future__ import annotations

import bpy

from ...nodegroups.osl_script import OslError
from .. import material, presets, scene


class VGROOVE_OT_apply(bpy.types.Operator):
    """Give the chosen preset to the active material slot of every selected object."""

    bl_idname = "vgroove.apply"
    bl_label = "Apply to Selected Objects"
    bl_description = "Give the chosen preset to the active material slot of every selected object"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not context.selected_objects:
            cls.poll_message_set("Select the objects that should get the material")
            return False
        if context.scene.vgroove.backend == "osl" and not bpy.app.build_options.cycles_osl:
            cls.poll_message_set("This Blender was built without OSL; choose the backend Nodes")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.vgroove
        estimator = chosen_estimator(context.scene)
        try:
            preset = presets.find(settings.preset)
            lamps = scene.lamps_to_bind(context.scene, estimator, preset.model)
            choice = material.Choice(settings.backend, estimator, lamps, bound=settings.bound / 100.0)
            made = material.build(preset, choice)
        except (presets.PresetError, material.MaterialError, OslError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        count = material.apply(made, context.selected_objects)
        if not count:
            self.report({"WARNING"}, "None of the selected objects can have a material; select a mesh, curve or text")
            return {"CANCELLED"}
        self.report(
            {"INFO"}, f"{made.name} ({estimator}, {settings.backend}) given to {count} object{'s' * (count > 1)}"
        )
        return {"FINISHED"}


class VGROOVE_OT_mend(bpy.types.Operator):
    """Change the setting that keeps the chosen estimator from rendering as it should."""

    bl_idname = "vgroove.mend"
    bl_label = "Mend"
    bl_description = "Change the setting that keeps the chosen estimator from rendering as it should"
    bl_options = {"REGISTER", "UNDO"}

    key: bpy.props.StringProperty(
        name="Problem", description="Which of the listed problems to mend; all if empty", options={"HIDDEN"}
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        found = next((p for p in current_problems(context.scene) if p.key == properties.key), None)
        return f"{found.button}. {found.text}" if found else "Press every button below at once"

    def execute(self, context: bpy.types.Context) -> set[str]:
        mendable = [p for p in current_problems(context.scene) if p.mend and self.key in {"", p.key}]
        for problem in mendable:
            if problem.mend:
                problem.mend()
        if not mendable:
            self.report({"INFO"}, "Nothing to mend: the scene is as it should be")
        return {"FINISHED"} if mendable else {"CANCELLED"}


def chosen_estimator(shown: bpy.types.Scene) -> str:
    """The panel's estimator, with ``auto`` decided."""
    return chosen(shown).estimator


def chosen(shown: bpy.types.Scene) -> scene.Pick:
    """The panel's estimator and, where ``auto`` picked it, why."""
    if shown.vgroove.estimator != "auto":
        return scene.Pick(shown.vgroove.estimator, "")
    preset = presets.find(shown.vgroove.preset)
    return scene.pick(shown, preset.m, preset.model, shown.vgroove.backend)


def current_problems(shown: bpy.types.Scene) -> list[scene.Problem]:
    """What is wrong with the scene for the panel's choices."""
    preset = presets.find(shown.vgroove.preset)
    return scene.problems_with(shown, preset, shown.vgroove.backend, chosen_estimator(shown))


CLASSES = (VGROOVE_OT_apply, VGROOVE_OT_mend)
