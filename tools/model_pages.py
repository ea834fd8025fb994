# SPDX-License-Identifier: GPL-3.0-or-later
"""What a model's page shows that has to be rendered: docs/models/NAME.webp and docs/models/measured.json.

python tools/model_pages.py               every model
python tools/model_pages.py ward glass    those alone

A strip has a row for each parameter, five balls over its range. What is measured, of one preset in Cycles: by how much
each estimator's f differs from the reference, and its albedo under an even sky.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from vgroove import headless

headless.prepare()

from vgroove.addon.blender import gonio, studio  # noqa: E402 - after prepare()
from vgroove.addon.choose import picture  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.addon.library.files import write_text  # noqa: E402
from vgroove.addon.models import MODELS, estimators, label, lobe_of, parameter  # noqa: E402
from vgroove.addon.reference import albedo  # noqa: E402

if TYPE_CHECKING:
    from bpy.types import Scene

    from vgroove.addon.library.presets import Preset
    from vgroove.addon.models import Number, Parameter

FOLDER = Path(__file__).parent.parent / "docs" / "models"
MEASURED = FOLDER / "measured.json"
SHOWN = {  # the preset of a page; of other models the first that is shipped
    "cook_torrance": "metals/copper", "oren_nayar": "diffuse/plaster",
    "anisotropic": "finished_metals/aluminium_hair_line",
    "glass": "glasses/bk7_crown_glass", "sum": "plastics/red_plastic", "car_paint": "car_paints/blue",
    "translucent": "translucent/marble", "ward": "finished_metals/brushed_aluminium_sheet",
    "generator": "merl_fits/alum_bronze_merl", "phong": "phong/phong_red_plastic",
    "blinn_phong": "phong/blinn_phong_red_plastic", "ashikhmin_shirley": "ashikhmin_shirley/brushed_aluminium_as",
}  # fmt: skip
# Of parameters whose range is not 0 to 1. Colours have no row, nor has what a picture does not show.
VALUES: dict[str, tuple[Number, ...]] = {
    "eta": (1.1, 1.33, 1.5, 2.0, 2.4), "absorption": (0.0, 3.0, 10.0, 30.0, 100.0),
    "mean_free_path": (1e-4, 3e-4, 1e-3, 3e-3, 1e-2), "rotation": (0.0, 0.125, 0.25, 0.375, 0.5),
}  # fmt: skip
UNSEEN = {"abbe"}
FIRST_LOBE = "Lobe 1 "
STEPS, TILE, GAP, LABEL = 5, 64, 4, 14
THETA = (20.0, 60.0)  # degrees of the sun
SKY_VIEWS, SKY_SAMPLES = (4, 8), 1024  # pixels of the hemisphere: Blender renders no fewer than four in a row


def shown(model: str) -> Preset | None:
    """The preset of a model's page; None of a model without one."""
    if model in SHOWN:
        return presets.find(SHOWN[model])
    return next((one for one in presets.shipped().values() if one.model == model and one.time is None), None)


def rows(preset: Preset) -> dict[str, list[Preset]]:
    """By parameter, what a row shows; of several lobes the first. Values that the other numbers forbid are left out."""
    found = {}
    for key in preset.parameters:
        if lobe_of(key) in {"", FIRST_LOBE}:
            made = [changed for value in values(parameter(key)) if (changed := _changed(preset, key, value))]
            if len(made) > 1:
                found[key] = made
    return found


def values(one: Parameter) -> tuple[Number, ...]:
    """Over the range of its input in Blender, from 0.05 of a roughness."""
    if one.name in VALUES:
        return VALUES[one.name]
    if one.is_rgb or one.name in UNSEEN or one.low == one.high:
        return ()
    low, high = sorted((float(one.scale.to_input(one.low)), float(one.scale.to_input(one.high))))
    inputs = np.linspace(
        max(low, 0.05 if one.is_roughness else 0.0), min(high, 1.0 if one.is_roughness else high), STEPS
    )
    return tuple(float(one.scale.of_input(value)) for value in inputs)


def _changed(preset: Preset, name: str, value: Number) -> Preset | None:
    try:
        return preset.with_parameters(**{name: value})
    except presets.PresetError:
        return None


def strip(stage: Scene, found: dict[str, list[Preset]], folder: Path) -> Image.Image:
    """A row of balls for each parameter, with its input's value above each."""
    width, height = STEPS * (TILE + GAP) + GAP, TILE + LABEL + GAP
    sheet = Image.new("RGB", (width, height * len(found)), (250, 250, 250))
    draw, font = ImageDraw.Draw(sheet), ImageFont.load_default(10)
    for row, (name, made) in enumerate(found.items()):
        for column, each in enumerate(made):
            file = folder / f"{name}_{column}.webp"
            picture.render(stage, replace(each, tags=()), file)  # without its tags it is a ball
            x, y = GAP + column * (TILE + GAP), row * height
            with Image.open(file) as tile:
                sheet.paste(tile, (x, y + LABEL))
            value = each.parameters[name]
            first = float(value[0] if isinstance(value, tuple) else value)
            draw.text((x, y), f"{parameter(name).scale.to_input(first):.3g}", (40, 40, 40), font)
    return sheet


@dataclass(frozen=True)
class Difference:
    """Of an estimator from the reference. l1: |f - f_ref| cos over f_ref cos, by angle of the sun; None: not measured.

    sky: of the whole hemisphere's albedo, as a share; None for what sees no sky.
    """

    l1: tuple[float, ...] | None
    sky: float | None


def differences(preset: Preset) -> dict[str, Difference]:
    """By estimator. f is not measured of what draws facets at random, or sends light through."""
    model = preset.reference()
    found = {}
    for name in preset.spec.estimators:
        of, l1, sky = estimators.ESTIMATORS[name], None, None
        if not of.random and not preset.transparent:
            l1 = tuple(_l1(preset, name, model, theta) for theta in THETA)
        if of.native or of.random:
            sky = _sky(preset, name, model)
        found[name] = Difference(l1, sky)
    return found


def _l1(preset: Preset, estimator: str, model: object, theta: float) -> float:
    geometry = gonio.Geometry(theta, resolution=(128, 128))
    wo, wi = geometry.wo(), geometry.wi()
    with headless.quiet():
        got = gonio.measure_preset(preset, "nodes", estimator, geometry, shading_osl=False)
    true = model.evaluate(wi, wo)
    weight = (wo[..., 2] * np.sqrt(1.0 - wo[..., 2] ** 2))[..., None]
    return float(np.sum(np.abs(got - true) * weight) / np.sum(true * weight))


def _sky(preset: Preset, estimator: str, model: object) -> float:
    geometry = gonio.Geometry(resolution=SKY_VIEWS, furnace=True)
    wo = geometry.wo()
    with headless.quiet():
        got = gonio.measure_preset(preset, "nodes", estimator, geometry, samples=SKY_SAMPLES, shading_osl=False)
    weight = (wo[..., 2] * np.sqrt(1.0 - wo[..., 2] ** 2))[..., None]
    true = albedo(model, wo)
    return float(np.sum((got - true) * weight) / np.sum(true * weight))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="MODEL")
    arguments = parser.parse_args()
    chosen = [MODELS[name] for name in arguments.names or MODELS]
    kept = json.loads(MEASURED.read_text(encoding="utf-8")) if MEASURED.is_file() else {}
    with headless.quiet():
        stage = studio.scene()
    stage.render.resolution_x = stage.render.resolution_y = TILE
    for model in chosen:
        if preset := shown(model.name):
            if found := rows(preset):
                with tempfile.TemporaryDirectory() as folder, headless.quiet():
                    made = strip(stage, found, Path(folder))
                made.save(FOLDER / f"{model.name}.webp", quality=85, method=6)
            kept[model.name] = {
                "preset": preset.id,
                "rows": [label(model.name, name) for name in found],
                "differences": {name: asdict(of) for name, of in differences(preset).items()},
            }
            write_text(MEASURED, json.dumps(kept, indent=1, sort_keys=True) + "\n")
            print(f"{model.name}: {kept[model.name]}", flush=True)


if __name__ == "__main__":
    main()
