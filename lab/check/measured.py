# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for measured tables: made from formulas, written as MERL files, and read as anybody's."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...addon.library.presets import Preset, parse
from ...addon.measured import tabulate, write_merl
from ...addon.measured.library import digest_of
from ...addon.reference import CookTorrance, Lambert, OrenNayar, Schlick, albedo
from ...addon.reference.directions import half_vector
from .rows import SETUPS, Plan, Row, Setup, View, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import closure_bar, noiseless_row, suns

if TYPE_CHECKING:
    from ...addon.reference.directions import Floats
    from ...addon.reference.model import Brdf, Model

MODEL = "measured"
# A half float rounds an entry by 2^-12 of itself (2.4e-4); the rest is room for float32. In float32 the angles round by
# 2^-23 each, times 180 texels of a tile and the largest step between two: some 1e-5 of the peak at slopes above .1.
# OSL's own arc tangents and square roots are fast, and round five times as much. ``conditioned`` adds what grazing
# directions, of which Cycles knows 24 bits, make of a table.
BARS = {"half": (5e-4, 5e-4), "float": (2e-5, 1e-4)}
SUN_ANGLE = 30.0
SUN_SAMPLES = {0.3: 8192, 0.6: 16384}  # by slope: broad lobes hit the sun less often
SUN_THETAS = (20.0, 60.0)
DOUBT = 3e-4  # share of the albedo: its quadrature with a half and a full number of nodes differ by so much at most
NOISY_ROWS = 9  # of the plan, judged by Z-tests; a test holds it to the plan


def copper(m: float) -> Brdf:
    """A rough metal over a little Lambert."""
    metal, flat = CookTorrance(m, Schlick([0.9, 0.6, 0.5])), Lambert([0.1, 0.15, 0.2])
    return lambda wi, wo: flat.evaluate(wi, wo) + 0.7 * metal.evaluate(wi, wo)


def retro(m: float) -> Brdf:
    """A peak toward the light, and a ring of facets at 35 degrees, which no lobe of Cycles has; its channels differ."""

    def f(wi: Floats, wo: Floats) -> Floats:
        h = half_vector(wi, wo)
        lean = np.degrees(np.arctan2(np.hypot(h[..., 0], h[..., 1]), h[..., 2]))
        back = np.exp((np.einsum("...i,...i->...", wi, wo) - 1.0) / (0.2 * m * m))
        ring = np.exp(-(((lean - 35.0) / (25.0 * m)) ** 2))
        return 0.05 + back[..., None] * [0.1, 0.3, 0.5] + ring[..., None] * [0.3, 0.2, 0.1]

    return f


def matte(sigma: float) -> Brdf:
    """Oren-Nayar, most of which is the flat part."""
    return OrenNayar([0.7, 0.5, 0.3], sigma).evaluate


SURFACES = {one.__name__: one for one in (copper, retro, matte)}
CASES = (("copper", 0.3), ("copper", 0.6), ("retro", 0.3), ("matte", 0.3))


@cache
def _file(surface: str, m: float) -> tuple[tempfile.TemporaryDirectory[str], str, str]:
    """A MERL file of a surface, its name and its digest; the folder goes with the process."""
    folder = tempfile.TemporaryDirectory(prefix="vgroove-")
    path = Path(folder.name) / f"{surface}.binary"
    write_merl(path, tabulate(SURFACES[surface](m)))
    return folder, str(path), digest_of(path)


def preset(surface: str, m: float, kind: str = "float") -> Preset:
    """A preset whose table is that surface's."""
    _, path, digest = _file(surface, m)
    text = f"""name = "Test"
model = "{MODEL}"
kind = "{kind}"
[table]
file = '{path}'
sha256 = "{digest}"
[source]
data = "check"
"""
    return parse(text, f"check/{MODEL}", "check")


def exact_row(estimator: str, setup: Setup, surface: str, kind: str, m: float) -> Row:
    """Under a sun of zero size: ``direct`` against the table interpolated in NumPy, ``closure`` against its formula."""
    of = preset(surface, m, kind)
    bar = closure_bar(0.1) if estimator == "closure" else BARS[kind][setup.shading_osl]
    row = noiseless_row(estimator, setup, of, bar, variant=f"{surface}, {kind}", at={"m": m})
    if estimator == "direct":
        row.views[:] = [conditioned(view, of.reference()) for view in row.views]
    return row


def conditioned(view: View, table: Model) -> View:
    """Its bar, and how far the table's value moves by float32's rounding of both directions.

    Each component rounds by 2^-24, and once more in the half vector, which is short where both directions graze; the
    worst case adds what the six do. At theta_i = 85 degrees this is some 1e-4 of the peak, below 75 degrees nothing.
    """
    wi, wo = view.geometry.wi(), view.geometry.wo()
    steps = 2.0**-23 * np.eye(3)
    pairs = [(_unit(wi + by), wo) for by in steps] + [(wi, _unit(wo + by)) for by in steps]
    moved = sum(np.abs(table.evaluate(*pair) - view.expected) for pair in pairs)
    return replace(view, bar=view.bar + float(np.max(moved)) / view.scale)


def _unit(v: Floats) -> Floats:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def furnace_row(setup: Setup, surface: str, m: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo."""
    of = preset(surface, m)
    expected = albedo(of.reference(), furnace_directions())[:, None]
    view = furnace_view(of, setup, "mirror", expected, doubt=DOUBT * expected)
    return Row("mirror, furnace", setup, MODEL, surface, {"m": m}, [view], NOISY_ROWS)


def sun_row(setup: Setup, surface: str, m: float) -> Row:
    """``mirror`` under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    of, geometries = preset(surface, m), suns(SUN_THETAS, SUN_ANGLE)
    views = [sun_view(of, setup, "mirror", geometry, SUN_SAMPLES[m], 0.02) for geometry in geometries]
    return Row("mirror, sun", setup, MODEL, surface, {"m": m}, views, NOISY_ROWS)


def plan() -> Plan:
    """Every row. The backend OSL runs the same nodes as nodes in OSL, so it is left out."""
    found: Plan = []
    for setup in SETUPS[:2]:
        for surface, m in CASES[:1] if setup.shading_osl else CASES:
            found += [partial(exact_row, "direct", setup, surface, kind, m) for kind in BARS]
            found.append(partial(furnace_row, setup, surface, m))
            found += [] if setup.shading_osl else [partial(sun_row, setup, surface, m)]
        found.append(partial(exact_row, "closure", setup, "copper", "half", 0.3))
    return side_by_side(found)
