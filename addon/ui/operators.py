# SPDX-License-Identifier: GPL-3.0-or-later
"""Change materials of the selected objects, fix the scene, cite. Each change of the file is one undo step."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from ..blender import facts, material
from ..blender.rebuild import rebuild, reset
from ..choose import advice, automatic
from ..library import families, presets
from ..library.errors import InputError
from . import course, memory, watch
from .properties import choose_listed, chosen_preset

if TYPE_CHECKING:
    from ..blender.facts import SceneFacts


class VGROOVE_OT_update(bpy.types.Operator):
    """Rebuild the materials of the selected objects in place, with the settings above and the scene's lights."""

    bl_idname = "vgroove.update"
    bl_label = "Update"
    bl_description = (
        "Rebuild the materials of the selected objects in place, with the settings above and the scene's current "
        "lights. Values, textures, links and keys stay"
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
        disperses = settings.disperses if chosen_preset(settings).can_disperse else None  # where the panel asks
        try:
            for made in chosen:
                estimator, now = settings.estimator, material.origin_of(made).preset
                if estimator == "auto":
                    estimator = automatic.pick(context.scene, now).estimator
                bounces = settings.bounces if families.gets_bounces(now) else None
                bound = settings.bound / 100.0 if estimator == "hybrid" else None
                said = rebuild(
                    made, context.scene, backend=settings.backend, estimator=estimator, bound=bound,
                    disperses=disperses, bounces=bounces,
                )  # fmt: skip
                lost += [f"{made.name}: {text}" for text in said]
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        names = ", ".join(one.name for one in chosen)
        self.report({"WARNING"} if lost else {"INFO"}, ". ".join([f"Updated: {names}", *lost]))
        return {"FINISHED"}


class VGROOVE_OT_mend(bpy.types.Operator):
    """Fix a scene setting that would spoil the render."""

    bl_idname = "vgroove.mend"
    bl_label = "Fix"
    bl_description = "Fix this setting"
    bl_options = {"REGISTER", "UNDO"}

    key: bpy.props.StringProperty(
        name="Problem",
        description="Which listed problem to fix; if empty, all fixes without side effects",
        options={"HIDDEN"},
    )

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        found = next((p for p in current_problems(watch.current(context.scene)) if p.key == properties.key), None)
        if found is None:
            return "Fix everything that has no side effects; shows the list first"
        return f"{found.button}. {found.text}" + (f". Side effect: {found.costs}" if found.costs else "")

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        if self.key:
            return self.execute(context)
        return context.window_manager.invoke_props_dialog(self, width=420, title="Fix All", confirm_text="Fix")

    def draw(self, context: bpy.types.Context) -> None:
        found = [p for p in current_problems(watch.current(context.scene)) if p.fix]
        column = self.layout.column(align=True)
        for problem in found:
            if not problem.costs:
                column.label(text=problem.button, icon="CHECKMARK")
        if costly := [p for p in found if p.costs]:
            column.label(text="Not included, use their own buttons:")
            for problem in costly:
                column.label(text=f"{problem.button}. Side effect: {problem.costs}", icon="X")

    def execute(self, context: bpy.types.Context) -> set[str]:
        found = [p for p in current_problems(context.scene) if p.fix]
        fixable = [p for p in found if (p.key == self.key if self.key else not p.costs)]
        try:
            for problem in fixable:
                if problem.fix:
                    problem.fix()
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"FINISHED"}  # the fixes before it stay
        if not fixable:
            left = ": the remaining fixes have side effects; use their buttons" if found else ""
            self.report({"INFO"}, f"Nothing to fix{left}")
        return {"FINISHED"} if fixable else {"CANCELLED"}


class VGROOVE_OT_favourite(bpy.types.Operator):
    """Mark the preset with a star, or remove the star."""

    bl_idname = "vgroove.favourite"
    bl_label = "Favourite"
    bl_description = "Mark the preset with a star, or remove the star"
    bl_options = {"INTERNAL"}  # preferences have no undo

    @classmethod
    def poll(cls, _context: bpy.types.Context) -> bool:
        if memory.preferences() is None:
            cls.poll_message_set("Favourites need the installed extension")
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        settings = context.scene.vgroove
        memory.toggle_favourite(chosen_preset(settings).id)
        choose_listed(settings)  # without its star it is no longer listed among the favourites
        return {"FINISHED"}


class VGROOVE_OT_copy_citation(bpy.types.Operator):
    """Copy the source of this preset's numbers."""

    bl_idname = "vgroove.copy_citation"
    bl_label = "Copy Citation"
    bl_description = "Copy the source of this preset's numbers"
    bl_options = {"INTERNAL"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        context.window_manager.clipboard = citation(chosen_preset(context.scene.vgroove))
        self.report({"INFO"}, "Copied the citation")
        return {"FINISHED"}


class VGROOVE_OT_reset(bpy.types.Operator):
    """Restore the preset's values in the active material."""

    bl_idname = "vgroove.reset"
    bl_label = "Reset to Preset"
    bl_description = "Restore the preset's values"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return poll_ours(cls, context)

    def execute(self, context: bpy.types.Context) -> set[str]:
        made = ours(context)
        assert made is not None  # noqa: S101 - poll saw to it
        try:
            left = reset(made, context.scene)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        if left:
            self.report({"WARNING"}, ". ".join([f"{made.name} was reset", *left]))
        return {"FINISHED"}


def poll_ours(operator: type[bpy.types.Operator], context: bpy.types.Context) -> bool:
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


def in_one_line(texts: list[str]) -> str:
    """The first reason, and how many more there are."""
    more = f" (and {len(texts) - 1} more)" if len(texts) > 1 else ""
    return f"{texts[0]}{more}" if texts else "Nothing is selected"


def citation(preset: presets.Preset) -> str:
    """One line: what it is, and where its numbers come from."""
    licence = f" ({preset.source['licence']})" if "licence" in preset.source else ""
    return f"{preset.name} [{preset.id}]: {preset.source['data']}{licence}."


def chosen_estimator(shown: bpy.types.Scene | SceneFacts) -> str:
    """The panel's estimator, with ``auto`` decided."""
    return pick(shown).estimator


def pick(shown: bpy.types.Scene | SceneFacts) -> automatic.Pick:
    """The panel's estimator; and why another one is used, where the panel says Automatic or the model lacks it."""
    known = facts.of(shown)
    settings = known.scene.vgroove
    preset = chosen_preset(settings)
    if settings.estimator in material.BUILDERS[preset.model]:
        return automatic.Pick(settings.estimator, "")
    picked = automatic.pick(known, preset)
    if settings.estimator == "auto":
        return picked
    wanted = advice.name_of(settings.estimator)
    return automatic.Pick(picked.estimator, f"{preset.name} has no {wanted}; Standard is used: {picked.why}")


_answered: list[Any] = []  # the facts that were last asked of, for which choice, and the problems


def current_problems(shown: bpy.types.Scene | SceneFacts) -> list[advice.Problem]:
    """The scene settings that would spoil the render, for the panel's settings and for the scene's own materials."""
    known = facts.of(shown)
    settings = known.scene.vgroove
    asked = chosen_preset(settings).id, settings.backend, chosen_estimator(known)
    if not _answered or _answered[0] is not known or _answered[1] != asked:  # the same object until the scene changes
        chosen = advice.problems_with(known, chosen_preset(settings), *asked[1:])
        _answered[:] = known, asked, advice.problems_in(known, chosen)
    return _answered[2]


CLASSES = (
    VGROOVE_OT_update,
    VGROOVE_OT_mend,
    VGROOVE_OT_favourite,
    VGROOVE_OT_copy_citation,
    VGROOVE_OT_reset,
)
