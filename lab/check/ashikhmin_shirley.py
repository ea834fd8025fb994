# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Ashikhmin & Shirley's model, at several azimuths of light, tangent and rotation."""

from __future__ import annotations

from functools import partial

import numpy as np

from ...addon.library.presets import Preset, parse
from ...addon.models.ashikhmin_shirley import LAMBERT, SHARPNESS
from ...addon.reference import albedo
from ...addon.reference.ashikhmin_shirley_fit import slopes
from .anisotropic import ROTATIONS, SUN_THETAS, TURNS
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import (
    closure_bar,
    direct_bar,
    mirror_furnace_view,
    mirror_sun_view,
    moments_by_azimuth,
    noiseless,
    noiseless_row,
    suns,
)

MODEL = "ashikhmin_shirley"
TEXT = """name = "Test"
model = "ashikhmin_shirley"
kind = {!r}
albedo = {}
specular = {}
amplitude = {}
sharpness = {!r}
anisotropy = {!r}
rotation = {!r}
[source]
data = "check"
"""
DEEP = (0.3, 0.2, 0.5)
TINTS = {"plain": (1.0, 1.0, 1.0), LAMBERT: (0.5, 0.4, 0.3)}
SHAPES = ((0.6, 0.5), (1.0, 0.3), (0.45, 0.0), (0.3, 0.8), (0.2, 0.9), (0.1, 0.7))  # Roughness and anisotropy
FEW_SHAPES = ((0.45, 0.8),)
MIRROR_SHAPES = ((0.3, 0.8), (0.6, 0.6), (0.8, 1.0))
FURNACE_SAMPLES = 1024
SUN_ANGLE, SUN_SAMPLES = 30.0, {0.3: 5120, 0.6: 7168, 0.8: 15360}
NOISY_ROWS = 19  # a test holds it to the plan


def material(
    roughness: float, anisotropy: float, rotation: float, kind: str = "plain", *, deep: tuple[float, ...] = DEEP,
    gray: bool = False,
) -> Preset:  # fmt: skip
    """A test material of numbers as float32 sockets hold them; ``gray``: a dielectric."""
    sharpness = min(max(SHARPNESS.scale.of_input(float(np.float32(roughness))), SHARPNESS.low), SHARPNESS.high)
    colors = [
        [float(np.float32(part)) for part in rgb]
        for rgb in (deep, (0.04,) * 3 if gray else (0.2, 0.4, 0.6), TINTS[kind])
    ]
    held = (float(np.float32(number)) for number in (anisotropy, rotation))
    return parse(TEXT.format(kind, *colors, sharpness, *held), "check/ashikhmin_shirley", "check")


def exact_row(estimator: str, setup: Setup, anisotropy: float, turn: int, roughness: float) -> Row:
    """An estimator without noise under a sun of zero size; ``corrected`` is the formula itself there."""
    phi_i, tangent, rotation = TURNS[turn]
    kind = LAMBERT if turn == 2 else "plain"
    preset = material(roughness, anisotropy, rotation, kind, gray=turn == 1)
    narrowest = min(slopes(preset.reference().n_u, preset.reference().n_v))
    bar = direct_bar(roughness**2) if estimator == "direct" else closure_bar(narrowest)
    if estimator == "direct" and setup.shading_osl:
        bar = max(bar, 1e-4)  # OSL's exp() and sqrt() round to 1e-6 and less
    at = {"roughness": roughness, "anisotropy": anisotropy, "turn": turn}
    variant = preset.spec.kinds[kind]
    return noiseless_row(estimator, setup, preset, bar, variant=variant, at=at, phi_i=phi_i, tangent=tangent)


def furnace_row(setup: Setup, anisotropy: float, rotation: float, roughness: float) -> Row:
    """``mirror`` under a uniform white world: the highlight's directional albedo, which the azimuth changes."""
    preset = material(roughness, anisotropy, rotation, deep=(0.0, 0.0, 0.0))
    moments = moments_by_azimuth(preset.reference().moment)
    view = mirror_furnace_view(preset, setup, moments, FURNACE_SAMPLES)
    at = {"roughness": roughness, "anisotropy": anisotropy}
    return Row("mirror, furnace", setup, MODEL, "", at, [view], NOISY_ROWS)


def sun_row(setup: Setup, anisotropy: float, turn: int, roughness: float) -> Row:
    """``mirror`` under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(roughness, anisotropy, rotation, deep=(0.0, 0.0, 0.0))
    at = {"roughness": roughness, "anisotropy": anisotropy}
    geometries = suns(SUN_THETAS, SUN_ANGLE, phi_i=phi_i, tangent=tangent)
    views = [mirror_sun_view(preset, setup, geometry, SUN_SAMPLES[roughness]) for geometry in geometries]
    return Row("mirror, sun", setup, MODEL, "", at, views, NOISY_ROWS)


def deep_row(setup: Setup, kind: str, roughness: float) -> Row:
    """``mirror`` of both parts, between which Cycles chooses, under a uniform white world."""
    preset = material(roughness, 0.0, 0.0, kind)
    view = furnace_view(preset, setup, "mirror", albedo(preset.reference(), furnace_directions())[:, None])
    variant = preset.spec.kinds[kind]
    return Row("mirror, furnace, both", setup, MODEL, variant, {"roughness": roughness}, [view], NOISY_ROWS)


def wide_row(setup: Setup, roughness: float) -> Row:
    """``corrected`` under a sun of 30 degrees, whose emission asks for one light within it."""
    preset = material(roughness, 0.6, 0.1)
    views = [sun_view(preset, setup, "corrected", of, 512, 0.2) for of in suns(SUN_THETAS, SUN_ANGLE, phi_i=20.0)]
    return Row("corrected, sun", setup, MODEL, "", {"roughness": roughness}, views, NOISY_ROWS)


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]  # nodes run as OSL are the same as in SVM, and slow to compile
        for name in noiseless(MODEL):
            shapes = FEW_SHAPES if few else SHAPES
            rows += [partial(exact_row, name, setup, a, k % 4, r) for k, (r, a) in enumerate(shapes)]
            if not few:
                rows += [partial(exact_row, name, setup, 0.8, k, 0.45) for k in range(len(TURNS))]
        if not few:
            rows += [partial(sun_row, setup, a, k, r) for k, (r, a) in enumerate(MIRROR_SHAPES, 1)]
            rows += [partial(deep_row, setup, kind, 0.6) for kind in TINTS]
            rows.append(partial(wide_row, setup, 0.6))
        turned = [
            (r, a, rotation) for (r, a), rotation in zip(MIRROR_SHAPES, ROTATIONS, strict=True) if r == 0.6 or not few
        ]
        rows += [partial(furnace_row, setup, a, rotation, r) for r, a, rotation in turned]
    return side_by_side(rows)
