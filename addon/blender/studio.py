# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene of every picture of a preset: one light, one camera, and a shape that suits what the material is.

A ball of white diffuse paint reaches 0.8 and no light but the small key light is above 1, so metals are not burnt out.
"""

from __future__ import annotations

from math import pi, radians
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from mathutils import Vector

from ...nodegroups import versions
from . import shapes, slots
from .shapes import CM

if TYPE_CHECKING:
    from pathlib import Path

    from bpy.types import Collection, Material, Object, Scene

    from ..library.presets import Preset

PIXELS, SAMPLES, QUALITY = 256, 16, 85
BALL, TUMBLER, PANE = "Ball", "Liquid", "Pane"
# By the first tag that a preset has: what light goes through, what it does not.
CLEAR = {"glass": BALL, "gem": "Gem", "liquid": TUMBLER, "crystal": "Crystal"}
OPAQUE = {
    "metal": BALL, "cloth": "Cloth", "leather": "Cloth", "paper": "Sheet", "ceramic": "Vase", "wood": "Boards",
    "stone": "Block", "building": "Block",
}  # fmt: skip
SHAPES = {  # how to make each, and degrees about z
    BALL: (shapes.ball, 0.0), "Gem": (shapes.gem, 12.0), "Crystal": (shapes.crystal, 22.0),
    TUMBLER: (shapes.liquid, 0.0), PANE: (shapes.pane, 22.0), "Cloth": (shapes.cloth, 0.0),
    "Sheet": (shapes.sheet, 24.0), "Vase": (shapes.vase, 0.0), "Boards": (shapes.boards, 0.0),
    "Block": (shapes.block, 0.0),
}  # fmt: skip
LEAN = 24.0  # degrees of the pane, so that it reflects the edge of a lamp
# Radiance, side in m, distance in m, degrees from the front to the right, degrees above the ground.
LIGHTS = {"Key": (4.4, 0.25, 0.6, -54.0, 46.0), "Fill": (0.9, 0.6, 0.7, 62.0, 28.0)}
SKY = ((0.0, 0.05), (0.45, 0.1), (0.55, 0.34), (1.0, 0.66))  # radiance by height: 0 straight down, 1 straight up


def shape_of(preset: Preset) -> str:
    """The shape that shows a material: by what it is called and whether light goes through it."""
    if preset.is_sheet:
        return PANE
    table = CLEAR if preset.transparent else OPAQUE
    return next((shape for tag, shape in table.items() if tag in preset.tags), BALL)


def scene() -> Scene:
    """The scene without a material on any shape; empties this session."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    made = bpy.context.scene
    _set_up(made)
    for name, (make, turn) in SHAPES.items():
        _add(_collection(made, name), make(), turn)
    _add(_collection(made, TUMBLER), shapes.tumbler()).active_material = _matter("Tumbler", "BsdfGlass", IOR=1.52)
    _behind_the_pane(_collection(made, PANE))
    _floor(made)
    _light(made)
    camera = bpy.data.cameras.new("Camera")
    camera.lens, camera.clip_start = 85, 0.01
    item = _add(made.collection, camera)
    item.location, item.rotation_euler = (0.0, -0.252, 0.138), (radians(66.5), 0.0, 0.0)
    made.camera = item
    return made


def show(shown: Scene, preset: Preset, made: Material) -> None:
    """The preset's shape with its material, and no other shape."""
    shape = shape_of(preset)
    for one in shown.collection.children:
        one.hide_render = one.name != shape
    slots.apply(made, [shown.objects[shape]])


def picture(shown: Scene, path: Path) -> None:
    """Render to ``path``, a WebP."""
    shown.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def _set_up(made: Scene) -> None:
    """One seed and one number of samples: the same picture each time on the same Blender."""
    made.render.engine = "CYCLES"
    cycles, render = made.cycles, made.render
    cycles.device, cycles.samples, cycles.seed, cycles.use_adaptive_sampling = "CPU", SAMPLES, 0, False
    cycles.blur_glossy, cycles.sample_clamp_indirect = 0.0, 4.0
    cycles.max_bounces, cycles.diffuse_bounces = 12, 2
    cycles.glossy_bounces = cycles.transmission_bounces = 12
    remove_noise(cycles)
    made.view_settings.view_transform = "Khronos PBR Neutral"  # a colour stays what the preset says
    render.resolution_x = render.resolution_y = PIXELS
    versions.write_as(render.image_settings, "IMAGE", "WEBP")
    render.image_settings.quality, render.image_settings.color_mode = QUALITY, "RGB"
    render.use_persistent_data = True


def remove_noise(cycles: Any) -> None:
    """By the denoiser; by four times the samples where Blender is built without one, as Debian's is."""
    try:
        cycles.denoiser = "OPENIMAGEDENOISE"
    except TypeError:
        cycles.use_denoising, cycles.samples = False, 4 * SAMPLES
        return
    cycles.use_denoising = True
    cycles.denoising_prefilter = "ACCURATE"  # faster ones leave grains in gems


def _collection(made: Scene, name: str) -> Collection:
    if name not in made.collection.children:
        made.collection.children.link(bpy.data.collections.new(name))
    return made.collection.children[name]


def _add(where: Collection, data: Any, turn: float = 0.0) -> Object:
    """An object, turned by degrees about z, a little above the ground so that light gets below glass."""
    item = bpy.data.objects.new(data.name, data)
    item.location.z, item.rotation_euler.z = 0.1 * CM, radians(turn)
    where.objects.link(item)
    return item


def _matter(name: str, kind: str, **given: Any) -> Material:
    """A material of one shader, whose inputs get a value, a grey, or an output."""
    made = versions.empty_material(name)
    tree = made.node_tree
    shader, output = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeOutputMaterial")
    for key, value in given.items():
        shader.inputs[key].default_value = (value, value, value, 1.0) if key == "Color" else value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def _behind_the_pane(where: Collection) -> None:
    """A red ball half behind it, and a frame that leans with it."""
    ball = _add(where, shapes.lathe("Behind", [(0.0, 0.0), *shapes.arc(0.0, 1.9, 1.9, -85, 85, 32), (0.0, 3.8)]))
    ball.location.x, ball.location.y = 3.0 * CM, 5.5 * CM
    ball.active_material = _matter("Behind", "BsdfDiffuse")
    ball.active_material.node_tree.nodes["Diffuse BSDF"].inputs["Color"].default_value = (0.55, 0.07, 0.03, 1.0)
    frame = _add(where, shapes.frame(), SHAPES[PANE][1])
    frame.active_material = _matter("Frame", "BsdfDiffuse", Color=0.06)
    for one in (frame, where.objects[PANE]):
        one.rotation_euler.x = radians(-LEAN)


def _floor(made: Scene) -> None:
    """Checks of 1 cm, and behind them a plain bend up into a wall."""
    turns = np.radians(np.linspace(0.0, 90.0, 13))
    curve = [(-0.5, 0.0), *zip(0.12 + 0.2 * np.sin(turns), 0.2 - 0.2 * np.cos(turns), strict=True), (0.32, 0.8)]
    points = [(x, y, z) for y, z in curve for x in (-0.8, 0.8)]
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata(points, [], [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(curve) - 1)])
    mesh.shade_smooth()
    for material in (_checks(0.22, 0.42), _matter("Wall", "BsdfDiffuse", Color=0.4)):
        mesh.materials.append(material)
    for face in mesh.polygons:
        face.material_index = min(face.index, 1)
    made.collection.objects.link(bpy.data.objects.new("Floor", mesh))


def _checks(*greys: float) -> Material:
    """Matte squares of 1 cm in two greys."""
    made = _matter("Floor", "BsdfDiffuse")
    tree = made.node_tree
    place, checks = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeTexChecker")
    for name, grey in zip(("Color1", "Color2"), greys, strict=True):
        checks.inputs[name].default_value = (grey, grey, grey, 1.0)
    checks.inputs["Scale"].default_value = 1.0 / CM
    tree.links.new(place.outputs["Position"], checks.inputs["Vector"])
    tree.links.new(checks.outputs["Color"], tree.nodes["Diffuse BSDF"].inputs["Color"])
    return made


def _light(made: Scene) -> None:
    """Two square lamps that mirrors show, and a sky that is brighter above."""
    for name, (radiance, side, away, right, above) in LIGHTS.items():
        lamp = bpy.data.lights.new(name, "AREA")
        lamp.shape, lamp.size, lamp.energy = "SQUARE", side, radiance * side**2 * pi
        item = _add(made.collection, lamp)
        item.rotation_euler = (radians(90.0 - above), 0.0, radians(right))
        item.location = item.rotation_euler.to_matrix() @ Vector((0.0, 0.0, away))
    world = bpy.data.worlds.new("Sky")
    tree = versions.nodes_of(world)
    tree.nodes.clear()
    place, split, ramp, background, output = (
        tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("NewGeometry", "SeparateXYZ", "ValToRGB", "Background", "OutputWorld")
    )
    height = tree.nodes.new("ShaderNodeMapRange")
    height.inputs["From Min"].default_value = -1.0
    tree.links.new(place.outputs["Position"], split.inputs[0])
    tree.links.new(split.outputs["Z"], height.inputs["Value"])
    tree.links.new(height.outputs[0], ramp.inputs["Fac" if "Fac" in ramp.inputs else "Factor"])
    stops = ramp.color_ramp.elements
    for (at, grey), stop in zip(SKY, [*stops, *(stops.new(0.5) for _ in SKY[2:])], strict=True):
        stop.position, stop.color = at, (grey, grey, grey, 1.0)
    tree.links.new(ramp.outputs[0], background.inputs["Color"])
    tree.links.new(background.outputs[0], output.inputs["Surface"])
    made.world = world
    made.world.cycles.sampling_method, made.world.cycles.sample_map_resolution = "MANUAL", 64
