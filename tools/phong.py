# SPDX-License-Identifier: GPL-3.0-or-later
"""Phong, Blinn-Phong and Cook-Torrance side by side: one colour, one Roughness, one light, as a labelled sheet.

    python tools/phong.py FILE.webp

Every ball is the exact model (``mirror`` under the sky, the formula itself for the sun).
"""

from __future__ import annotations

import sys
from pathlib import Path

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - prepare() must come first
import matplotlib as mpl  # noqa: E402 - after prepare(), which Blender's own modules need
from mathutils import Vector  # noqa: E402

mpl.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from vgroove.addon.blender import material, slots  # noqa: E402
from vgroove.addon.blender.material import lamps_to_bind  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.headless import scene  # noqa: E402
from vgroove.nodegroups import versions  # noqa: E402

SAMPLES, TILE, SKY = 64, (240, 220), 0.25
RED, REFLECTED, SLOPE = "[0.5, 0.03, 0.025]", 0.05, 0.04  # head-on; the exponents of as wide a lobe
MODELS = {
    "Phong": f'model = "phong"\nalbedo = {RED}\nspecular = {REFLECTED}\nexponent = {(SLOPE**-2 - 1) / 2}',
    "Blinn-Phong": f'model = "blinn_phong"\nalbedo = {RED}\nspecular = {REFLECTED}\nshininess = {2 * SLOPE**-2 - 2}',
    "Cook-Torrance": f'model = "sum"\ncoupled = true\nd = 1.0\ns = 1.0\nalbedo = {RED}\nsigma = 0.0\nm = {SLOPE}\n'
    f"[fresnel]\nf0 = {REFLECTED}",
}
SUNS = {"light in front": (-0.5, -1.0, 0.9), "light behind": (-0.45, 1.0, 0.35)}


def render(text: str, sun: tuple[float, float, float], path: Path) -> None:
    """One ball under a dim grey sky and a sun in this direction."""
    preset = presets.parse(f'name = "Ball"\n{text}\n[source]\ndata = "tools/phong.py"', "sheet/ball", "sheet")
    with headless.quiet():
        shown = scene.preview()
        shown.objects["Sun"].rotation_euler = Vector(sun).to_track_quat("Z", "Y").to_euler()
        shown.world = bpy.data.worlds.new("Grey")
        tree = versions.nodes_of(shown.world)
        sky = tree.nodes.get("Background") or tree.nodes.new("ShaderNodeBackground")
        sky.inputs["Color"].default_value = (SKY, SKY, SKY, 1.0)
        made = material.build(preset, material.Choice("nodes", "mirror", lamps_to_bind(shown, "mirror", preset.model)))
        slots.apply(made, [shown.objects["Ball"]])
        scene.still(shown, path, samples=SAMPLES, seed=0, resolution=TILE)


def main() -> None:
    path = Path(sys.argv[1])
    figure, axes = plt.subplots(len(SUNS), len(MODELS), figsize=(7.2, 4.8), facecolor="white")
    tile = path.with_name("phong_tile.png")
    for row, (where, sun) in zip(axes, SUNS.items(), strict=True):
        for axis, (name, text) in zip(row, MODELS.items(), strict=True):
            render(text, sun, tile)
            axis.imshow(plt.imread(tile))
            axis.set_axis_off()
            axis.set_title(f"{name}, {where}", fontsize=9)
    tile.unlink()
    figure.tight_layout()
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    main()
