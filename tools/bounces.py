# SPDX-License-Identifier: GPL-3.0-or-later
"""Rough copper by one bounce, and with light that bounces within the grooves, as a labelled sheet.

python tools/bounces.py FILE.webp
"""

from __future__ import annotations

import sys
from pathlib import Path

from vgroove import headless

headless.prepare()

import matplotlib as mpl  # noqa: E402 - after prepare(), which Blender's own modules need

mpl.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402

from vgroove.addon.blender import material, slots  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.headless import scene  # noqa: E402

SAMPLES, TILE = 48, (200, 190)
EXPOSURE = -1.0  # or the brightest parts lose their colour
SLOPES = (0.2, 0.5, 0.8)
ROWS = {"one bounce": False, "Multiple Scattering": True}


def render(m: float, path: Path, *, bounces: bool) -> None:
    """One ball in the preview scene."""
    preset = presets.find("metals/copper").with_parameters(m=m)
    with headless.quiet():
        shown = scene.preview()
        slots.apply(material.build(preset, material.Choice(bounces=bounces)), [shown.objects["Ball"]])
        shown.view_settings.exposure = EXPOSURE
        scene.still(shown, path, samples=SAMPLES, seed=0, resolution=TILE)


def main() -> None:
    path = Path(sys.argv[1])
    figure, axes = plt.subplots(len(ROWS), len(SLOPES), figsize=(6.4, 4.4), facecolor="white")
    tile = path.with_name("bounces_tile.png")
    for row, (name, bounces) in zip(axes, ROWS.items(), strict=True):
        for axis, m in zip(row, SLOPES, strict=True):
            render(m, tile, bounces=bounces)
            axis.imshow(plt.imread(tile))
            axis.set_axis_off()
            axis.set_title(f"m = {m:g}, {name}", fontsize=9)
    tile.unlink()
    figure.tight_layout()
    figure.savefig(path, dpi=100)


if __name__ == "__main__":
    main()
