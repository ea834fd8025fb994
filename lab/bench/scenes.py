# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that a report renders: small pictures, whose light is known and whose truth can be had.

- furnace: the gonioreflectometer under a white sky: each pixel is a direction, the truth is the reference's albedo;
- environment: a ball under an environment map whose brightest spots are held to 3, as its truth would need too many
  samples else;
- softbox: a ball by an area lamp of 1 m, 2.5 m away, and nothing else;
- sun: a ball by a sun of half a degree, under a dim, even sky;
- outdoors: a ball under the environment map and that sun;
- checker: a ball of glass on a checkered floor, under the environment map.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from math import radians
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...addon.blender import gonio
from ...headless import scene
from ...nodegroups import versions

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Object, Scene
    from numpy.typing import NDArray

BRIGHTEST = 3.0
DISTANCE, LENS, SENSOR = 6.0, 90.0, 36.0  # of the camera from the unit ball, in metres and millimetres
LAMP = (1.3, -1.6, 2.6)


@dataclass(frozen=True)
class Stage:
    """A scene, what in it takes the material, and the pixels that are judged."""

    scene: Scene
    item: Object
    seen: NDArray[np.bool_]

    @property
    def lamp(self) -> Object | None:
        return self.scene.objects.get("Lamp")


@contextmanager
def stage(name: str, size: int) -> Iterator[Stage]:
    """One of ``findings.SCENES`` in ``size`` x ``size`` pixels, kept in Cycles between renders. Empties the session."""
    if name == "furnace":
        bpy.ops.wm.read_factory_settings(use_empty=True)
        geometry = gonio.Geometry(furnace=True, resolution=(size, size))
        with gonio.instrument(lambda _scene: bpy.data.materials.new("None"), geometry) as shown:
            shown.render.use_persistent_data = True
            patch = next(item for item in shown.objects if item.type == "MESH")
            yield Stage(shown, patch, np.ones((size, size), np.bool_))
        return
    shown = _ball(size)
    if name in {"environment", "checker", "outdoors"}:
        _hold(shown, BRIGHTEST)
    else:
        _even(shown, 0.05 if name == "sun" else 0.0)
    if name in {"softbox", "sun", "outdoors"}:
        _lamp(shown, "AREA" if name == "softbox" else "SUN")
    if name == "checker":
        _checker(shown)
    shown.view_layers[0].update()
    seen = np.ones((size, size), np.bool_) if name == "checker" else ball_pixels(size)
    yield Stage(shown, shown.objects["Ball"], seen)


def ball_pixels(size: int) -> NDArray[np.bool_]:
    """The pixels that show the ball alone, a little inside its outline."""
    place = (np.arange(size) + 0.5) / size - 0.5
    x, y = np.meshgrid(place, place)
    radius = LENS / SENSOR / np.sqrt(DISTANCE**2 - 1.0)  # as a share of the picture's width
    return np.hypot(x, y) < radius - 1.5 / size


def _ball(size: int) -> Scene:
    shown = scene.preview("studio")
    for item in [shown.objects["Floor"], shown.objects["Sun"]]:
        bpy.data.objects.remove(item)
    shown.render.resolution_x = shown.render.resolution_y = size
    shown.render.image_settings.file_format, shown.render.image_settings.color_depth = "OPEN_EXR", "32"
    shown.render.use_persistent_data = True
    shown.cycles.pixel_filter_type, shown.cycles.filter_width = "BOX", 1.0  # as other renderers have it
    shown.view_settings.view_transform = "Raw"
    shown.camera.location, shown.camera.rotation_euler = (0.0, -DISTANCE, 1.0), (radians(90.0), 0.0, 0.0)
    shown.camera.data.lens, shown.camera.data.sensor_width = LENS, SENSOR
    return shown


def _hold(shown: Scene, brightest: float) -> None:
    """Have the world nowhere brighter than that."""
    tree = shown.world.node_tree
    colour = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground").inputs["Color"]
    held = tree.nodes.new("ShaderNodeVectorMath")
    held.operation, held.inputs[1].default_value = "MINIMUM", (brightest,) * 3
    tree.links.new(colour.links[0].from_socket, held.inputs[0])
    tree.links.new(held.outputs[0], colour)


def _even(shown: Scene, level: float) -> None:
    """Have the world the same grey everywhere."""
    tree = shown.world.node_tree
    colour = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground").inputs["Color"]
    tree.links.remove(colour.links[0])
    colour.default_value = (level, level, level, 1.0)


def _lamp(shown: Scene, kind: str) -> None:
    light = bpy.data.lights.new("Lamp", kind)
    if kind == "AREA":
        light.energy, light.size = 60.0, 1.0
    else:
        light.energy, light.angle = 2.0, radians(0.53)
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.location, lamp.rotation_euler = LAMP, (radians(45.0), 0.0, radians(39.0))
    shown.collection.objects.link(lamp)


def _checker(shown: Scene) -> None:
    """A floor of squares half a metre wide under the ball, and the camera a little above it."""
    shown.cycles.diffuse_bounces = shown.cycles.glossy_bounces = shown.cycles.max_bounces  # light is not to be lost
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata([(-40, -40, 0), (40, -40, 0), (40, 40, 0), (-40, 40, 0)], [], [(0, 1, 2, 3)])
    made = versions.empty_material("Checker")
    tree = made.node_tree
    texture, place, diffuse, output = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexChecker", "NewGeometry", "BsdfDiffuse", "OutputMaterial")
    )
    texture.inputs["Scale"].default_value = 2.0
    texture.inputs["Color1"].default_value, texture.inputs["Color2"].default_value = (
        (0.7, 0.7, 0.7, 1.0),
        (0.05, 0.05, 0.05, 1.0),
    )
    tree.links.new(place.outputs["Position"], texture.inputs["Vector"])
    tree.links.new(texture.outputs["Color"], diffuse.inputs["Color"])
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    mesh.materials.append(made)
    shown.collection.objects.link(bpy.data.objects.new("Floor", mesh))
    shown.camera.location, shown.camera.rotation_euler = (0.0, -5.6, 2.6), (radians(74.0), 0.0, 0.0)
