# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply a preset to the selected objects, mend the scene, and keep presets. What changes the file is one undo step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ...nodegroups.osl_script import OslError
from .. import advice, animation, automatic, facts, material, preset_files, presets
from ..files import replacing
from ..material import lamps_to_bind
from ..preset_checks import PresetError
from . import course, memory, watch
from .properties import chosen_preset

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..facts import SceneFacts


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
            preset = chosen_preset(settings)
            lamps = lamps_to_bind(context.scene, estimator, preset.model)
            play = course.play_of(context.scene) if preset.time and context.scene.vgroove_course.play else None
            choice = material.Choice(settings.backend, estimator, lamps, bound=settings.bound / 100.0, play=play)
            made = material.build(preset, choice)
        except (material.MaterialError, animation.AnimationError, OslError) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        count = material.apply(made, context.selected_objects)
        if not count:
            self.report({"WARNING"}, "None of the selected objects can have a material; select a mesh, curve or text")
            return {"CANCELLED"}
        memory.used(preset.id)
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
        name="Problem",
        description="Which of the listed problems to mend; if empty, all whose mending costs nothing elsewhere",
        options={"HIDDEN"},
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        found = next((p for p in current_problems(watch.current(context.scene)) if p.key == properties.key), None)
        if found is None:
            return "Press the buttons below that cost nothing elsewhere in the scene; lists them first"
        return f"{found.button}. {found.text}" + (f". Costs {found.costs}" if found.costs else "")

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        if self.key:
            return self.execute(context)
        return context.window_manager.invoke_props_dialog(self, width=420, title="Mend All", confirm_text="Mend")

    def draw(self, context: bpy.types.Context) -> None:
        found = [p for p in current_problems(watch.current(context.scene)) if p.mend]
        column = self.layout.column(align=True)
        for problem in found:
            if not problem.costs:
                column.label(text=problem.button, icon="CHECKMARK")
        if costly := [p for p in found if p.costs]:
            column.label(text="Left alone, each with its own button:")
            for problem in costly:
                column.label(text=f"{problem.button}: costs {problem.costs}", icon="X")

    def execute(self, context: bpy.types.Context) -> set[str]:
        found = [p for p in current_problems(context.scene) if p.mend]
        mendable = [p for p in found if (p.key == self.key if self.key else not p.costs)]
        for problem in mendable:
            if problem.mend:
                problem.mend()
        if not mendable:
            left = (
                "what is left costs something elsewhere and has its own button"
                if found
                else "the scene suits the choice"
            )
            self.report({"INFO"}, f"Nothing to mend: {left}")
        return {"FINISHED"} if mendable else {"CANCELLED"}


class VGROOVE_OT_favourite(bpy.types.Operator):
    """Mark the chosen preset with a star, or take the star away."""

    bl_idname = "vgroove.favourite"
    bl_label = "Favourite"
    bl_description = "Mark the chosen preset with a star, or take the star away"
    bl_options = {"INTERNAL"}  # preferences have no undo

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        if memory.preferences() is None:
            cls.poll_message_set("Favourites are kept with the installed extension's preferences")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        memory.toggle_favourite(chosen_preset(context.scene.vgroove).id)
        return {"FINISHED"}


class VGROOVE_OT_copy_citation(bpy.types.Operator):
    """Copy where the numbers of the chosen preset come from."""

    bl_idname = "vgroove.copy_citation"
    bl_label = "Copy Citation"
    bl_description = "Copy where the numbers of the chosen preset come from, to paste into a text"
    bl_options = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        context.window_manager.clipboard = citation(chosen_preset(context.scene.vgroove))
        self.report({"INFO"}, "Copied the citation")
        return {"FINISHED"}


class VGROOVE_OT_reset(bpy.types.Operator):
    """Give the active material the preset's own numbers again."""

    bl_idname = "vgroove.reset"
    bl_label = "Reset to Preset"
    bl_description = "Give the active material the preset's own numbers again"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _poll_ours(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        material.reset(ours(context))
        return {"FINISHED"}


class VGROOVE_OT_save_preset(bpy.types.Operator):
    """Keep the active material's numbers as a preset of one's own."""

    bl_idname = "vgroove.save_preset"
    bl_label = "Save as My Preset"
    bl_description = "Keep the active material's numbers as a preset of your own, in your folder; it is offered at once"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; the file stays

    name: bpy.props.StringProperty(name="Name", description="What the preset is to be called", maxlen=60)

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return _poll_folder(cls) and _poll_ours(cls, context)

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        self.name = f"My {material.origin_of(ours(context)).preset.name}"[:60]
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        made = ours(context)
        preset = material.kept(made)
        known = presets.all_presets().get(preset.id)
        source = dict(preset.source)
        if material.is_edited(made):
            source |= {"data": f"edited from {preset.id}, whose source is: {source['data']}"}
        kept = replace(preset, name=self.name, source=source, tags=known.tags if known else ())
        return _keep(self, context, lambda folder: preset_files.save(kept, folder))


class VGROOVE_OT_import_preset(bpy.types.Operator, ImportHelper):
    """Copy a preset's file into one's own folder."""

    bl_idname = "vgroove.import_preset"
    bl_label = "Import Preset"
    bl_description = "Copy a preset's file into your own folder; it is offered at once"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; the file stays

    filename_ext = ".toml"
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return _poll_folder(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        return _keep(self, context, lambda folder: preset_files.take(Path(self.filepath), folder))


class VGROOVE_OT_export_preset(bpy.types.Operator, ExportHelper):
    """Write the chosen preset to a file."""

    bl_idname = "vgroove.export_preset"
    bl_label = "Export Preset"
    bl_description = "Write the chosen preset to a file, to send or to change"
    bl_options = {"REGISTER"}

    filename_ext = ".toml"
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.filepath = f"{preset_files.file_name(chosen_preset(context.scene.vgroove).name)}.toml"
        return ExportHelper.invoke(self, context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        path = Path(self.filepath)
        try:
            with replacing(path) as temporary:
                temporary.write_text(preset_files.dumps(chosen_preset(context.scene.vgroove)), encoding="utf-8")
        except OSError as error:
            self.report({"ERROR"}, f"{path} cannot be written: {error.strerror or error}")
            return {"CANCELLED"}
        self.report({"INFO"}, f"Wrote {path}")
        return {"FINISHED"}


def _keep(operator: bpy.types.Operator, context: bpy.types.Context, keep: Callable[[Path], presets.Preset]) -> set[str]:
    """Have a preset put into the user's folder, and choose it."""
    folder = presets.user_folder()
    try:
        kept = keep(folder) if folder else None
    except (PresetError, OSError) as error:
        operator.report({"ERROR"}, str(error))
        return {"CANCELLED"}
    if kept is None:
        return {"CANCELLED"}
    context.scene.vgroove.preset = kept.id
    operator.report({"INFO"}, f"{kept.name} is kept in {folder}")
    return {"FINISHED"}


def _poll_folder(operator: type[bpy.types.Operator]) -> bool:
    if presets.user_folder() is None:
        operator.poll_message_set("Needs a folder of your own: install the extension, or set VGROOVE_PRESETS")
        return False
    return True


def _poll_ours(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
    if ours(context) is None:
        operator.poll_message_set("Select an object whose active material came from this panel")
        return False
    return True


def ours(context: bpy.types.Context) -> bpy.types.Material | None:
    """The active object's active material, if it came from a preset and can be edited."""
    item = context.object
    made = item.active_material if item else None
    return made if made and material.KEY in made and made.library is None else None


def citation(preset: presets.Preset) -> str:
    """One line: what it is, and where its numbers come from."""
    licence = f" ({preset.source['licence']})" if "licence" in preset.source else ""
    return f"{preset.name} [{preset.id}]: {preset.source['data']}{licence}."


def chosen_estimator(shown: bpy.types.Scene | SceneFacts) -> str:
    """The panel's estimator, with ``auto`` decided."""
    return chosen(shown).estimator


def chosen(shown: bpy.types.Scene | SceneFacts) -> automatic.Pick:
    """The panel's estimator and why it is taken, where the panel did not ask for it or the model lacks it."""
    known = facts.of(shown)
    settings = known.scene.vgroove
    preset = chosen_preset(settings)
    if settings.estimator in material.BUILDERS[preset.model]:
        return automatic.Pick(settings.estimator, "")
    picked = automatic.pick(known, preset)
    if settings.estimator == "auto":
        return picked
    wanted = advice.name_of(settings.estimator)
    return automatic.Pick(picked.estimator, f"{preset.name} has no {wanted} and gets Standard: {picked.why}")


def current_problems(shown: bpy.types.Scene | SceneFacts) -> list[advice.Problem]:
    """What is wrong with the scene for the panel's choices."""
    known = facts.of(shown)
    settings = known.scene.vgroove
    return advice.problems_with(known, chosen_preset(settings), settings.backend, chosen_estimator(known))


CLASSES = (
    VGROOVE_OT_apply,
    VGROOVE_OT_mend,
    VGROOVE_OT_favourite,
    VGROOVE_OT_copy_citation,
    VGROOVE_OT_reset,
    VGROOVE_OT_save_preset,
    VGROOVE_OT_import_preset,
    VGROOVE_OT_export_preset,
)
