# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Ward's model, at the azimuths of ``anisotropic``, in every estimator and backend."""

from __future__ import annotations

from functools import partial

import numpy as np

from ...addon.library.presets import Preset, parse
from . import anisotropic
from .anisotropic import FEW_SHAPES, MIRROR_SHAPES, ROTATIONS, SUN_SAMPLES, SUN_THETAS, TURNS
from .rows import SETUPS, Plan, Row, Setup, side_by_side
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

MODEL = "ward"
TEXT = (
    'name = "Test"\nmodel = "ward"\nkind = "{}"\nalbedo = {}\nspecular = {}\nm = {}\nanisotropy = {}\nrotation = {}\n'
)
TEXT += '[source]\ndata = "check"'
KINDS = ("bounded", "ward_1992")
SHAPES = [(m, a) for m, a in anisotropic.SHAPES if m >= 0.02]  # of narrower lobes Cycles' closures round off 1 %
SPECULAR = [0.25, 0.5, 0.625]  # as float32 holds it
FURNACE_SAMPLES = 1024
SUN_ANGLE = 30.0
NOISY_ROWS = 11  # a test holds it to the plan


def material(kind: str, m: float, anisotropy: float, rotation: float, albedo: float = 0.0) -> Preset:
    """A test material."""
    return parse(TEXT.format(kind, albedo, SPECULAR, m, anisotropy, rotation), "check/ward", "check")


def exact_row(estimator: str, setup: Setup, kind: str, anisotropy: float, turn: int, m: float) -> Row:
    """An estimator without noise under a sun of zero size; ``corrected`` is the formula itself there.

    Over a little Lambert: more would hide what is wrong with the lobe.
    """
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(kind, m, anisotropy, rotation, 0.0625)
    bar = direct_bar(m) if estimator == "direct" else closure_bar(preset.reference().m_y)
    if estimator == "direct" and setup.shading_osl:
        bar = max(bar, 1e-4)  # OSL's exp() and sqrt() round to 1e-6 and less
    at = {"m": m, "anisotropy": anisotropy, "turn": turn}
    return noiseless_row(estimator, setup, preset, bar, variant=kind, at=at, phi_i=phi_i, tangent=tangent)


def furnace_row(setup: Setup, kind: str, anisotropy: float, rotation: float, m: float) -> Row:
    """``mirror`` of the lobe alone under a uniform white world: its albedo, which the azimuth of the view changes."""
    preset = material(kind, m, anisotropy, rotation)
    model, specular = preset.reference(), np.array(SPECULAR)
    moments = moments_by_azimuth(lambda wo, power: model.lobe_moment(wo, power)[..., None] * specular**power)
    view = mirror_furnace_view(preset, setup, moments, FURNACE_SAMPLES)
    return Row("mirror, furnace", setup, MODEL, kind, {"m": m, "anisotropy": anisotropy}, [view], NOISY_ROWS)


def sun_row(setup: Setup, kind: str, anisotropy: float, turn: int, m: float) -> Row:
    """``mirror`` of the lobe alone under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(kind, m, anisotropy, rotation)
    at = {"m": m, "anisotropy": anisotropy}
    geometries = suns(SUN_THETAS, SUN_ANGLE, phi_i=phi_i, tangent=tangent)
    views = [mirror_sun_view(preset, setup, geometry, SUN_SAMPLES[m], by_density=True) for geometry in geometries]
    return Row("mirror, sun", setup, MODEL, kind, at, views, NOISY_ROWS)


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
