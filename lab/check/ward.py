# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Ward's model, at the azimuths of ``anisotropic``, in every estimator and backend."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ...addon.blender import gonio
from ...addon.library.presets import Preset, parse
from ...addon.models.estimators import NATIVE
from ...addon.reference import rendered
from .anisotropic import FEW_SHAPES, MIRROR_SHAPES, ROTATIONS, SHAPES, SUN_SAMPLES, SUN_THETAS, TURNS
from .rows import SETUPS, Plan, Row, Setup, View, side_by_side
from .views import (
    OSL_THETAS,
    THETAS,
    WINDOW,
    closure_bar,
    direct_bar,
    disc,
    furnace,
    measure,
    mirror_furnace_view,
    noiseless,
    pooled_view,
    sun_radiance,
)

if TYPE_CHECKING:
    from ...addon.reference.ward import Ward

MODEL = "ward"
TEXT = (
    'name = "Test"\nmodel = "ward"\nkind = "{}"\nalbedo = {}\nspecular = {}\nm = {}\nanisotropy = {}\nrotation = {}\n'
)
TEXT += '[source]\ndata = "check"'
KINDS = ("bounded", "ward_1992")
SPECULAR = [0.25, 0.5, 0.625]  # as float32 holds it
FURNACE_SAMPLES = 1024
SUN_ANGLE = 30.0
NOISY_ROWS = 11  # a test holds it to the plan


def material(kind: str, m: float, anisotropy: float, rotation: float, albedo: float = 0.0) -> Preset:
    """A test material."""
    return parse(TEXT.format(kind, albedo, SPECULAR, m, anisotropy, rotation), "check/ward", "check")


def model_of(preset: Preset, geometry: gonio.Geometry) -> Ward:
    """The reference in the gonioreflectometer's frame, whose patch has its tangent at an azimuth of its own."""
    model: Ward = preset.reference()
    return replace(model, azimuth=model.azimuth + float(np.radians(geometry.tangent)))


def exact_row(estimator: str, setup: Setup, kind: str, anisotropy: float, turn: int, m: float) -> Row:
    """An estimator without noise under a sun of zero size; ``corrected`` is the formula itself there.

    Over a little Lambert: more would hide what is wrong with the lobe.
    """
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(kind, m, anisotropy, rotation, 0.0625)
    native, signed = estimator in NATIVE, estimator == "corrected"
    bar = direct_bar(m) if estimator == "direct" else closure_bar(preset.reference().m_y)
    if estimator == "direct" and setup.shading_osl:
        bar = max(bar, 1e-4)  # OSL's exp() and sqrt() round to 1e-6 and less
    row = Row(estimator, setup, MODEL, kind, {"m": m, "anisotropy": anisotropy, "turn": turn})
    for theta_i in THETAS if setup is not SETUPS[1] else OSL_THETAS:
        for window in (0.0, WINDOW):
            geometry = gonio.Geometry(theta_i, window, phi_i=phi_i, tangent=tangent)
            wi, wo, model = geometry.wi(), geometry.wo(), model_of(preset, geometry)
            expected = rendered(model, estimator if native else "direct")(wi, wo)
            scales = [float(np.max(expected))] + ([float(np.max(rendered(model, "fit")(wi, wo)))] if signed else [])
            image = measure(preset, setup, estimator, geometry)
            if signed:  # a difference of two equal numbers, which may round to below 0
                image = np.where(image >= -bar * max(scales), np.maximum(image, 0.0), image)
            row.views.append(View(geometry, image, expected, bar, max(scales)))
    return row


def furnace_row(setup: Setup, kind: str, anisotropy: float, rotation: float, m: float) -> Row:
    """``mirror`` of the lobe alone under a uniform white world: its albedo, which the azimuth of the view changes."""
    preset = material(kind, m, anisotropy, rotation)
    model, wo = preset.reference(), furnace().wo()
    half = wo[:, : wo.shape[1] // 2]  # views from opposite sides see the same
    moments = [
        np.concatenate([of, of], axis=1)
        for of in (model.lobe_moment(half, k)[..., None] * np.array(SPECULAR) ** k for k in (1, 2, 3))
    ]
    view = mirror_furnace_view(preset, setup, tuple(moments), FURNACE_SAMPLES)
    return Row("mirror, furnace", setup, MODEL, kind, {"m": m, "anisotropy": anisotropy}, [view], NOISY_ROWS)


def sun_row(setup: Setup, kind: str, anisotropy: float, turn: int, m: float) -> Row:
    """``mirror`` of the lobe alone under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(kind, m, anisotropy, rotation)
    row = Row("mirror, sun", setup, MODEL, kind, {"m": m, "anisotropy": anisotropy}, noisy_rows=NOISY_ROWS)
    samples = SUN_SAMPLES[m]
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(
            theta_i, window=20.0, resolution=(16, 16), sun_angle=SUN_ANGLE, phi_i=phi_i, tangent=tangent
        )
        model, wo, radiance = model_of(preset, geometry), geometry.wo(), sun_radiance(geometry)
        mean, square, hits = np.zeros_like(wo), np.zeros_like(wo), np.zeros(wo.shape[:-1])
        for wi, weight in zip(*disc(geometry), strict=True):
            f_cos = model.evaluate(wi, wo) * max(wi[2], 0.0)
            density = model.pdf(wi, wo)
            mean += weight * radiance * f_cos
            square += weight * radiance**2 * f_cos**2 / np.where(density > 0, density, 1.0)[..., None]
            hits += weight * density
        measured = measure(preset, setup, "mirror", geometry, samples=samples)
        row.views.append(pooled_view(geometry, samples * hits, measured, mean, square, samples))
    return row


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    estimators = noiseless(MODEL)
    for setup in SETUPS:
        few = setup is SETUPS[1]  # nodes run as OSL are the same as in SVM, and slow to compile
        for name in estimators:
            shapes = FEW_SHAPES if few else SHAPES
            rows += [partial(exact_row, name, setup, KINDS[0], a, k % 4, m) for k, (m, a) in enumerate(shapes)]
            if not few:
                rows += [partial(exact_row, name, setup, KINDS[0], 0.8, k, 0.2) for k in range(len(TURNS))]
                rows += [partial(exact_row, name, setup, KINDS[1], a, 1, m) for m, a in MIRROR_SHAPES]
        for kind in KINDS if not few else KINDS[:1]:
            turned = zip(MIRROR_SHAPES, ROTATIONS, strict=True)
            shown = [(m, a, rotation) for (m, a), rotation in turned if m == 0.3 or (kind == KINDS[0] and not few)]
            rows += [partial(furnace_row, setup, kind, a, rotation, m) for m, a, rotation in shown]
        if setup is SETUPS[0]:  # others draw the very same facets: the furnace shows it
            rows += [partial(sun_row, setup, KINDS[k // 2], a, k, m) for k, (m, a) in enumerate(MIRROR_SHAPES[:2], 1)]
    return side_by_side(rows)
