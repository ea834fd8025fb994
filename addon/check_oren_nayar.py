# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for Oren-Nayar 1994, full and qualitative, in every estimator and backend."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from .. import nodegroups
from ..nodegroups import lamp, oren_nayar_closure, oren_nayar_direct, oren_nayar_fit, oren_nayar_mirror
from . import check, gonio, headless, lamps
from .check import Row, Setup, View
from .reference import OrenNayar
from .reference import oren_nayar_fit as fit
from .reference.quadrature import diffuse_albedo

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Object
    from numpy.typing import NDArray

ALBEDO = (0.2, 0.5, 1.0)
DIRECT_BAR = 2e-5  # as Cook-Torrance's for broad lobes
NATIVE_BAR = 5e-6  # about 20 float32 operations on cosines of 2^-24 each; 8e-7 was seen
SIGMAS = (0.0, 0.1, 0.3, 0.6, 1.0, np.pi / 2)
MIRROR_SIGMAS = (0.1, 0.3, 0.6, 1.0)
SUN_ANGLE = 30.0
SUN_THETAS = (20.0, 60.0, 74.0)
NOISY_ROWS = 28  # of the plan, judged by Z-tests; they add to check.NOISY_ROWS
FURNACE_SAMPLES = 1024
SUN_SAMPLES = 20480
MODULES = {
    "closure": oren_nayar_closure,
    "fit": oren_nayar_fit,
    "mirror": oren_nayar_mirror,
    "direct": oren_nayar_direct,
}


def material(setup: Setup, estimator: str, kind: str, sigma: float, albedo: Any, suns: tuple[Object, ...]) -> Material:
    """The estimator's group with these inputs, bound to ``suns``."""
    module, osl = MODULES[estimator], setup.backend == "osl"
    arguments = {} if estimator in {"closure", "fit"} else {"lamps": len(suns)}
    build = partial(module.build_osl if osl else module.build, kind=kind, **arguments)
    made = bpy.data.materials.new(module.NAME)
    if bpy.app.version < (5, 0, 0):  # as in material.py; goes with 4.5 LTS
        made.use_nodes = True
    made.cycles.emission_sampling, made.cycles.use_bump_map_correction = "NONE", False
    tree = made.node_tree
    tree.nodes.clear()
    node, output = tree.nodes.new("ShaderNodeGroup"), tree.nodes.new("ShaderNodeOutputMaterial")
    node.node_tree = nodegroups.ensure(f"{module.NAME} {kind} {setup.backend}", module.REVISION, build)
    node.inputs["Base Color"].default_value = (*np.broadcast_to(albedo, 3), 1.0)
    node.inputs["Sigma"].default_value = sigma
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for sun in suns:
        source = tree.nodes.new("ShaderNodeGroup")
        build_sun = partial(lamp.build_osl if osl else lamp.build, kind="SUN", shadows=False)
        source.node_tree = nodegroups.ensure(f"Sun {setup.backend}", lamp.REVISION, build_sun)
        lamps.bind(source, sun)
        tree.links.new(source.outputs["To Lamp"], node.inputs["To Lamp 1"])
        tree.links.new(source.outputs["Irradiance"], node.inputs["Irradiance 1"])
    return made


def _measure(
    setup: Setup, estimator: str, kind: str, sigma: float, geometry: gonio.Geometry, *, samples: int = 1,
    albedo: Any = ALBEDO,
) -> NDArray[np.float64]:  # fmt: skip
    def make(suns: tuple[Object, ...]) -> Material:
        return material(setup, estimator, kind, sigma, albedo, suns if estimator == "direct" else ())

    with headless.quiet():
        return gonio._measure(make, geometry, samples, 0, setup.shading_osl).astype(np.float64)


def _exact_row(test: str, setup: Setup, kind: str, sigma: float, evaluate: Callable[..., Any], bar: float) -> Row:
    row = Row(test, setup, kind, sigma)
    for theta_i in check.THETAS:
        geometry = gonio.Geometry(theta_i)
        expected = evaluate(geometry.wi(), geometry.wo())
        measured = _measure(setup, test, kind, sigma, geometry)
        row.views.append(View(geometry, measured, expected, bar, float(np.max(expected))))
    return row


def direct_row(setup: Setup, kind: str, sigma: float) -> Row:
    """``direct`` at every theta_i against the formula."""
    return _exact_row("direct", setup, kind, sigma, model(kind, sigma).evaluate, DIRECT_BAR)


def closure_row(setup: Setup, kind: str, sigma: float) -> Row:
    """``closure`` against the closed formula of Cycles' own model, at the roughness that stands for sigma."""
    reference = model(kind, sigma)
    r = fit.closure_roughness(reference.sigma, qualitative=reference.qualitative)

    def evaluate(wi: NDArray[np.float64], wo: NDArray[np.float64]) -> NDArray[np.float64]:
        return fit.cycles_diffuse(wi, wo, reference.albedo, r)

    return _exact_row("closure", setup, kind, sigma, evaluate, NATIVE_BAR)


def fit_row(setup: Setup, kind: str, sigma: float) -> Row:
    """``fit`` against the fitted BRDF; how near that is to Oren-Nayar 1994, ``tools/fit_oren_nayar.py`` says."""
    reference = model(kind, sigma)

    def evaluate(wi: NDArray[np.float64], wo: NDArray[np.float64]) -> NDArray[np.float64]:
        return fit.oren_nayar_fit(wi, wo, reference.albedo, reference.sigma, qualitative=reference.qualitative)

    return _exact_row("fit", setup, kind, sigma, evaluate, NATIVE_BAR)


def furnace_row(setup: Setup, kind: str, sigma: float, albedo: Any = ALBEDO) -> Row:
    """``mirror`` under a uniform white world: the directional albedo. E[w^2] is the integral of pi f^2 cos."""
    reference = model(kind, sigma, albedo)
    geometry = gonio.Geometry(furnace=True, resolution=(32, 32))
    column = geometry.wo()[:, :1]
    mean = np.broadcast_to(reference.directional_albedo(column), (32, 32, 3))
    square = diffuse_albedo(column, lambda wi, wo: np.pi * reference.evaluate(wi, wo) ** 2)
    variance = np.maximum(square - mean**2, 0.0) / FURNACE_SAMPLES
    measured = _measure(setup, "mirror", kind, sigma, geometry, samples=FURNACE_SAMPLES, albedo=albedo)
    return Row("mirror, furnace", setup, kind, sigma, [View(geometry, measured, mean, variance=variance)])


def sun_row(setup: Setup, kind: str, sigma: float) -> Row:
    """``mirror`` under a sun of 30 degrees: the mean of f over its disc, weighted by the cosine."""
    reference = model(kind, sigma)
    row = Row("mirror, sun", setup, kind, sigma)
    for theta_i in SUN_THETAS:
        geometry = gonio.Geometry(theta_i, resolution=(16, 16), sun_angle=SUN_ANGLE)
        wo = geometry.wo()
        mean, square = np.zeros_like(wo), np.zeros_like(wo)
        # The disc has the radiance that lights a facing plane with 1/cos(theta_i).
        radiance = 1.0 / np.cos(np.radians(theta_i)) / (np.pi * np.sin(np.radians(SUN_ANGLE / 2)) ** 2)
        for wi, weight in zip(*check.disc(geometry), strict=True):
            f = reference.evaluate(wi, wo)
            mean += weight * radiance * f * wi[2]
            square += weight * radiance**2 * f**2 * wi[2] * np.pi
        measured = _measure(setup, "mirror", kind, sigma, geometry, samples=SUN_SAMPLES)
        variance = np.maximum(square - mean**2, 0.0) / SUN_SAMPLES
        # Below 25 expected hits a count is too skewed for a normal limit: such pixels are judged together.
        hits = SUN_SAMPLES * mean[..., 0] / radiance
        pooled = [check.pool(image, hits) for image in (measured, mean, variance)]
        row.views.append(View(geometry, pooled[0], pooled[1], variance=pooled[2]))
    return row


def model(kind: str, sigma: float, albedo: Any = ALBEDO) -> OrenNayar:
    """The reference with what float32 sockets hold of the parameters."""
    held = min(float(np.float32(sigma)), np.pi / 2)
    return OrenNayar(np.float64(np.float32(albedo)), held, qualitative=kind == "qualitative")


def plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """Every row, as the function that measures it and its arguments."""
    rows: list[tuple[Callable[..., Row], tuple[Any, ...]]] = []
    for setup in check.SETUPS:
        few = setup is check.SETUPS[1]  # the same nodes as in SVM, and slow to compile
        for kind in fit.KINDS:
            sigmas = (0.3,) if few else SIGMAS
            rows += [(row, (setup, kind, sigma)) for row in (direct_row, closure_row, fit_row) for sigma in sigmas]
            rows += [(furnace_row, (setup, kind, sigma)) for sigma in ((0.3,) if few else MIRROR_SIGMAS)]
        if setup is not check.SETUPS[1]:  # nodes run as OSL draw the very same directions: the furnace shows it
            rows += [(sun_row, (setup, "full", sigma)) for sigma in MIRROR_SIGMAS]
            rows.append((sun_row, (setup, "qualitative", MIRROR_SIGMAS[-1])))
    return rows
