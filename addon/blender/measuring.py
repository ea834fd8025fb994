# SPDX-License-Identifier: GPL-3.0-or-later
"""What the BRDF Viewer's curves are in Cycles: any material, measured at points of them by the gonioreflectometer.

``main`` does so in a Blender of its own, with a material that ``hand_over`` has written to a folder, so that the one
with the window goes on.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ..library.files import replacing
from ..measured import curves
from ..models.estimators import NATIVE
from ..reference.lobe import ACROSS, ALBEDO, PLANE, PLOTS, THETA_H
from . import colour_space, gonio, material, origin

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Scene
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

ROWS = 45  # of a slice, on each side of the normal
SKY_ROWS = 15
HALF = 88.0 * np.square((np.arange(16) + 0.5) / 16.0)  # degrees
# Four columns of the hemisphere are at 45, 135, 225 and 315 degrees: a light at 45 has its plane of incidence and the
# one across in one image.
COLUMNS, LIGHT_AT = 4, 45.0
SAMPLES, SKY_SAMPLES = 16, 256  # many of a slice's are for textures alone, as a sun of zero size brings no noise
BLEND, REQUEST, PROGRESS, POINTS = "material.blend", "request.json", "progress", "points.npz"  # in the folder


@dataclass(frozen=True)
class Points:
    """Measured values along one plot.

    at: the plot's angle in degrees, (n,). rgb: f in 1/sr, or the albedo, in linear Rec.709, (n, 3). cosines: of theta_i
    and theta_o, (n, 2); 1 of an albedo.
    """

    at: Floats
    rgb: Floats
    cosines: Floats

    def weighted(self, times: str) -> Floats:
        """``rgb`` times the cosines that ``times``, of ``lobe.TIMES``, names."""
        among = {"one": self.cosines[:, :0], "cos_o": self.cosines[:, 1:], "cos_io": self.cosines}[times]
        return self.rgb * among.prod(axis=1, keepdims=True)


def measure(
    of: Material, theta_i: float, phi_i: float, *, shading_osl: bool = False,
    progress: Callable[[float], None] = lambda _share: None,
) -> dict[str, Points]:  # fmt: skip
    """f of any material in 1/sr, and its albedo, as Cycles renders it, by plot. Degrees; phi from its tangent.

    The sun is a direction, and the sky of the albedo white. Where the material evaluates lights by the formula, it is
    rebuilt from its numbers for the instrument's own light: its textures are then not measured. progress: 0 to 1.
    """
    done, steps = 0, len(HALF) + 2

    def step() -> None:
        nonlocal done
        done += 1
        progress(done / steps)

    def made(scene: Scene) -> Material:
        return _for_instrument(of, scene)

    # The material turns below the light, not the light.
    lit = gonio.Geometry(theta_i, resolution=(COLUMNS, ROWS), phi_i=LIGHT_AT, tangent=LIGHT_AT - phi_i)
    sky = replace(lit, resolution=(COLUMNS, SKY_ROWS), furnace=True)
    image = _rendered(made, lit, SAMPLES, shading_osl)
    step()
    albedo = _rendered(made, sky, SKY_SAMPLES, shading_osl)[:, 0]
    step()
    theta = _rows(ROWS)
    at = np.concatenate([-theta[::-1], theta])
    sides = {PLANE: (0, 2), ACROSS: (1, 3)}  # columns of the light's side and of the other
    cosines = np.cos(np.radians(np.stack([np.full_like(at, theta_i), at], axis=-1)))
    found = {
        plot: Points(at, np.concatenate([image[::-1, low], image[:, high]]), cosines)
        for plot, (low, high) in sides.items()
    }
    found[ALBEDO] = Points(_rows(SKY_ROWS), albedo, np.ones((SKY_ROWS, 2)))
    wi, wo = curves.pairs(HALF, np.full_like(HALF, theta_i), curves.View(theta_i, phi_i))
    above = (wi[:, 2] > 0.0) & (wo[:, 2] > 0.0)
    values = gonio.measure_pairs(
        made, wi[above], wo[above], samples=SAMPLES, shading_osl=shading_osl, seen=step
    )  # fmt: skip
    found[THETA_H] = Points(HALF[above], values.astype(np.float64), np.stack([wi[above, 2], wo[above, 2]], axis=-1))
    progress(1.0)
    return found


def _rows(count: int) -> Floats:
    """theta_o of an image's rows, in degrees."""
    return 90.0 * (np.arange(count) + 0.5) / count


def _rendered(
    make: Callable[[Scene], Material],
    geometry: gonio.Geometry,
    samples: int,
    shading_osl: bool,  # noqa: FBT001
) -> Floats:
    with gonio.instrument(make, geometry, samples=samples, shading_osl=shading_osl) as scene:
        return gonio.rendered(scene).astype(np.float64)


def _for_instrument(of: Material, scene: Scene) -> Material:
    """The material itself, or one built anew for the instrument's lights if it reads the lights of its scene."""
    record = origin.read(of)
    if record is None or record.estimator in NATIVE:
        return of
    now = material.origin_of(of)
    lamps = material.lamps_to_bind(scene, record.estimator, record.preset.model)
    choice = material.Choice(
        record.backend, record.estimator, lamps, shadows=False, bound=now.bound, bounces=record.bounces
    )  # fmt: skip
    return material.build(now.preset, choice)


# From one Blender to another

FIELDS = tuple(one.name for one in fields(Points))


def hand_over(of: Material, theta_i: float, phi_i: float, folder: Path, *, shading_osl: bool) -> None:
    """Write what ``main`` needs into a folder: the material with all that it uses, and what to measure."""
    bpy.data.libraries.write(str(folder / BLEND), {of}, path_remap="ABSOLUTE", fake_user=True)
    request = {
        "name": of.name, "theta_i": theta_i, "phi_i": phi_i, "shading_osl": shading_osl, "space": colour_space.name()
    }  # fmt: skip
    (folder / REQUEST).write_text(json.dumps(request), encoding="utf-8")


def progress_in(folder: Path) -> float:
    """How much is done, 0 to 1."""
    try:
        return float((folder / PROGRESS).read_text(encoding="ascii"))
    except (OSError, ValueError):  # it has just begun, or just writes
        return 0.0


def points_in(folder: Path) -> dict[str, Points]:
    """What was measured; OSError where that is not there."""
    with np.load(folder / POINTS) as kept:
        return {plot: Points(*(kept[f"{plot}.{name}"] for name in FIELDS)) for plot in PLOTS}


def main() -> None:
    """In a Blender of its own: measure what the folder holds that the command line names last."""
    folder = Path(sys.argv[-1])
    request = json.loads((folder / REQUEST).read_text(encoding="utf-8"))
    if request["space"] != colour_space.name():
        bpy.ops.wm.set_working_color_space(convert_colors=False, working_space=request["space"])
    with bpy.data.libraries.load(str(folder / BLEND)) as (_, wanted):
        wanted.materials = [request["name"]]

    def progress(share: float) -> None:
        with replacing(folder / PROGRESS) as temporary:
            temporary.write_text(f"{share:.3f}", encoding="ascii")

    found = measure(
        wanted.materials[0], request["theta_i"], request["phi_i"], shading_osl=request["shading_osl"],
        progress=progress,
    )  # fmt: skip
    arrays = {f"{plot}.{name}": getattr(one, name) for plot, one in found.items() for name in FIELDS}
    with replacing(folder / POINTS) as temporary, temporary.open("wb") as file:
        np.savez(file, **arrays)
