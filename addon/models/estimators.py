# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimators: how a model reaches the renderer. docs/estimators.md compares them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Estimator:
    """One way for a model into Cycles.

    label, tip: what the panel says. number: what Blender stores for it, which never changes.
    quality: the one of the panel's three that is nearest.
    native: Cycles' own closures and nothing else, which see every light. borrows: closures for a part at least.
    random: draws a facet for each sample. every_light: evaluates the formula at bound lights of any size.
    upright: its closures stand on the shading normal; others lean, and Bump Map Correction would bend them.
    """

    label: str
    tip: str
    number: int
    quality: str
    native: bool = False
    borrows: bool = False
    random: bool = False
    every_light: bool = False
    upright: bool = False


ESTIMATORS = {
    "fit": Estimator(
        "Fit",
        "A fixed mixture of Cycles' own closures within a few percent of the formula: every light, no added noise",
        4, "standard", native=True, borrows=True,
    ),
    "closure": Estimator(
        "Closure",
        "Cycles' own closure: every light, least noise, but another model: Smith's shadowing, Fujii's rough diffuse",
        1, "standard", native=True, borrows=True, upright=True,
    ),
    "corrected": Estimator(
        "Corrected",
        "Fit, made exact for the eight strongest lights: no noise from lights of zero size, little from others",
        5, "exact", borrows=True, every_light=True,
    ),
    "hybrid": Estimator(
        "Hybrid",
        "Fit for the most part, the rest by Mirror: exact within a bound that you set, with less noise than Mirror",
        6, "reference", borrows=True, random=True,
    ),
    "mirror": Estimator(
        "Mirror",
        "Exact: a random facet for each sample. Lights of zero size are added by the formula",
        2, "reference", random=True,
    ),
    "direct": Estimator(
        "Direct",
        "Exact and free of noise, for the eight strongest lights alone: no world, no reflections",
        3, "exact", every_light=True, upright=True,
    ),
}  # fmt: skip
ALL = tuple(ESTIMATORS)
NATIVE = tuple(name for name, of in ESTIMATORS.items() if of.native)
BORROWING = tuple(name for name, of in ESTIMATORS.items() if of.borrows)
RANDOM = tuple(name for name, of in ESTIMATORS.items() if of.random)
EVERY_LIGHT = tuple(name for name, of in ESTIMATORS.items() if of.every_light)
UPRIGHT = frozenset(name for name, of in ESTIMATORS.items() if of.upright)
