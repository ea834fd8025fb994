# SPDX-License-Identifier: GPL-3.0-or-later
"""The BRDF Viewer's lobes, drawn in every 3D viewport; in none of a Blender without a window, and in no render.

The handler runs at each redraw. It reads the material and where the light is, which takes a fraction of a millisecond;
the lobe's inputs are compared, and only what changed is evaluated and uploaded again.
"""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

import bpy
import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader

from ..blender import lobes, material
from ..reference import lobe
from . import viewer, viewer_measure, viewer_plots

if TYPE_CHECKING:
    from collections.abc import Callable

    from mathutils import Matrix

    from ..reference.directions import Floats
    from ..reference.lobe import Lobe

COLORS = ((0.12, 0.45, 0.85), (0.9, 0.42, 0.08))  # of the active material and of the one to compare with
GOLD, GREY, WHITE = (0.95, 0.72, 0.1, 1.0), (0.75, 0.75, 0.75, 1.0), (1.0, 1.0, 1.0, 0.35)
TOWARD = np.array([0.35, 0.3, 0.89])  # from where a lobe is shaded, in its own frame
LINE = 1.5  # pixels
MARGIN, SOLID = 12.0, 0.88  # of the plots: pixels to the edge, and how much they hide
MOST_KEPT = 16  # meshes on the GPU

_handles: list[Any] = []
_meshes: OrderedDict[tuple[Any, ...], tuple[Lobe, Any]] = OrderedDict()


def draw() -> None:
    """Called at each redraw of a viewport, in the scene's space. The panel says what cannot be drawn."""
    context = bpy.context
    settings = context.scene.vgroove_viewer
    at, wi = _light(context)
    found = shown(context, wi) if wi is not None else []
    if at is None or wi is None or not found:
        return
    gpu.state.depth_test_set("LESS_EQUAL")
    gpu.state.depth_mask_set(True)  # noqa: FBT003 (Blender takes no name)
    gpu.state.blend_set("ALPHA")
    try:
        with gpu.matrix.push_pop():
            gpu.matrix.multiply_matrix(at)
            gpu.matrix.scale_uniform(settings.size)
            peak = peak_of([one for one, _ in found], settings)
            shader = gpu.shader.from_builtin("SMOOTH_COLOR")
            for one, color in found:
                _mesh(one, settings, peak, color, shader).draw(shader)
            _lines(context, at, wi)
    finally:
        gpu.state.depth_test_set("NONE")
        gpu.state.depth_mask_set(False)  # noqa: FBT003
        gpu.state.blend_set("NONE")


def draw_plots() -> None:
    """The same, as plots in the viewport's corner, in the colors of the theme's menus."""
    context = bpy.context
    _, wi = _light(context)
    menu = context.preferences.themes[0].user_interface.wcol_menu_back
    found = plots(context, wi, (*menu.text, 1.0)) if wi is not None else []
    if not found:
        return
    tools = next((one for one in context.area.regions if one.type == "TOOLS"), None)
    scale = context.preferences.system.ui_scale
    left = (tools.width if tools else 0.0) + MARGIN * scale
    viewer_plots.draw(found, scale, (left, MARGIN * scale), (*menu.inner[:3], SOLID))


def plots(context: bpy.types.Context, wi: Floats, ink: tuple[float, ...]) -> list[viewer_plots.Plot]:
    """Those that were asked for, of the lobes that are shown and of what was measured."""
    settings = context.scene.vgroove_viewer
    theta_i = float(np.degrees(np.arctan2(np.hypot(wi[0], wi[1]), wi[2])))
    unit = f"{settings.term} in 1/sr" if settings.term in (lobes.BRDF, "D") else settings.term
    if settings.term == lobes.BRDF and settings.times != "one":
        unit = {"cos_o": "f cos θo", "cos_io": "f cos θi cos θo"}[settings.times] + " in 1/sr"
    found = []
    for plot in (name for name, *_ in viewer_plots.ITEMS if name in settings.plots):
        curves = plot_curves(context, plot, wi)
        if curves:
            found.append(viewer_plots.plotted(plot, curves, theta_i, _channel(settings), ink, unit, log=settings.log))
    return found


def plot_curves(context: bpy.types.Context, plot: str, wi: Floats) -> list[viewer_plots.Curve]:
    """Curves of materials of ours, then what was measured of any under this light."""
    settings = context.scene.vgroove_viewer

    def numbers(of: bpy.types.Material, wi: Floats, times: str, term: str, uvs: Any) -> Any:
        found = lobes.curve_of(of, wi, plot, times, term, uvs)
        return found and (of.name, found)

    curves = [
        viewer_plots.Curve(name, one.at[:, 0], one.rgb[""], color) for (name, one), color in shown(context, wi, numbers)
    ]
    if settings.term != lobes.BRDF:
        return curves
    for one, color in zip(viewer.candidates(context), COLORS, strict=False):
        points = viewer_measure.points_of(one, wi, plot)
        if points is not None:
            rgb = points.weighted(settings.times)
            curves.append(viewer_plots.Curve(one.name, points.at, rgb, color, measured=True))
    return curves


def _light(context: bpy.types.Context) -> tuple[Matrix | None, Floats | None]:
    """Where the lobe stands, and to the light; None where nothing is to be drawn."""
    if not context.scene.vgroove_viewer.show or not context.space_data.overlay.show_overlays:
        return None, None
    at = viewer.frame(context.scene)
    wi = viewer.toward_light(context.scene, context.region_data, at)
    return at, wi if wi is not None and wi[2] > 0.0 else None


def shown(
    context: bpy.types.Context, wi: Floats, what: Callable[..., Any] = lobes.of_material
) -> list[tuple[Any, tuple[float, float, float]]]:
    """What to draw of each material, lobes or curves, with its color; nothing of what cannot be read or is not ours."""
    settings = context.scene.vgroove_viewer
    times = settings.times if settings.term == lobes.BRDF else "one"
    candidates = zip(viewer.candidates(context), COLORS, strict=False)
    ours = [(one, color) for one, color in candidates if material.is_ours(one)]
    try:
        found = [(what(one, wi, times, settings.term, viewer.uvs_of(context.scene, one)), color) for one, color in ours]
    except ValueError:  # numbers that do not go together, too
        return []
    return [(one, color) for one, color in found if one is not None]


def peak_of(found: list[Lobe], settings: viewer.VGrooveViewer) -> float:
    """The value that is as large as Size: 1, or the largest of all lobes."""
    return 1.0 if settings.absolute else max(float(np.max(one.values(_channel(settings)))) for one in found)


def _channel(settings: viewer.VGrooveViewer) -> str:
    return "luminance" if settings.channel == "color" else settings.channel


def surface(one: Lobe, settings: viewer.VGrooveViewer, peak: float, color: tuple[float, ...]) -> tuple[Floats, Floats]:
    """Vertices (rings, around, 3) in the local frame, and their shaded colors in linear Rec.709, RGBA."""
    vertices = one.vertices(_channel(settings), peak, log=settings.log)
    base = one.colors() if settings.channel == "color" else np.broadcast_to(color, vertices.shape)
    shade = 0.55 + 0.45 * np.clip(lobe.normals(vertices) @ TOWARD, -0.6, 1.0)
    return vertices, np.concatenate([base * shade[..., None], np.ones((*vertices.shape[:2], 1))], axis=-1)


def _mesh(one: Lobe, settings: viewer.VGrooveViewer, peak: float, color: tuple[float, ...], shader: Any) -> Any:
    """On the GPU; the same lobe, drawn in the same way, is uploaded once."""
    key = (id(one), settings.channel, settings.log, peak, color)
    if key not in _meshes:
        vertices, colors = (array.reshape(-1, array.shape[-1]) for array in surface(one, settings, peak, color))
        content = {"pos": vertices.astype(np.float32), "color": colors.astype(np.float32)}
        batch = batch_for_shader(shader, "TRIS", content, indices=lobe.triangles(*one.wo.shape[:2]))
        _meshes[key] = one, batch  # which keeps the lobe, so that no other gets its id
        while len(_meshes) > MOST_KEPT:
            _meshes.popitem(last=False)
    _meshes.move_to_end(key)
    return _meshes[key][1]


def _lines(context: bpy.types.Context, at: Matrix, wi: Floats) -> None:
    """The surface's circle, its normal, the light, and the directions that were asked for."""
    settings = context.scene.vgroove_viewer
    turn = np.linspace(0.0, 2.0 * np.pi, 97)
    circle = np.stack([np.cos(turn), np.sin(turn), 0.0 * turn], axis=-1)
    drawn = [(circle, WHITE), (_ray((0.0, 0.0, 1.0)), WHITE), (_ray(1.15 * wi), GOLD)]
    if settings.mirror:
        drawn.append((_ray(1.15 * wi * [-1.0, -1.0, 1.0]), GREY))
    if settings.half:
        wo = lobes.local(viewer.toward_eye(context.region_data, at.translation), at)
        both = wi + wo
        length = float(np.linalg.norm(both))
        if length > 1e-6:
            drawn.append((_ray(1.15 * both / length), (*COLORS[1], 1.0)))
    shader = gpu.shader.from_builtin("POLYLINE_UNIFORM_COLOR")
    shader.uniform_float("viewportSize", gpu.state.viewport_get()[2:])
    shader.uniform_float("lineWidth", LINE * context.preferences.system.ui_scale)
    for points, color in drawn:
        shader.uniform_float("color", color)
        batch_for_shader(shader, "LINE_STRIP", {"pos": points.astype(np.float32)}).draw(shader)


def _ray(to: Any) -> Floats:
    return np.array([[0.0, 0.0, 0.0], to], dtype=np.float64)


@bpy.app.handlers.persistent
def changed(scene: bpy.types.Scene, *_: object) -> None:
    """After each evaluation: a viewport in Solid mode would not draw again for a change of a material."""
    if scene.vgroove_viewer.show:
        viewer.redraw()


def register(*, background: bool | None = None) -> None:
    """Draw from now on; nothing where Blender has no window."""
    if bpy.app.background if background is None else background:
        return
    for function, when in ((draw, "POST_VIEW"), (draw_plots, "POST_PIXEL")):
        _handles.append(bpy.types.SpaceView3D.draw_handler_add(function, (), "WINDOW", when))
    bpy.app.handlers.depsgraph_update_post.append(changed)


def unregister() -> None:
    while _handles:
        bpy.types.SpaceView3D.draw_handler_remove(_handles.pop(), "WINDOW")
    if changed in bpy.app.handlers.depsgraph_update_post:
        bpy.app.handlers.depsgraph_update_post.remove(changed)
    _meshes.clear()
    lobes.forget()
