# SPDX-License-Identifier: GPL-3.0-or-later
"""UTIA's .bin: anisotropic BRDFs in steps of 15 degrees of theta and 7.5 of phi, for both directions.

float64, little-endian, without a header: R, then G, then B; of each theta_i (0 to 75), phi_i (0 to 352.5), theta_o and
phi_o, the last fastest. Values are taken as they stand, as linear RGB in 1/sr. Readers differ about that:
docs/measured.md.

Source: Filip & Vavra 2014, Template-Based Sampling of Anisotropic BRDFs, Computer Graphics Forum 33(7),
doi:10.1111/cgf.12477
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..library.files import FileError
from .table import LARGEST, Contents, Table, between, is_reflectance

if TYPE_CHECKING:
    from ..reference.directions import Floats

THETA, PHI = 6, 48
STEP_THETA, STEP_PHI = np.radians(15.0), np.radians(7.5)
SHAPE = (3, THETA, PHI, THETA, PHI)
SIZE = 8 * int(np.prod(SHAPE))
FILLED = (
    "negative ones, which are noise in the dark, by 0; others by the entry before along phi_o, or else phi_i, theta_o, "
    "theta_i. Held constant beyond a theta of 75 degrees"
)


class Utia(Table):
    """A table (3, theta_i, phi_i, theta_o, phi_o) of RGB in 1/sr, interpolated linearly; its holes are filled."""

    def __init__(self, table: Floats) -> None:
        whole = is_reflectance(table).all(axis=0)
        if not whole.any():
            message = "holds no reflectance: every entry is negative or not finite; get the file again"
            raise FileError(message)
        self.contents = Contents(
            format="UTIA .bin",
            text="",
            size=f"{THETA} theta_i x {PHI} phi_i x {THETA} theta_o x {PHI} phi_o, RGB",
            isotropic=False,
            entries=whole.size,
            below=0,
            holes=int((~whole).sum()),
            filled=FILLED,
        )
        table[(table < 0) & (table >= -LARGEST)] = 0.0
        whole = is_reflectance(table).all(axis=0)
        for axis in (3, 1, 2, 0):
            for _ in range(whole.shape[axis]):
                gap = ~whole & np.roll(whole, 1, axis)
                if not gap.any():
                    break
                for channel in table:
                    channel[gap] = np.roll(channel, 1, axis)[gap]
                whole |= gap
        self.table = table

    def look_up(self, wi: Floats, wo: Floats) -> Floats:
        places, shares = [], []
        for v in (wi, wo):
            before, share = between(np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2]) / STEP_THETA, THETA)
            turn = np.arctan2(v[:, 1], v[:, 0]) / STEP_PHI
            first = np.floor(turn).astype(np.intp)
            places += [before, first]
            shares += [share, turn - first]
        f = np.zeros((3, len(wi)))
        for steps in np.ndindex(2, 2, 2, 2):
            weight = np.prod([a if step else 1.0 - a for step, a in zip(steps, shares, strict=True)], axis=0)
            i, j, k, n = (place + step for place, step in zip(places, steps, strict=True))
            f += weight * self.table[:, i, j % PHI, k, n % PHI]
        return f.T


def read_utia(content: bytes) -> Utia:
    """The BRDF in the bytes of a .bin file; FileError says what is wrong with them."""
    if len(content) != SIZE:
        what = "is cut off" if len(content) < SIZE else "is too long"
        message = f"{what}: {len(content)} bytes, where a UTIA file has {SIZE}; get it again"
        raise FileError(message)
    raw = np.frombuffer(content, "<f8")
    if _sensible(raw) < 0.5 < _sensible(raw.view(">f8")):
        message = "is a UTIA file whose bytes are swapped (big-endian); convert it to little-endian"
        raise FileError(message)
    return Utia(raw.reshape(SHAPE).astype(np.float64))


def _sensible(values: Floats) -> float:
    """Share of values that a measurement could give; of random bytes a twentieth is."""
    size = np.abs(values)
    return float(np.mean((size == 0) | ((size > 1e-12) & (size < 1e12))))
