# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer: where the light goes, drawn as a lobe over the scene. Its settings, panel and picker."""

from __future__ import annotations

from math import pi, radians
from typing import Any

import bpy
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from mathutils import Matrix, Vector

from ..blender import lobes, material
from ..library.errors import InputError
from ..reference import lobe, spherical
from .panels import InSidebar
from .text import lines

PLACES = (
    ("CURSOR", "3D Cursor", "At the 3D cursor, whose Z axis is the normal and X axis the tangent", 0),
    ("POINT", "Surface", "On the surface that was clicked last", 1),
)
LIGHTS = (
    ("LIGHT", "Light", "From a light of the scene", 0),
    ("VIEW", "View", "From where you look", 1),
    ("ANGLES", "Angles", "From a direction given by two angles", 2),
)
TERMS = (
    (lobes.BRDF, "f", "The whole BRDF, in 1/sr", 0),
    ("D", "D", "Distribution of the facets alone, in 1/sr", 1),
    ("G", "G", "Shadowing and masking alone: the share of facets that are both lit and seen", 2),
    ("F", "F", "Fresnel reflectance of the facets alone", 3),
)
TIMES = (
    ("one", "1", "f itself, in 1/sr", 0),
    ("cos_o", "cos θo", "f times the cosine of the outgoing angle: reflected power per solid angle", 1),
    ("cos_io", "cos θi cos θo", "f times the cosines of both angles: of facets, D, G and F are left", 2),
)
CHANNELS = (
    ("luminance", "Luminance", "Luminance of linear Rec.709, in the viewer's own color", 0),
    ("red", "Red", "The red channel", 1),
    ("green", "Green", "The green channel", 2),
    ("blue", "Blue", "The blue channel", 3),
    ("color", "Color", "As far away as the luminance, in the color of the reflected light", 4),
)


def redraw(_settings: Any = None, _context: Any = None) -> None:
    """Draw every viewport again."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


def _is_ours(_settings: Any, candidate: bpy.types.Material) -> bool:
    return material.is_ours(candidate)


def _is_light(_settings: Any, candidate: bpy.types.Object) -> bool:
    return candidate.type == "LIGHT"


class VGrooveViewer(bpy.types.PropertyGroup):
    """What the BRDF Viewer draws, and where."""

    show: bpy.props.BoolProperty(
        name="BRDF Viewer",
        description="Draw the lobe of the active material over the scene. Not in renders",
        default=False, options=set(), update=redraw,
    )  # fmt: skip
    place: bpy.props.EnumProperty(
        name="Place", description="Where the lobe stands", items=PLACES, options=set(), update=redraw
    )
    point: bpy.props.FloatVectorProperty(
        name="Point", description="Where the lobe stands, in world space", size=3, subtype="TRANSLATION",
        options=set(), update=redraw,
    )  # fmt: skip
    normal: bpy.props.FloatVectorProperty(
        name="Normal", description="The surface's normal there, in world space", size=3, default=(0.0, 0.0, 1.0),
        subtype="DIRECTION", options=set(), update=redraw,
    )  # fmt: skip
    light_from: bpy.props.EnumProperty(
        name="Light From", description="Where the light comes from", items=LIGHTS, options=set(), update=redraw
    )
    lamp: bpy.props.PointerProperty(
        name="Light", description="The light; if empty, the first one in the scene by name", type=bpy.types.Object,
        poll=_is_light, options=set(), update=redraw,
    )  # fmt: skip
    theta: bpy.props.FloatProperty(
        name="Angle", description="Between the light and the normal, 0 to 89.9 degrees", subtype="ANGLE",
        default=pi / 4, min=0.0, max=radians(89.9), options=set(), update=redraw,
    )  # fmt: skip
    phi: bpy.props.FloatProperty(
        name="Azimuth", description="Of the light around the normal, from the tangent, -180 to 180 degrees",
        subtype="ANGLE", default=0.0, min=-pi, max=pi, options=set(), update=redraw,
    )  # fmt: skip
    other: bpy.props.PointerProperty(
        name="Compare With", description="A second V-Groove material, drawn in another color", type=bpy.types.Material,
        poll=_is_ours, options=set(), update=redraw,
    )  # fmt: skip
    term: bpy.props.EnumProperty(
        name="Term", description="The whole BRDF, or one factor of a model with facets", items=TERMS, options=set(),
        update=redraw,
    )  # fmt: skip
    times: bpy.props.EnumProperty(
        name="Times", description="What f is multiplied by", items=TIMES, options=set(), update=redraw
    )
    channel: bpy.props.EnumProperty(
        name="Channel", description="What the distance to the surface shows", items=CHANNELS, options=set(),
        update=redraw,
    )  # fmt: skip
    log: bpy.props.BoolProperty(
        name="Logarithmic", description="Show four decades below the largest value instead of a linear scale",
        default=False, options=set(), update=redraw,
    )  # fmt: skip
    absolute: bpy.props.BoolProperty(
        name="Absolute",
        description="A value of 1 is as large as Size; otherwise the largest value of all lobes is",
        default=False, options=set(), update=redraw,
    )  # fmt: skip
    size: bpy.props.FloatProperty(
        name="Size", description="Length of the largest value, or of a value of 1 if Absolute", subtype="DISTANCE",
        default=1.0, min=1e-3, max=1e4, soft_max=100.0, options=set(), update=redraw,
    )  # fmt: skip
    mirror: bpy.props.BoolProperty(
        name="Mirror Direction", description="Draw the direction in which a smooth mirror would reflect the light",
        default=True, options=set(), update=redraw,
    )  # fmt: skip
    half: bpy.props.BoolProperty(
        name="Half Vector", description="Draw the direction halfway between the light and the view: the normal of the "
        "facets that mirror the light toward you",
        default=False, options=set(), update=redraw,
    )  # fmt: skip
    slice: bpy.props.BoolProperty(
        name="Slice", description="Draw the slice through the plane of incidence in the viewport's corner, with its "
        "values and the angle of its peak",
        default=True, options=set(), update=redraw,
    )  # fmt: skip


def materials(context: bpy.types.Context) -> list[bpy.types.Material]:
    """The active material and the one to compare with, as far as they are ours; each once."""
    item = context.object
    chosen = [item.active_material if item else None, context.scene.vgroove_viewer.other]
    return list(dict.fromkeys(one for one in chosen if one and material.is_ours(one)))


def frame(scene: bpy.types.Scene) -> Matrix:
    """The local frame in which the lobe stands."""
    settings = scene.vgroove_viewer
    if settings.place == "POINT":
        return lobes.frame(settings.point, settings.normal)
    cursor = scene.cursor.matrix
    return lobes.frame(cursor.translation, cursor.col[2].to_3d(), cursor.col[0].to_3d())


def light_of(scene: bpy.types.Scene) -> bpy.types.Object | None:
    """The chosen light, or the first of the scene."""
    chosen = scene.vgroove_viewer.lamp
    if chosen is not None and chosen.name in scene.objects:
        return chosen
    return min((one for one in scene.objects if one.type == "LIGHT"), key=lambda one: one.name, default=None)


def toward_eye(region: bpy.types.RegionView3D, point: Vector) -> Vector:
    """To the viewer from a point, in world."""
    back = region.view_matrix.inverted()
    return (back.translation - point if region.is_perspective else back.col[2].to_3d()).normalized()


def toward_light(scene: bpy.types.Scene, region: bpy.types.RegionView3D | None, at: Matrix) -> Any:
    """To the light in the local frame, (3,); None without one."""
    settings = scene.vgroove_viewer
    if settings.light_from == "ANGLES":
        return spherical(settings.theta, settings.phi)
    if settings.light_from == "VIEW":
        return lobes.local(toward_eye(region, at.translation), at) if region else None
    lamp = light_of(scene)
    return lobes.local(lobes.toward(lamp, at.translation), at) if lamp else None


def problem(context: bpy.types.Context) -> str:
    """Why nothing is drawn, and what to do; "" if a lobe is."""
    settings, found = context.scene.vgroove_viewer, materials(context)
    if not found:
        return "Apply a preset to the active object to see its lobe"
    if settings.term != lobes.BRDF and not any(lobes.has_term(one, settings.term) for one in found):
        return f"This model has no facets, so no {settings.term}. Choose f"
    at = frame(context.scene)
    wi = toward_light(context.scene, getattr(context, "region_data", None), at)
    if wi is None:
        return "Add a light, or let the light come from View or Angles" if settings.light_from == "LIGHT" else ""
    if wi[2] <= 0.0:
        return "The light is below the surface here. Turn the 3D cursor, or pick a point on a surface that is lit"
    return ""


class VGROOVE_OT_pick_point(bpy.types.Operator):
    """Click a surface to see the lobe there."""

    bl_idname = "vgroove.pick_point"
    bl_label = "Pick Point"
    bl_description = "Click a surface, and the lobe stands there along its normal. Esc cancels"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.area is None or context.area.type != "VIEW_3D":
            cls.poll_message_set("Works in the 3D viewport")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        context.window.cursor_modal_set("EYEDROPPER")
        context.workspace.status_text_set("Click a surface    Esc: Cancel")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self._end(context, {"CANCELLED"})
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"RUNNING_MODAL" if event.type == "MOUSEMOVE" else "PASS_THROUGH"}
        found = self._below(context, event)
        if found is None:
            self.report({"WARNING"}, "There is no surface. Click one, or press Esc")
            return {"RUNNING_MODAL"}
        stand_at(context.scene, *found)
        return self._end(context, {"FINISHED"})

    @staticmethod
    def _below(context: bpy.types.Context, event: bpy.types.Event) -> tuple[Vector, Vector] | None:
        region = next(one for one in context.area.regions if one.type == "WINDOW")
        data, place = context.area.spaces.active.region_3d, (event.mouse_x - region.x, event.mouse_y - region.y)
        if not (0 <= place[0] < region.width and 0 <= place[1] < region.height):
            return None
        start = region_2d_to_origin_3d(region, data, place)
        along = region_2d_to_vector_3d(region, data, place)
        return lobes.surface_at(context.scene, context.evaluated_depsgraph_get(), start, along)

    @staticmethod
    def _end(context: bpy.types.Context, how: set[str]) -> set[str]:
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        redraw()
        return how


def stand_at(scene: bpy.types.Scene, point: Vector, normal: Vector) -> None:
    """Show the lobe at a point of a surface."""
    settings = scene.vgroove_viewer
    settings.place, settings.point, settings.normal, settings.show = "POINT", point, normal, True


class VGROOVE_PT_viewer(InSidebar, bpy.types.Panel):
    bl_label = "BRDF Viewer"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: bpy.types.Context) -> None:
        self.layout.prop(context.scene.vgroove_viewer, "show", text="")

    def draw(self, context: bpy.types.Context) -> None:
        settings, layout = context.scene.vgroove_viewer, self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        layout.active = settings.show
        try:
            text = problem(context)
        except InputError as error:
            text = str(error)
        if text:
            lines(layout, text, context.region.width, icon="INFO")
        column = layout.column()
        column.row().prop(settings, "place", expand=True)
        column.operator("vgroove.pick_point", icon="EYEDROPPER")
        column = layout.column()
        column.row().prop(settings, "light_from", expand=True)
        if settings.light_from == "LIGHT":
            column.prop(settings, "lamp")
        elif settings.light_from == "ANGLES":
            column.prop(settings, "theta")
            column.prop(settings, "phi")
        column = layout.column()
        column.row().prop(settings, "term", expand=True)
        row = column.row()
        row.enabled = settings.term == lobes.BRDF
        row.prop(settings, "times")
        column.prop(settings, "channel")
        column.prop(settings, "log")
        column.prop(settings, "absolute")
        column.prop(settings, "size")
        column.prop(settings, "mirror")
        column.prop(settings, "half")
        column.prop(settings, "slice")
        layout.column().prop(settings, "other")


assert [name for name, *_ in TIMES] == list(lobe.TIMES)  # noqa: S101
CLASSES = (VGrooveViewer, VGROOVE_OT_pick_point, VGROOVE_PT_viewer)
