# SPDX-License-Identifier: GPL-3.0-or-later
"""The six lecture materials on one labelled sheet, and below it a table of Cycles against NumPy.

    python tools/demo.py FILE.png

Every ball is the exact model (``mirror`` under the environment map, the formula itself for the sun).
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from rich.console import Console
from rich.table import Table

from vgroove import headless

headless.prepare()

import matplotlib as mpl  # noqa: E402 - after prepare(), which Blender's own modules need

mpl.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from vgroove.addon.blender import material, slots  # noqa: E402
from vgroove.addon.blender.material import lamps_to_bind  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.headless import scene  # noqa: E402
from vgroove.lab.check.rows import SETUPS  # noqa: E402
from vgroove.lab.check.views import direct_bar, noiseless_row  # noqa: E402

NAMES = ("water", "plastic", "glass", "diamond", "copper", "aluminium")
SAMPLES = 128
TILE = (320, 260)


def render(preset: presets.Preset, path: Path) -> None:
    """One ball to ``path``."""
    with headless.quiet():
        shown = scene.preview()
        lamps = lamps_to_bind(shown, "mirror")
        made = material.build(preset, material.Choice("nodes", "mirror", lamps))
        slots.apply(made, [shown.objects["Ball"]])
        scene.still(shown, path, samples=SAMPLES, seed=0, resolution=TILE)


def sheet(tiles: dict[str, Path], path: Path) -> None:
    """All tiles in a grid, each with its name and numbers."""
    figure, axes = plt.subplots(2, 3, figsize=(10.8, 6.9), facecolor="white")
    for axis, (name, tile) in zip(axes.flat, tiles.items(), strict=True):
        preset = presets.find(f"lecture/{name}")
        f0 = preset.parameters["f0"]
        f0 = f0[:1] if len(set(f0)) == 1 else f0
        axis.imshow(plt.imread(tile))
        axis.set_axis_off()
        axis.set_title(f"{preset.name}   F0 {' '.join(f'{value:g}' for value in f0)}   m {preset.m:g}", fontsize=11)
    figure.suptitle(
        f"Cook-Torrance as its paper defines it, in Cycles: {SAMPLES} samples, estimator mirror", fontsize=12
    )
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)


def agreement() -> Table:
    """Largest difference between Cycles and NumPy for each lecture material, over 10 views each."""
    table = Table(
        "material", "m", "direct, nodes", "direct, OSL", "bar", title="Cycles against NumPy, share of the peak"
    )
    for name in NAMES:
        preset = presets.find(f"lecture/{name}")
        rows = [
            noiseless_row("direct", setup, preset, direct_bar(preset.m), variant=preset.kind, at={"m": preset.m})
            for setup in (SETUPS[0], SETUPS[2])
        ]
        table.add_row(preset.name, f"{preset.m:g}", *(f"{row.error:.1e}" for row in rows), f"{rows[0].bar:.0e}")
    return table


def main() -> None:
    path, console, start = Path(sys.argv[1]), Console(), time.perf_counter()
    folder = path.parent / "tiles"
    folder.mkdir(parents=True, exist_ok=True)
    tiles = {}
    for name in NAMES:
        tiles[name] = folder / f"{name}.png"
        render(presets.find(f"lecture/{name}"), tiles[name])
        console.print(f"rendered {name}", highlight=False)
    sheet(tiles, path)
    console.print(agreement())
    console.print(f"{path}, after {time.perf_counter() - start:.0f} s", highlight=False)
    console.print(f"Now render one yourself: {next_command()}", highlight=False, soft_wrap=True)


def next_command() -> str:
    """A line that runs from this folder as it is printed: uv need not be on PATH."""
    vgroove = os.path.relpath(Path(sys.executable).with_name("vgroove"))
    return f"{vgroove} render copper -o copper.png"


if __name__ == "__main__":
    main()
