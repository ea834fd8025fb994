# SPDX-License-Identifier: GPL-3.0-or-later
"""Glass to look at: a slab's offset, a ball's inverted image beside a bubble, water in a glass, two slopes.

    python tools/glass.py FOLDER

Water meets the glass in one surface whose IOR is that of water over that of glass.
"""

from __future__ import annotations

import sys
from math import cos, pi, sin
from pathlib import Path

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - prepare() must come first
from mathutils import Vector  # noqa: E402

from vgroove.lab.check.glass import probe  # noqa: E402
from vgroove.lab.check.rows import SETUPS  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

SIZE = (300, 225)
BOUNCES = 24


def glass(eta: float, m: float = 0.0, *, thin: bool = False) -> bpy.types.Material:
    return probe(SETUPS[0], "mirror", eta, m, thin=thin)


def diffuse(*, checker: bool = False) -> bpy.types.Material:
    made = versions.empty_material("Diffuse")
    tree = made.node_tree
    bsdf, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    bsdf.inputs["Color"].default_value = (0.7, 0.1, 0.05, 1.0)
    tree.links.new(bsdf.outputs[0], output.inputs[0])
    if checker:
        texture, place = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeNewGeometry")
        texture.inputs["Scale"].default_value = 1.0
        texture.inputs["Color2"].default_value = (0.1, 0.15, 0.3, 1.0)
        tree.links.new(place.outputs["Position"], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], bsdf.inputs["Color"])
    return made


def lathe(profile: list[tuple[float, float]], material: bpy.types.Material, sides: int = 256) -> None:
    """A surface of revolution of (radius, height) points; it faces the right of the way from first to last."""
    ring = [(cos(2 * pi * i / sides), sin(2 * pi * i / sides)) for i in range(sides)]
    points = [(r * x, r * y, z) for r, z in profile for x, y in ring]
    faces = [
        (k * sides + i, k * sides + (i + 1) % sides, (k + 1) * sides + (i + 1) % sides, (k + 1) * sides + i)
        for k in range(len(profile) - 1)
        for i in range(sides)
    ]
    mesh = bpy.data.meshes.new("Lathe")
    mesh.from_pydata(points, [], faces)
    mesh.materials.append(material)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=0.5)
    bpy.context.collection.objects.link(bpy.data.objects.new("Lathe", mesh))


def ball(x: float, material: bpy.types.Material) -> None:
    bpy.ops.mesh.primitive_uv_sphere_add(location=(x, 0, 1), segments=192, ring_count=96)
    bpy.context.object.data.shade_smooth()
    bpy.context.object.data.materials.append(material)


def slab() -> None:
    floor()
    bpy.ops.mesh.primitive_cube_add(location=(0, 0, 0.7), scale=(1.5, 1.0, 0.5))
    bpy.context.object.data.materials.append(glass(1.5))


def floor() -> None:
    bpy.ops.mesh.primitive_plane_add(size=40)
    bpy.context.object.data.materials.append(diffuse(checker=True))


def balls() -> None:
    ball(-1.1, glass(1.5))
    ball(1.1, glass(1.5, thin=True))


def rough() -> None:
    ball(-1.1, glass(1.5, 0.1))
    ball(1.1, glass(1.5, 0.6))


def water() -> None:
    floor()
    outside, inside, rim, level = 1.0, 0.88, 2.2, 1.4
    lathe([(1e-4, 0.02), (outside, 0.02), (outside, rim), (inside, rim), (inside, level)], glass(1.5))
    lathe([(1e-4, 0.2), (inside, 0.2), (inside, level)], glass(1.33 / 1.5))
    lathe([(inside, level), (1e-4, level)], glass(1.33))
    bpy.ops.mesh.primitive_cylinder_add(location=(0.05, 0, 1.5), radius=0.06, depth=2.9, rotation=(0, 0.42, 0))
    bpy.context.object.data.materials.append(diffuse())


def stage(*, environment: bool) -> bpy.types.Scene:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.cycles.samples, scene.cycles.use_denoising, scene.cycles.blur_glossy = 128, False, 0.0
    for kind in ("max", "transmission", "glossy", "transparent_max"):
        setattr(scene.cycles, f"{kind}_bounces", BOUNCES)
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("World")
    tree = versions.nodes_of(scene.world)
    background = tree.nodes.get("Background") or tree.nodes.new("ShaderNodeBackground")
    background.inputs["Color"].default_value = (0.8, 0.8, 0.8, 1.0)
    if environment:
        image = tree.nodes.new("ShaderNodeTexEnvironment")
        city = Path(bpy.utils.resource_path("LOCAL")) / "datafiles/studiolights/world/city.exr"
        image.image = bpy.data.images.load(str(city))
        tree.links.new(image.outputs[0], background.inputs["Color"])
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.location = (0, -7, 1.2 if environment else 3.4)
    camera.rotation_euler = (Vector((0, 0, 1)) - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    return scene


def main(folder: Path) -> None:
    for build, environment in ((slab, False), (balls, True), (rough, True), (water, False)):
        with headless.quiet():
            scene = stage(environment=environment)
            build()
            scene.render.filepath = str(folder / f"glass_{build.__name__}.png")
            bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
