# SPDX-License-Identifier: GPL-3.0-or-later
"""Views of estimators whose variance no formula gives, as Cycles chooses between closures: it is taken from seeds.

Or from the pixels of one theta_o, which are alike in all but their noise.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...addon.reference import rendered
from ...addon.reference.hybrid import DEFAULT_BOUND
from .rows import Setup, View
from .views import FURNACE_SIZE, disc, furnace, measure, pool, sun_radiance

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...addon.blender import gonio
    from ...addon.library.presets import Preset


def furnace_directions() -> NDArray[np.float64]:
    """wo of each row of ``furnace``, in the plane of x and z, (32, 3): all that an isotropic model needs."""
    cosine = furnace().wo()[:, 0, 2]
    return np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)


def furnace_view(
    preset: Preset, setup: Setup, estimator: str, expected: NDArray[np.float64], *, samples: int = 256, seeds: int = 4,
    doubt: NDArray[np.float64] | float = 0.0,
) -> View:  # fmt: skip
    """Under a white sky, against the directional albedo ``expected``, known to within ``doubt``.

    expected: (32, 1, 3) of an isotropic model, where the pixels of a row are alike in all but noise and share a
    variance; or (32, 32, 3), where each pixel has the variance of its own ``seeds``. doubt: of that shape, or a number.
    """
    images = np.stack([measure(preset, setup, estimator, furnace(), samples, seed) for seed in range(seeds)])
    alike = expected.shape[1] == 1
    spread = np.var(images, axis=(0, 2) if alike else 0, ddof=1).reshape(expected.shape) / seeds
    # A wrong reference is the same in all pixels of a row, whose sum it moves by as many times itself.
    variance = spread + FURNACE_SIZE * np.square(doubt)
    full = np.ones((FURNACE_SIZE, FURNACE_SIZE, 3))
    return View(
        furnace(), images.mean(axis=0), expected * full, variance=variance * full,
        degrees=seeds * (FURNACE_SIZE if alike else 1) - 1,
    )  # fmt: skip


def sun_view(
    preset: Preset, setup: Setup, estimator: str, geometry: gonio.Geometry, samples: int, share: float, seeds: int = 16
) -> View:
    """Under a sun with an angle: the mean of f over its disc, weighted by the cosine.

    samples: per pixel, over all seeds. share: of these, at least so many look for the sun by a random ray.
    """
    evaluate = rendered(preset.reference(), estimator, DEFAULT_BOUND)
    wo = geometry.wo()
    expected = np.zeros_like(wo)
    radiance = sun_radiance(geometry)
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
