# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday scenes whose idea is a camera or a setting; ``everyday_stage`` says what a maker gets and may return."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import bpy

from ...addon.blender import gonio
from ...addon.blender.images import pixels
from ...nodegroups import versions
from ..scenery import add_node
from . import everyday_stage as stage
from .everyday_stage import Shot, everyday

if TYPE_CHECKING:
    import numpy as np
    from bpy.types import Material, Scene
    from numpy.typing import NDArray


@everyday("orthographic camera", "copper", "plaster")
def orthographic(shown: Scene) -> None:
    shown.camera.data.type, shown.camera.data.ortho_scale = "ORTHO", 2.2
    stage.light(shown, "SUN", 3.0)


@everyday("panoramic camera near the ball")
def panoramic(shown: Scene) -> None:
    shown.camera.data.type = "PANO"
    shown.camera.data.panorama_type = "EQUIRECTANGULAR"
    shown.camera.location = (1.3, -1.3, 0.3)
    stage.look_at(shown.camera)
    stage.map_of(shown, "interior")


@everyday("depth of field", timed=True)
def depth_of_field(shown: Scene) -> None:
    focus = shown.camera.data.dof
    focus.use_dof, focus.focus_distance, focus.aperture_fstop = True, 8.0, 0.2
    stage.light(shown, "SUN", 3.0)


@everyday("motion blur")
def motion_blur(shown: Scene) -> None:
    shown.render.use_motion_blur = True
    item = shown.objects[stage.NAME]
    for frame, place in ((0, -0.5), (2, 0.5)):
        item.location = (place, place, 0.0)
        item.keyframe_insert("location", frame=frame)
    stage.light(shown, "SUN", 3.0)


# --- settings -------------------------------------------------------------------------------------------------------


@everyday("ACEScg as the working space", "copper", "plaster", "conductor", since=(5, 0))
def acescg(shown: Scene) -> None:
    stage.light(shown, "AREA", 300.0, size=2.0)
    stage.sky(shown, 0.2)
    bpy.ops.wm.set_working_color_space(working_space="ACEScg")


@everyday("millimetres: unit scale 0.001 and a ball of 1 mm", "copper", "plaster")
def millimetres(shown: Scene) -> None:
    shown.unit_settings.scale_length = 0.001
    _shrink(shown, 0.001)
    stage.light(shown, "SUN", 3.0)


def _shrink(shown: Scene, by: float) -> None:
    shown.objects[stage.NAME].scale = (by, by, by)
    shown.camera.location *= by
    shown.camera.data.clip_start *= by


@everyday("100 m from the origin", "copper", "plaster")
def far_100m(shown: Scene) -> None:
    _far(shown, 100.0)


@everyday("10 km from the origin", "copper", "plaster")
def far_10km(shown: Scene) -> None:
    _far(shown, 10_000.0)


def _far(shown: Scene, distance: float) -> None:
    stage.light(shown, "POINT", 800.0)
    for item in shown.objects:
        item.location.x += distance


@everyday("shadow catcher under the ball", "copper", "plaster")
def shadow_catcher(shown: Scene) -> Shot:
    stage.floor(shown, 0.8).is_shadow_catcher = True
    shown.render.film_transparent = True
    stage.light(shown, "AREA", 300.0, size=2.0)
    shown.camera.data.lens /= 2.0
    return Shot(everywhere=True)


@everyday("persistent data: a second render, after the light has moved")
def persistent(shown: Scene) -> Shot:
    shown.render.use_persistent_data = True
    lamp = stage.light(shown, "POINT", 800.0, (-3.0, -4.0, 1.0))

    def again(shown: Scene) -> NDArray[np.float32]:
        lamp.location = (-3.0, -4.0, 1.0)
        gonio.rendered(shown)
        lamp.location = (3.0, -3.5, 4.0)
        return gonio.rendered(shown)

    return Shot(render=again)


@everyday("a view layer that overrides all materials")
def view_layer_override(shown: Scene) -> Shot:
    stage.floor(shown)
    stage.light(shown, "AREA", 300.0, size=1.0)

    def override(made: Material) -> None:
        shown.view_layers[0].material_override = made

    return Shot(finish=override)


@everyday("baking: combined")
def bake(shown: Scene) -> Shot:
    stage.light(shown, "SUN", 3.0)
    return _baked(shown, "COMBINED")


@everyday("baking: diffuse colour", "plaster")
def bake_colour(shown: Scene) -> Shot:
    stage.light(shown, "SUN", 3.0)
    return _baked(shown, "DIFFUSE")


def _baked(shown: Scene, kind: str) -> Shot:
    stage.uv_sphere(shown.objects[stage.NAME])
    image = bpy.data.images.new("Baked", stage.SIZE, stage.SIZE, float_buffer=True)

    def target(made: Material) -> None:
        made.node_tree.nodes.active = add_node(made.node_tree, "TexImage", image=image)

    def render(shown: Scene) -> NDArray[np.float32]:
        item = shown.objects[stage.NAME]
        bpy.context.view_layer.objects.active = item
        item.select_set(state=True)
        everything = {"DIRECT", "INDIRECT", "DIFFUSE", "GLOSSY", "TRANSMISSION", "EMIT"}
        passes = {"COLOR"} if kind == "DIFFUSE" else everything
        bpy.ops.object.bake(type=kind, pass_filter=passes, margin=0)
        return pixels(image).copy()

    return Shot(finish=target, render=render, everywhere=True)


@everyday("the pass that a denoiser takes as the surface's colour", "copper", "plaster")
def denoising_albedo(shown: Scene) -> Shot:
    shown.view_layers[0].cycles.denoising_store_passes = True
    stage.light(shown, "SUN", 3.0)
    return Shot(render=partial(stage.render_pass, name="Denoising Albedo"))


@everyday("no caustics, clamped light, no light tree")
def fast_settings(shown: Scene) -> None:
    cycles = shown.cycles
    cycles.caustics_reflective = cycles.caustics_refractive = cycles.use_light_tree = False
    cycles.sample_clamp_direct, cycles.sample_clamp_indirect = 3.0, 1.0
    stage.floor(shown)
    stage.light(shown, "AREA", 300.0, size=1.0)
    stage.light(shown, "POINT", 200.0, (-1.0, -5.0, 1.0))


@everyday("Open Shading Language switched on", "copper", "plaster")
def osl_on(shown: Scene) -> None:
    shown.cycles.shading_system = True
    stage.map_of(shown, "forest")


@everyday("EEVEE", "copper", "plaster", "plastic", slow=True, says=("engine is not Cycles", *stage.SAYS_FRESNEL))
def eevee(shown: Scene) -> None:
    shown.render.engine = versions.EEVEE
    shown.eevee.taa_render_samples = 1  # both materials are seen through the same ones, of which each takes a second
    stage.light(shown, "SUN", 3.0)
