# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for glass, an interface or a thin sheet, in every estimator and backend.

A white furnace gives R + T; one lit only above or only below gives R or T alone. The sun below gives the BTDF.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ... import headless, nodegroups
from ...addon.blender import gonio
from ...addon.models import label, parameter
from ...addon.reference import Glass, glass_btdf, reflect, smith_g, vgroove_g1
from ...addon.reference.directions import dot
from ...addon.reference.glass import pane, refraction_facet, transmitted_g
from ...addon.reference.quadrature import vgroove_mean
from ...nodegroups import glass_closure, glass_mirror
from ..scenery import add_node, surface
from .rows import ROUNDING, SETUPS, Plan, Row, Setup, View, side_by_side
from .views import SUN_ANGLES, WINDOW, disc, furnace, pooled_view, sun_radiance

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material
    from numpy.typing import NDArray

MODEL = "glass"
SLOPES = (0.1, 0.3, 0.6, 1.0)
CLOSURE_SLOPES = (0.1, 0.3, 1.0)
ETAS = (1.33, 1.5, 2.42, 1.0 / 1.5)
THETAS = (180.0, 160.0, 140.0, 100.0)  # of the sun below
SUN_THETAS = (175.0, 150.0)
# So many that every row surely turns red on a common error of 1 % (surely_seen).
SAMPLES = {"all": 512, "below": 1024, "above": 3072}  # one side alone depends on what Cycles picks
# From inside lobes are broad and rarely hit the disc.
SUN_SAMPLES = {0.1: 512, 0.3: 512, 0.6: 2048, 1.0: 4096}
INSIDE_SUN_SAMPLES = {0.1: 2048, 0.3: 4096}
SMOOTH_BAR = 1e-4
NOISY_ROWS = 85  # of the plan, judged by Z-tests; a test holds it to the plan
MODULES = {"closure": glass_closure, "mirror": glass_mirror}


def probe(
    setup: Setup,
    estimator: str,
    eta: float,
    m: float,
    *,
    thin: bool = False,
    tint: tuple[float, float, float] = (1, 1, 1),
) -> Material:
    """Glass as ``estimator`` builds it; smooth for m = 0."""
    module = MODULES[estimator]
    make = module.build_osl if setup.backend == "osl" else module.build
    name = f"{module.NAME}{' Sheet' * thin}{' Smooth' * (m == 0)}{' (OSL)' * (setup.backend == 'osl')}"
    group = nodegroups.ensure(name, module.REVISION, partial(make, thin=thin, smooth=m == 0))
    of = {"eta": eta, "tint": tint} | ({"m": m} if m > 0 else {})
    given = {label("glass", key): parameter(key).scale.to_input(value) for key, value in of.items()}
    made = surface(name, lambda tree: add_node(tree, "Group", node_tree=group, **given))
    made.cycles.use_bump_map_correction = estimator != "mirror"  # it would bend the sampled facets
    return made


def _kind(*, thin: bool) -> str:
    return "thin" if thin else "interface"


def measure_probe(made: Material, setup: Setup, geometry: gonio.Geometry, samples: int) -> NDArray[np.float64]:
    """The image of ``made``, which is removed."""
    with headless.quiet():
        image = gonio.measure(made, geometry, samples=samples, shading_osl=setup.shading_osl)
    bpy.data.materials.remove(made)
    return image.astype(np.float64)


def furnace_row(setup: Setup, eta: float, m: float, lit: str, *, inside: bool = False, thin: bool = False) -> Row:
    """``mirror`` in a white world, or in half of one: R + T, R or T; seen from ``inside`` with 1/eta.

    One sample is worth FR + (1-F)T of its facet where it finds light. In half a world it does with the share that
    Cycles gives to the closure on that side, in proportion to the weights.
    """
    geometry = replace(furnace(), lit=lit, inside=inside)  # type: ignore[arg-type]
    ahead = float(np.float32(1.0 / eta if inside and not thin else eta))
    mean, square = (np.broadcast_to(moment, (32, 32, 3)) for moment in furnace_moments(ahead, m, lit, thin=thin))
    made = probe(setup, "mirror", eta, m, thin=thin)
    # Near total reflection light is found rarely: so many samples of equal worth would give this mean and square.
    hits = SAMPLES[lit] * mean[..., 0] ** 2 / np.where(square[..., 0] > 0, square[..., 0], 1.0)
    view = pooled_view(geometry, hits, measure_probe(made, setup, geometry, SAMPLES[lit]), mean, square, SAMPLES[lit])
    side = {"all": "R + T", "above": "R", "below": "T"}[lit]
    return Row(
        f"mirror, {side}{', inside' * inside}", setup, MODEL, _kind(thin=thin), {"eta": eta, "m": m}, [view], NOISY_ROWS
    )


@cache
def furnace_moments(eta: float, m: float, lit: str, *, thin: bool) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean and mean square of what one sample is worth for each row of a furnace, (32, 1, 3)."""

    def worth_of_facet(F: Any, R: Any, T: Any) -> Any:
        F, T = (pane(F), 1.0) if thin else (F, T)
        up, down = F * R, (1.0 - F) * T
        found = {"all": up + down, "above": up, "below": down}[lit]
        return np.stack([found, found * (up + down), 0.0 * found], axis=-1)

    moments = vgroove_mean(furnace().wo()[:, :1], m, eta, worth_of_facet)
    mean, square = (np.repeat(moments[..., k : k + 1], 3, axis=-1) for k in (0, 1))
    return mean, square


def smooth_row(setup: Setup, estimator: str, eta: float, *, inside: bool = False, thin: bool = False) -> Row:
    """m = 0 in a white world: nothing is lost."""
    geometry = replace(furnace(), inside=inside)
    made = probe(setup, estimator, eta, 0.0, thin=thin)
    measured = measure_probe(made, setup, geometry, 16)
    view = View(geometry, measured, np.ones_like(measured), SMOOTH_BAR, 1.0)
    return Row(f"{estimator}, sky", setup, MODEL, _kind(thin=thin), {"eta": eta, "m": 0.0}, [view])


def closure_row(setup: Setup, eta: float, m: float, *, inside: bool = False) -> Row:
    """``closure`` lit by a sun below: the BTDF with Smith's G, on the hemisphere and around the refracted ray.

    Only pairs that some facet connects: Cycles does not check v.h > 0 and (n.h) > 0, so its lights also shine through
    facets that the view sees from behind, at m = 1 by up to 16 % of the peak (Blender 4.5 and 5.2).
    """
    row = Row(f"closure, sun below{', inside' * inside}", setup, MODEL, "interface", {"eta": eta, "m": m})
    m32, ahead = float(np.float32(m)), float(np.float32(1.0 / eta if inside else eta))
    bar = max(2e-4, 4.0 * ROUNDING / m**2)
    for geometry in _views(ahead, inside=inside):
        wi, wo = geometry.wi(), geometry.wo()
        h, length = refraction_facet(np.broadcast_to(wi, wo.shape), wo, ahead)
        connected = (length > 0) & (h[..., 2] > 0)
        expected = glass_btdf(wi, wo, m32, ahead, smith_g(-wi, wo, m32))[connected][:, None] * np.ones(3)
        measured = measure_probe(probe(setup, "closure", eta, m), setup, geometry, 1)[connected]
        # Where the view holds less than 2^-64 of the lobe there is only what exp() leaves of its underflow.
        lobe = float(glass_btdf([0.0, 0.0, -1.0], [0.0, 0.0, 1.0], m32, ahead))
        scale = max(float(np.max(expected)), 2.0**-64 * lobe)
        row.views.append(View(geometry, measured, expected, bar, scale))
    return row


def _views(eta: float, *, inside: bool) -> Iterator[gonio.Geometry]:
    for theta_i in THETAS:
        yield gonio.Geometry(theta_i, inside=inside)
        if eta * np.sin(np.radians(theta_i)) < 0.98:  # else total reflection: there is no direction to look around
            yield gonio.Geometry(theta_i, WINDOW, eta=eta, inside=inside)


def sun_row(setup: Setup, eta: float, m: float, *, inside: bool = False) -> Row:
    """``mirror`` through which a sun of 10 to 30 degrees shines: the mean of the BTDF over its disc.

    One sample that refracts to the disc is worth the radiance times FR + (1-F)T of its facet.
    """
    ahead, samples = float(np.float32(1.0 / eta if inside else eta)), (INSIDE_SUN_SAMPLES if inside else SUN_SAMPLES)[m]
    model, angle = Glass(float(np.float32(m)), ahead), SUN_ANGLES[m]
    test, at = f"mirror, sun below{', inside' * inside}", {"eta": eta, "m": m}
    row = Row(test, setup, MODEL, "interface", at, noisy_rows=NOISY_ROWS)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, window=20.0, resolution=(16, 16), sun_angle=angle, eta=ahead, inside=inside)
        wo = geometry.wo()
        mean, square = np.zeros_like(wo), np.zeros_like(wo)
        radiance = sun_radiance(geometry)
        for wi, weight in zip(*disc(geometry), strict=True):
            f_cos = model.evaluate(wi, wo) * max(-wi[2], 0.0)
            mean += weight * radiance * f_cos
            square += weight * radiance**2 * f_cos * worth(model, wi, wo)[..., None]
        measured = measure_probe(probe(setup, "mirror", eta, m), setup, geometry, samples)
        hits = samples * mean[..., 0] / radiance
        row.views.append(pooled_view(geometry, hits, measured, mean, square, samples))
    return row


def worth(model: Glass, wi: NDArray[np.float64], wo: NDArray[np.float64]) -> NDArray[np.float64]:
    """(F G2 + (1 - F) G2t) / G1 of the facet that refracts between ``wi`` and ``wo``, (...)."""
    h, _ = refraction_facet(np.broadcast_to(wi, wo.shape), wo, model.eta)
    vh = np.clip(dot(wo, h), 0.0, 1.0)
    F, G1, up = model.fresnel(vh)[..., 0], vgroove_g1(wo, h), reflect(wo, h)
    G2 = np.minimum(G1, vgroove_g1(up, h))
    total = F * G2 + (1.0 - F) * transmitted_g(np.broadcast_to(wi, wo.shape), wo, h)
    return total / np.where(G1 > 0, G1, 1.0)


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]  # the same nodes as in SVM, and slow to compile
        for eta in (1.5,) if few else ETAS:
            for estimator in MODULES:
                rows += [partial(smooth_row, setup, estimator, eta, inside=True)]
                rows += [partial(smooth_row, setup, estimator, eta, thin=True)]
                rows += [partial(smooth_row, setup, estimator, eta)]
            rows += [partial(closure_row, setup, eta, m) for m in ((0.3,) if few else CLOSURE_SLOPES)]
        rows += [partial(closure_row, setup, 1.5, m, inside=True) for m in ((0.3,) if few else CLOSURE_SLOPES)]
        rows += [partial(furnace_row, setup, 1.5, m, "all", inside=True) for m in ((0.3,) if few else SLOPES)]
        if few:  # nodes run as OSL draw the very same facets: one furnace shows it
            continue
        for m in SLOPES:
            rows += [partial(furnace_row, setup, eta, m, "all") for eta in ETAS]
            rows += [partial(furnace_row, setup, eta, m, "below") for eta in (1.5, 1.0 / 1.5)]
            rows += [partial(furnace_row, setup, 1.5, m, "below", thin=True)]
            rows += [partial(furnace_row, setup, 2.42, m, "above")]
            rows += [partial(sun_row, setup, 1.5, m)]
        rows += [partial(sun_row, setup, 1.5, m, inside=True) for m in INSIDE_SUN_SAMPLES]
    return side_by_side(rows)
