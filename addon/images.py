# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's images as arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from bpy.types import Image
    from numpy.typing import NDArray


def pixels(image: Image) -> NDArray[np.float32]:
    """RGB as stored, (H, W, 3), row 0 on top."""
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    width, height = image.size
    return flat.reshape(height, width, -1)[::-1, :, :3]
