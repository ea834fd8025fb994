# SPDX-License-Identifier: GPL-3.0-or-later
"""Views that a formula predicts: of estimators without noise, and of ``mirror``, whose variance the reference gives."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import headless
from ...addon.blender import gonio
from ...addon.models import MODELS
from ...addon.models.estimators import NATIVE
from ...addon.reference import rendered
from ...addon.reference.quadrature import gauss_legendre
from .rows import FLOAT_SUM, ROUNDING, SETUPS, Row, Setup, View

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from numpy.typing import NDArray

    from ...addon.library.presets import Preset
    from ...addon.reference import Model

THETAS = (0.0, 20.0, 45.0, 70.0, 85.0)
OSL_THETAS = (20.0, 70.0)  # of nodes run as OSL, which are the same as in SVM and slow to compile
WINDOW = 5.0
FURNACE_SIZE = 32
# Degrees, by slope m. Broad lobes rarely hit a small sun; a wider one needs as many fewer samples as it is larger.
SUN_ANGLES = {0.1: 20.0, 0.3: 30.0, 0.6: 30.0, 1.0: 30.0}


def noiseless(model: str) -> list[str]:
    """Estimators of a model that have no noise under a sun of zero size: all but ``mirror``, which cannot hit it."""
    return [name for name in MODELS[model].estimators if name != "mirror"]


def direct_bar(m: float) -> float:
    """Largest difference allowed for the formula itself, as a share of the view's maximum."""
    return 2e-5 if m >= 0.1 else 1e-4 if m >= 0.02 else 1e-3


def closure_bar(m: float) -> float:
    """The same for Cycles' own lobe: its 1 - 1/cos^2 rounds by 4 * 2^-24, and exp() divides that by m^2."""
    return max(2e-4, 4.0 * ROUNDING / m**2)


def measure(
    preset: Preset, setup: Setup, estimator: str, geometry: gonio.Geometry, samples: int = 1, seed: int = 0
) -> NDArray[np.float64]:
    """The gonioreflectometer's image of a preset, (H, W, 3) in 1/sr, without Blender's chatter."""
    with headless.quiet():
        image = gonio.measure_preset(
            preset, setup.backend, estimator, geometry, samples=samples, seed=seed, shading_osl=setup.shading_osl
        )
    return image.astype(np.float64)


def noiseless_row(
    estimator: str, setup: Setup, preset: Preset, bar: float, *, variant: str, at: Mapping[str, float],
    windows: tuple[float, ...] = (0.0, WINDOW), lobe: Model | None = None, phi_i: float = 0.0, tangent: float = 0.0,
) -> Row:  # fmt: skip
    """An estimator without noise under a sun of zero size, at every theta_i; ``variant`` and ``at`` name the row.

    phi_i, tangent: azimuths of the light and of the patch's tangent, in degrees.

    There ``corrected`` and ``hybrid`` are the model itself. The bar is a share of the view's largest value, or of
    that of ``lobe``; for these two, where the model is next to 0 the mixture may not be, and what float32 rounds of it
    remains.
    """
    row = Row(estimator, setup, preset.model, variant, at)
    model = turned(preset.reference(), tangent)
    lobe = turned(lobe, tangent) if lobe else model
    native = estimator in NATIVE
    evaluate = rendered(model, estimator if native else "direct")
    scales = [rendered(lobe, estimator if native else "direct")]
    signed = estimator in {"corrected", "hybrid"}  # a difference of two equal numbers, which may round to below 0
    scales += [rendered(lobe, "fit")] if signed else []
    for theta_i in THETAS if setup is not SETUPS[1] else OSL_THETAS:
        for window in windows:
            geometry = gonio.Geometry(theta_i, window, phi_i=phi_i, tangent=tangent)
            wi, wo = geometry.wi(), geometry.wo()
            # Where the view holds less than 2^-64 of the lobe there is only what exp() leaves of its underflow.
            peak = float(np.max(scales[0](wi, wi * [-1.0, -1.0, 1.0])))
            scale = max(*(float(np.max(f(wi, wo))) for f in scales), 2.0**-64 * peak)
            image = measure(preset, setup, estimator, geometry)
            if signed and np.min(image) >= -bar * scale:
                image = np.maximum(image, 0.0)
            row.views.append(View(geometry, image, evaluate(wi, wo), bar, scale))
    return row


def turned(model: Any, tangent: float) -> Any:
    """A reference in the gonioreflectometer's frame, whose patch has its tangent at an azimuth, in degrees."""
    return replace(model, azimuth=model.azimuth + float(np.radians(tangent))) if tangent else model


def sun_radiance(geometry: gonio.Geometry) -> float:
    """Of the sun's disc, in 1/sr, so that it lights a plane that faces it with 1/cos(theta_i)."""
    area = np.pi * np.sin(np.radians(geometry.sun_angle / 2)) ** 2
    return float(1.0 / abs(np.cos(np.radians(geometry.theta_i))) / area)


def disc(
    geometry: gonio.Geometry, rings: int = 16, spokes: int = 48
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Directions (N, 3) over the sun's disc and their solid angles (N,)."""
    x, weight = gauss_legendre(rings)
    height = 1.0 - np.cos(np.radians(geometry.sun_angle / 2))  # solid angle is even in the cosine
    cos, phi = 1.0 - height * x, 2.0 * np.pi * (np.arange(spokes) + 0.5) / spokes
    sin = np.sqrt(1.0 - cos**2)
    phi_i = np.radians(geometry.phi_i)
    axis, across = geometry.wi(), np.array([-np.sin(phi_i), np.cos(phi_i), 0.0])
    up = np.cross(axis, across)
    ring = np.cos(phi)[:, None] * across + np.sin(phi)[:, None] * up
    directions = cos[:, None, None] * axis + sin[:, None, None] * ring
    weights = np.repeat(weight * height * 2.0 * np.pi / spokes, spokes)
    return directions.reshape(-1, 3), weights


def suns(thetas: Iterable[float], angle: float, **azimuths: float) -> list[gonio.Geometry]:
    """Views around the mirror direction of suns ``angle`` degrees wide at each of ``thetas``."""
    return [
        gonio.Geometry(theta_i, window=20.0, resolution=(16, 16), sun_angle=angle, **azimuths)  # type: ignore[arg-type]
        for theta_i in thetas
    ]


def mirror_sun_view(
    preset: Preset, setup: Setup, geometry: gonio.Geometry, samples: int, *, by_density: bool = False
) -> View:
    """``mirror`` under a sun with an angle: the mean of f over its disc, weighted by the cosine.

    by_density: the hits that are expected are those of the draws' density; else as many as a weight of 1 would take.
    """
    model, wo, radiance = turned(preset.reference(), geometry.tangent), geometry.wo(), sun_radiance(geometry)
    mean, square, hits = np.zeros_like(wo), np.zeros_like(wo), np.zeros(wo.shape[:-1])
    for wi, weight in zip(*disc(geometry), strict=True):
        f_cos = model.evaluate(wi, wo) * max(wi[2], 0.0)
        density = model.pdf(wi, wo)
        mean += weight * radiance * f_cos
        square += weight * radiance**2 * f_cos**2 / np.where(density > 0, density, 1.0)[..., None]
        hits += weight * density
    measured = measure(preset, setup, "mirror", geometry, samples=samples)
    expected = samples * hits if by_density else samples * mean[..., 0] / radiance
    return pooled_view(geometry, expected, measured, mean, square, samples)


def furnace() -> gonio.Geometry:
    """A white sky."""
    return gonio.Geometry(furnace=True, resolution=(FURNACE_SIZE, FURNACE_SIZE))


def moments_by_azimuth(
    moment: Callable[[NDArray[np.float64], int], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], ...]:
    """E[w], E[w^2], E[w^3] of a weight at each pixel of a furnace, (32, 32, 3); opposite views see the same.

    moment: of directions and a power.
    """
    half = furnace().wo()[:, : FURNACE_SIZE // 2]
    return tuple(np.concatenate([found, found], axis=1) for found in (moment(half, power) for power in (1, 2, 3)))


def mirror_furnace_view(preset: Preset, setup: Setup, moments: tuple[NDArray[np.float64], ...], samples: int) -> View:
    """``mirror`` under a white sky, against the directional albedo.

    moments: mean, mean square and, where few samples may lose light, mean cube of one sample's weight; each
    broadcasts to (32, 32, 3).
    """
    shape = (FURNACE_SIZE, FURNACE_SIZE, 3)
    mean, square, *cube = (np.broadcast_to(moment, shape) for moment in moments)
    measured = measure(preset, setup, "mirror", furnace(), samples)
    if cube:
        return pooled_view(furnace(), events(mean, square, cube[0], samples), measured, mean, square, samples)
    return View(furnace(), measured, mean, variance=np.maximum(square - mean**2, 0.0) / samples)


def events(
    mean: NDArray[np.float64], square: NDArray[np.float64], cube: NDArray[np.float64], samples: int
) -> NDArray[np.float64]:
    """The count whose skewness is that of a pixel's sum of samples, (H, W); infinite where only rounding is left.

    A Poisson count of n has skewness n^(-1/2); a sum of N samples N^(-1/2) mu_3 / sigma^3.
    """
    variance = np.maximum(square - mean**2, 0.0)[..., 0]
    third = (cube - 3.0 * mean * square + 2.0 * mean**3)[..., 0]
    live = variance / samples > np.square(mean[..., 0] * FLOAT_SUM)
    return np.where(live, samples * variance**3 / np.maximum(third**2, 1e-300), np.inf)


def pooled_view(
    geometry: gonio.Geometry, hits: NDArray[np.float64], measured: NDArray[np.float64],
    mean: NDArray[np.float64], square: NDArray[np.float64], samples: int,
) -> View:  # fmt: skip
    """``measured`` beside the moments of its samples.

    Below 25 expected hits a count is too skewed for a normal limit: such pixels are judged together.
    """
    variance = np.maximum(square - mean**2, 0.0) / samples
    measured, mean, variance = (pool(image, hits) for image in (measured, mean, variance))
    return View(geometry, measured, mean, variance=variance)


def pool(image: NDArray[np.float64], hits: NDArray[np.float64], enough: float = 25.0) -> NDArray[np.float64]:
    """Sums of pixels (N, 3), taken together in order of expected hits until each group expects ``enough``."""
    order = np.argsort(hits.ravel())
    groups = np.floor(np.cumsum(np.minimum(hits.ravel()[order], enough)) / enough).astype(int)
    groups = np.minimum(groups, max(groups.max() - 1, 0))  # the last may not be full
    sums = np.zeros((groups.max() + 1, 3))
    np.add.at(sums, groups, image.reshape(-1, 3)[order])
    return sums
