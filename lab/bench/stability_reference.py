# SPDX-License-Identifier: GPL-3.0-or-later
"""What the reference says of extreme parameters, and of courses that are all but steps."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import headless
from ...addon.blender import course as changes
from ...addon.blender import fcurves, gonio
from ...addon.blender.course import Play
from ...addon.library.presets import parse
from ...addon.models import parameter
from ...addon.reference import (
    Conductor,
    CookTorrance,
    Dielectric,
    Glass,
    OrenNayar,
    Schlick,
    albedo,
    rendered,
    spherical,
)
from ..check.views import direct_bar
from .stability_measures import Outcome

if TYPE_CHECKING:
    from collections.abc import Callable

    from ...addon.reference import Model
    from ..check.rows import Setup

THETAS = (0.0, 1e-9, 1e-3, 30.0, 60.0, 89.0, 89.9, 89.9999, 90.0 - 1e-6)
PHIS = (0.0, 0.1, 90.0, 180.0 - 1e-6, 180.0)
FRAMES = 240.0
MOMENTS = (0.0, 0.25, 0.6, 0.8, 1.0)  # of a course: none within the step of ``logistic``, at 0.5
# f with wi and wo swapped. At the angle of total reflection F goes as a root: 1 - F is 2 (1 + 1 / eta^2) / c times the
# root of 2 c 2^-52, 2e-7 of the eta of 0.5 that meets it here exactly. Rounding otherwise is 2^-52 a step.
RECIPROCAL = 2.0**-20


def values(of: Callable[[float], Model], value: float, _setup: Setup) -> Outcome:
    """f of a model for all pairs of ``THETAS`` and ``PHIS``; reciprocal."""
    wi, wo = _directions()[:, None], _directions()[None]
    model = of(value)
    f, back = model.evaluate(wi, wo), model.evaluate(wo, wi)
    scale = np.maximum(np.maximum(np.abs(f), np.abs(back)), 1e-30)
    apart = np.max(np.abs(f - back) / scale, axis=-1)
    # Vectors by sines and cosines are unit to 3 * 2^-52, by which v.h and l.h part: over their |wi + wo| / 2 that is
    # 2 (3 + 3) 2^-52 / |wi + wo|^2, and G takes v.h as it is.
    bound = RECIPROCAL + 12.0 * 2.0**-52 / np.sum((wi + wo) ** 2, axis=-1)
    return Outcome(f, holds=bool(np.all(apart <= bound)))


def shares(of: Callable[[float], Model], value: float, _setup: Setup) -> Outcome:
    """The directional albedo of a model at each of ``THETAS``."""
    return Outcome(albedo(of(value), spherical(np.radians(THETAS), 0.0)))


def _directions() -> Any:
    theta, phi = np.meshgrid(np.radians(THETAS), np.radians(PHIS))
    return spherical(theta.ravel(), phi.ravel())


SIGMAS = (0.0, 1e-6, 0.3, 1.0, np.pi / 2)
ETAS = (0.1, 0.5, 1.0 - 1e-9, 1.0 + 1e-9, 1.5, 10.0)
ALBEDO = (("albedo", shares, 1.0),)
BOTH = (("f", values, None), *ALBEDO)
# what is varied, its values, the model of a value, and what is computed of it
MODELS: tuple[tuple[str, tuple[float, ...], Callable[[float], Model], Any], ...] = (
    ("m", (1e-6, 1e-4, 0.01, 0.3, 1.0, 10.0), lambda m: CookTorrance(m, Schlick(1.0)), BOTH),
    ("eta", ETAS, lambda eta: CookTorrance(0.3, Dielectric(eta)), BOTH),
    ("k", (0.0, 1e-9, 1.0, 20.0), lambda k: CookTorrance(0.3, Conductor(0.2, k)), BOTH),
    ("sigma, full", SIGMAS, partial(OrenNayar, 0.95), BOTH),
    ("sigma, qualitative", SIGMAS, partial(OrenNayar, 0.95, qualitative=True), ALBEDO),
    ("eta, glass", ETAS, partial(Glass, 0.3), ALBEDO),
)
# what, values, measure, most
ROWS: tuple[tuple[Any, ...], ...] = tuple(
    (f"{what}, {number}", varied, partial(measure, model), most)
    for what, varied, model, numbers in MODELS
    for number, measure, most in numbers
)


def course(law: str, driving: str, rate: float, setup: Setup) -> Outcome:
    """A slope that falls from 1 to 0.05 at ``rate``, all but a step, by ``direct`` at moments of its course."""
    middle = "middle = 0.5\n" if law == "logistic" else ""
    text = (
        'name = "Step"\nmodel = "cook_torrance"\nm = 1.0\n[fresnel]\nf0 = 1.0\n[source]\ndata = "check"\n'
        f'[time]\nunit = "s"\nrange = [0.0, 1.0]\nkind = "authored"\n[time.m]\nlaw = "{law}"\nend = 0.05\n'
        f"rate = {rate!r}\n{middle}"
    )
    preset = parse(text, "check/step", "check")
    play = Play(driving, 1.0, FRAMES)
    keys = changes.keyframes(preset.trajectory(), play)
    frames = (1.0 + FRAMES * np.array(MOMENTS)).tolist()
    geometry = gonio.Geometry(45.0, 0.0, (32, 32))
    with headless.quiet():
        images = gonio.measure_course(
            preset, setup.backend, "direct", geometry, play, frames, shading_osl=setup.shading_osl
        )
    off = 0.0
    for image, frame in zip(images, frames, strict=True):
        m = float(parameter("m").scale.of_input(keys["m"].law()(np.array((frame - 1.0) / FRAMES))))
        expected = rendered(CookTorrance(m, Schlick(1.0)), "direct")(geometry.wi(), geometry.wo())
        off = max(off, float(np.max(np.abs(image - expected)) / np.max(expected)))
    nearest = float(np.min(np.diff(keys["m"].times))) * FRAMES
    crowded = driving == "curves" and nearest < fcurves.CLOSEST
    limit = f"F-curves have no two keys within {fcurves.CLOSEST:g} frames: a step takes that long" if crowded else ""
    return Outcome(images.astype(np.float64), limit=limit, holds=off <= direct_bar(0.05), more={"error": off})
