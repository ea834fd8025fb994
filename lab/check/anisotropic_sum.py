# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for a diffuse part under a brushed one, plain and coupled."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from . import anisotropic
from . import sum as plain
from .cook_torrance import fresnel_approximation
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .views import closure_bar, direct_bar, noiseless, noiseless_row

if TYPE_CHECKING:
    from ...addon.library.presets import Preset

MODEL = "anisotropic_sum"
ANISOTROPY, ROTATION = 0.7, 0.15


def preset(kind: str, m: float) -> Preset:
    """That of ``sum``, brushed."""
    return plain.preset(kind, m, model=MODEL, anisotropy=ANISOTROPY, rotation=ROTATION)


def exact_row(estimator: str, setup: Setup, kind: str, m: float) -> Row:
    """Under a sun of zero size, with the bar of the specular part."""
    of = preset(kind, m)
    bar = direct_bar(m) if estimator == "direct" else closure_bar(m)
    lobe = None
    if estimator != "direct" and (approximate := fresnel_approximation(setup, "dielectric")):
        lobe, bar = anisotropic.white(m, ANISOTROPY, ROTATION), approximate
    return noiseless_row(estimator, setup, of, bar, variant=kind, at={"m": m}, windows=(0.0,), lobe=lobe)


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    for setup in SETUPS:
        rows += [partial(exact_row, name, setup, kind, 0.3) for name in noiseless(MODEL) for kind in plain.KINDS]
    return side_by_side(rows)
