# SPDX-License-Identifier: GPL-3.0-or-later
"""Animate materials that change over time: how Apply does it, and the operators on it. Each is one undo step."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import bpy

from ...nodegroups.trajectory import AGE, OFFSET, RATE
from ..blender import course, fcurves, material
from ..library import presets
from ..library import writing as preset_files
from ..library.errors import InputError
from ..models import label
from ..reference.keyframes import TOLERANCE, TOLERANCES
from . import properties
from .text import lines

if TYPE_CHECKING:
    from collections.abc import Iterable

CURVES = (
    "F-curves on the inputs that change, to edit in the Graph Editor; "
    f"the shortest step between keys is {fcurves.CLOSEST:g} frames"
)


def ours(context: bpy.types.Context) -> list[bpy.types.Material]:
    """The active materials of the selected objects that came from a preset and can be edited, each once."""
    found = [item.active_material for item in context.selected_objects if item.active_material]
    return list(dict.fromkeys(one for one in found if material.is_ours(one) and not material.locked(one)))


def moving(context: bpy.types.Context) -> list[bpy.types.Material]:
    """Those of them that are animated, by curves or by Age."""
    return [one for one in ours(context) if material.plays(one)]


class _Course:
    """What the operators share: they work on the materials of the selected objects, and say why if they cannot."""

    bl_options = {"REGISTER", "UNDO"}
    needs = staticmethod(moving)
    wanting = "Select objects whose active material came from this panel and changes over time"
    done = ""
    if TYPE_CHECKING:
        report: Any
        poll_message_set: Any

    def do(self, context: bpy.types.Context, one: bpy.types.Material) -> None:
        """Change one material."""
        raise NotImplementedError

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if not cls.needs(context):
            cls.poll_message_set(cls.wanting)
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        chosen = type(self).needs(context)
        try:
            for one in chosen:
                material.upgrade(one)
                fcurves.make_own(one)
                self.do(context, one)
        except InputError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        context.scene.frame_set(context.scene.frame_current, subframe=context.scene.frame_subframe)  # shows the change
        self.report({"INFO"}, f"{self.done}: {', '.join(one.name for one in chosen)}")
        return {"FINISHED"}


class VGROOVE_OT_course_add(_Course, bpy.types.Operator):
    """Animate the selected objects' materials as their presets say, with the settings above."""

    bl_idname = "vgroove.course_add"
    bl_label = "Add Animation"
    bl_description = "Animate the selected objects' materials"
    wanting = "Select objects whose active material came from a preset that changes over time"
    done = "Animated"

    @staticmethod
    def needs(context: bpy.types.Context) -> list[bpy.types.Material]:
        return [one for one in ours(context) if material.preset_of(one).time]

    def do(self, context: bpy.types.Context, one: bpy.types.Material) -> None:
        material.play(one, play_of(context.scene))


class VGROOVE_OT_course_retime(_Course, bpy.types.Operator):
    """Move and stretch all keys to the start and length above."""

    bl_idname = "vgroove.course_retime"
    bl_label = "Retime"
    bl_description = "Move and stretch the keys of the selected objects' materials to the start and length above"
    done = "Retimed"

    def do(self, context: bpy.types.Context, one: bpy.types.Material) -> None:
        play = play_of(context.scene)
        course.retime(material.curves(one), play.start, play.length)


class VGROOVE_OT_course_reverse(_Course, bpy.types.Operator):
    """Play the animation backwards over the same frames."""

    bl_idname = "vgroove.course_reverse"
    bl_label = "Reverse"
    bl_description = "Play the animation of the selected objects' materials backwards, over the same frames"
    done = "Reversed"

    def do(self, _context: bpy.types.Context, one: bpy.types.Material) -> None:
        course.reverse(material.curves(one))


class VGROOVE_OT_course_bake(_Course, bpy.types.Operator):
    """Turn animations that Age drives into F-curves on the inputs."""

    bl_idname = "vgroove.course_bake"
    bl_label = "Bake to Curves"
    bl_description = "Turn animations that Age drives into F-curves on the inputs, to edit in the Graph Editor"
    wanting = "Select objects whose active material is driven by Age"
    done = "Baked"

    @staticmethod
    def needs(context: bpy.types.Context) -> list[bpy.types.Material]:
        return [one for one in moving(context) if course.trajectory_node(one)]

    def do(self, _context: bpy.types.Context, one: bpy.types.Material) -> None:
        course.bake(one, material.parameter_sockets(one))


class VGROOVE_OT_course_remove(_Course, bpy.types.Operator):
    """Remove the animation; the material keeps the look of the current frame."""

    bl_idname = "vgroove.course_remove"
    bl_label = "Remove Animation"
    bl_description = "Remove the animation; materials keep the look of the current frame"
    done = "Animation removed"

    def do(self, _context: bpy.types.Context, one: bpy.types.Material) -> None:
        material.stop(one)


def _in_seconds(name: str) -> dict[str, Any]:
    """Getter and setter of a number of frames as seconds of the scene's frame rate."""

    def rate(settings: VGrooveCourse) -> float:
        render = settings.id_data.render  # of the scene that the settings belong to
        return float(render.fps / render.fps_base)

    def read(settings: VGrooveCourse) -> float:
        return float(getattr(settings, name) / rate(settings))

    def write(settings: VGrooveCourse, seconds: float) -> None:
        setattr(settings, name, seconds * rate(settings))

    return {"get": read, "set": write}


class VGrooveCourse(bpy.types.PropertyGroup):
    """How Apply animates a preset that changes over time."""

    play: bpy.props.BoolProperty(
        name="Animate",
        description="Apply also animates the material; otherwise it keeps its first state",
        default=True,
    )
    driving: bpy.props.EnumProperty(
        name="Driven by",
        description="What drives the animation",
        items=(
            ("curves", "Curves", CURVES, "FCURVE", 0),
            ("age", "Age", "One keyed Age; textures can drive the Rate and Offset of each point", "TIME", 1),
        ),
        default="curves",
    )
    unit: bpy.props.EnumProperty(
        name="Unit",
        description="Unit of start and length",
        items=(("frames", "Frames", "Frames of the scene", 0), ("seconds", "Seconds", "At the scene's frame rate", 1)),
        default="frames",
    )
    start: bpy.props.FloatProperty(
        name="Start", description="First frame of the change",
        default=1.0, soft_min=0.0, soft_max=1000.0, min=course.FRAMES[0], max=course.FRAMES[1], precision=2,
    )  # fmt: skip
    length: bpy.props.FloatProperty(
        name="Length", description="Duration in frames",
        default=240.0, soft_min=1.0, soft_max=1000.0, min=course.LENGTHS[0], max=course.LENGTHS[1], precision=2,
    )  # fmt: skip
    start_seconds: bpy.props.FloatProperty(
        name="Start", description="Start of the change, in seconds from frame 0", unit="TIME_ABSOLUTE",
        min=-1e5, max=1e5, **_in_seconds("start"),
    )  # fmt: skip
    length_seconds: bpy.props.FloatProperty(
        name="Length", description="Duration in seconds", unit="TIME_ABSOLUTE",
        min=1e-7, max=1e7, **_in_seconds("length"),
    )  # fmt: skip
    tolerance: bpy.props.FloatProperty(
        name="Tolerance",
        description="Largest error of the keys, as a share of the parameter's range; smaller needs more keys",
        default=100.0 * TOLERANCE, min=100.0 * TOLERANCES[0], max=100.0 * TOLERANCES[1], soft_min=0.01,
        subtype="PERCENTAGE", precision=3,
    )  # fmt: skip
    interpolation: bpy.props.EnumProperty(
        name="Between Keys",
        description="Interpolation of the curves; Age is always straight",
        items=(
            ("linear", "Straight", "Straight lines: the same as Age, and as measured", "IPO_LINEAR", 0),
            (
                "shape",
                "Shape",
                "Handles that follow the shape of the change: fewer keys, no overshoot",
                "IPO_BEZIER",
                1,
            ),
        ),
        default="linear",
    )


def play_of(shown: bpy.types.Scene) -> course.Play:
    """The panel's settings."""
    chosen = shown.vgroove_course
    interpolation = chosen.interpolation if chosen.driving == "curves" else "linear"
    return course.Play(chosen.driving, chosen.start, chosen.length, chosen.tolerance / 100.0, interpolation)


@cache
def _key_count(text: str, tolerance: float, interpolation: str) -> int:
    play = course.Play(tolerance=tolerance, interpolation=interpolation)
    preset = presets.parse(text, "counted", "counted")
    found = course.keyframes(preset.trajectory(), play)
    return sum(keys.times.size for keys in found.values())


def key_count(preset: presets.Preset, tolerance: float, interpolation: str) -> int:
    """How many keys a preset's animation needs. Cached by the preset's contents, as a user's file may change."""
    return _key_count(preset_files.dumps(preset), tolerance, interpolation)


class VGROOVE_PT_course(bpy.types.Panel):
    """How the chosen preset changes over time, and the operators on the active material's animation."""

    bl_label = "Change Over Time"
    bl_parent_id = "VGROOVE_PT_material"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "V-Groove"
    bl_order = 1

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return properties.chosen_preset(context.scene.vgroove).time is not None or bool(moving(context))

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.vgroove_course
        layout.use_property_split = True
        layout.use_property_decorate = False
        preset = properties.chosen_preset(context.scene.vgroove)
        if preset.time is not None:
            of = preset.time
            names = ", ".join(label(preset.model, name) for name in of.laws)
            span = "its whole duration" if of.unit == "share" else f"{of.start:g} to {of.end:g} {of.unit}"
            lines(layout, f"{preset.name} ({of.kind}) changes over {span}: {names}", context.region.width)
            layout.prop(settings, "play")
        draw_settings(layout, settings, preset)
        found = moving(context)
        column = layout.column(align=True)
        if preset.time is not None and not found:
            column.operator("vgroove.course_add", icon="ADD")
        row = column.row(align=True)
        row.operator("vgroove.course_retime", icon="TIME")
        row.operator("vgroove.course_reverse", icon="ARROW_LEFTRIGHT")
        row = column.row(align=True)
        row.operator("vgroove.course_bake", icon="FCURVE")
        row.operator("vgroove.course_remove", text="Remove", icon="X")
        draw_clocks(layout, found)


def draw_settings(layout: bpy.types.UILayout, settings: VGrooveCourse, preset: presets.Preset) -> None:
    """Driving, start, length, and tolerance of the keys."""
    column = layout.column()
    column.row().prop(settings, "driving", expand=True)
    column.row().prop(settings, "unit", expand=True)
    suffix = "" if settings.unit == "frames" else "_seconds"
    column.prop(settings, f"start{suffix}")
    column.prop(settings, f"length{suffix}")
    if settings.driving == "curves":
        column.row().prop(settings, "interpolation", expand=True)
    column.prop(settings, "tolerance")
    if preset.time is not None:
        shape = settings.interpolation if settings.driving == "curves" else "linear"
        split = column.split(factor=0.4)
        split.label()
        split.label(text=f"{key_count(preset, round(settings.tolerance / 100.0, 9), shape)} keys")


def draw_clocks(layout: bpy.types.UILayout, found: Iterable[bpy.types.Material]) -> None:
    """Age, Rate and Offset of materials that have them."""
    for one in found:
        node = course.trajectory_node(one)
        if node is None:
            continue
        column = layout.column()
        column.label(text=one.name, icon="MATERIAL")
        for name, socket in zip((AGE, RATE, OFFSET), course.clock(node), strict=True):
            if socket.is_linked:
                column.label(text=f"{name}: from a texture", icon="TEXTURE")
            else:
                column.prop(socket, "default_value", text=name)


CLASSES = (
    VGrooveCourse,
    VGROOVE_OT_course_add,
    VGROOVE_OT_course_retime,
    VGROOVE_OT_course_reverse,
    VGROOVE_OT_course_bake,
    VGROOVE_OT_course_remove,
    VGROOVE_PT_course,
)
