# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer: where the light goes, drawn as a lobe over the scene. Its settings and tools."""

from __future__ import annotations

from math import pi, radians
from typing import TYPE_CHECKING, Any

import bpy
from bpy_extras.view3d_utils import region_2d_to_origin_3d, region_2d_to_vector_3d
from mathutils import Matrix, Vector

from ..blender import lobes, material, texel
from ..reference import lobe, spherical
from . import viewer_plots

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
    picked: bpy.props.PointerProperty(
        name="Picked Material", description="The material of the face that was clicked", type=bpy.types.Material,
        options=set(), update=redraw,
    )  # fmt: skip
    picked_uvs: bpy.props.StringProperty(
        name="Picked UVs", description="Where the clicked point is in each UV map", options=set(), update=redraw
    )
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
    plots: bpy.props.EnumProperty(
        name="Plots", description="Curves in the viewport's corner, with their peaks; Shift for several",
        items=viewer_plots.ITEMS, default={viewer_plots.PLANE}, options={"ENUM_FLAG"}, update=redraw,
    )  # fmt: skip


def candidates(context: bpy.types.Context) -> list[bpy.types.Material]:
    """The material shown, whatever its nodes are, and the one to compare with; each once.

    That is the one of the face that was clicked, or else the active one.
    """
    settings, item = context.scene.vgroove_viewer, context.object
    active = item.active_material if item else None
    picked = settings.picked if settings.place == "POINT" else None
    chosen = [picked or active, settings.other]
    return list(dict.fromkeys(one for one in chosen if one))


def uvs_of(scene: bpy.types.Scene, of: bpy.types.Material) -> dict[str, tuple[float, float]] | None:
    """Where the clicked point is in each UV map, of the material there; None of any other."""
    settings = scene.vgroove_viewer
    return texel.loads(settings.picked_uvs) if settings.place == "POINT" and settings.picked == of else None


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


class _InViewport:
    """A tool that follows the mouse in a 3D viewport. It ends with a click, or with Esc, which changes nothing."""

    bl_options = {"REGISTER", "UNDO"}
    cursor = "CROSSHAIR"
    hint = ""
    if TYPE_CHECKING:
        report: Any
        poll_message_set: Any

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        if context.area is None or context.area.type != "VIEW_3D":
            cls.poll_message_set("Works in the 3D viewport")
            return False
        return True

    def invoke(self, context: bpy.types.Context, _event: bpy.types.Event) -> set[str]:
        context.window.cursor_modal_set(self.cursor)
        context.workspace.status_text_set(f"{self.hint}    Esc: Cancel")
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    @staticmethod
    def ray(context: bpy.types.Context, event: bpy.types.Event) -> tuple[Vector, Vector] | None:
        """Start and direction of the ray below the mouse, in world; None beside the viewport."""
        region = next(one for one in context.area.regions if one.type == "WINDOW")
        data, place = context.area.spaces.active.region_3d, (event.mouse_x - region.x, event.mouse_y - region.y)
        if not (0 <= place[0] < region.width and 0 <= place[1] < region.height):
            return None
        return region_2d_to_origin_3d(region, data, place), region_2d_to_vector_3d(region, data, place)

    @staticmethod
    def end(context: bpy.types.Context, how: set[str]) -> set[str]:
        context.window.cursor_modal_restore()
        context.workspace.status_text_set(None)
        redraw()
        return how


class VGROOVE_OT_pick_point(_InViewport, bpy.types.Operator):
    """Click a surface to see the lobe there."""

    bl_idname = "vgroove.pick_point"
    bl_label = "Pick Point"
    bl_description = (
        "Click a surface, and the lobe of its material stands there along its normal, with its textures there. "
        "Esc cancels"
    )
    cursor = "EYEDROPPER"
    hint = "Click a surface"

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self.end(context, {"CANCELLED"})
        if event.type != "LEFTMOUSE" or event.value != "PRESS":
            return {"RUNNING_MODAL" if event.type == "MOUSEMOVE" else "PASS_THROUGH"}
        ray = self.ray(context, event)
        found = ray and texel.surface_at(context.scene, context.evaluated_depsgraph_get(), *ray)
        if not found:
            self.report({"WARNING"}, "There is no surface. Click one, or press Esc")
            return {"RUNNING_MODAL"}
        stand_at(context.scene, found)
        return self.end(context, {"FINISHED"})


class VGROOVE_OT_aim_light(_InViewport, bpy.types.Operator):
    """Move the light's direction with the mouse."""

    bl_idname = "vgroove.aim_light"
    bl_label = "Aim Light"
    bl_description = "Move the mouse over the lobe's hemisphere, and the light comes from there. Click to confirm"
    hint = "Move: Aim    Click: Confirm"

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        settings = context.scene.vgroove_viewer
        self.before = settings.light_from, settings.theta, settings.phi
        return super().invoke(context, event)

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        settings = context.scene.vgroove_viewer
        if event.type in {"ESC", "RIGHTMOUSE"}:
            settings.light_from, settings.theta, settings.phi = self.before
            return self.end(context, {"CANCELLED"})
        if event.type in {"LEFTMOUSE", "RET"} and event.value == "PRESS":
            return self.end(context, {"FINISHED"})
        if event.type != "MOUSEMOVE":
            return {"PASS_THROUGH"}
        ray = self.ray(context, event)
        if ray:
            settings.light_from, settings.show = "ANGLES", True
            settings.theta, settings.phi = lobes.aimed(frame(context.scene), settings.size, *ray)
        return {"RUNNING_MODAL"}


def stand_at(scene: bpy.types.Scene, hit: texel.Hit) -> None:
    """Show the lobe at a point of a surface, of the material there."""
    settings = scene.vgroove_viewer
    texel.forget()
    settings.place, settings.point, settings.normal, settings.show = "POINT", hit.point, hit.normal, True
    settings.picked, settings.picked_uvs = hit.material, texel.dumps(hit.uvs)


assert [name for name, *_ in TIMES] == list(lobe.TIMES)  # noqa: S101
CLASSES = (VGrooveViewer, VGROOVE_OT_pick_point, VGROOVE_OT_aim_light)
