# SPDX-License-Identifier: GPL-3.0-or-later
"""Time and noise of each estimator and backend over Cycles' own Metallic BSDF, in one run on one scene.

    python bench/estimators.py [--samples N] [--rounds N] [--system SVM|OSL] [--floor]

A ball under an environment map and a sun of zero size (``direct``: under that alone), 256 x 256; with --floor on the
floor that ``vgroove render`` shows presets on. Each round renders every material once, so that what else the
machine does falls on all alike; times are of the processor, and the ratio of a round is to the Metallic BSDF in that
round under the same shading system. The median of the rounds is printed. Noise is the root mean square of what two
seeds differ by, at as many samples.
"""

from __future__ import annotations

import argparse
import statistics
import time
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from vgroove.addon import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()
import numpy as np  # noqa: E402

from vgroove.addon import gonio, material, presets, scene  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Scene


def metallic() -> Material:
    """The peer: Cycles' Metallic BSDF with Beckmann's distribution, and the slope and colour of the preset."""
    made = bpy.data.materials.new("Metallic")
    if bpy.app.version < (5, 0, 0):  # as in material.py; goes with 4.5 LTS
        made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    bsdf, output = tree.nodes.new("ShaderNodeBsdfMetallic"), tree.nodes.new("ShaderNodeOutputMaterial")
    bsdf.distribution, bsdf.fresnel_type = "BECKMANN", "F82"
    bsdf.inputs["Base Color"].default_value = (0.95, 0.64, 0.54, 1.0)
    bsdf.inputs["Roughness"].default_value = 0.3**0.5
    tree.links.new(bsdf.outputs[0], output.inputs["Surface"])
    return made


def contestants(shown: Scene) -> dict[tuple[str, str], Callable[[], Material]]:
    """Material makers by (name, shading system)."""
    preset = presets.find("lecture/copper")
    makers: dict[tuple[str, str], Callable[[], Material]] = {("Metallic BSDF", s): metallic for s in ("SVM", "OSL")}
    for estimator in material.ESTIMATORS:
        lamps = scene.lamps_to_bind(shown, estimator)
        for backend, system in (("nodes", "SVM"), ("nodes", "OSL"), ("osl", "OSL")):
            choice = material.Choice(backend, estimator, lamps)
            makers[f"{estimator}, {backend}", system] = lambda choice=choice: material.build(preset, choice)
    return makers


def render_seconds(shown: Scene, made: Material, system: str, samples: int) -> float:
    """Processor time of one render call, synchronising and compiling included."""
    shown.objects["Ball"].active_material = made
    shown.cycles.shading_system = system == "OSL"
    shown.cycles.samples = samples
    shown.render.resolution_x = shown.render.resolution_y = 256
    start = time.process_time()
    with headless.quiet():
        bpy.ops.render.render(scene=shown.name)
    return time.process_time() - start


def noise(shown: Scene, made: Material, system: str, samples: int) -> float:
    """Root mean square of the difference between two seeds, over sqrt(2)."""
    shown.objects["Ball"].active_material = made
    shown.cycles.shading_system = system == "OSL"
    shown.cycles.samples = samples
    images = []
    with headless.quiet():
        for seed in (1, 2):
            shown.cycles.seed = seed
            images.append(gonio.rendered(shown).astype(np.float64))
    return float(np.sqrt(np.mean((images[0] - images[1]) ** 2) / 2.0))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--system", choices=("SVM", "OSL"), help="only what runs so; both if left out")
    parser.add_argument("--floor", action="store_true", help="keep the floor")
    options = parser.parse_args()
    with headless.quiet():
        shown = scene.preview()
        if not options.floor:
            bpy.data.objects.remove(shown.objects["Floor"])
    shown.render.image_settings.file_format, shown.render.image_settings.color_depth = "OPEN_EXR", "32"
    makers = {key: make for key, make in contestants(shown).items() if options.system in {None, key[1]}}
    materials = {key: make() for key, make in makers.items()}
    ratios: dict[tuple[str, str], list[float]] = {key: [] for key in makers}
    for key, made in materials.items():  # a first, short render of each loads the map and compiles
        render_seconds(shown, made, key[1], 1)
    for _ in range(options.rounds):
        seconds = {key: render_seconds(shown, made, key[1], options.samples) for key, made in materials.items()}
        for key, value in seconds.items():
            ratios[key].append(value / seconds["Metallic BSDF", key[1]])
    noises = {key: noise(shown, made, key[1], options.samples) for key, made in materials.items()}
    title = f"{options.samples} samples; time and noise over Metallic BSDF"
    table = Table("material", "run as", "time", "spread", "noise", title=title)
    for (name, system), values in ratios.items():
        spread = f"{min(values):.2f} to {max(values):.2f}"
        louder = noises[name, system] / noises["Metallic BSDF", system]
        table.add_row(name, system, f"{statistics.median(values):.2f}", spread, f"{louder:.2f}")
    Console().print(table)
    print(f"Blender {'.'.join(map(str, bpy.app.version))}, median of {options.rounds} rounds")


if __name__ == "__main__":
    main()
