# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for the microfacet generator, in every estimator and backend, of each distribution."""

from __future__ import annotations

from functools import partial

import numpy as np

from ...addon.library.presets import Preset, parse
from ...addon.reference import albedo
from ...addon.reference.facet_distribution import Distribution
from ...addon.reference.generator_fit import beckmann_terms
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import closure_bar, direct_bar, noiseless, noiseless_row, suns

MODEL = "generator"
SLOPES = (0.3, 0.1)  # how wide each distribution is, about as Beckmann's of this slope
SHAPES = ("beckmann", "ggx", "exponential", "abc", "points", "two slopes")
SUN_ANGLE = 30.0
SUN_THETAS = (20.0, 60.0)
SUN_SAMPLES = 8192
NOISY_ROWS = 15  # of the plan, judged by Z-tests; a test holds it to the plan
OSL_BAR = 1e-4  # of ``direct``: OSL's own arc tangents and logarithms are fast, and round as much


def table(shape: str, m: float) -> str:
    """[[distribution]] of this shape; points have a bump beside the normal's."""
    if shape == "abc":
        return f"[[distribution]]\nabc = [{2.0 / m**2!r}, 1.2]"
    if shape == "points":
        x = np.linspace(0.0, 1.0, 33)
        D = np.exp(-((x**2 * 1.5 / m) ** 2)) + 0.05 * np.exp(-(((x - 0.7) / 0.08) ** 2))
        return f"[[distribution]]\npoints = {[float(f'{number:.6g}') for number in D]}"
    if shape == "two slopes":
        narrow = f"[[distribution]]\nbeckmann = {m!r}\nweight = 0.6"
        return f"{narrow}\n[[distribution]]\nggx = {2.0 * m!r}\nweight = 0.4"
    return f"[[distribution]]\n{shape} = {m!r}"


def preset(shape: str, m: float, diffuse: float = 0.2) -> Preset:
    """Facets of glass, over a diffuse share of white; numbers as float32 sockets hold them."""
    held = [float(np.float32(share)) for share in (diffuse, 0.9, 0.6, 0.3, 1.5)]
    text = f"""name = "Test"
model = "{MODEL}"
albedo = {held[0]}
specular = {held[1:4]}
{table(shape, m)}
[fresnel]
eta = {held[4]}
[source]
data = "check"
"""
    return parse(text, f"check/{MODEL}", "check")


def exact_row(estimator: str, setup: Setup, shape: str, m: float) -> Row:
    """Under a sun of zero size: ``fit`` and ``closure`` against Cycles' lobes as formulas, ``direct`` against f."""
    of = preset(shape, m)
    narrowest = min(m for _, m in beckmann_terms(Distribution(of.distribution)))
    bar = max(direct_bar(m), OSL_BAR * setup.shading_osl) if estimator == "direct" else closure_bar(narrowest)
    return noiseless_row(estimator, setup, of, bar, variant=shape, at={"m": m})


def furnace_row(setup: Setup, shape: str, m: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo of the lobe alone."""
    of = preset(shape, m, 0.0)
    view = furnace_view(of, setup, "mirror", albedo(of.reference(), furnace_directions())[:, None])
    return Row("mirror, furnace", setup, MODEL, shape, {"m": m}, [view], NOISY_ROWS)


def sun_row(setup: Setup, shape: str, m: float) -> Row:
    """``mirror`` under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    of = preset(shape, m, 0.0)
    views = [sun_view(of, setup, "mirror", geometry, SUN_SAMPLES, 0.2) for geometry in suns(SUN_THETAS, SUN_ANGLE)]
    return Row("mirror, sun", setup, MODEL, shape, {"m": m}, views, NOISY_ROWS)


def plan() -> Plan:
    """Every row; nodes run as OSL are the same as in SVM, and slow to compile: one shape of them is enough."""
    found: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]
        shapes = ("points",) if few else SHAPES
        for shape in shapes:
            found += [partial(exact_row, "direct", setup, shape, m) for m in (SLOPES[:1] if few else SLOPES)]
            found.append(partial(furnace_row, setup, shape, 0.3))
        for estimator in noiseless(MODEL)[:2]:
            found += [
                partial(exact_row, estimator, setup, shape, 0.3) for shape in shapes if shape in {"ggx", "points"}
            ]
        if not few:
            found.append(partial(sun_row, setup, "ggx", 0.3))
    return side_by_side(found)
