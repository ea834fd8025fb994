# SPDX-License-Identifier: GPL-3.0-or-later
"""Every preset as an asset for Blender's Asset Browser: assets/VERSION/vgroove.blend, and its catalogs beside it.

python tools/assets.py [FOLDER]

Pictures come from previews/ (tools/previews.py); without one an asset has Blender's own icon. Each Blender has a file
of its own: 4.5 has no exact Fresnel term of a dielectric in its lobes, and builds what comes nearest of other nodes.
"""

from __future__ import annotations

import sys
import uuid
from pathlib import Path

from vgroove import headless

headless.prepare()

import bpy  # noqa: E402 - after prepare()
import numpy as np  # noqa: E402

from vgroove.addon.blender import (  # noqa: E402
    assets,
    course,
    material,
)
from vgroove.addon.choose import automatic  # noqa: E402
from vgroove.addon.library import families, presets  # noqa: E402
from vgroove.addon.library.files import replacing  # noqa: E402

PREVIEWS = Path(__file__).parent.parent / "previews"
CATALOGS = uuid.UUID("5b1c3a0e-6f0d-4d53-9b3e-0d3b8f3a7c11")  # catalogs keep their ids for ever: families hang on it
PIXELS = 128  # as large as the Asset Browser shows them; pictures are most of the file
AUTHOR, LICENCE = "The vgroove authors", "GPL-3.0-or-later"


def catalog(title: str) -> uuid.UUID:
    """The id of a family's catalog, by its first folder."""
    return uuid.uuid5(CATALOGS, next(family["folders"][0] for family in families.TABLE if family["title"] == title))


def catalogs() -> str:
    """blender_assets.cats.txt: a catalog a family below one of our own."""
    lines = [f"{CATALOGS}:V-Groove:V-Groove"]
    lines += [f"{catalog(title)}:V-Groove/{title}:V-Groove-{title}" for title in sorted(families.TITLES)]
    return "VERSION 1\n\n" + "\n".join(lines) + "\n"


def as_asset(preset: presets.Preset, name: str) -> bpy.types.Material:
    """A material for any scene, marked as an asset; what changes plays its course."""
    estimator = automatic.pick_estimator(None, preset)
    play = course.Play() if preset.time else None
    bounces = families.gets_bounces(preset)
    made = material.build(preset, material.Choice("nodes", estimator, bounces=bounces, play=play))
    made.name = name
    made.asset_mark()
    data = made.asset_data
    data.catalog_id = str(catalog(families.of(preset)))
    data.author, data.license = AUTHOR, LICENCE
    data.description = f"{preset.name}: {preset.source['trust']}. Source: {preset.source['data']}"
    for tag in dict.fromkeys((preset.family.replace("_", " "), *preset.tags)):
        data.tags.new(tag)
    if hasattr(data, "use_preferred_import_method"):  # 5.2, which would pack assets so that they cannot be edited
        data.use_preferred_import_method, data.preferred_import_method = True, "APPEND"
    picture = PREVIEWS / f"{preset.id}.webp"
    if picture.exists():
        show(made, picture)
    return made


def show(made: bpy.types.Material, picture: Path) -> None:
    image = bpy.data.images.load(str(picture))
    image.scale(PIXELS, PIXELS)
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    preview = made.preview_ensure()
    preview.image_size = (PIXELS, PIXELS)
    preview.image_pixels_float.foreach_set(pixels)


def write(folder: Path) -> Path:
    """The library below ``folder``; empties this session."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.engine = "CYCLES"
    shown = presets.shipped().values()
    names = [preset.name.casefold() for preset in shown]
    for preset in shown:
        alone = names.count(preset.name.casefold()) == 1
        as_asset(preset, preset.name if alone else f"{preset.name} ({preset.family})")
    folder /= assets.version()
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / assets.FILE
    with replacing(path) as temporary:
        bpy.ops.wm.save_as_mainfile(filepath=str(temporary), compress=True, copy=True)
    with replacing(folder / "blender_assets.cats.txt") as temporary:
        temporary.write_text(catalogs(), encoding="utf-8")
    return path


def main() -> None:
    with headless.quiet():
        path = write(Path(sys.argv[1]) if len(sys.argv) > 1 else assets.FOLDER)
    count = len(presets.shipped())
    print(f"{path}: {count} materials, {path.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
