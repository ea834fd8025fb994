# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove measure``: a preset's BRDF as Cycles renders it, in an EXR file, or as a MERL table."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..addon.library import presets
from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, replacing
from ..addon.reference.hybrid import DEFAULT_BOUND
from .environment import start_blender, versions
from .measure_merl import measure_merl
from .options import (
    AUTO,
    Backend,
    BackendOption,
    BoundOption,
    Estimator,
    SamplesOption,
    SeedOption,
    SetOption,
    TimeOption,
    apply_settings,
    parse_resolution,
    real,
)
from .terminal import say

if TYPE_CHECKING:
    from ..addon.library.presets import Preset

WhatArgument = Annotated[
    str, typer.Argument(metavar="PRESET", help="A preset's id, or the end of one: copper; with --material a .blend")
]
OutputOption = Annotated[
    Path,
    typer.Option(
        "-o", "--output", metavar="FILE", help="float32 EXR, channels R G B, f in 1/sr; with --merl a .binary"
    ),
]
MerlOption = Annotated[bool, typer.Option("--merl", help="All 90 x 90 x 180 entries of a MERL table; isotropic only")]
MaterialOption = Annotated[
    str | None,
    typer.Option(metavar="NAME", help="With --merl: any material of the file SCENE.blend in place of PRESET"),
]
ThetaOption = Annotated[
    float | None, typer.Option(parser=real(0.0, 89.99), metavar="DEG", help="Angle between the sun and the normal")
]
PhiOption = Annotated[
    float,
    typer.Option(
        parser=real(-360.0, 360.0),
        metavar="DEG",
        help="Azimuth of the sun. --window turns with it; the hemisphere's pixels keep their phi_o",
    ),
]
SunAngleOption = Annotated[
    float, typer.Option(parser=real(0.0, 90.0), metavar="DEG", help="Angular diameter of the sun; mirror needs > 0")
]
FurnaceOption = Annotated[bool, typer.Option(help="Measure the directional albedo under a uniform white world")]
WindowOption = Annotated[
    float,
    typer.Option(
        parser=real(0.0, 45.0), metavar="DEG", help="Half width of a window around the mirror direction; 0: hemisphere"
    ),
]
EstimatorOption = Annotated[
    Estimator, typer.Option(help="auto: mirror for a sun with an angle or a furnace, else direct (glass: closure)")
]


def measure(
    name: WhatArgument,
    output: OutputOption,
    *,
    merl: MerlOption = False,
    material: MaterialOption = None,
    settings: SetOption = None,
    theta_i: ThetaOption = None,
    phi_i: PhiOption = 0.0,
    sun_angle: SunAngleOption = 0.0,
    furnace: FurnaceOption = False,
    window: WindowOption = 0.0,
    at_time: TimeOption = None,
    resolution: Annotated[str, typer.Option(metavar="WxH")] = "64x64",
    samples: SamplesOption = 1,
    seed: SeedOption = 0,
    backend: BackendOption = Backend.NODES,
    estimator: EstimatorOption = AUTO,
    bound: BoundOption = DEFAULT_BOUND,
) -> None:
    """Measure a preset's BRDF in Cycles with the virtual gonioreflectometer; with --merl any material's."""
    _check_form(merl=merl, one_direction=theta_i is not None or furnace or phi_i or sun_angle or window, of=material)
    if merl:
        how: dict[str, Any] = {
            "estimator": estimator,
            "backend": str(backend),
            "samples": samples,
            "seed": seed,
            "bound": bound,
        }
        measure_merl(name, output, material=material, settings=settings, at_time=at_time, **how)
        return
    preset = apply_settings(presets.find(name), settings, at_time)
    size = parse_resolution(resolution)
    _check_light(theta_i, phi_i, sun_angle, window, furnace=furnace)
    if output.suffix.lower() != ".exr":
        message = f"{output}: measurements are EXR files; name one that ends in .exr"
        raise InputError(message)
    estimator = _suitable(estimator, preset, extended=furnace or sun_angle > 0, furnace=furnace)
    check_writable(output)
    start_blender()
    from .. import headless
    from ..addon.blender import gonio, images

    geometry = gonio.Geometry(theta_i or 0.0, window, size, sun_angle, furnace, phi_i=phi_i)
    start = time.perf_counter()
    osl = backend == Backend.OSL
    with headless.quiet():
        image = gonio.measure_preset(
            preset, backend, estimator, geometry, samples=samples, seed=seed, shading_osl=osl, bound=bound
        )
    attributes = {
        "preset": preset.id, "parameters": json.dumps(preset.parameters), "estimator": str(estimator),
        "backend": str(backend), "samples": samples, "seed": seed, "seconds": time.perf_counter() - start,
        "geometry": json.dumps(asdict(geometry)), "versions": json.dumps(versions()),
    }  # fmt: skip
    with replacing(output) as temporary:
        images.write(temporary, image, {f"vgroove:{key}": value for key, value in attributes.items()})
    say(f"wrote {output}")


def _check_form(*, merl: bool, one_direction: object, of: str | None) -> None:
    """InputError for options that do not go with a table, or only with one."""
    if merl and one_direction:
        message = "--merl measures all directions; leave --theta-i, --phi-i, --sun-angle, --furnace and --window out"
        raise InputError(message)
    if of is not None and not merl:
        message = "--material goes with --merl; other measurements take a preset"
        raise InputError(message)


def _check_light(theta_i: float | None, phi_i: float, sun_angle: float, window: float, *, furnace: bool) -> None:
    """InputError unless there is one light: a sun, or the white world of the furnace."""
    if (theta_i is None) != furnace:
        message = "give either --theta-i DEG or --furnace"
        raise InputError(message)
    if furnace and (window or sun_angle or phi_i):
        message = "--furnace has no sun: leave --window, --sun-angle and --phi-i out"
        raise InputError(message)


def _suitable(estimator: Estimator, preset: Preset, *, extended: bool, furnace: bool) -> Estimator:
    """The estimator, with auto resolved. InputError for one that is blind to this light.

    extended: whether the light has a size, which mirror needs.
    """
    if estimator == "mirror" and not extended:
        message = "mirror misses a sun of zero size; give --sun-angle DEG or --furnace"
        raise InputError(message)
    if estimator == "direct" and furnace:
        message = "direct sees only lights, not the world of --furnace; give --theta-i DEG, or choose mirror"
        raise InputError(message)
    if estimator != AUTO:
        return estimator
    exact = Estimator("closure" if preset.transparent else "direct")
    return Estimator("mirror") if extended else exact
