# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Oren-Nayar 1994, full and qualitative, in every estimator and backend."""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ...addon.blender import gonio
from ...addon.library.presets import Preset, parse
from ...addon.reference import OrenNayar, rendered
from ...addon.reference import oren_nayar_fit as fit
from ...addon.reference.hybrid import DEFAULT_BOUND
from ...addon.reference.quadrature import diffuse_albedo
from .rows import SETUPS, Plan, Row, Setup, side_by_side
from .seeds import furnace_directions, furnace_view, sun_view
from .views import disc, furnace, measure, mirror_furnace_view, noiseless, noiseless_row, pooled_view, sun_radiance

if TYPE_CHECKING:
    from numpy.typing import NDArray

MODEL = "oren_nayar"
ALBEDO = (0.2, 0.5, 0.95)
DIRECT_BAR = 2e-5  # as Cook-Torrance's for broad lobes
NATIVE_BAR = 5e-6  # about 20 float32 operations on cosines of 2^-24 each; 8e-7 was seen
BARS = {"closure": NATIVE_BAR, "fit": NATIVE_BAR}
SIGMAS = (0.0, 0.1, 0.3, 0.6, 1.0, np.pi / 2)
MIRROR_SIGMAS = (0.1, 0.3, 0.6, 1.0)
SUN_SIGMAS = (0.3, 1.0)  # furnaces are seen at all of MIRROR_SIGMAS
SUN_ANGLE = 60.0  # broad lobes meet a wide sun often; at the last of these it stays above the horizon
SUN_THETAS = (20.0, 55.0)
NOISY_ROWS = 38  # of the plan, judged by Z-tests; a test holds it to the plan
FURNACE_SAMPLES = 1024
SUN_SAMPLES = 8192
SEEDED_SUN_SAMPLES = {"corrected": 512, "hybrid": 2048}
MIRRORED = 0.1  # of hybrid at sigma 1 and above, at least


def preset(kind: str, sigma: float, albedo: Any = ALBEDO) -> Preset:
    """Oren-Nayar with what float32 sockets hold of these parameters."""
    text = f'name = "Test"\nmodel = "oren_nayar"\nkind = "{kind}"\nalbedo = 0.5\nsigma = 0\n[source]\ndata = "check"'
    held = tuple(float(np.float32(channel)) for channel in np.broadcast_to(albedo, 3))
    sigma = min(float(np.float32(sigma)), np.pi / 2)
    return parse(text, f"check/{kind}", "check").with_parameters(sigma=sigma, albedo=held)


def model(of: Preset) -> OrenNayar:
    """The preset's reference."""
    reference = of.reference()
    assert isinstance(reference, OrenNayar)
    return reference


def exact_row(estimator: str, setup: Setup, kind: str, sigma: float) -> Row:
    """Under a sun of zero size: ``closure`` and ``fit`` against their own formulas, others against the 1994 model."""
    bar = BARS.get(estimator, DIRECT_BAR)
    at = {"sigma": sigma}
    return noiseless_row(estimator, setup, preset(kind, sigma), bar, variant=kind, at=at, windows=(0.0,))


def furnace_row(setup: Setup, kind: str, sigma: float, albedo: Any = ALBEDO) -> Row:
    """``mirror`` under a uniform white world: the directional albedo. E[w^2] is the integral of pi f^2 cos."""
    of = preset(kind, sigma, albedo)
    view = mirror_furnace_view(of, setup, furnace_moments(model(of)), FURNACE_SAMPLES)
    return Row("mirror, furnace", setup, MODEL, kind, {"sigma": sigma}, [view], NOISY_ROWS)


@cache
def furnace_moments(reference: OrenNayar) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """E[w] and E[w^2] of ``mirror``'s weight for each row of a furnace, (32, 1, 3): the model is isotropic."""
    column = furnace().wo()[:, :1]
    square = diffuse_albedo(column, lambda wi, wo: np.pi * reference.evaluate(wi, wo) ** 2)
    return reference.directional_albedo(column), square


def sun_row(setup: Setup, kind: str, sigma: float) -> Row:
    """``mirror`` under a sun of 60 degrees: the mean of f over its disc, weighted by the cosine."""
    of = preset(kind, sigma)
    reference = model(of)
    row = Row("mirror, sun", setup, MODEL, kind, {"sigma": sigma}, noisy_rows=NOISY_ROWS)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, resolution=(16, 16), sun_angle=SUN_ANGLE)
        wo = geometry.wo()
        mean, square = np.zeros_like(wo), np.zeros_like(wo)
        radiance = sun_radiance(geometry)
        for wi, weight in zip(*disc(geometry), strict=True):
            f = reference.evaluate(wi, wo)
            mean += weight * radiance * f * wi[2]
            square += weight * radiance**2 * f**2 * wi[2] * np.pi
        measured = measure(of, setup, "mirror", geometry, SUN_SAMPLES)
        hits = SUN_SAMPLES * mean[..., 0] / radiance
        row.views.append(pooled_view(geometry, hits, measured, mean, square, SUN_SAMPLES))
    return row


def hybrid_furnace_row(setup: Setup, kind: str, sigma: float) -> Row:
    """``hybrid`` under a uniform white world: the directional albedo of ``oren_nayar_hybrid``."""
    of = preset(kind, sigma)
    coarse, fine = (hybrid_albedo(model(of), nodes) for nodes in (96, 160))
    view = furnace_view(of, setup, "hybrid", fine[:, None], doubt=(fine - coarse)[:, None])
    return Row("hybrid, furnace", setup, MODEL, kind, {"sigma": sigma}, [view], NOISY_ROWS)


@cache
def hybrid_albedo(reference: OrenNayar, nodes: int) -> NDArray[np.float64]:
    """Directional albedo of ``oren_nayar_hybrid`` for each ``furnace_directions``, (32, 3)."""
    return diffuse_albedo(furnace_directions(), rendered(reference, "hybrid", DEFAULT_BOUND), nodes)


def seeded_sun_row(estimator: str, setup: Setup, kind: str, sigma: float) -> Row:
    """``corrected`` and ``hybrid`` under a sun of 60 degrees."""
    row = Row(f"{estimator}, sun", setup, MODEL, kind, {"sigma": sigma}, noisy_rows=NOISY_ROWS)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, resolution=(16, 16), sun_angle=SUN_ANGLE)
        row.views.append(
            sun_view(preset(kind, sigma), setup, estimator, geometry, SEEDED_SUN_SAMPLES[estimator], MIRRORED)
        )
    return row


def plan() -> Plan:
    """Every row."""
    rows: Plan = []
    for setup in SETUPS:
        few = setup is SETUPS[1]  # the same nodes as in SVM, and slow to compile
        for kind in fit.KINDS:
            for estimator in noiseless(MODEL):
                rows += [partial(exact_row, estimator, setup, kind, sigma) for sigma in ((0.3,) if few else SIGMAS)]
            rows += [partial(furnace_row, setup, kind, sigma) for sigma in ((0.3,) if few else MIRROR_SIGMAS)]
            rows += [partial(hybrid_furnace_row, setup, kind, sigma) for sigma in ((1.0,) if few else (0.3, 1.0))]
        if not few:  # nodes run as OSL draw the very same directions: the furnace shows it
            rows += [partial(sun_row, setup, "full", sigma) for sigma in SUN_SIGMAS]
            rows.append(partial(sun_row, setup, "qualitative", MIRROR_SIGMAS[-1]))
            rows += [partial(seeded_sun_row, estimator, setup, "full", 1.0) for estimator in ("corrected", "hybrid")]
    return side_by_side(rows)
