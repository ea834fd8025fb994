# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Cook-Torrance in every estimator and backend.

Under a sun of zero size ``corrected`` and ``hybrid`` are the formula itself, free of noise; under a sun with an angle
or a white sky they are noisy, and their variance is taken from seeds.
"""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from ... import headless
from ...addon.blender import gonio, material
from ...addon.choose.advice import native_fresnel_error
from ...addon.library.presets import Preset, find, parse
from ...addon.reference import CookTorrance, albedo, cook_torrance, rendered
from ...addon.reference.cook_torrance_fit import hybrid_share
from ...addon.reference.directions import dot
from ...addon.reference.groove_fit import bounced
from ...addon.reference.hybrid import DEFAULT_BOUND
from ...addon.reference.quadrature import vgroove_albedo
from ...nodegroups import versions
from .hybrid import excess
from .rows import SETUPS, Plan, Row, Setup, View, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import (
    SUN_ANGLES,
    closure_bar,
    direct_bar,
    furnace,
    mirror_furnace_view,
    mirror_sun_view,
    noiseless_row,
    suns,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...addon.reference import Fresnel

MODEL = "cook_torrance"
DIRECT_SLOPES = (1.0, 0.6, 0.3, 0.1, 0.05, 0.02, 0.005, 0.001)
# Nodes run as OSL are the same as in SVM, and slow to compile: what OSL may round otherwise shows at these.
OSL_SLOPES = (0.3, 0.05)
CLOSURE_SLOPES = (1.0, 0.6, 0.3, 0.1, 0.05, 0.02)
SPHERE_SLOPES = (1.0, 0.3, 0.1)
MIRROR_SLOPES = (0.1, 0.3, 0.6, 1.0)
FURNACE_SAMPLES = 1024
SUN_THETAS = (20.0, 60.0, 74.0)  # the widest sun stays above the horizon
SUN_SAMPLES = {0.1: 2560, 0.3: 2560, 0.6: 7168, 1.0: 15360}  # per pixel, so that every row resolves surely_seen(0.01)
NOISY_ROWS = 32  # rows of ``mirror`` that are judged by Z-tests; a test holds it to the plan

SEEDED = ("corrected", "hybrid")  # estimators whose noise only seeds tell
SEEDED_NOISY_ROWS = 13  # rows of these that are judged by Z-tests; a test holds it to the plan
SEEDED_SUN_SLOPES = (0.3,)
SEEDED_SUN_ANGLE = 20.0
SEEDED_SUN_THETAS = (20.0, 70.0)
SEEDED_SUN_SAMPLES = {"corrected": 512, "hybrid": 2048}
MIRRORED = 0.2  # at least this share of hybrid's samples are mirrored, at that slope
# A test holds what leaning lobes send back in the mean over views to ``versions.LEANING``. Slopes to NARROW do so at
# grazing views alone, which are noisy and weigh next to nothing in a row.
NARROW = 0.3


def materials() -> dict[str, Preset]:
    """One material for each Fresnel kind, and a white one; m is set by each row."""
    test = 'name = "Test"\nmodel = "cook_torrance"\nm = 0.3\n[fresnel]\n{}\n[source]\ndata = "check"\n'
    return {
        "schlick": find("lecture/copper"),
        "dielectric": parse(test.format("eta = 1.5"), "check/dielectric", "check"),
        "conductor": parse(test.format("n = [0.27, 0.68, 1.32]\nk = [3.61, 2.62, 2.29]"), "check/conductor", "check"),
        "f82": parse(test.format("f0 = [0.7, 0.5, 0.3]\nf82_tint = [0.6, 0.9, 1.0]"), "check/f82", "check"),
        "white": parse(test.format("f0 = 1.0"), "check/white", "check"),
    }


def fresnel_approximation(setup: Setup, fresnel: str) -> float:
    """How far a native closure's Fresnel term may be off on this Blender, as a reflectance; 0 if it is exact."""
    return native_fresnel_error(fresnel, setup.backend)


def direct_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``direct`` at every theta_i, on the hemisphere and in the window, against the V-groove model."""
    preset = materials()[fresnel].with_parameters(m=m)
    return noiseless_row("direct", setup, preset, direct_bar(m), variant=fresnel, at={"m": m})


def closure_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``closure`` against the same model with Smith's G."""
    return native_row("closure", setup, fresnel, m)


def fit_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``fit`` against its mixture as the reference has it; how near that is to the V-groove model, tests say."""
    return native_row("fit", setup, fresnel, m)


def native_row(estimator: str, setup: Setup, fresnel: str, m: float) -> Row:
    """An estimator of Cycles' own lobes. Where their F is an approximation, that is a share of the lobe with F = 1."""
    preset = materials()[fresnel].with_parameters(m=m)
    approximate = fresnel_approximation(setup, fresnel)
    lobe = (materials()["white"].with_parameters(m=m) if approximate else preset).reference()
    bar = approximate or closure_bar(m)
    return noiseless_row(estimator, setup, preset, bar, variant=fresnel, at={"m": m}, lobe=lobe)


def sphere_row(fresnel: str, m: float) -> Row:
    """``direct`` as plain nodes on the point-cloud sphere, without any OSL."""
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    row = Row("direct, sphere", SETUPS[0], MODEL, fresnel, {"m": m})
    for theta_i in (20.0, 70.0):
        with headless.quiet():
            radiance, normal = gonio.measure_sphere(preset, "nodes", "direct", theta_i)
        geometry = gonio.Geometry(theta_i)
        # The limb is left out: there a pixel's normal turns by 1/nz of what float32 rounds its place.
        seen = (normal[..., 2] > 0.2) & (normal @ geometry.wi() > 0.02)
        n = normal[seen]
        wi, wo = (
            to_local(np.broadcast_to(geometry.wi(), n.shape), n),
            to_local(np.broadcast_to([0.0, 0.0, 1.0], n.shape), n),
        )
        expected = cook_torrance(wi, wo, m, F) * wi[..., 2:]
        scale = float(np.max(expected))
        row.views.append(View(geometry, radiance[seen].astype(np.float64), expected, direct_bar(m), scale))
    return row


def to_local(w: NDArray[np.float64], n: NDArray[np.float64]) -> NDArray[np.float64]:
    """``w`` in a frame whose z axis is ``n``; any azimuth will do for an isotropic model."""
    x = _unit(np.cross(n, np.where(np.abs(n[..., :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])))
    return _unit(np.stack([dot(w, x), dot(w, np.cross(n, x)), dot(w, n)], axis=-1))


def _unit(v: NDArray[np.float64]) -> NDArray[np.float64]:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def bounces_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``closure`` with the lobe of further bounces, against both as the reference has them."""
    preset = materials()[fresnel].with_parameters(m=m)
    made = material.build(preset, material.Choice(setup.backend, "closure", bounces=True))
    once, F = rendered(preset.reference(), "closure"), preset.reference_fresnel()
    row = Row("closure, bounces", setup, MODEL, fresnel, {"m": m})
    for theta_i in (20.0, 60.0):
        geometry = gonio.Geometry(theta_i)
        wi, wo = geometry.wi(), geometry.wo()
        expected = once(wi, wo) + bounced(wi, wo, m, F, "closure")
        with headless.quiet():
            image = gonio.measure(made, geometry, shading_osl=setup.shading_osl)
        row.views.append(View(geometry, image.astype(np.float64), expected, closure_bar(m), float(np.max(expected))))
    return row


def furnace_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``mirror`` under a uniform white world: the directional albedo."""
    preset = materials()[fresnel].with_parameters(m=m)
    view = mirror_furnace_view(preset, setup, furnace_moments(preset.reference_fresnel(), m), FURNACE_SAMPLES)
    return Row("mirror, furnace", setup, MODEL, fresnel, {"m": m}, [view], NOISY_ROWS)


@cache
def furnace_moments(fresnel: Fresnel, m: float) -> tuple[NDArray[np.float64], ...]:
    """E[w], E[w^2], E[w^3] of ``mirror``'s weight for each row of a furnace, (32, 1, 3): the model is isotropic."""
    column = furnace().wo()[:, :1]
    higher = (vgroove_albedo(column, m, fresnel, moment=moment) for moment in (2, 3))
    return albedo(CookTorrance(m, fresnel), column), *higher


def sun_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``mirror`` under a sun of 10 to 30 degrees: the mean of f over its disc, weighted by the cosine."""
    preset = materials()[fresnel].with_parameters(m=m)
    geometries = suns(SUN_THETAS, SUN_ANGLES[m])
    views = [mirror_sun_view(preset, setup, geometry, SUN_SAMPLES[m]) for geometry in geometries]
    return Row("mirror, sun", setup, MODEL, fresnel, {"m": m}, views, NOISY_ROWS)


def hybrid_furnace_row(setup: Setup, fresnel: str, m: float) -> Row:
    """``hybrid`` under a uniform white world: the directional albedo of what it renders."""
    preset = materials()[fresnel].with_parameters(m=m)
    F = preset.reference_fresnel()
    coarse, fine = furnace_excess(F, m)
    wo = furnace_directions()
    expected = albedo(preset.reference(), wo) + fine
    more = versions.LEANING * m if m > NARROW else 0.0
    leaning = 0.5 * more * hybrid_share(wo, m, DEFAULT_BOUND)[:, None] * expected  # half of it, and as much for doubt
    # Two grids apart by as much say how well the reference is known.
    doubt = np.hypot(fine - coarse, leaning)
    view = furnace_view(preset, setup, "hybrid", (expected + leaning)[:, None], doubt=doubt[:, None])
    return Row("hybrid, furnace", setup, MODEL, fresnel, {"m": m}, [view], SEEDED_NOISY_ROWS)


@cache
def furnace_excess(fresnel: Fresnel, m: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """``excess`` for each ``furnace_directions``, (32, 3), on a coarse and on a fine grid."""
    wo = furnace_directions()
    coarse, fine = (np.stack([excess(view, m, fresnel, DEFAULT_BOUND, nodes) for view in wo]) for nodes in (72, 100))
    return coarse, fine


def seeded_sun_row(estimator: str, setup: Setup, fresnel: str, m: float) -> Row:
    """``corrected`` and ``hybrid`` under a sun of 20 degrees: the mean of f over its disc, weighted by the cosine."""
    preset = materials()[fresnel].with_parameters(m=m)
    samples, geometries = SEEDED_SUN_SAMPLES[estimator], suns(SEEDED_SUN_THETAS, SEEDED_SUN_ANGLE)
    views = [sun_view(preset, setup, estimator, geometry, samples, MIRRORED) for geometry in geometries]
    return Row(f"{estimator}, sun", setup, MODEL, fresnel, {"m": m}, views, SEEDED_NOISY_ROWS)


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]
        for fresnel in ("schlick", "dielectric", "conductor"):
            rows += [partial(direct_row, setup, fresnel, m) for m in (OSL_SLOPES if few else DIRECT_SLOPES)]
            slopes = OSL_SLOPES if few else CLOSURE_SLOPES
            rows += [partial(row, setup, fresnel, m) for row in (closure_row, fit_row) for m in slopes]
        rows += [partial(row, setup, "f82", 0.3) for row in (direct_row, closure_row, fit_row)]
        rows += [partial(bounces_row, setup, "schlick", m) for m in (1.0, 0.3)]
        for m in MIRROR_SLOPES:
            rows += [partial(furnace_row, setup, fresnel, m) for fresnel in ("white", "schlick")]
        if not few:  # nodes run as OSL draw the very same facets: the furnace shows it
            rows += [partial(sun_row, setup, "schlick", m) for m in MIRROR_SLOPES]
    rows += [
        partial(sphere_row, fresnel, m) for fresnel in ("schlick", "dielectric", "conductor") for m in SPHERE_SLOPES
    ]
    return side_by_side(rows) + side_by_side(_seeded_plan())


def _seeded_plan() -> Plan:
    rows: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]
        for estimator in SEEDED:
            rows += [partial(native_row, estimator, setup, "schlick", m) for m in ((0.3,) if few else CLOSURE_SLOPES)]
            rows += [partial(native_row, estimator, setup, fresnel, 0.3) for fresnel in ("dielectric", "conductor")]
        rows += [partial(hybrid_furnace_row, setup, "white", m) for m in ((0.3,) if few else MIRROR_SLOPES)]
        if not few:  # as above
            slopes = SEEDED_SUN_SLOPES
            rows += [partial(seeded_sun_row, estimator, setup, "schlick", m) for estimator in SEEDED for m in slopes]
    return rows
