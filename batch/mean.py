# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of independent pictures of one scene, and its standard error. Imports no bpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Mean:
    """Pictures X_b (H, W, 3), linear light, of n_b samples per pixel: their mean M, weighted by n_b, and its error.

    With N = sum n_b over B pictures, sigma^2 = sum n_b (X_b - M)^2 / (B - 1) is each pixel's variance of one sample,
    and sigma^2 / N that of M. Cycles stratifies its samples, which makes the true error smaller.
    """

    def __init__(self) -> None:
        self.samples = self._count = 0
        self._sum: NDArray[np.float64] | float = 0.0
        self._squares: NDArray[np.float64] | float = 0.0

    def add(self, picture: NDArray[np.floating], samples: int) -> None:
        """Add X_b (H, W, 3) of n_b = ``samples`` samples per pixel."""
        wide = np.asarray(picture, np.float64)
        self.samples, self._count = self.samples + samples, self._count + 1
        self._sum = self._sum + samples * wide
        self._squares = self._squares + samples * wide**2

    @property
    def picture(self) -> NDArray[np.float32]:
        """M (H, W, 3), linear light."""
        return np.asarray(self._sum / self.samples, np.float32)

    @property
    def error(self) -> float:
        """RMS of M's standard error over pixels and channels, as a share of the mean of M; nan for one picture.

        inf for a picture whose mean is 0, 0 for one without noise.
        """
        if self._count < 2:
            return float("nan")
        mean = self._sum / self.samples
        variance = np.maximum(np.asarray(self._squares) - self.samples * mean**2, 0.0) / (self._count - 1)
        noise = float(np.sqrt(np.mean(variance / self.samples)))
        shown = abs(float(np.mean(mean)))
        return 0.0 if noise == 0.0 else noise / shown if shown else float("inf")
