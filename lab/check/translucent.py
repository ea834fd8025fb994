# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for the coat of a translucent body, over a black one, which sends nothing back."""

from __future__ import annotations

from functools import partial

from ...addon.library.presets import Preset, parse
from ...addon.reference import albedo
from . import cook_torrance
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view
from .views import closure_bar, noiseless, noiseless_row

MODEL, KIND = "translucent", "dielectric"
ESTIMATORS = noiseless(MODEL)
NOISY_ROWS = 2  # rows of the plan that are judged by Z-tests; a test holds it to the plan
TEXT = """
name = "Test"
model = "translucent"
reflectance = 0.0
mean_free_path = 0.0003
m = 0.3
[fresnel]
eta = 1.3
[source]
data = "check"
"""


def preset(m: float) -> Preset:
    """A coat of water over nothing."""
    return parse(TEXT, "check/coat", "check").with_parameters(m=m)


def exact_row(estimator: str, setup: Setup, m: float) -> Row:
    """Under a sun of zero size."""
    approximate = cook_torrance.fresnel_approximation(setup, KIND)
    lobe = cook_torrance.materials()["white"].with_parameters(m=m).reference() if approximate else None
    bar = approximate or closure_bar(m)
    return noiseless_row(estimator, setup, preset(m), bar, variant=KIND, at={"m": m}, windows=(0.0,), lobe=lobe)


def furnace_row(setup: Setup, m: float) -> Row:
    """``mirror`` under a uniform white world: the coat's directional albedo."""
    of = preset(m)
    view = furnace_view(of, setup, "mirror", albedo(of.reference(), furnace_directions())[:, None])
    return Row("mirror, furnace", setup, MODEL, KIND, {"m": m}, [view], NOISY_ROWS)


def plan() -> Plan:
    """Every row."""
    rows: Plan = [partial(exact_row, estimator, setup, 0.3) for setup in SETUPS for estimator in ESTIMATORS]
    rows += [partial(furnace_row, setup, 0.3) for setup in SETUPS if setup is not SETUPS[1]]
    return side_by_side(rows)
