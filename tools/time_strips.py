# SPDX-License-Identifier: GPL-3.0-or-later
"""Contact strips of every preset that changes over time, one a row, and of some whose points have clocks of their own.

python tools/time_strips.py FILE.webp SPREADING.webp      the studio's shape at eight moments of each course;
                                                          the second file has the rows of points with their own clocks
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from PIL import Image, ImageDraw, ImageFont

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()

from vgroove.addon.blender import course, material, studio  # noqa: E402
from vgroove.addon.choose import automatic  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402

if TYPE_CHECKING:
    from vgroove.addon.library.presets import Preset

MOMENTS, TILE, HEADING, LABEL = 8, 132, 22, 16
PAPER, INK, GREY = (250, 250, 250), (40, 40, 40), (120, 120, 120)
SPREADING = {"rusting_iron": (6.0, 0.9), "copper_patina": (4.0, 0.8), "banana_ripening": (14.0, 0.6)}  # scale, lateness


def frames(shown: bpy.types.Scene, preset: Preset, clock: tuple[float, float] | None) -> list[Image.Image]:
    """The body at each moment; ``clock``: by noise of this scale, points are late by up to this much."""
    estimator = automatic.pick_estimator(shown, preset)
    length = MOMENTS - 1.0
    if clock:  # the last points start when the first have gone half their way
        length /= 1.0 + clock[1]
    play = course.Play("age" if clock else "curves", 1.0, length)
    made = material.build(preset, material.Choice("nodes", estimator, play=play))
    if clock:
        let_spread(made, *clock)
    studio.show(shown, preset, made)
    pictures = []
    for frame in range(1, MOMENTS + 1):
        shown.frame_set(frame)
        path = Path(__file__).parent.parent / "build" / "strip.webp"
        path.parent.mkdir(exist_ok=True)
        studio.picture(shown, path)
        pictures.append(Image.open(path).convert("RGB").resize((TILE, TILE), Image.Resampling.LANCZOS))
    bpy.data.materials.remove(made)
    return pictures


def let_spread(made: bpy.types.Material, scale: float, late: float) -> None:
    """Offset from noise, and an Age that goes on until the last points have come to the end."""
    node, tree = course.trajectory_node(made), made.node_tree
    assert node is not None
    place, noise, spread = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "MapRange"))
    noise.inputs["Scale"].default_value, noise.inputs["Detail"].default_value = 100.0 * scale / 6.0, 4.0
    for name, value in zip(("From Min", "From Max", "To Min", "To Max"), (0.3, 0.7, 0.0, late), strict=True):
        spread.inputs[name].default_value = value
    tree.links.new(place.outputs["Object"], noise.inputs["Vector"])
    tree.links.new(noise.outputs[0], spread.inputs["Value"])
    tree.links.new(spread.outputs[0], node.inputs["Offset"])
    (curve,) = material.curves(made)
    last = curve.keyframe_points[1]  # Age above 1: the clocks that are late need it
    node.inputs["Rate"].default_value = 1.0 + late
    last.co.x = float(MOMENTS)


def sheet() -> Image.Image:
    """A heading, eight tiles and their times for each preset."""
    with headless.quiet():
        shown = studio.scene()
    rows = [(preset, None) for preset in presets.shipped().values() if preset.time]
    rows += [(presets.find(f"time_varying/{name}"), clock) for name, clock in SPREADING.items()]
    height = HEADING + TILE + LABEL
    page = Image.new("RGB", (TILE * MOMENTS, height * len(rows)), PAPER)
    pen, font, small = ImageDraw.Draw(page), ImageFont.load_default(size=14), ImageFont.load_default(size=11)
    for index, (preset, clock) in enumerate(rows):
        top = index * height
        of = preset.time
        pen.text((6, top + 3), preset.name, fill=INK, font=font)
        note = "each point by its own clock: Offset from noise" if clock else of.kind
        pen.text((12 + pen.textlength(preset.name, font=font), top + 5), note, fill=GREY, font=small)
        with headless.quiet():
            pictures = frames(shown, preset, clock)
        for k, picture in enumerate(pictures):
            page.paste(picture, (TILE * k, top + HEADING))
            age = k / (MOMENTS - 1) * (1.0 + clock[1] if clock else 1.0)  # above 1 where points are late
            time = of.start + (of.end - of.start) * age
            unit = "" if of.unit == "share" else f" {of.unit}"
            pen.text((TILE * k + 6, top + HEADING + TILE + 1), f"{time:.3g}{unit}", fill=GREY, font=small)
        print(preset.id, flush=True)
    return page


if __name__ == "__main__":
    page = sheet()
    page.save(sys.argv[1], quality=80, method=6)
    bottom = len(SPREADING) * (HEADING + TILE + LABEL)
    page.crop((0, page.height - bottom, page.width, page.height)).save(sys.argv[2], quality=80, method=6)
