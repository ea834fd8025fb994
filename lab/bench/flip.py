# SPDX-License-Identifier: GPL-3.0-or-later
"""FLIP: how much two pictures differ to an eye that flips between them, by the library of its authors.

Source: Andersson et al. 2020, FLIP: A Difference Evaluator for Alternating Images, doi:10.1145/3406183
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...addon.blender.images import srgb

if TYPE_CHECKING:
    from numpy.typing import NDArray

ENLARGED = 8.0  # times that a report shows its small pictures
PIXELS_PER_DEGREE = 67.0 / ENLARGED  # 67: the authors' monitor, 0.7 m and 3840 pixels wide, seen from 0.7 m


def flip(reference: NDArray[np.floating], test: NDArray[np.floating], judged: NDArray[np.bool_] | None = None) -> float:
    """Mean FLIP of two pictures in linear RGB, each (H, W, 3): 0 where nobody sees a difference, at most 1.

    judged: (H, W), the pixels that count, all if it is None. Around them both are taken to be ``reference``.

    They are taken as a monitor shows them, through sRGB, what is above 1 as white, each pixel ``ENLARGED``: at the
    authors' 67 pixels a degree a picture of 32 pixels is a dot of half a degree, in which the eye, and with it FLIP's
    filters, averages half of the noise away. The order does not matter. ValueError if the shapes differ.
    """
    import flip_evaluator

    if reference.shape != test.shape or reference.ndim != 3 or reference.shape[-1] != 3:
        message = f"FLIP compares two pictures (H, W, 3) of one size, got {reference.shape} and {test.shape}"
        raise ValueError(message)
    if judged is None:
        judged = np.ones(reference.shape[:2], np.bool_)
    test = np.where(judged[..., None], test, reference)
    shown = [np.ascontiguousarray(srgb(np.asarray(picture, np.float32)), np.float32) for picture in (reference, test)]
    errors, _, _ = flip_evaluator.evaluate(*shown, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE})
    return float(np.mean(np.asarray(errors, np.float64).reshape(judged.shape)[judged]))
