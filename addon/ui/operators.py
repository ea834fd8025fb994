# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply a preset to the selected objects, mend the scene, and keep presets. What changes the file is one undo step."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
from bpy_extras.io_utils import ExportHelper, ImportHelper

from ..blender import facts, material, slots
from ..blender.rebuild import AS_IT_IS, rebuild, reset
from ..choose import advice, automatic
from ..library import presets
from ..library import writing as preset_files
from ..library.errors import InputError
from ..library.files import replacing
from . import course, memory, watch
from .properties import chosen_preset

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..blender.facts import SceneFacts

FILE_PATH = bpy.props.StringProperty(
    name="File Path", description="The preset's file", subtype="FILE_PATH", options={"PATH_SUPPORTS_BLEND_RELATIVE"}
)


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
        settings, in_parts = context.scene.vgroove, slots.in_parts(context)
        refused = [text for item in context.selected_objects if (text := slots.refusal(item))]
        able = [item for item in context.selected_objects if not slots.refusal(item)]
        if not able:
            self.report({"ERROR"}, _in_one_line(refused))
            return {"CANCELLED"}
        if in_parts and not slots.parts_selected(context):
            self.report({"ERROR"}, "No face is selected; select those that should get the material, or leave Edit Mode")
            return {"CANCELLED"}
        try:
            preset, backend, estimator = chosen_preset(settings), settings.backend, chosen_estimator(context.scene)
            bound = settings.bound / 100.0
            play = course.play_of(context.scene) if preset.time and context.scene.vgroove_course.play else None
            same = {} if in_parts else {item: item.active_material for item in able if _is_of(item, preset)}
            lost = []
            for made in dict.fromkeys(same.values()):
                lost += rebuild(
                    made, context.scene, backend=backend, estimator=estimator, bound=bound,
                    play=play if preset.time else AS_IT_IS,
                )  # fmt: skip
            others = [item for item in able if item not in same]
            if others:
                lamps = material.lamps_to_bind(context.scene, estimator, preset.model)
                new = material.build(preset, material.Choice(backend, estimator, lamps, bound=bound, play=play))
                if in_parts:
                    slots.give_to_parts(new, context)
                else:
                    slots.apply(new, others)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        memory.used(preset.id)
        count = f"{len(able)} object{'s' * (len(able) > 1)}"
        text = f"{preset.name} ({estimator}, {backend}) given to {'what is selected in ' * in_parts}{count}"
        if also := [item.name for item in slots.sharing(able) if item not in able]:
            text += f", and to {', '.join(also)}, which share{'s' * (len(also) == 1)} their mesh"
        left = [
            slots.refusal(item) for item in context.selected_objects if item.type in slots.TYPES and item not in able
        ]
        self.report({"WARNING"} if left or lost else {"INFO"}, ". ".join([text, *lost, *left[:1]]))
        return {"FINISHED"}


def _is_of(item: bpy.types.Object, preset: presets.Preset) -> bool:
    """Whether an object's active material was built from just this preset and can be changed in place."""
    made = item.active_material
    if made is None or not material.is_ours(made) or material.locked(made):
        return False
    known = material.preset_of(made)
    wanted = {"id", "name", "model", "kind", "coupled", "parameters"}
    return all(getattr(known, name) == getattr(preset, name) for name in wanted)


def _in_one_line(texts: list[str]) -> str:
    """The first reason, and how many more there are."""
    more = f" (and {len(texts) - 1} more)" if len(texts) > 1 else ""
    return f"{texts[0]}{more}" if texts else "Nothing is selected"


class VGROOVE_OT_update(bpy.types.Operator):
    """Rebuild the materials of the selected objects in place, by the estimator above and for the scene's lights."""

    bl_idname = "vgroove.update"
    bl_label = "Update"
    bl_description = (
        "Rebuild the materials of the selected objects in place, by the choice above and for the scene's lights. "
        "Values, textures, links and keys stay"
    )
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not course.ours(context):
            cls.poll_message_set("Select objects whose active material came from this panel and can be changed here")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings, chosen, lost = context.scene.vgroove, course.ours(context), []
        try:
            for made in chosen:
                estimator = settings.estimator
                if estimator == "auto":
                    estimator = automatic.pick(context.scene, material.origin_of(made).preset).estimator
                bound = settings.bound / 100.0 if estimator == "hybrid" else None
                said = rebuild(made, context.scene, backend=settings.backend, estimator=estimator, bound=bound)
                lost += [f"{made.name}: {text}" for text in said]
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        names = ", ".join(one.name for one in chosen)
        self.report({"WARNING"} if lost else {"INFO"}, ". ".join([f"Updated: {names}", *lost]))
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
        try:
            for problem in mendable:
                if problem.mend:
                    problem.mend()
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"FINISHED"}  # of what was mended before it
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
        made = ours(context)
        assert made is not None  # noqa: S101 - poll saw to it
        try:
            left = reset(made, context.scene)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if left:
            self.report({"WARNING"}, ". ".join([f"{made.name} has the preset's numbers again", *left]))
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
        self.name = f"My {material.preset_of(ours(context)).name}"[:60]
        return context.window_manager.invoke_props_dialog(self)

    def execute(self, context: bpy.types.Context) -> set[str]:
        made = ours(context)
        try:
            preset = material.to_preset(made)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        source = dict(preset.source)
        if material.is_edited(made):
            source |= {"data": f"edited from {preset.id}, whose source is: {source['data']}"}
        kept = replace(preset, name=self.name, source=source)
        return _keep(self, context, lambda folder: preset_files.save(kept, folder))


class VGROOVE_OT_import_preset(bpy.types.Operator, ImportHelper):
    """Copy a preset's file into one's own folder."""

    bl_idname = "vgroove.import_preset"
    bl_label = "Import Preset"
    bl_description = "Copy a preset's file into your own folder; it is offered at once"
    bl_options = {"REGISTER", "UNDO"}  # of the choice; the file stays

    filename_ext = ".toml"
    filepath: FILE_PATH
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        return _poll_folder(cls)

    def execute(self, context: bpy.types.Context) -> set[str]:
        return _keep(self, context, lambda folder: preset_files.take(Path(bpy.path.abspath(self.filepath)), folder))


class VGROOVE_OT_export_preset(bpy.types.Operator, ExportHelper):
    """Write the chosen preset to a file."""

    bl_idname = "vgroove.export_preset"
    bl_label = "Export Preset"
    bl_description = "Write the chosen preset to a file, to send or to change"
    bl_options = {"REGISTER"}

    filename_ext = ".toml"
    filepath: FILE_PATH
    filter_glob: bpy.props.StringProperty(default="*.toml", options={"HIDDEN"})

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        self.filepath = f"{preset_files.file_name(chosen_preset(context.scene.vgroove).name)}.toml"
        return ExportHelper.invoke(self, context, event)

    def execute(self, context: bpy.types.Context) -> set[str]:
        path = Path(bpy.path.abspath(self.filepath))  # "//" is the .blend's folder
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
    except (InputError, OSError) as error:
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
        item = context.object
        made = item.active_material if item else None
        reason = material.locked(made) if made and material.is_ours(made) else ""
        operator.poll_message_set(reason or "Select an object whose active material came from this panel")
        return False
    return True


def ours(context: bpy.types.Context) -> bpy.types.Material | None:
    """The active object's active material, if it came from a preset and can be edited."""
    item = context.object
    made = item.active_material if item else None
    return made if made and material.is_ours(made) and not material.locked(made) else None


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
    VGROOVE_OT_update,
    VGROOVE_OT_mend,
    VGROOVE_OT_favourite,
    VGROOVE_OT_copy_citation,
    VGROOVE_OT_reset,
    VGROOVE_OT_save_preset,
    VGROOVE_OT_import_preset,
    VGROOVE_OT_export_preset,
)
