# SPDX-License-Identifier: GPL-3.0-or-later
"""MERL's .binary: isotropic BRDFs in half and difference angles, 90 x 90 x 180 entries a channel.

A file is three int32 (90, 90, 180) and 3 x 90 x 90 x 180 float64, little-endian: all of red, then green, then blue,
phi_d fastest. Red is in 1/1500 of 1/sr, green in 1.15/1500, blue in 1.66/1500. Entry i, j, k belongs to the cell
    theta_h in (pi/2) [(i/90)^2, ((i+1)/90)^2),  theta_d in [j, j+1) degrees,  phi_d in [k, k+1) degrees,
h is the half vector; theta_d and phi_d are wi's in the frame whose z axis is h and whose y axis is perpendicular to
the normal. Reciprocity turns phi_d into phi_d + 180 degrees, so half of them are enough; files with 360 hold all.

Sources:
    Matusik, Pfister, Brand & McMillan 2003, A Data-Driven Reflectance Model, SIGGRAPH, doi:10.1145/882262.882343
    Rusinkiewicz 1998, A New Change of Variables for Efficient BRDF Representation, EGWR
"""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

import numpy as np

from ..library.files import FileError, check_writable, replacing
from ..reference.directions import above, norm
from .table import Contents, Table, between, is_reflectance

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from ..reference.directions import Floats
    from ..reference.model import Brdf

THETA_H, THETA_D = 90, 90
PHI_D = 180, 360  # reciprocal, and not
SIZES = tuple((THETA_H, THETA_D, one) for one in PHI_D)
SCALE = np.array([1.0, 1.15, 1.66]) / 1500.0  # 1/sr
HEADER = struct.Struct("<3i")
INVALID = -1.0
FILLED = (
    "along theta_d, by the entry before, or else the entry after; a theta_h and phi_d without any, by the theta_h "
    "before, or else after. The same beyond the horizon. Held constant beyond theta_h 89 and theta_d 89.5 degrees"
)


class Merl(Table):
    """A table (3, 90, 90, 180 or 360) of RGB in 1/sr, interpolated linearly between the cells' centres.

    The interpolation is linear in sqrt(theta_h), theta_d and phi_d, and periodic in phi_d. ``table`` is changed: its
    holes are filled. ``whole`` says which entries were none.
    """

    def __init__(self, table: Floats) -> None:
        if table.shape[:3] != (3, THETA_H, THETA_D) or table.shape[3] not in PHI_D:
            message = f"a MERL table has the shape (3, 90, 90, 180 or 360), got {table.shape}"
            raise ValueError(message)
        phi_d = table.shape[3]
        self.whole = is_reflectance(table[0])
        for channel in table[1:]:
            self.whole &= is_reflectance(channel)
        lit = _lit(phi_d)
        self.contents = Contents(
            format="MERL .binary",
            text="",
            size=f"{THETA_H} theta_h x {THETA_D} theta_d x {phi_d} phi_d, RGB"
            + ("" if phi_d == PHI_D[0] else ", not reciprocal"),
            isotropic=True,
            entries=lit.size,
            below=int(lit.size - lit.sum()),
            holes=int((lit & ~self.whole).sum()),
            filled=FILLED,
        )
        self.whole &= lit
        _fill(table, self.whole)
        self.table = table

    def look_up(self, wi: Floats, wo: Floats) -> Floats:
        return self._interpolate(*self._positions(wi, wo))

    def _positions(self, wi: Floats, wo: Floats) -> tuple[Floats, Floats, Floats]:
        """Along the three axes, in entries from the first one's centre."""
        theta_h, theta_d, phi_d = half_and_difference(wi, wo)
        h, d = np.sqrt(theta_h / (np.pi / 2)) * THETA_H, theta_d / (np.pi / 2) * THETA_D
        return h - 0.5, d - 0.5, np.degrees(phi_d) - 0.5

    def _interpolate(self, h: Floats, d: Floats, phi: Floats) -> Floats:
        i, a = between(h, THETA_H)
        j, b = between(d, THETA_D)
        k = np.floor(phi).astype(np.intp)
        c = phi - k
        f = np.zeros((3, h.size))
        for di, dj, dk in np.ndindex(2, 2, 2):
            weight = (a if di else 1.0 - a) * (b if dj else 1.0 - b) * (c if dk else 1.0 - c)
            f += weight * self.table[:, i + di, j + dj, (k + dk) % self.table.shape[3]]
        return f.T

    def grid_error(self, wi: Floats, wo: Floats) -> Floats:
        """How far f(wi, wo) may be from what the entries were taken from, in 1/sr (n, 3), for pairs (n, 3).

        Let g have the second derivative k along an axis, in steps of it, and a kink in a cell at x of 0 to 1, where its
        slope jumps by J. Interpolation is off by at most J x (1 - x) + k/8, or the larger of the two if they differ in
        sign. The second differences of the four nodes around the cell are k, k + J (1 - x), k + J x and k. With M the
        largest size among them, |k| <= M and |J| max(x, 1 - x) <= 2 M, so the error is at most M. Axes add up, as an
        interpolation never increases the largest value. M is taken over all lines up to one node beside the cell,
        because what lies between the nodes of the other axes is not known. Infinite in cells that touch a hole, the
        horizon or the end of an axis.
        """
        positions = self._positions(wi, wo)
        cell = [np.floor(position).astype(np.intp) for position in positions]
        inside = (cell[0] >= 0) & (cell[0] < THETA_H - 1) & (cell[1] >= 0) & (cell[1] < THETA_D - 1)
        error = np.zeros((3, wi.shape[0]))
        for axis in range(3):
            largest = np.zeros_like(error)
            for beside in np.ndindex(4, 4):  # from one node before the cell to one behind
                at = [self._entries(cell, np.insert(np.array(beside) - 1, axis, step)) for step in range(-2, 4)]
                for first, middle, last in zip(at, at[1:], at[2:], strict=False):
                    largest = np.maximum(largest, np.abs(first - 2.0 * middle + last))
            error += largest
        return np.where(inside & ~np.isnan(error), error, np.inf).T

    def _entries(self, cell: list[NDArray[np.intp]], step: NDArray[np.intp]) -> Floats:
        """Entries ``step`` from each cell, held at the ends of the axes; NaN where there is no reflectance."""
        i, j, k = (one + far for one, far in zip(cell, step, strict=True))
        i, j, k = np.clip(i, 0, THETA_H - 1), np.clip(j, 0, THETA_D - 1), k % self.table.shape[3]
        return np.where(self.whole[i, j, k], self.table[:, i, j, k], np.nan)


def half_and_difference(wi: Floats, wo: Floats) -> tuple[Floats, Floats, Floats]:
    """theta_h, theta_d and phi_d in [-pi, pi] of pairs (..., 3), in radians.

    Angles are taken from sines and cosines both: an arc cosine alone would lose the digits of narrow lobes.
    """
    total = wi + wo
    cos_d, sin_d = norm(total) / 2.0, norm(wi - wo) / 2.0
    h = total / (2.0 * cos_d)[..., None]
    sin_h = np.hypot(h[..., 0], h[..., 1])
    along = np.where((sin_h > 0)[..., None], h[..., :2] / np.where(sin_h > 0, sin_h, 1.0)[..., None], [1.0, 0.0])
    # wi's components along the frame's axes: x in the plane of h and the normal, y perpendicular to it
    x = (wi[..., 0] * along[..., 0] + wi[..., 1] * along[..., 1]) * h[..., 2] - wi[..., 2] * sin_h
    y = wi[..., 1] * along[..., 0] - wi[..., 0] * along[..., 1]
    return np.arctan2(sin_h, h[..., 2]), np.arctan2(sin_d, cos_d), np.arctan2(y, x)


def directions(theta_h: Floats, theta_d: Floats, phi_d: Floats) -> tuple[Floats, Floats]:
    """wi and wo (..., 3) of these angles in radians, with h in the plane of x and z."""
    sin, cos = np.sin(theta_h), np.cos(theta_h)
    across, along = np.sin(theta_d) * np.cos(phi_d), np.cos(theta_d)
    side = np.sin(theta_d) * np.sin(phi_d)

    def turned(x: Floats, y: Floats) -> Floats:
        return np.stack(np.broadcast_arrays(cos * x + sin * along, y, cos * along - sin * x), axis=-1)

    return turned(across, side), turned(-across, -side)


def _centres(phi_d: int) -> tuple[Floats, Floats, Floats]:
    """Angles of the entries' centres, in radians."""
    theta_h = np.square((np.arange(THETA_H) + 0.5) / THETA_H) * np.pi / 2
    theta_d = (np.arange(THETA_D) + 0.5) / THETA_D * np.pi / 2
    return theta_h, theta_d, np.radians(np.arange(phi_d) + 0.5)


def rows(phi_d: int) -> Iterator[tuple[Floats, Floats]]:
    """wi and wo (90, phi_d, 3) of the entries of each theta_h."""
    theta_h, theta_d, phi = _centres(phi_d)
    for one in theta_h:
        yield directions(one, theta_d[:, None], phi)


def _lit(phi_d: int) -> NDArray[np.bool_]:
    """Entries (90, 90, phi_d) whose centre has both directions above the horizon."""
    return np.stack([above(wi, wo) for wi, wo in rows(phi_d)])


def _fill(table: Floats, whole: NDArray[np.bool_]) -> None:
    """Give entries that are not ``whole`` a value, as ``FILLED`` says."""
    known = whole.copy()
    if not known.any():
        message = "holds no reflectance: every entry is negative or not finite; measure again"
        raise FileError(message)
    for axis, length in ((1, THETA_D), (0, THETA_H)):
        values, there = np.moveaxis(table, axis + 1, 1), np.moveaxis(known, axis, 0)  # views
        for order in (range(1, length), range(length - 2, -1, -1)):
            step = order.step
            for index in order:
                gap = ~there[index] & there[index - step]
                values[:, index][:, gap] = values[:, index - step][:, gap]
                there[index] |= gap


def is_merl(content: bytes) -> bool:
    """Whether a file's beginning is a MERL header's, in either order of bytes."""
    return len(content) >= HEADER.size and any(struct.unpack_from(f"{order}3i", content) in SIZES for order in "<>")


def read_merl(content: bytes) -> Merl:
    """The table in the bytes of a .binary file; FileError says what is wrong with them."""
    if len(content) < HEADER.size:
        message = f"ends after {len(content)} bytes, within the header of a MERL file; get the whole file"
        raise FileError(message)
    sizes = HEADER.unpack_from(content)
    if sizes not in SIZES:
        message = f"has {' x '.join(map(str, sizes))} entries; a MERL file has 90 x 90 x 180, or 360 phi_d; resample it"
        if is_merl(content):
            message = "is a MERL file whose bytes are swapped (big-endian); convert it to little-endian"
        raise FileError(message)
    wanted = HEADER.size + 3 * 8 * int(np.prod(sizes))
    if len(content) != wanted:
        what = "is cut off" if len(content) < wanted else "is too long"
        message = f"{what}: {len(content)} bytes, where a MERL file of {sizes[2]} phi_d has {wanted}; get it again"
        raise FileError(message)
    table = np.frombuffer(content, "<f8", offset=HEADER.size).reshape(3, *sizes).astype(np.float64)
    for channel, scale in zip(table, SCALE, strict=True):
        channel *= scale  # noqa: PLW2901 (in place: a copy would be the size of the file)
    return Merl(table)


def tabulate(f: Brdf, phi_d: int = PHI_D[0]) -> Floats:
    """A table (3, 90, 90, phi_d) of f(wi, wo) at the cells' centres; -1 where a direction is below the horizon."""
    table = np.full((3, THETA_H, THETA_D, phi_d), INVALID)
    for index, (wi, wo) in enumerate(rows(phi_d)):
        lit = above(wi, wo)
        table[:, index, lit] = f(wi[lit], wo[lit]).T
    return table


def write_merl(path: Path, table: Floats) -> None:
    """Write a table (3, 90, 90, 180 or 360) of RGB in 1/sr as .binary; what is no reflectance becomes -1.

    Values are divided by the format's scale, which rounds them once, by at most 1.1e-16 of themselves.
    """
    check_writable(path)
    with replacing(path) as temporary, temporary.open("wb") as file:
        file.write(HEADER.pack(*table.shape[1:]))
        for channel, scale in zip(table, SCALE, strict=True):
            for row in channel:
                file.write(np.where(is_reflectance(row), row / scale, INVALID).astype("<f8").tobytes())
