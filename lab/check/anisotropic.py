# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for anisotropic Cook-Torrance, at several azimuths of light, tangent and rotation."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from ...addon.library.presets import Preset, parse
from ...addon.reference import Anisotropic, Schlick
from ...addon.reference.quadrature import vgroove_albedo
from .cook_torrance import fresnel_approximation
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

if TYPE_CHECKING:
    from numpy.typing import NDArray

MODEL = "anisotropic"
TEXT = 'name = "Test"\nmodel = "anisotropic"\nm = {}\nanisotropy = {}\nrotation = {}\n[fresnel]\n{}\n'
TEXT += '[source]\ndata = "check"'
TERMS = {
    "schlick": "f0 = [0.95, 0.64, 0.54]",
    "dielectric": "eta = 1.5",
    "conductor": "n = [0.27, 0.68, 1.32]\nk = [3.61, 2.62, 2.29]",
    "f82": "f0 = [0.7, 0.5, 0.3]\nf82_tint = [0.6, 0.9, 1.0]",
}
SHAPES = ((0.1, 0.8), (0.3, 0.5), (0.2, 1.0), (0.6, 0.6), (0.03, 0.9), (0.005, 0.7), (0.3, 0.0))  # m and anisotropy
FEW_SHAPES = ((0.2, 0.8),)
TURNS = ((0.0, 0.0, 0.0), (20.0, 35.0, 0.1), (250.0, 110.0, 0.3), (130.0, 300.0, 0.75))  # phi_i, tangent; rotation
MIRROR_SHAPES, ROTATIONS = ((0.2, 0.8), (0.3, 0.6), (0.6, 1.0)), (0.0, 0.1, 0.3)
FURNACE_SAMPLES = 1024
SUN_THETAS = (20.0, 60.0)
SUN_ANGLE, SUN_SAMPLES = 30.0, {0.2: 5120, 0.3: 7168, 0.6: 15360}
NOISY_ROWS = 13  # a test holds it to the plan


def material(fresnel: str, m: float, anisotropy: float, rotation: float) -> Preset:
    """A test material."""
    return parse(TEXT.format(m, anisotropy, rotation, TERMS[fresnel]), "check/anisotropic", "check")


def white(m: float, anisotropy: float, rotation: float) -> Anisotropic:
    """Such a surface with F = 1, of which an approximate F of Cycles' closures is a share."""
    model: Anisotropic = material("schlick", m, anisotropy, rotation).reference()
    return replace(model, fresnel=Schlick(1.0))


def exact_row(estimator: str, setup: Setup, fresnel: str, anisotropy: float, turn: int, m: float) -> Row:
    """An estimator without noise under a sun of zero size; ``corrected`` is the formula itself there."""
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(fresnel, m, anisotropy, rotation)
    bar = direct_bar(m) if estimator == "direct" else closure_bar(preset.reference().m_y)
    if estimator == "direct" and setup.shading_osl:
        bar = max(bar, 1e-4)  # OSL's exp() and sqrt() round to 1e-6 and less
    approximate = fresnel_approximation(setup, fresnel) if estimator != "direct" else 0.0
    lobe = white(m, anisotropy, rotation) if approximate else None
    at = {"m": m, "anisotropy": anisotropy, "turn": turn}
    return noiseless_row(
        estimator, setup, preset, approximate or bar, variant=fresnel, at=at, lobe=lobe, phi_i=phi_i, tangent=tangent
    )


def furnace_row(setup: Setup, fresnel: str, anisotropy: float, rotation: float, m: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo, which the azimuth of the view changes."""
    preset = material(fresnel, m, anisotropy, rotation)
    view = mirror_furnace_view(preset, setup, furnace_moments(preset.reference()), FURNACE_SAMPLES)
    return Row("mirror, furnace", setup, MODEL, fresnel, {"m": m, "anisotropy": anisotropy}, [view], NOISY_ROWS)


@cache
def furnace_moments(model: Anisotropic) -> tuple[NDArray[np.float64], ...]:
    """As ``moments_by_azimuth``."""
    cos, sin = np.cos(model.azimuth), np.sin(model.azimuth)

    def moment(wo: NDArray[np.float64], power: int) -> NDArray[np.float64]:
        x, y, z = np.moveaxis(wo, -1, 0)
        along = np.stack([cos * x + sin * y, cos * y - sin * x, z], axis=-1)
        return vgroove_albedo(along, model.m_x, model.fresnel, m_y=model.m_y, moment=power)

    return moments_by_azimuth(moment)


def sun_row(setup: Setup, fresnel: str, anisotropy: float, turn: int, m: float) -> Row:
    """``mirror`` under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    phi_i, tangent, rotation = TURNS[turn]
    preset = material(fresnel, m, anisotropy, rotation)
    at = {"m": m, "anisotropy": anisotropy}
    geometries = suns(SUN_THETAS, SUN_ANGLE, phi_i=phi_i, tangent=tangent)
    views = [mirror_sun_view(preset, setup, geometry, SUN_SAMPLES[m]) for geometry in geometries]
    return Row("mirror, sun", setup, MODEL, fresnel, at, views, NOISY_ROWS)


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    estimators = noiseless(MODEL)
    for setup in SETUPS:
        few = setup is SETUPS[1]  # nodes run as OSL are the same as in SVM, and slow to compile
        for name in estimators:
            shapes = FEW_SHAPES if few else SHAPES
            rows += [partial(exact_row, name, setup, "schlick", a, k % 4, m) for k, (m, a) in enumerate(shapes)]
        if not few:
            for name in estimators:
                rows += [partial(exact_row, name, setup, "schlick", 0.8, k, 0.2) for k in range(len(TURNS))]
                rows += [partial(exact_row, name, setup, term, 0.7, 1, 0.3) for term in list(TERMS)[1:]]
            rows += [partial(sun_row, setup, "schlick", a, k, m) for k, (m, a) in enumerate(MIRROR_SHAPES, 1)]
        turned = [
            (m, a, rotation) for (m, a), rotation in zip(MIRROR_SHAPES, ROTATIONS, strict=True) if m == 0.3 or not few
        ]
        rows += [partial(furnace_row, setup, "schlick", a, rotation, m) for m, a, rotation in turned]
    return side_by_side(rows)
