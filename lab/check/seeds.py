# SPDX-License-Identifier: GPL-3.0-or-later
"""Views of estimators whose variance no formula gives, as Cycles chooses between closures: it is taken from seeds.

Or from the pixels of one theta_o, which are alike in all but their noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...addon.blender import gonio
from ...addon.reference import rendered
from ...addon.reference.hybrid import DEFAULT_BOUND
from .rows import Setup, View, disc, measure, pool

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...addon.library.presets import Preset

FURNACE_SIZE = 32


def furnace_directions() -> NDArray[np.float64]:
    """wo of each row of ``furnace_view``, in the plane of x and z, (32, 3)."""
    cosine = furnace().wo()[:, 0, 2]
    return np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)


def furnace() -> gonio.Geometry:
    return gonio.Geometry(furnace=True, resolution=(FURNACE_SIZE, FURNACE_SIZE))


def furnace_view(
    preset: Preset, setup: Setup, estimator: str, expected: NDArray[np.float64], *, samples: int = 256, seeds: int = 4,
    doubt: NDArray[np.float64] | float = 0.0,
) -> View:  # fmt: skip
    """Under a white sky, against the albedo of each ``furnace_directions``, (32, 3), known to within ``doubt``."""
    shape = np.ones((FURNACE_SIZE, FURNACE_SIZE, 3))
    images = np.stack([measure(preset, setup, estimator, furnace(), samples, seed) for seed in range(seeds)])
    # A wrong reference is the same in all pixels of a row, whose sum it moves by as many times itself.
    variance = np.var(images, axis=(0, 2), ddof=1) / seeds + FURNACE_SIZE * np.square(doubt)
    return View(
        furnace(), images.mean(axis=0), expected[:, None] * shape, variance=variance[:, None] * shape,
        degrees=seeds * FURNACE_SIZE - 1,
    )  # fmt: skip


def sun_view(
    preset: Preset, setup: Setup, estimator: str, geometry: gonio.Geometry, samples: int, share: float, seeds: int = 16
) -> View:
    """Under a sun with an angle: the mean of f over its disc, weighted by the cosine.

    samples: a pixel, over all seeds. share: at least how many of a pixel's samples look for the sun by a random ray.
    """
    evaluate = rendered(preset.reference(), estimator, DEFAULT_BOUND)
    wo = geometry.wo()
    expected = np.zeros_like(wo)
    # The disc has the radiance that lights a facing plane with 1/cos(theta_i).
    solid_angle = np.pi * np.sin(np.radians(geometry.sun_angle / 2)) ** 2
    radiance = 1.0 / np.cos(np.radians(geometry.theta_i)) / solid_angle
    for wi, weight in zip(*disc(geometry), strict=True):
        expected += weight * radiance * evaluate(wi, wo) * max(wi[2], 0.0)
    images = [measure(preset, setup, estimator, geometry, samples // seeds, seed) for seed in range(seeds)]
    # A count of N hits has skewness N^-1/2, and Student's t of n such counts a mean of -(N n)^-1/2 / 2: pixels are
    # judged together until all seeds expect 400, and that is 2.5 % of a standard error.
    hits = share * samples * expected[..., 0] / radiance
    pooled = np.stack([pool(image, hits, 400.0) for image in images])
    variance = np.var(pooled, axis=0, ddof=1) / seeds
    mean = pooled.mean(axis=0)
    return View(geometry, mean, pool(expected, hits, 400.0), variance=variance, degrees=seeds - 1)
