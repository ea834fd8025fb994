# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of every preset, for the panel and the asset library: previews/FAMILY/MATERIAL.webp.

python tools/previews.py                      all that are missing or older than their preset
python tools/previews.py --all                all, anew
python tools/previews.py metals/gold water    those alone, anew

The body is as large as a fist, on checks of 1 cm: a ball for the form and the environment's reflection, a plate for
light at grazing angles, an edge, and a low sun that draws a shadow's line. Each material is built as the panel would by
Automatic. One seed and one number of samples: the same picture each time on the same Blender.
"""

from __future__ import annotations

import argparse
import time
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.progress import Progress

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()

from vgroove.addon.blender import material, slots  # noqa: E402
from vgroove.addon.blender.material import lamps_to_bind  # noqa: E402
from vgroove.addon.choose import automatic  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.addon.library.files import replacing  # noqa: E402
from vgroove.headless import scene  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Sequence

FOLDER = Path(__file__).parent.parent / "previews"
PIXELS, SAMPLES, QUALITY = 256, 12, 85
CM = 0.01
SHOWN_AGE = 0.6
SEGMENTS = 96


def profile() -> list[tuple[float, float]]:
    """(r, z) in cm, from the middle of the underside to the top of the ball."""

    def arc(r: float, z: float, radius: float, start: float, end: float, steps: int) -> list[tuple[float, float]]:
        turns = np.radians(np.linspace(start, end, steps + 1))
        return [(r + radius * np.cos(turn), z + radius * np.sin(turn)) for turn in turns]

    plate = [(0.0, 0.0), *arc(4.1, 0.3, 0.3, -90, 0, 6), *arc(4.1, 0.8, 0.3, 0, 90, 6)]
    return [*plate, *arc(0.0, 3.9, 3.0, -75, 90, 48)]


def body() -> bpy.types.Object:
    """The profile turned about its axis."""
    points, faces = [], []
    inner = profile()[1:-1]
    turn = np.arange(SEGMENTS) * 2.0 * np.pi / SEGMENTS
    for r, z in inner:
        points += [(r * CM * np.cos(t), r * CM * np.sin(t), z * CM) for t in turn]
    points += [(0.0, 0.0, profile()[0][1] * CM), (0.0, 0.0, profile()[-1][1] * CM)]
    bottom, top, last = len(points) - 2, len(points) - 1, (len(inner) - 1) * SEGMENTS
    for s in range(SEGMENTS):
        t = (s + 1) % SEGMENTS
        faces += [(bottom, t, s), (top, last + s, last + t)]
        faces += [(r + s, r + t, r + SEGMENTS + t, r + SEGMENTS + s) for r in range(0, last, SEGMENTS)]
    mesh = bpy.data.meshes.new("Body")
    mesh.from_pydata(points, [], faces)
    mesh.shade_smooth()
    mesh.set_sharp_from_angle(angle=radians(35.0))
    item = bpy.data.objects.new("Body", mesh)
    item.location.z = 0.1 * CM  # so that light gets below glass
    return item


def stage() -> bpy.types.Scene:
    """The scene without a material on its body; empties this session."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    shown = bpy.context.scene
    shown.render.engine = "CYCLES"
    scene.exact(shown)
    cycles, render = shown.cycles, shown.render
    cycles.device, cycles.samples, cycles.seed = "CPU", SAMPLES, 0
    cycles.max_bounces, cycles.diffuse_bounces, cycles.transmission_bounces = 8, 2, 8
    cycles.use_denoising, cycles.denoiser = True, "OPENIMAGEDENOISE"
    shown.view_settings.view_transform = "Khronos PBR Neutral"  # a colour stays what the preset says
    render.resolution_x = render.resolution_y = PIXELS
    render.image_settings.file_format, render.image_settings.quality = "WEBP", QUALITY
    render.image_settings.color_mode = "RGB"
    render.use_persistent_data = True
    shown.collection.objects.link(body())
    floor(shown)
    scene.add_sun(shown, energy=2.5)
    scene.light_by(shown, scene.environments()["interior"], strength=0.7)
    camera = bpy.data.cameras.new("Camera")
    camera.lens, camera.clip_start = 80, 0.01
    item = bpy.data.objects.new("Camera", camera)
    item.location, item.rotation_euler = (0.0, -0.245, 0.135), (radians(66.5), 0.0, 0.0)
    shown.collection.objects.link(item)
    shown.camera = item
    return shown


def floor(shown: bpy.types.Scene) -> None:
    """Checks of 1 cm, and behind them a plain bend up into a wall."""
    turns = np.radians(np.linspace(0.0, 90.0, 13))
    curve = [(-0.5, 0.0), *zip(0.12 + 0.2 * np.sin(turns), 0.2 - 0.2 * np.cos(turns), strict=True), (0.32, 0.8)]
    points = [(x, y, z) for y, z in curve for x in (-0.8, 0.8)]
    mesh = bpy.data.meshes.new("Floor")
    mesh.from_pydata(points, [], [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(curve) - 1)])
    mesh.shade_smooth()
    for greys in ((0.18, 0.26), (0.22, 0.22)):
        mesh.materials.append(checked(*greys))
    for face in mesh.polygons:
        face.material_index = min(face.index, 1)
    shown.collection.objects.link(bpy.data.objects.new("Floor", mesh))


def checked(*greys: float) -> bpy.types.Material:
    """Matte squares of 1 cm in two greys."""
    made = versions.empty_material("Floor")
    tree = made.node_tree
    place, checks, diffuse, output = (
        tree.nodes.new(f"ShaderNode{kind}") for kind in ("NewGeometry", "TexChecker", "BsdfDiffuse", "OutputMaterial")
    )
    for name, grey in zip(("Color1", "Color2"), greys, strict=True):
        checks.inputs[name].default_value = (grey, grey, grey, 1.0)
    checks.inputs["Scale"].default_value = 1.0 / CM
    tree.links.new(place.outputs["Position"], checks.inputs["Vector"])
    tree.links.new(checks.outputs["Color"], diffuse.inputs["Color"])
    tree.links.new(diffuse.outputs[0], output.inputs["Surface"])
    return made


def render(shown: bpy.types.Scene, preset: presets.Preset, path: Path) -> None:
    """One picture to ``path``; its material is removed again. What changes is shown when most of it has changed."""
    if preset.time is not None:
        preset = preset.at(float(preset.trajectory().time(SHOWN_AGE)))
    estimator = automatic.pick_estimator(shown, preset)
    lamps = lamps_to_bind(shown, estimator, preset.model)
    made = material.build(preset, material.Choice("nodes", estimator, lamps))
    slots.apply(made, [shown.objects["Body"]])
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as temporary:
        shown.render.filepath = str(temporary)
        bpy.ops.render.render(write_still=True)
    bpy.data.materials.remove(made)


def wanted(names: Sequence[str], folder: Path, *, everything: bool) -> list[presets.Preset]:
    """The presets named, else those whose picture is missing or older than their file."""
    if names:
        return [presets.find(name) for name in names]

    def is_old(preset: presets.Preset) -> bool:
        picture = folder / f"{preset.id}.webp"
        return not picture.exists() or picture.stat().st_mtime < (presets.FOLDER / f"{preset.id}.toml").stat().st_mtime

    return [preset for preset in presets.shipped().values() if everything or is_old(preset)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="PRESET")
    parser.add_argument("--all", action="store_true", help="every preset, also where the picture is new enough")
    parser.add_argument("--folder", type=Path, default=FOLDER)
    arguments = parser.parse_args()
    start = time.perf_counter()
    chosen = wanted(arguments.names, arguments.folder, everything=arguments.all)
    with headless.quiet():
        shown = stage()
    with Progress() as progress:
        for preset in progress.track(chosen, description="previews"):
            with headless.quiet():
                render(shown, preset, arguments.folder / f"{preset.id}.webp")
    size = sum(path.stat().st_size for path in arguments.folder.glob("*/*.webp"))
    print(f"{len(chosen)} pictures in {time.perf_counter() - start:.0f} s; all together {size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
