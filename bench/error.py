# SPDX-License-Identifier: GPL-3.0-or-later
"""Error of each estimator against the V-groove model, noise and bias together, against run time, on three scenes.

    python bench/error.py [--write] [--json FILE]   --write: also docs/error.md and its picture; what FILE holds is not
                                                    measured anew

A copper ball alone, so that all its light comes straight from a lamp or the world: an environment map whose brightest
spots are held to 3, as the truth of it would need too many samples else; a softbox (an area lamp of 1 m, 2.5 m away);
a sun of half a degree under a dim, even sky. The truth is the sum of two images: the world by ``mirror``, the lamp by
``direct``, which ``vgroove check`` holds against the reference. The error is the root mean square of what differs, as
a share of the root mean square of the truth, over the pixels of the ball; the truth's own noise drops out of it, as
the differences from truths of several seeds are multiplied with each other. Times are of the processor, which other
work on the machine changes little, over those of ``closure`` at as many samples in the same round.
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict, dataclass
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from vgroove.addon import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from vgroove.addon import gonio, material, presets, scene  # noqa: E402

if TYPE_CHECKING:
    from bpy.types import Scene
    from numpy.typing import NDArray

SIZE = 32
SLOPES = (0.1, 0.3, 0.6)
SAMPLES = (16, 64, 256, 1024, 4096)
WORLD_SAMPLES, LAMP_SAMPLES, TRUTHS = 16384, 32768, 4  # samples of each of the truths
SCENES = ("environment", "softbox", "sun")
LABELS = {"environment": "environment map", "softbox": "softbox", "sun": "half-degree sun, dim sky"}
BRIGHTEST = 3.0
DOCS = Path(__file__).parent.parent / "docs"
TABLE, PICTURE = DOCS / "error.md", DOCS / "images" / "error.png"


@dataclass(frozen=True)
class Measured:
    """The error and the run time of each estimator at one sample count; times over that of ``closure``."""

    scene: str
    m: float
    samples: int
    errors: dict[str, float]
    times: dict[str, float]
    seconds: float  # of closure


def stage(name: str) -> Scene:
    """The ball under one of ``SCENES``."""
    shown = scene.preview("studio")
    for item in [shown.objects["Floor"], shown.objects["Sun"]]:
        bpy.data.objects.remove(item)
    shown.render.resolution_x = shown.render.resolution_y = SIZE
    shown.render.image_settings.file_format, shown.render.image_settings.color_depth = "OPEN_EXR", "32"
    shown.view_settings.view_transform = "Raw"
    shown.camera.location, shown.camera.rotation_euler = (0.0, -6.0, 1.0), (radians(90.0), 0.0, 0.0)
    shown.camera.data.lens = 90
    tree = shown.world.node_tree
    background = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeBackground")
    if name == "environment":
        held = tree.nodes.new("ShaderNodeVectorMath")
        held.operation, held.inputs[1].default_value = "MINIMUM", (BRIGHTEST,) * 3
        tree.links.new(background.inputs["Color"].links[0].from_socket, held.inputs[0])
        tree.links.new(held.outputs[0], background.inputs["Color"])
        return shown
    tree.links.remove(background.inputs["Color"].links[0])
    level = 0.05 if name == "sun" else 0.0
    background.inputs["Color"].default_value = (level, level, level, 1.0)
    light = bpy.data.lights.new("Lamp", "AREA" if name == "softbox" else "SUN")
    if name == "softbox":
        light.energy, light.size = 60.0, 1.0
    else:
        light.energy, light.angle = 2.0, radians(0.53)
    lamp = bpy.data.objects.new("Lamp", light)
    lamp.location, lamp.rotation_euler = (1.3, -1.6, 2.6), (radians(45.0), 0.0, radians(39.0))
    shown.collection.objects.link(lamp)
    shown.view_layers[0].update()
    return shown


def image(shown: Scene, m: float, estimator: str, samples: int, seed: int = 0) -> NDArray[np.float64]:
    """Linear RGB of the ball of slope ``m``."""
    preset = presets.find("lecture/copper").with_parameters(m=m)
    made = material.build(preset, material.Choice("nodes", estimator, scene.lamps_to_bind(shown, estimator)))
    shown.objects["Ball"].active_material = made
    shown.view_layers[0].update()
    shown.cycles.samples, shown.cycles.seed = samples, seed
    return gonio.rendered(shown).astype(np.float64)


def truth(shown: Scene, m: float, seed: int) -> NDArray[np.float64]:
    """The world by ``mirror``, the lamp by ``direct``."""
    lamp = shown.objects.get("Lamp")
    total = np.zeros((SIZE, SIZE, 3))
    if lamp is not None:
        world, shown.world = shown.world, None
        total += image(shown, m, "direct", LAMP_SAMPLES, seed)
        shown.world = world
        lamp.hide_render = True
    total += image(shown, m, "mirror", WORLD_SAMPLES if lamp is None else WORLD_SAMPLES // 16, seed)
    if lamp is not None:
        lamp.hide_render = False
    return total


def mean_square(parts: list[NDArray[np.float64]]) -> float:
    """Mean square of what ``parts`` have in common, without the independent noise of each."""
    total, count = np.sum(parts, axis=0), len(parts)
    products = total**2 - np.sum(np.square(parts), axis=0)  # of each part with each other one
    return max(0.0, float(np.mean(products)) / (count * (count - 1)))


def ball() -> NDArray[np.bool_]:
    """The pixels that show the ball alone, a little inside its outline."""
    x, y = np.meshgrid((np.arange(SIZE) + 0.5) / SIZE - 0.5, (np.arange(SIZE) + 0.5) / SIZE - 0.5)
    radius = 90.0 / 36.0 / np.sqrt(6.0**2 - 1.0)  # of a unit ball 6 m away, as a share of the picture's width
    return np.hypot(x, y) < radius - 1.5 / SIZE


def measure(name: str, m: float) -> list[Measured]:
    """One scene and slope, every estimator at each sample count; the median of three seeds."""
    found = []
    seen = ball()
    with headless.quiet():
        shown = stage(name)
        truths = [truth(shown, m, seed)[seen] for seed in range(101, 101 + TRUTHS)]
        scale = np.sqrt(mean_square(truths))
        # Without lamps corrected is fit, and direct is black.
        estimators = [e for e in material.ESTIMATORS if shown.objects.get("Lamp") or e not in material.EVERY_LAMP]
        for estimator in estimators:
            image(shown, m, estimator, 1)  # loads and compiles
        for samples in SAMPLES:
            rounds = [{e: timed(shown, m, e, samples, seed) for e in estimators} for seed in (1, 2, 3)]
            errors, times = {}, {}
            for e in estimators:
                off = [mean_square([one[e][0][seen] - exact for exact in truths]) for one in rounds]
                errors[e] = float(np.sqrt(np.median(off)) / scale)
                times[e] = float(np.median([one[e][1] / one["closure"][1] for one in rounds]))
            seconds = float(np.median([one["closure"][1] for one in rounds]))
            found.append(Measured(name, m, samples, errors, times, seconds))
    return found


def timed(shown: Scene, m: float, estimator: str, samples: int, seed: int) -> tuple[NDArray[np.float64], float]:
    """The image, and the processor seconds that it took."""
    start = time.process_time()
    pixels = image(shown, m, estimator, samples, seed)
    return pixels, time.process_time() - start


def picks(name: str) -> dict[tuple[float, int], str]:
    """What ``auto`` takes in a scene, by slope and samples."""
    found = {}
    with headless.quiet():
        shown = stage(name)
    for m in SLOPES:
        for samples in SAMPLES:
            shown.cycles.samples = samples
            found[m, samples] = scene.pick_estimator(shown, m)
    return found


def markdown(rows: list[Measured], picked: dict[str, dict[tuple[float, int], str]]) -> str:
    """docs/error.md."""
    lines = [
        "# Error of each estimator against the V-groove model",
        "",
        "Root mean square of bias and noise together, in percent of the picture's, on a copper ball; median of three",
        "seeds, by samples a pixel. In brackets: processor time over that of closure at as many samples, in the same",
        "round; at 16 and 64 samples most of it is what a render needs to start. **Bold**: what Automatic picks.",
        "Direct sees bound lamps alone, and next to nothing under a sky. `python bench/error.py --write` made it.",
        "",
        "![Error against run time](images/error.png)",
    ]
    for name in SCENES:
        lines += ["", f"## {LABELS[name].capitalize()}", ""]
        columns = [e for e in material.ESTIMATORS if any(e in row.errors for row in rows if row.scene == name)]
        lines += ["| m | samples | " + " | ".join(columns) + " |", "| --- " * (len(columns) + 2) + "|"]
        for row in rows:
            if row.scene == name:
                cells = [f"{100 * row.errors[e]:.3g} ({row.times[e]:.2f})" for e in columns]
                cells = [
                    f"**{c}**" if e == picked[name][row.m, row.samples] else c
                    for c, e in zip(cells, columns, strict=True)
                ]
                lines.append(f"| {row.m:g} | {row.samples} | " + " | ".join(cells) + " |")
    return "\n".join([*lines, ""])


def plot(rows: list[Measured]) -> None:
    """Error against run time, a panel for each scene and slope; a dot for each sample count."""
    with plt.rc_context({"font.size": 8, "axes.grid": True, "grid.alpha": 0.25, "axes.spines.top": False}):
        figure, axes = plt.subplots(len(SCENES), len(SLOPES), figsize=(9, 8), sharex=True, layout="constrained")
        for (name, m), ax in zip(((name, m) for name in SCENES for m in SLOPES), axes.flat, strict=True):
            here = [row for row in rows if (row.scene, row.m) == (name, m)]
            for index, e in enumerate(material.ESTIMATORS):
                if e in here[0].errors:
                    seconds = [row.times[e] * row.seconds for row in here]
                    ax.loglog(seconds, [100 * row.errors[e] for row in here], ".-", label=e, color=f"C{index}", lw=1.2)
            ax.set_title(f"{LABELS[name]}, m = {m:g}", fontsize=8)
        axes[1, 0].set_ylabel("error, % of the picture")
        axes[-1, 1].set_xlabel("processor seconds a render (32 x 32 pixels, 16 to 4096 samples)")
        figure.legend(*axes[1, 0].get_legend_handles_labels(), loc="outside upper center", ncols=6, frameon=False)
        figure.savefig(PICTURE, dpi=100)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--write", action="store_true", help="write docs/error.md")
    parser.add_argument("--json", type=Path, help="write the numbers here too")
    options = parser.parse_args()
    rows: list[Measured] = []
    if options.json and options.json.exists():
        rows = [Measured(**row) for row in json.loads(options.json.read_text())]
    known = {(row.scene, row.m) for row in rows}
    for name, m in ((name, m) for name in SCENES for m in SLOPES if (name, m) not in known):
        rows += measure(name, m)
        Console(stderr=True).print(f"{name}, m = {m:g}")
        if options.json:
            options.json.write_text(json.dumps([asdict(row) for row in rows]))
    rows.sort(key=lambda row: (SCENES.index(row.scene), row.m, row.samples))
    picked = {name: picks(name) for name in SCENES}
    table = Table("scene", "m", "samples", *material.ESTIMATORS, "picked", "over best")
    for row in rows:
        cells = [f"{row.errors[e]:.3%}" if e in row.errors else "" for e in material.ESTIMATORS]
        pick = picked[row.scene][row.m, row.samples]
        over = row.errors[pick] / min(row.errors.values())
        table.add_row(row.scene, f"{row.m:g}", str(row.samples), *cells, pick, f"{over:.2f}")
    Console(width=150).print(table)
    if options.write:
        TABLE.write_text(markdown(rows, picked), encoding="utf-8")
        plot(rows)


if __name__ == "__main__":
    main()
