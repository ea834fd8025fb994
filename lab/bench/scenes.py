# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes of ``scene_table`` in Blender."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from math import radians
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...addon.blender import gonio
from ...headless import scene
from ..scenery import add_node, add_object, background, checker, light_data, quad, surface, wire, write_exact
from . import scene_table as table

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, NodeTree, Object, Scene
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Stage:
    """A scene, what in it takes the material, and the pixels that are judged, (H, W)."""

    scene: Scene
    item: Object
    judged: NDArray[np.bool_]

    @property
    def lamp(self) -> Object | None:
        return self.scene.objects.get("Lamp")


@contextmanager
def stage(name: str, size: int) -> Iterator[Stage]:
    """One of ``scene_table.SCENES`` in ``size`` x ``size`` pixels; Cycles keeps it loaded. Empties the session."""
    if name == "furnace":
        bpy.ops.wm.read_factory_settings(use_empty=True)
        geometry = gonio.Geometry(furnace=True, resolution=(size, size))
        with gonio.instrument(lambda _scene: bpy.data.materials.new("None"), geometry) as shown:
            shown.render.use_persistent_data = True
            patch = next(item for item in shown.objects if item.type == "MESH")
            yield Stage(shown, patch, np.ones((size, size), np.bool_))
        return
    kind, shown = table.SCENES[name], ball(size)
    if kind.mapped:
        _hold(shown, table.BRIGHTEST)
    else:
        _even(shown, kind.world)
    if kind.lamp:
        _lamp(shown, kind.lamp)
    if kind.floor:
        _checker(shown)
    shown.view_layers[0].update()
    judged = np.ones((size, size), np.bool_) if kind.floor else ball_pixels(size)
    yield Stage(shown, shown.objects["Ball"], judged)


def ball_pixels(size: int) -> NDArray[np.bool_]:
    """The pixels that show the ball alone, a little inside its outline."""
    place = (np.arange(size) + 0.5) / size - 0.5
    x, y = np.meshgrid(place, place)
    radius = table.LENS / table.SENSOR / np.sqrt(table.DISTANCE**2 - 1.0)  # as a share of the picture's width
    return np.hypot(x, y) < radius - 1.5 / size


def ball(size: int, height: float = 1.0) -> Scene:
    """A unit ball under the studio's map, its middle and the camera at a height in metres."""
    shown = scene.preview("studio")
    for name in ("Floor", "Sun"):
        bpy.data.objects.remove(shown.objects[name])
    write_exact(shown, size)
    shown.render.use_persistent_data = True
    shown.cycles.pixel_filter_type, shown.cycles.filter_width = "BOX", 1.0  # as other renderers have it
    shown.view_settings.view_transform = "Raw"
    shown.objects["Ball"].location.z = height
    shown.camera.location, shown.camera.rotation_euler = (0.0, -table.DISTANCE, height), (radians(90.0), 0.0, 0.0)
    shown.camera.data.lens, shown.camera.data.sensor_width = table.LENS, table.SENSOR
    return shown


def _hold(shown: Scene, brightest: float) -> None:
    """Have the world nowhere brighter than that."""
    tree, colour = shown.world.node_tree, background(shown.world).inputs["Color"]
    uncut = colour.links[0].from_socket
    wire(tree, add_node(tree, "VectorMath", operation="MINIMUM", Vector=uncut, Vector_001=(brightest,) * 3), colour)


def _even(shown: Scene, level: float) -> None:
    """Have the world the same grey everywhere."""
    colour = background(shown.world).inputs["Color"]
    shown.world.node_tree.links.remove(colour.links[0])
    colour.default_value = (level, level, level, 1.0)


def _lamp(shown: Scene, kind: str) -> None:
    if kind == "AREA":
        light = light_data("Lamp", kind, energy=table.SOFTBOX_WATTS, size=table.SOFTBOX_SIDE)
    else:
        light = light_data("Lamp", kind, energy=table.SUN_STRENGTH, angle=table.SUN_ANGLE)
    x, z = table.LAMP_DEGREES
    add_object(shown, "Lamp", light, table.LAMP_LOCATION, (x, 0.0, z))


def _checker(shown: Scene) -> None:
    """A floor of squares half a metre wide under the ball, and the camera a little above it."""
    shown.cycles.diffuse_bounces = shown.cycles.glossy_bounces = shown.cycles.max_bounces  # light is not to be lost
    dark, light = ((level, level, level) for level in table.CHECKER_LEVELS)

    def squares(tree: NodeTree) -> Node:
        place = add_node(tree, "NewGeometry").outputs["Position"]
        return add_node(tree, "BsdfDiffuse", Color=checker(tree, light, dark, 1.0 / table.CHECKER_SIDE, Vector=place))

    floor = add_object(shown, "Floor", quad("Floor", 2.0 * table.FLOOR_HALF))
    floor.data.materials.append(surface("Checker", squares))
    shown.camera.location = table.CHECKER_CAMERA
    shown.camera.rotation_euler = (radians(table.CHECKER_DEGREES), 0.0, 0.0)
