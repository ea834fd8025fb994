# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for car paint: a base and two lobes, each with numbers of its own."""

from __future__ import annotations

from functools import partial

from ...addon.library.presets import Preset, parse
from ...addon.reference import albedo
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view
from .views import closure_bar, direct_bar, noiseless, noiseless_row

MODEL, KIND = "car_paint", "f82"
ESTIMATORS = noiseless(MODEL)
NOISY_ROWS = 2  # rows of the plan that are judged by Z-tests; a test holds it to the plan
TEXT = """
name = "Test"
model = "car_paint"
albedo = [0.3, 0.1, 0.05]
sigma = 0.2
[[lobes]]
s = 0.3
m = 0.6
f0 = [0.6, 0.4, 0.2]
f82_tint = [0.8, 0.9, 1.0]
[[lobes]]
s = 0.2
m = 0.2
f0 = 0.5
f82_tint = 1.0
[source]
data = "check"
"""


def preset() -> Preset:
    """A rough base under a broad, coloured lobe and a narrow, grey one."""
    return parse(TEXT, "check/paint", "check")


def exact_row(estimator: str, setup: Setup, m: float) -> Row:
    """Under a sun of zero size, with the bar of the narrower lobe, whose slope is ``m``."""
    bar = direct_bar(m) if estimator == "direct" else closure_bar(m)
    of = preset().with_parameters(m_2=m)
    return noiseless_row(estimator, setup, of, bar, variant=KIND, at={"m": m}, windows=(0.0,))


def furnace_row(setup: Setup, m: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo."""
    of = preset().with_parameters(m_2=m)
    view = furnace_view(of, setup, "mirror", albedo(of.reference(), furnace_directions())[:, None])
    return Row("mirror, furnace", setup, MODEL, KIND, {"m": m}, [view], NOISY_ROWS)


def plan() -> Plan:
    """Every row."""
    rows: Plan = [
        partial(exact_row, estimator, setup, m) for setup in SETUPS for estimator in ESTIMATORS for m in (0.3,)
    ]
    rows += [partial(furnace_row, setup, 0.3) for setup in SETUPS if setup is not SETUPS[1]]
    return side_by_side(rows)
