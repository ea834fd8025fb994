# SPDX-License-Identifier: GPL-3.0-or-later
"""ASTM E1392: scattered directions as text, a pair on each line.

Keywords with values come first, among them NUM_POINTS; VARS names the columns, then follow the numbers, with commas
or spaces between them. Four columns are angles: theta_i, phi_i, theta_s (or theta_r, theta_o) and phi_s. The others are
R, G, B or X, Y, Z under D65 or wavelengths (550nm) or one BRDF for all. Angles are in radians, or in degrees if a polar
angle is above 1.6. Azimuths are taken as they stand. A CSV whose first line names these columns is read the same way.

Between pairs f is the mean of the four that are nearest, weighted by 1/d^2 (Shepard 1968, A two-dimensional
interpolation function for irregularly-spaced data, doi:10.1145/800186.810616), d^2 = |wi - wi'|^2 + 4 |h - h'|^2: peaks
stay with the half vector. If all phi_i are equal the surface is isotropic, and both sides of the plane of incidence the
same.

Source of the format: ASTM E1392-96, Standard Practice for Angle Resolved Optical Scatter Measurements, annex
"""

from __future__ import annotations

import re
from array import array
from typing import TYPE_CHECKING

import numpy as np

from ..library.files import FileError
from ..reference.directions import norm, spherical
from .spectrum import FROM_XYZ, rgb_weights
from .table import Contents, Table, is_reflectance

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ..reference.directions import Floats

VARS = re.compile(rb"^[ \t]*(?:VARS[ \t,]+|(?=theta_i[ \t]*,))", re.MULTILINE)  # the names alone are our CSV's
HEAD = 2**16  # bytes within which VARS must come
ANGLES = (("theta_i",), ("phi_i",), ("theta_s", "theta_r", "theta_o"), ("phi_s", "phi_r", "phi_o"))
WAVELENGTH = re.compile(r"(\d+(?:\.\d+)?)\s*nm", re.IGNORECASE)
MOST_COLUMNS = 4096
RADIANS = 1.6  # a polar angle above this is in degrees: pi/2 with the rounding of files
LARGEST_ANGLE = 720.0
NEAREST = 4
DISTANCES = 2**20  # that are computed at once
EXACT = 1e-10  # d^2 of a pair that is met, about (2 arc seconds)^2
FILLED = (
    "by what is near: pairs with a negative or impossible value are left out, as are those below the horizon, and "
    "everywhere f is the mean of the four nearest pairs"
)


class Astm(Table):
    """Angles (n, 4) in radians: theta_i, phi_i, theta_o, phi_o; RGB (n, 3) in 1/sr."""

    def __init__(self, angles: NDArray[np.float32], rgb: NDArray[np.float32], text: str, columns: int) -> None:
        below = (np.abs(angles[:, (0, 2)]) >= np.pi / 2).any(axis=1)
        whole = is_reflectance(rgb).all(axis=1)
        use = whole & ~below
        if not use.any():
            message = "holds no reflectance: each pair is below the horizon, negative or not finite; measure again"
            raise FileError(message)
        self.angles, self.rgb = angles[use], rgb[use]
        self.isotropic = bool(np.ptp(angles[:, 1]) == 0)
        self.contents = Contents(
            format="ASTM E1392 text",
            text=text,
            size=f"{len(angles)} pairs of directions, {columns} column{'s' * (columns > 1)}",
            isotropic=self.isotropic,
            entries=len(angles),
            below=int(below.sum()),
            holes=int((~whole & ~below).sum()),
            filled=FILLED,
        )

    def look_up(self, wi: Floats, wo: Floats) -> Floats:
        step = max(1, DISTANCES // len(self.angles))
        theta_i, phi_i, theta_o, phi_o = self.angles.T
        known = self._place(spherical(theta_i, phi_i), spherical(theta_o, phi_o))
        asked = self._place(wi, wo)
        parts = [self._near(known, asked[start : start + step]) for start in range(0, len(asked), step)]
        return np.concatenate(parts)

    def _near(self, known: Floats, asked: Floats) -> Floats:
        distance = (asked**2).sum(1)[:, None] + (known**2).sum(1) - 2.0 * asked @ known.T
        count = min(NEAREST, len(known))
        near = np.argpartition(distance, count - 1, axis=1)[:, :count]
        weight = 1.0 / (((asked[:, None] - known[near]) ** 2).sum(-1) + EXACT)  # the product above cancels
        return np.einsum("nk,nkc->nc", weight, self.rgb[near]) / weight.sum(1)[:, None]

    def _place(self, wi: Floats, wo: Floats) -> Floats:
        """Where a pair lies, (n, 6): its wi and twice its h, turned to phi_i = 0 and phi_o in [0, 180] if isotropic."""
        if self.isotropic:
            phi = np.arctan2(wo[:, 1], wo[:, 0]) - np.arctan2(wi[:, 1], wi[:, 0])
            sin = np.hypot(wo[:, 0], wo[:, 1])
            wo = np.stack([sin * np.cos(phi), np.abs(sin * np.sin(phi)), wo[:, 2]], axis=1)
            wi = np.stack([np.hypot(wi[:, 0], wi[:, 1]), np.zeros(len(wi)), wi[:, 2]], axis=1)
        h = (wi + wo) / norm(wi + wo)[:, None]
        return np.concatenate([wi, 2.0 * h], axis=1)


def is_astm(content: bytes) -> bool:
    """Whether a file's beginning is an ASTM header's."""
    return VARS.search(content, 0, HEAD) is not None


def read_astm(content: bytes) -> Astm:
    """The BRDF in the bytes of an ASTM file; FileError says what is wrong with them, and in which line."""
    found = VARS.search(content, 0, HEAD)
    if found is None:
        message = 'has no line "VARS theta_i,phi_i,theta_s,phi_s,..."; add one that names the columns'
        raise FileError(message)
    end = content.find(b"\n", found.end())
    end = len(content) if end < 0 else end
    head = content[: found.start()].decode("utf-8", "replace")
    names = re.split(r"[\s,;]+", content[found.end() : end].decode("utf-8", "replace").strip())
    places, to_rgb = _columns(names)
    angles, rgb = _numbers(content, end + 1, len(names), places, to_rgb)
    points = re.search(r"NUM_POINTS[\s,:=]+(\d{1,12})\b", head)
    if points and int(points[1]) != len(angles):
        message = f"NUM_POINTS says {points[1]}, but {len(angles)} lines of numbers follow; get the whole file"
        raise FileError(message)
    if angles.size and np.abs(angles[:, (0, 2)]).max() > RADIANS:
        angles = np.radians(angles)
    text = " ".join(line.strip() for line in head.splitlines() if line.strip().upper().startswith(("SAMPLE", "DESCR")))
    return Astm(angles, rgb, text, len(names) - len(places))


def _columns(names: list[str]) -> tuple[list[int], Floats]:
    """Where the four angles stand, and RGB of each of the other columns (n, 3)."""
    low = [name.lower() for name in names]
    if len(names) > MOST_COLUMNS:
        message = f"VARS names {len(names)} columns, where {MOST_COLUMNS} are the most"
        raise FileError(message)
    places = [next((low.index(name) for name in spellings if name in low), -1) for spellings in ANGLES]
    if -1 in places:
        missing = ANGLES[places.index(-1)][0]
        message = f"VARS names no {missing}; it must name theta_i, phi_i, theta_s and phi_s"
        raise FileError(message)
    others = [name for index, name in enumerate(names) if index not in places]
    wavelengths = [float(match[1]) if (match := WAVELENGTH.fullmatch(name)) else np.nan for name in others]
    if [name.lower() for name in others] == ["r", "g", "b"]:
        return places, np.eye(3)
    if [name.lower() for name in others] == ["x", "y", "z"]:
        return places, FROM_XYZ.T
    if len(others) == 1:
        return places, np.ones((1, 3))
    if others and np.isfinite(wavelengths).all() and (np.diff(wavelengths) > 0).all():
        return places, rgb_weights(np.array(wavelengths))
    message = (
        "VARS must name R,G,B or X,Y,Z or one BRDF or rising wavelengths such as 400nm,410nm beside the angles, got "
    )
    raise FileError(message + ",".join(others)[:80])


def _numbers(
    content: bytes, start: int, count: int, places: list[int], to_rgb: Floats
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Angles (n, 4) and RGB (n, 3) of the lines from ``start``; a row with an impossible value gets NaN."""
    angles, rgb = array("f"), array("f")
    others = [index for index in range(count) if index not in places]
    line = content.count(b"\n", 0, start)
    while start < len(content):
        end = content.find(b"\n", start)
        end = len(content) if end < 0 else end
        words = content[start:end].replace(b",", b" ").replace(b";", b" ").split()
        start, line = end + 1, line + 1
        if not words:
            continue
        try:
            row = np.array(words, dtype=np.float64) if len(words) == count else None
        except ValueError:
            row = None
        if row is None or not (np.abs(row[places]) <= LARGEST_ANGLE).all():
            got = b" ".join(words)[:60].decode("ascii", "backslashreplace")
            message = f"line {line} must be {count} numbers, as VARS names them, with angles up to {LARGEST_ANGLE:g}"
            message += f'; got "{got}"'
            raise FileError(message)
        angles.extend(row[places])
        values = row[others]
        rgb.extend(np.maximum(values @ to_rgb, 0.0) if is_reflectance(values).all() else (np.nan,) * 3)
    return np.array(angles, np.float32).reshape(-1, 4), np.array(rgb, np.float32).reshape(-1, 3)
