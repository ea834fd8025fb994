# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for sums, plain and coupled, in every estimator: each the weighted sum of its parts."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from ...addon.blender import gonio
from ...addon.library.presets import Preset, parse
from ...addon.reference import CookTorrance, OrenNayar, Sum, albedo, rendered
from ...addon.reference.hybrid import DEFAULT_BOUND
from ...addon.reference.quadrature import diffuse_albedo
from ...addon.reference.sum import quick_diffuse_share
from . import cook_torrance
from .hybrid import excess
from .oren_nayar import SUN_ANGLE, SUN_THETAS
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import closure_bar, direct_bar, noiseless, noiseless_row

if TYPE_CHECKING:
    from numpy.typing import NDArray

MODEL = "sum"
ESTIMATORS = noiseless(MODEL)
KINDS = ("sum", "coupled")
SLOPES = (0.3, 0.6)
GREY = "f0 = 0.0816"  # Schlick's F of that base for noisy rows: it is exact in native closures of 4.5 too
SUN_SAMPLES = {"mirror": 8192, "hybrid": 2048, "corrected": 512}
SUN_SEEDS = 8  # as the largest of shaders take longer to compile than to run
MIRRORED = 0.05  # of hybrid, at least
NOISY_ROWS = 14  # of the plan, judged by Z-tests; a test holds it to the plan


def preset(kind: str, m: float, fresnel: str = "eta = 1.8", model: str = MODEL, **more: float) -> Preset:
    """A rough base under a rough dielectric; ``more``: numbers that another such ``model`` has."""
    others = "\n".join(f"{name} = {value}" for name, value in more.items())
    weights = "d = 0.95\ns = 1.0\ncoupled = true" if kind == "coupled" else "d = 0.6\ns = 0.4"
    text = f"""name = "Test"
model = "{model}"
{weights}
{others}
albedo = [0.8, 0.5, 0.2]
sigma = 0.6
m = {m}
[fresnel]
{fresnel}
[source]
data = "check"
"""
    return parse(text, f"check/{kind}", "check")


def exact_row(estimator: str, setup: Setup, kind: str, m: float) -> Row:
    """Under a sun of zero size, with the bar of the specular part."""
    bar = direct_bar(m) if estimator == "direct" else closure_bar(m)
    lobe = None
    approximate = cook_torrance.fresnel_approximation(setup, "dielectric") if estimator != "direct" else 0.0
    if approximate:
        lobe, bar = cook_torrance.materials()["white"].with_parameters(m=m).reference(), approximate
    of, at = preset(kind, m), {"m": m}
    return noiseless_row(estimator, setup, of, bar, variant=kind, at=at, windows=(0.0,), lobe=lobe)


def furnace_row(estimator: str, setup: Setup, kind: str, m: float) -> Row:
    """``mirror`` and ``hybrid`` under a uniform white world: the weighted sum of what the parts send back."""
    of = preset(kind, m, GREY)
    coarse, fine = (_sent_back(kind, m, estimator, nodes) for nodes in (72, 100))
    # Two grids apart by as much say how well the reference is known.
    view = furnace_view(of, setup, estimator, fine[:, None], doubt=(fine - coarse)[:, None])
    return Row(f"{estimator}, furnace", setup, MODEL, kind, {"m": m}, [view], NOISY_ROWS)


@cache
def _sent_back(kind: str, m: float, estimator: str, nodes: int) -> NDArray[np.float64]:
    of, wo = preset(kind, m, GREY), furnace_directions()
    model = of.reference()
    assert isinstance(model, Sum)
    diffuse, specular = model.diffuse, model.specular
    assert isinstance(diffuse, OrenNayar)
    assert isinstance(specular, CookTorrance)
    under = diffuse_albedo(wo, rendered(diffuse, estimator, DEFAULT_BOUND), nodes)
    over = albedo(specular, wo)
    if estimator == "hybrid":
        over = over + np.stack([excess(view, of.m, specular.fresnel, DEFAULT_BOUND, nodes) for view in wo])
    return quick_diffuse_share(model, wo) * under + model.s * over


def sun_row(estimator: str, setup: Setup, kind: str, m: float) -> Row:
    """Noisy estimators under a sun of 60 degrees."""
    row = Row(f"{estimator}, sun", setup, MODEL, kind, {"m": m}, noisy_rows=NOISY_ROWS)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, resolution=(16, 16), sun_angle=SUN_ANGLE)
        row.views.append(
            sun_view(preset(kind, m, GREY), setup, estimator, geometry, SUN_SAMPLES[estimator], MIRRORED, SUN_SEEDS)
        )
    return row


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]  # the same nodes as in SVM, and slow to compile
        for kind in KINDS:
            slopes = (0.3,) if few else SLOPES
            rows += [partial(exact_row, estimator, setup, kind, m) for estimator in ESTIMATORS for m in slopes]
        if few:
            continue
        for estimator in ("mirror", "hybrid"):
            rows += [partial(furnace_row, estimator, setup, kind, 0.3) for kind in KINDS]
        for estimator in ("mirror", "hybrid", "corrected"):
            rows.append(partial(sun_row, estimator, setup, "coupled", 0.3))
    return side_by_side(rows)
