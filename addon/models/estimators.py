# SPDX-License-Identifier: GPL-3.0-or-later
"""The estimators: how a model reaches the renderer. docs/estimators.md compares them."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Estimator:
    """One way for a model into Cycles.

    label, tip: in the panel. number: what Blender stores for it, which never changes.
    quality: the nearest of the panel's three.
    native: only Cycles' own closures, which see every light. borrows: Cycles' closures for at least a part.
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
        "A mixture of Cycles' own closures within a few percent of the formula; works with every light, adds no noise",
        4, "standard", native=True, borrows=True,
    ),
    "closure": Estimator(
        "Closure",
        "Cycles' nearest closure: least noise, but a different model (Smith shadowing, Fujii diffuse)",
        1, "standard", native=True, borrows=True, upright=True,
    ),
    "corrected": Estimator(
        "Corrected",
        "Fit, corrected to the formula at the eight strongest lights. Lights of zero size add no noise, others little",
        5, "exact", borrows=True, every_light=True,
    ),
    "hybrid": Estimator(
        "Hybrid",
        "Mostly Fit, the rest Mirror: exact within a bound that you set, less noise than Mirror",
        6, "reference", borrows=True, random=True,
    ),
    "mirror": Estimator(
        "Mirror",
        "Exact: a random facet for each sample, and the formula at lights of zero size",
        2, "reference", random=True,
    ),
    "direct": Estimator(
        "Direct",
        "Exact and noise-free, but only the eight strongest lights: no world, no reflections",
        3, "exact", every_light=True, upright=True,
    ),
}  # fmt: skip
ALL = tuple(ESTIMATORS)
NATIVE = tuple(name for name, of in ESTIMATORS.items() if of.native)
BORROWING = tuple(name for name, of in ESTIMATORS.items() if of.borrows)
RANDOM = tuple(name for name, of in ESTIMATORS.items() if of.random)
EVERY_LIGHT = tuple(name for name, of in ESTIMATORS.items() if of.every_light)
UPRIGHT = frozenset(name for name, of in ESTIMATORS.items() if of.upright)
