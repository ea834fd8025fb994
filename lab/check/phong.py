# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Phong and Blinn-Phong, in every estimator and backend."""

from __future__ import annotations

from functools import partial

import numpy as np

from ...addon.library.presets import Preset, parse
from ...addon.models import MODELS
from ...addon.reference import albedo
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import closure_bar, direct_bar, noiseless, noiseless_row, suns

MODEL = "phong"
ROUGHNESSES = (1.0, 0.6, 0.3, 0.12)  # as Blender has it; the last is an exponent of 2411, of Blinn's 9643
MIRROR_ROUGHNESSES = (0.8, 0.3)
SUN_ANGLE = 30.0
SUN_THETAS = (20.0, 60.0)
SUN_SAMPLES = {"corrected": 512, "mirror": 8192}
NOISY_ROWS = 9  # of the plan, judged by Z-tests; a test holds it to the plan


def preset(model: str, roughness: float, diffuse: float = 0.3) -> Preset:
    """A lobe of this width, as float32 sockets hold it, over a diffuse share of white."""
    key = MODELS[model].parameters[-1]
    exponent = min(max(key.scale.of_input(float(np.float32(roughness))), key.low), key.high)
    held = [float(np.float32(share)) for share in (diffuse, 0.2, 0.4, 0.6)]
    text = f"""name = "Test"
model = "{model}"
albedo = {held[0]}
specular = {held[1:]}
{key.name} = {exponent!r}
[source]
data = "check"
"""
    return parse(text, f"check/{model}", "check")


def exact_row(model: str, estimator: str, setup: Setup, roughness: float) -> Row:
    """Under a sun of zero size: ``closure`` against Cycles' closures as formulas, others against the model."""
    m = roughness * roughness
    bar = closure_bar(m) if estimator != "direct" else direct_bar(m)
    return noiseless_row(estimator, setup, preset(model, roughness), bar, variant="", at={"roughness": roughness})


def furnace_row(model: str, setup: Setup, roughness: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo of the lobe alone."""
    of = preset(model, roughness, 0.0)
    view = furnace_view(of, setup, "mirror", albedo(of.reference(), furnace_directions())[:, None])
    return Row("mirror, furnace", setup, model, "", {"roughness": roughness}, [view], NOISY_ROWS)


def sun_row(model: str, estimator: str, setup: Setup, roughness: float) -> Row:
    """Under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    of = preset(model, roughness, 0.0 if estimator == "mirror" else 0.3)
    samples, geometries = SUN_SAMPLES[estimator], suns(SUN_THETAS, SUN_ANGLE)
    views = [sun_view(of, setup, estimator, geometry, samples, 0.2) for geometry in geometries]
    return Row(f"{estimator}, sun", setup, model, "", {"roughness": roughness}, views, NOISY_ROWS)


def plan(model: str = MODEL) -> Plan:
    """Every row of one of the two models."""
    found: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]  # the same nodes as in SVM, and slow to compile
        for estimator in noiseless(model):
            found += [partial(exact_row, model, estimator, setup, r) for r in ((0.3,) if few else ROUGHNESSES)]
        found += [partial(furnace_row, model, setup, r) for r in ((0.3,) if few else MIRROR_ROUGHNESSES)]
        if not few:  # nodes run as OSL draw the very same directions: the furnace shows it
            found += [partial(sun_row, model, estimator, setup, 0.3) for estimator in SUN_SAMPLES]
    return side_by_side(found)
