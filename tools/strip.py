# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials three times each: by Principled with matching inputs, by V-Groove's Standard, and by its Reference.

    python tools/strip.py FILE.webp

Shape, camera and lights are the same, and one low lamp lights all: models differ most at grazing angles. Reference
has no bias, so with many samples it shows the formula. Below a picture stands its mean difference from Reference, as a
share of Reference's mean, over the pixels that the object changes by a tenth or more.
"""

from __future__ import annotations

import sys
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()
from mathutils import Vector  # noqa: E402

from vgroove.addon.blender import images, material, principled, studio  # noqa: E402
from vgroove.addon.choose import automatic  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.lab import scenery  # noqa: E402

if TYPE_CHECKING:
    from bpy.types import Material, Scene
    from numpy.typing import NDArray

    from vgroove.addon.library.presets import Preset

SHOWN = {"metals/gold": 0.4, "car_paints/polaris_silver": None, "plastics/blue_plastic_matte": None}  # and m if another
SAMPLES = {"Principled": 64, "V-Groove": 64, "reference": 4096}
TILE, GAP, LABEL = 144, 12, 20
PAPER, INK, GREY = (250, 250, 250), (40, 40, 40), (120, 120, 120)
LOW = (-110.0, 14.0)  # degrees of the lamp: from the front to the right, above the ground
BRIGHTER, DIMMER = 4.0, 0.15  # the lamp's and the sky's light, as shares of the studio's


def as_principled(preset: Preset) -> Material:
    """Blender's own shader with the inputs that an export of the material has."""
    given = principled.describe(material.build(preset, material.Choice("nodes", "closure")))
    values = {name.replace(" ", "_"): one.value for name, one in given.items() if one.value is not None}
    return scenery.surface("Principled", lambda tree: scenery.add_node(tree, "BsdfPrincipled", **values))


def materials(shown: Scene, preset: Preset) -> dict[str, Material]:
    """The preset in the three ways."""
    standard = automatic.pick_estimator(shown, preset)
    return {
        "Principled": as_principled(preset),
        "V-Groove": material.build(preset, material.Choice("nodes", standard)),
        "reference": material.build(preset, material.Choice("nodes", "mirror")),
    }


def scene() -> Scene:
    """The previews' studio, nearer, in the light of one low lamp alone, without what biases a render."""
    shown = studio.scene()
    lamp, away = shown.objects["Key"], shown.objects["Key"].location.length
    lamp.rotation_euler = (radians(90.0 - LOW[1]), 0.0, radians(LOW[0]))
    lamp.location = lamp.rotation_euler.to_matrix() @ Vector((0.0, 0.0, away))
    lamp.data.energy *= BRIGHTER
    shown.objects["Fill"].hide_render = True
    scenery.background(shown.world).inputs["Strength"].default_value = DIMMER
    shown.camera.data.lens, shown.camera.data.shift_y = 125.0, 0.23
    shown.cycles.sample_clamp_indirect = 0.0
    shown.render.resolution_x = shown.render.resolution_y = TILE
    return shown


def render(shown: Scene, preset: Preset, made: Material, samples: int) -> tuple[Image.Image, NDArray[np.float32]]:
    """The render as one sees it, and its linear pixels."""
    studio.show(shown, preset, made)
    return _rendered(shown, samples)


def _rendered(shown: Scene, samples: int) -> tuple[Image.Image, NDArray[np.float32]]:
    shown.cycles.samples = samples
    bpy.ops.render.render()
    result, settings = bpy.data.images["Render Result"], shown.render.image_settings
    path = Path(bpy.app.tempdir) / "strip"
    for kind, depth in (("PNG", "8"), ("OPEN_EXR", "32")):
        settings.file_format, settings.color_depth = kind, depth
        result.save_render(f"{path}.{kind}", scene=shown)
    return Image.open(f"{path}.PNG").convert("RGB"), images.load(Path(f"{path}.OPEN_EXR"))[..., :3]


def difference(found: NDArray[np.float32], truth: NDArray[np.float32], empty: NDArray[np.float32]) -> float:
    """The mean difference as a share of the mean, where ``truth`` is not as ``empty``, the scene without the object."""
    inside = np.any(np.abs(truth - empty) >= 0.1 * empty, axis=-1)
    return float(np.abs(found - truth)[inside].mean() / truth[inside].mean())


def strip() -> Image.Image:
    """A tile for each material in each way, in one row."""
    width = len(SHOWN) * (3 * TILE + GAP) - GAP
    page = Image.new("RGB", (width, TILE + 2 * LABEL), PAPER)
    pen, font = ImageDraw.Draw(page), ImageFont.load_default(size=13)
    with headless.quiet():
        shown = scene()
        for one in shown.collection.children:
            one.hide_render = True
        empty = _rendered(shown, SAMPLES["Principled"])[1]
    for column, (name, m) in enumerate(SHOWN.items()):
        preset = presets.find(name)
        preset = preset if m is None else preset.with_parameters(m=m)
        with headless.quiet():
            ways = materials(shown, preset)
            made = {way: render(shown, preset, one, SAMPLES[way]) for way, one in ways.items()}
        truth = made["reference"][1]
        for k, (way, (tile, pixels)) in enumerate(made.items()):
            left = column * (3 * TILE + GAP) + k * TILE
            page.paste(tile, (left, LABEL))
            label = way if way == "reference" else f"{way}: {difference(pixels, truth, empty):.0%}"
            pen.text((left + TILE / 2, TILE + LABEL + 2), label, fill=GREY, font=font, anchor="ma")
            print(name, label, flush=True)
        title = preset.name if m is None else f"{preset.name}, roughness {m**0.5:.2g}"
        pen.text((column * (3 * TILE + GAP) + 1.5 * TILE, 2), title, fill=INK, font=font, anchor="ma")
    return page


if __name__ == "__main__":
    strip().save(sys.argv[1], quality=85, method=6)
