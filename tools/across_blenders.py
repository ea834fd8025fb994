# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets and textured scenes as each Blender renders them, and how far apart: the tables of docs/testing.md.

python tools/across_blenders.py render build/across      once by each Blender; `make across` does all three
python tools/across_blenders.py compare build/across     prints the table

A ball under an even white sky and a small sun by Automatic, or an everyday scene of the report with a texture; two
seeds. The table has the largest difference of the mean in one channel, and of blocks of 4 x 4 pixels in per cent of the
picture's brightest block; noise is what two seeds of one Blender differ by.
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from math import radians
from pathlib import Path

import numpy as np

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()

from vgroove.addon.blender import gonio, material  # noqa: E402
from vgroove.addon.choose import automatic  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.headless import scene  # noqa: E402
from vgroove.lab.bench import everyday  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

PRESETS = (
    "lecture/copper", "metals/gold", "metals/aluminium", "metals_schlick/iron_schlick",
    "finished_metals/copper_satin", "alloys/brass", "lecture/plastic", "plastics/red_plastic",
    "diffuse/plaster", "diffuse/chalk", "diffuse/brick", "car_paints/blue", "car_paints/polaris_silver",
    "glasses/bk7_crown_glass", "glasses/frosted_glass", "glasses/window", "gems/diamond", "liquids/water",
    "translucent/marble", "translucent/skin_1",
)  # fmt: skip
TEXTURED = (
    "textured_colour", "textured_roughness", "mild_bump", "strong_bump", "mild_normal_map", "strong_normal_map",
    "displacement",
)  # fmt: skip
SIZE, SAMPLES, BLOCK = 64, 256, 4


def render(folder: Path) -> None:
    """Everything by the Blender that runs, two seeds each."""
    found = {}
    for name in PRESETS:
        preset = presets.find(name)
        with headless.quiet():
            found[name] = np.stack([picture(preset, seed) for seed in (0, 1)])
        print(name, flush=True)
    for name in TEXTURED:
        with headless.quiet():
            found[name] = everyday.look(name, everyday.SCENES[name].subjects[0], SIZE, SAMPLES).ours
        print(name, flush=True)
    folder.mkdir(parents=True, exist_ok=True)
    np.savez(folder / ("{}.{}.npz".format(*versions.version())), **found)


def picture(preset: presets.Preset, seed: int) -> np.ndarray:
    """The ball, (SIZE, SIZE, 3)."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with gonio.stage((SIZE, SIZE), samples=SAMPLES, seed=seed, shading_osl=False) as shown:
        gonio.light(shown, gonio.Geometry(furnace=True))
        sun = bpy.data.lights.new("Sun", "SUN")
        sun.energy, sun.angle = 2.0, radians(20.0)
        item = bpy.data.objects.new("Sun", sun)
        item.rotation_euler = (radians(50.0), 0.0, radians(30.0))
        shown.collection.objects.link(item)
        mesh = scene.ball_mesh(64, 32)
        estimator = automatic.pick(shown, preset).estimator
        made = material.build(preset, material.Choice("nodes", estimator))
        mesh.materials.append(made)
        shown.collection.objects.link(bpy.data.objects.new("Ball", mesh))
        gonio.look_down(shown, 2.1, (0.0, 0.0, 9.0))
        return gonio.rendered(shown).astype(np.float64)


def blocks(image: np.ndarray) -> np.ndarray:
    side = SIZE // BLOCK
    return image.reshape(side, BLOCK, side, BLOCK, 3).mean(axis=(1, 3))


def compare(folder: Path) -> None:
    """Markdown tables, of presets and of textured scenes: how far neighbouring versions are apart."""
    files = sorted(folder.glob("*.npz"), key=lambda path: tuple(map(int, path.stem.split("."))))
    runs = {path.stem: np.load(path) for path in files}
    pairs = list(pairwise(runs))
    for kind, names in (("preset", PRESETS), ("textured scene", TEXTURED)):
        print(f"\n| {kind} | " + " | ".join(f"{a} to {b}: mean | blocks" for a, b in pairs) + " | noise |")
        print("| --- |" + " --- | --- |" * len(pairs) + " --- |")
        for name in names:
            cells = [cell for a, b in pairs for cell in apart(runs[a][name], runs[b][name])]
            first, second = map(blocks, runs[files[-1].stem][name])
            cells.append(np.abs(first - second).max() / first.max())
            print(f"| {name} | " + " | ".join(f"{100 * cell:.2f}" for cell in cells) + " |")


def apart(before: np.ndarray, after: np.ndarray) -> tuple[float, float]:
    """The largest difference of a channel's mean, and of a block over the brightest; of pictures by seed."""
    before, after = (blocks(pictures.mean(axis=0)) for pictures in (before, after))
    means = np.abs(after.mean(axis=(0, 1)) / before.mean(axis=(0, 1)) - 1.0).max()
    return means, np.abs(after - before).max() / before.max()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("what", choices=("render", "compare"))
    parser.add_argument("folder", type=Path)
    given = parser.parse_args()
    {"render": render, "compare": compare}[given.what](given.folder)
