# SPDX-License-Identifier: GPL-3.0-or-later
"""What docs/tutorial.md tells artists to do, done by its own table and words; and its picture.

python tools/still_life.py docs/images/still_life.webp
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()

import vgroove  # noqa: E402
from vgroove.addon.ui import properties  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

if TYPE_CHECKING:
    from bpy.types import Object

PAGE = Path(__file__).parent.parent / "docs" / "tutorial.md"
ROW = re.compile(r"^\| (Plane|UV Sphere) \| ([\d.]+) \| (.+?) \| (.+?) \| (.+?) \|$", re.MULTILINE)
SAMPLES, SIZE = 32, (480, 300)


def follow() -> list[Object]:
    """The tutorial's steps 2 and 3 in Blender's default scene, with the extension on. The objects in its order."""
    page, made = PAGE.read_text(encoding="utf-8"), []
    bpy.data.objects.remove(bpy.data.objects["Cube"])
    for mesh, size, place, _, _ in ROW.findall(page):
        location = [float(value) for value in place.split(",")]
        if mesh == "Plane":
            bpy.ops.mesh.primitive_plane_add(size=float(size), location=location)
        else:
            bpy.ops.mesh.primitive_uv_sphere_add(radius=float(size), location=location)
            bpy.ops.object.shade_smooth()
        made.append(bpy.context.object)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    for item, (_, _, _, words, name) in zip(made, ROW.findall(page), strict=True):
        for other in made:
            other.select_set(other is item)
        bpy.context.view_layer.objects.active = item
        scene.vgroove.search = words
        found = {one.name: one for one in properties.matching(scene.vgroove)}
        scene.vgroove.preset = found[name].id
        bpy.ops.vgroove.apply()
    return made


def main() -> None:
    path = Path(sys.argv[1]).resolve()
    with headless.quiet():
        bpy.ops.wm.read_factory_settings()
        vgroove.register()
        follow()
        bpy.ops.vgroove.mend()
        scene = bpy.context.scene
        render, cycles = scene.render, scene.cycles
        render.resolution_x, render.resolution_y, render.resolution_percentage = *SIZE, 100
        cycles.samples, cycles.use_denoising, cycles.device = SAMPLES, True, "CPU"
        versions.write_as(render.image_settings, "IMAGE", "WEBP")
        render.filepath = str(path)
        bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main()
