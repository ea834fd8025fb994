# SPDX-License-Identifier: GPL-3.0-or-later
"""To come."""

from __future__ import annotations

from typing import TYPE_CHECKING

import flip_evaluator
import numpy as np

from ..images import srgb

if TYPE_CHECKING:
    from numpy.typing import NDArray


def flip(reference: NDArray[np.floating], picture: NDArray[np.floating]) -> float:
    a, b = (np.ascontiguousarray(srgb(np.asarray(one, np.float32)), np.float32) for one in (reference, picture))
    return float(flip_evaluator.evaluate(a, b, "LDR", applyMagma=False)[1])
