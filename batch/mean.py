# SPDX-License-Identifier: GPL-3.0-or-later
"""The mean of independent pictures of one scene, and how far noise leaves it from the truth. Imports no bpy."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Mean:
    """Pictures X_b of n_b samples a pixel each: their mean M, weighted by n_b, and its error.

    With N = sum n_b over B pictures, sigma^2 = sum n_b (X_b - M)^2 / (B - 1) is each pixel's variance of one sample,
    and sigma^2 / N that of M. Samples that are spread evenly, as Cycles spreads them, make the true error smaller.
    """

    def __init__(self) -> None:
        self.samples = self._count = 0
        self._sum: NDArray[np.float64] | float = 0.0
        self._squares: NDArray[np.float64] | float = 0.0

    def add(self, picture: NDArray[np.floating], samples: int) -> None:
        wide = np.asarray(picture, np.float64)
        self.samples, self._count = self.samples + samples, self._count + 1
        self._sum = self._sum + samples * wide
        self._squares = self._squares + samples * wide**2

    @property
    def picture(self) -> NDArray[np.float32]:
        """M, as float32."""
        return np.asarray(self._sum / self.samples, np.float32)

    @property
    def error(self) -> float:
        """The root mean square of M's standard error over pixels and channels, over the mean of M; nan of one picture.

        inf of a picture that is black but for noise, 0 of one without noise.
        """
        if self._count < 2:
            return float("nan")
        mean = self._sum / self.samples
        variance = np.maximum(np.asarray(self._squares) - self.samples * mean**2, 0.0) / (self._count - 1)
        noise = float(np.sqrt(np.mean(variance / self.samples)))
        shown = abs(float(np.mean(mean)))
        return 0.0 if noise == 0.0 else noise / shown if shown else float("inf")
