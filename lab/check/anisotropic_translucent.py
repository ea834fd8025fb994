# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for the brushed coat of a translucent body, over a black one, which sends nothing back."""

from __future__ import annotations

from functools import partial

from ...addon.library.presets import Preset, parse
from . import anisotropic, translucent
from .cook_torrance import fresnel_approximation
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .views import closure_bar, noiseless, noiseless_row

MODEL = "anisotropic_translucent"
ANISOTROPY, ROTATION = 0.7, 0.15
BRUSHED = f"m = 0.3\nanisotropy = {ANISOTROPY}\nrotation = {ROTATION}"
TEXT = translucent.TEXT.replace('"translucent"', f'"{MODEL}"').replace("m = 0.3", BRUSHED)


def preset(m: float) -> Preset:
    """A brushed coat of water over nothing."""
    return parse(TEXT, "check/coat", "check").with_parameters(m=m)


def exact_row(estimator: str, setup: Setup, m: float) -> Row:
    """Under a sun of zero size."""
    approximate = fresnel_approximation(setup, translucent.KIND)
    lobe = anisotropic.white(m, ANISOTROPY, ROTATION) if approximate else None
    bar = approximate or closure_bar(m)
    at = {"m": m}
    return noiseless_row(estimator, setup, preset(m), bar, variant=translucent.KIND, at=at, windows=(0.0,), lobe=lobe)


def plan() -> Plan:
    """Every row."""
    return side_by_side([partial(exact_row, name, setup, 0.3) for setup in SETUPS for name in noiseless(MODEL)])
