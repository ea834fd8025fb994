# SPDX-License-Identifier: GPL-3.0-or-later
"""Spectra to linear Rec.709 RGB: under D65, as the CIE 1931 2-degree observer sees them.

RGB = sum of weight x reflectance over 380 to 780 nm in steps of 5 (``rgb_weights.csv``), the weights by which the
presets were integrated. Spectra are interpolated linearly, and held constant beyond their ends. Readers
clip colours outside Rec.709 at 0.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..reference.directions import Floats

FROM_XYZ = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)  # IEC 61966-2-1, D65


@cache
def _table() -> Floats:
    return np.loadtxt(Path(__file__).with_name("rgb_weights.csv"), delimiter=",", skiprows=2)


def rgb_weights(wavelengths: NDArray[Any]) -> Floats:
    """What each of ``wavelengths`` (n,) in nm, which rise, adds to RGB: (n, 3). A spectrum of 1 gives 1, 1, 1."""
    table = _table()
    each = np.eye(wavelengths.size)
    return np.stack([np.interp(table[:, 0], wavelengths, one) @ table[:, 1:] for one in each])
