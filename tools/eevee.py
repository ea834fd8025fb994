# SPDX-License-Identifier: GPL-3.0-or-later
"""EEVEE beside Cycles: 60 presets of all families as balls, at lights and in a world.

    python tools/eevee.py [FOLDER]

Prints the differences by preset and by model; the pictures go to FOLDER. Cycles renders Exact Lights, or Direct, at
lights of zero size, which are the formula there, and Standard in a world. Both pictures are averaged over squares of
pixels, as noise and the edges of highlights would count for a difference.
"""

from __future__ import annotations

import sys
from itertools import groupby
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - prepare() must come first
from OpenImageIO import ImageBuf  # noqa: E402

from vgroove.addon.blender import gonio  # noqa: E402
from vgroove.addon.blender.material import Choice, build, lamps_to_bind  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.addon.models import MODELS  # noqa: E402
from vgroove.headless.scene import ball_mesh  # noqa: E402
from vgroove.lab.bench.everyday_stage import light  # noqa: E402
from vgroove.lab.scenery import add_node, add_object, background, wire, write_exact  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Object, Scene
    from numpy.typing import NDArray

    from vgroove.addon.library.presets import Preset

PRESETS, COLUMNS = 60, 8
SIZE, SQUARE = 48, 6  # pixels of a ball with its surroundings, and of what is averaged
APART = 2.4  # radii from ball to ball
WORLD = Path(bpy.utils.resource_path("LOCAL")) / "datafiles/studiolights/world/city.exr"
SAMPLES = {"lights": (64, 16), "world": (32, 4)}  # of Cycles and of EEVEE, per pixel


def selected() -> list[Preset]:
    """Presets of every family, evenly spaced by name; families that have many give one more."""
    everything = sorted(presets.shipped().values(), key=lambda one: one.id)
    families = [list(among) for _, among in groupby(everything, key=lambda one: one.family)]
    least, more = divmod(PRESETS, len(families))
    largest = sorted(families, key=len, reverse=True)[:more]
    counts = [least + (among in largest) for among in families]
    return [among[i * len(among) // n] for among, n in zip(families, counts, strict=True) for i in range(n)]


def stage(shown: list[Preset]) -> tuple[Scene, list[Object]]:
    """A ball for each preset, in rows, seen from above without perspective."""
    bpy.ops.wm.read_factory_settings()
    scene, rows = bpy.context.scene, -(-len(shown) // COLUMNS)
    for unwanted in ("Cube", "Light"):
        bpy.data.objects.remove(scene.objects[unwanted])
    scene.cycles.use_denoising, scene.cycles.device = False, "CPU"
    write_exact(scene, SIZE)
    scene.render.resolution_x, scene.render.resolution_y = SIZE * COLUMNS, SIZE * rows
    camera = scene.camera
    camera.location, camera.rotation_euler = (0, 0, 30), (0, 0, 0)
    camera.data.type, camera.data.ortho_scale = "ORTHO", APART * max(COLUMNS, rows)
    mesh, balls = ball_mesh(96, 48), []
    mesh.materials.append(None)
    for k, preset in enumerate(shown):
        x, y = (k % COLUMNS - (COLUMNS - 1) / 2) * APART, ((rows - 1) / 2 - k // COLUMNS) * APART
        balls.append(add_object(scene, preset.id, mesh, (x, y, 0)))
        balls[-1].material_slots[0].link = "OBJECT"
        balls[-1].visible_diffuse = balls[-1].visible_glossy = False  # EEVEE's closures see the world alone
    return scene, balls


def lit(scene: Scene) -> None:
    """By a sun, a point and a spot."""
    background(scene.world).inputs["Strength"].default_value = 0.0
    light(scene, "SUN", pi, (3, 2, 4), angle=0.0)
    light(scene, "POINT", 6e4, (-20, 15, 25), shadow_soft_size=0.0)
    light(scene, "SPOT", 6e4, (-15, -20, 25), shadow_soft_size=0.0, spot_size=2.0)


def in_world(scene: Scene) -> None:
    """Where Blender's own picture of a city is around."""
    tree = scene.world.node_tree
    image = add_node(tree, "TexEnvironment", image=bpy.data.images.load(str(WORLD)))
    wire(tree, image, background(scene.world).inputs["Color"])


def standard(preset: Preset) -> Material:
    return build(preset, Choice("nodes", next(one for one in ("fit", "closure") if one in preset.spec.estimators)))


def exact(preset: Preset) -> Material:
    """At lights the formula, of a model that has it."""
    estimator = next((one for one in ("corrected", "direct") if one in preset.spec.estimators), "")
    if not estimator:
        return standard(preset)
    return build(preset, Choice("nodes", estimator, lamps_to_bind(bpy.context.scene, estimator, preset.model)))


def picture(scene: Scene, engine: str, samples: int, path: Path | None) -> NDArray[np.float32]:
    scene.render.engine, scene.cycles.samples, scene.eevee.taa_render_samples = engine, samples, samples
    with headless.quiet():
        found = gonio.rendered(scene)
    if path is not None:
        out = ImageBuf(np.ascontiguousarray(np.clip(found, 0, 1) ** (1 / 2.2)))
        out.write(str(path))
    return found


def of_ball(image: NDArray[np.float32], k: int) -> NDArray[np.float32]:
    """Means over the squares that lie on the k-th ball, (squares, 3)."""
    row, column = divmod(k, COLUMNS)
    own = image[row * SIZE : (row + 1) * SIZE, column * SIZE : (column + 1) * SIZE]
    n = SIZE // SQUARE
    means = own.reshape(n, SQUARE, n, SQUARE, 3).mean(axis=(1, 3))
    corner = np.abs((np.arange(n + 1) / n - 0.5) * APART)
    farthest = np.maximum(corner[1:], corner[:-1])
    return means[np.hypot(*np.meshgrid(farthest, farthest)) < 1.0]


def differences(shown: list[Preset], where: str, folder: Path | None) -> dict[str, float]:
    """By preset: the mean difference of EEVEE's picture from Cycles', over the mean of Cycles'."""
    scene, balls = stage(shown)
    {"lights": lit, "world": in_world}[where](scene)
    scene.view_layers[0].update()

    def render(engine: str, samples: int, made: Callable[[Preset], Material]) -> NDArray[np.float32]:
        for ball, preset in zip(balls, shown, strict=True):
            ball.material_slots[0].material = made(preset)
        return picture(scene, engine, samples, folder and folder / f"eevee_{where}_{engine.lower()}.png")

    of_cycles, of_eevee = SAMPLES[where]
    cycles = render("CYCLES", of_cycles, exact if where == "lights" else standard)
    eevee = render(versions.EEVEE, of_eevee, standard)
    found = {}
    for k, preset in enumerate(shown):
        expected, got = of_ball(cycles, k), of_ball(eevee, k)
        found[preset.id] = float(np.abs(got - expected).mean() / max(expected.mean(), 1e-6))
    return found


def main(folder: Path | None = None) -> None:
    shown = selected()
    found = {}
    for where in SAMPLES:
        found[where] = differences(shown, where, folder)
        for preset in shown:
            print(f"{where:8} {preset.id:60} {preset.model:14} {found[where][preset.id]:8.4f}", flush=True)
    print("\n| model | presets | at lights: median | worst | in a world: median | worst |\n|---|---|---|---|---|---|")
    for model in MODELS.values():
        of = [preset.id for preset in shown if preset.model == model.name]
        if of:
            values = [f([found[where][one] for one in of]) for where in SAMPLES for f in (np.median, max)]
            print(f"| {model.label} | {len(of)} | {' | '.join(f'{100 * one:.1f} %' for one in values)} |")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
