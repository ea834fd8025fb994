# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Blinn-Phong, as for Phong."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import phong

if TYPE_CHECKING:
    from .rows import Plan, Row, Setup

MODEL = "blinn_phong"


def exact_row(estimator: str, setup: Setup, roughness: float) -> Row:
    """As ``phong.lobe_row``."""
    return phong.lobe_row(MODEL, estimator, setup, roughness)


def furnace_row(setup: Setup, roughness: float) -> Row:
    """As ``phong.sky_row``."""
    return phong.sky_row(MODEL, setup, roughness)


def sun_row(estimator: str, setup: Setup, roughness: float) -> Row:
    """As ``phong.disc_row``."""
    return phong.disc_row(MODEL, estimator, setup, roughness)


def plan() -> Plan:
    """Every row."""
    return phong.rows(MODEL, exact_row, furnace_row, sun_row)
