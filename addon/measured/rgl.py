# SPDX-License-Identifier: GPL-3.0-or-later
"""RGL's .bsdf: BRDFs on a grid that is dense where the surface reflects, isotropic or not, as RGB or spectra.

Directions are given as u = (sqrt(2 theta / pi), phi / (2 pi) + 1/2). For each measured wi (phi_i x theta_i) a file has
    vndf             density of visible normals over u(h), bilinear
    rgb or spectra   values S over the unit square into which vndf's cumulative distribution P takes u(h)
and for all of them ndf (the facets' density D) over u(h) and sigma (their projected area) over u(wi). h's phi is
relative to wi's if the surface is isotropic. Then
    f(wi, wo) n.wo = S(P(u(h))) D(u(h)) / (4 sigma(u(wi)))
Between measured wi, vndf, P and S are interpolated linearly in phi_i and theta_i. P(u) is two shares of vndf: of its
row at u's phi, interpolated between two, the part before u's theta; and of all rows those before u's phi. Anisotropic
files may stop at 180 or 90 degrees of phi_i; the rest is symmetric.

Source: Dupuy & Jakob 2018, An Adaptive Parameterization for Efficient Material Acquisition and Rendering,
ACM TOG 37(6), doi:10.1145/3272127.3275059
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..library.files import FileError
from ..reference.directions import norm
from .spectrum import rgb_weights
from .table import Contents, Table, between, between_angles, is_reflectance
from .tensor import fields

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from ..reference.directions import Floats

    Slices = list[tuple[tuple[NDArray[np.intp], NDArray[np.intp]], Floats]]

MOST_SIDE = 2**14
NEEDED = {"phi_i": 1, "theta_i": 1, "sigma": 2, "ndf": 2, "vndf": 4}  # with their dimensions
FILLED = (
    "by the file itself, which marks what was extrapolated; negative and other impossible values by 0. Held constant "
    "below the first theta_i and beyond the last"
)


class Rgl(Table):
    """The arrays of a .bsdf file, and the cumulative distributions of its vndf."""

    def __init__(self, arrays: Mapping[str, NDArray[Any]]) -> None:
        _check(arrays)
        self.phi_i, self.theta_i = (arrays[name].astype(np.float64) for name in ("phi_i", "theta_i"))
        self.sigma, self.ndf, self.vndf = (arrays[name] for name in ("sigma", "ndf", "vndf"))
        self.values, impossible = _rgb(arrays)
        self.has_ndf = bool(arrays["jacobian"].flat[0]) if "jacobian" in arrays else True
        self.isotropic = self.phi_i.size <= 2
        span = 2.0 * np.pi if self.isotropic else float(self.phi_i[-1] - self.phi_i[0])
        self.symmetry = round(2.0 * np.pi / span)
        self.before = np.zeros(self.vndf.shape, np.float32)  # the integral over each row up to a node
        self.rows = np.zeros(self.vndf.shape[:3])  # the integral over whole rows up to one
        for slot in np.ndindex(*self.vndf.shape[:2]):
            for row, before in zip(self.vndf[slot], self.before[slot], strict=True):
                before[1:] = np.cumsum((row[1:].astype(np.float64) + row[:-1]) / 2.0)
            whole = self.before[slot][:, -1].astype(np.float64)
            self.rows[slot][1:] = np.cumsum((whole[1:] + whole[:-1]) / 2.0)
        if not (self.rows[..., -1] > 0).all():
            message = 'field "vndf" is 0 for some theta_i, where no light could be seen; get the file again'
            raise FileError(message)
        self.contents = self._contents(arrays, impossible)

    def _contents(self, arrays: Mapping[str, NDArray[Any]], impossible: NDArray[np.bool_]) -> Contents:
        phi, theta, _, rows, columns = self.values.shape
        holes = impossible
        if "valid" in arrays and arrays["valid"].nbytes * 8 == holes.size:
            holes = impossible | (np.unpackbits(arrays["valid"].view("u1").ravel()) == 0).reshape(holes.shape)
        text = arrays["description"].tobytes().decode("utf-8", "replace") if "description" in arrays else ""
        colour = f"{arrays['wavelengths'].size} wavelengths" if "wavelengths" in arrays else "RGB"
        return Contents(
            format="RGL .bsdf",
            text=text,
            size=f"{phi} phi_i x {theta} theta_i x {rows} x {columns}, {colour}",
            isotropic=self.isotropic,
            entries=holes.size,
            below=0,
            holes=int(holes.sum()),
            filled=FILLED,
        )

    def look_up(self, wi: Floats, wo: Floats) -> Floats:
        wi, wo = self._into_measured(wi, wo)
        h = (wi + wo) / norm(wi + wo)[:, None]
        theta_i, phi_i = _elevation(wi), np.arctan2(wi[:, 1], wi[:, 0])
        phi_h = np.arctan2(h[:, 1], h[:, 0]) - (phi_i if self.isotropic else 0.0)
        x, y = _as_u(_elevation(h), phi_h)
        slices = self._slices(phi_i, theta_i)
        s = _bilinear(self.values, slices, *self._warped(slices, x, y))
        if self.has_ndf:
            s = s * (_plain(self.ndf, x, y) / (4.0 * _plain(self.sigma, *_as_u(theta_i, phi_i))))
        return s.T / wo[:, 2:]

    def _into_measured(self, wi: Floats, wo: Floats) -> tuple[Floats, Floats]:
        """Both turned or mirrored so that wi's azimuth was measured: [-180, 0] or [-180, -90] degrees."""
        if self.symmetry < 2:
            return wi, wo
        y = np.where(wi[:, 1] > 0, -1.0, 1.0)
        x = np.where(wi[:, 0] > 0, -1.0, 1.0) if self.symmetry == 4 else y
        flip = np.stack([x, y, np.ones_like(x)], axis=-1)
        return wi * flip, wo * flip

    def _slices(self, phi_i: Floats, theta_i: Floats) -> Slices:
        """The up to four measured wi around each, and their weights."""
        (p, a), (t, b) = between_angles(phi_i, self.phi_i), between_angles(theta_i, self.theta_i)
        found = []
        for dp, dt in np.ndindex(min(2, self.phi_i.size), min(2, self.theta_i.size)):
            found.append(((p + dp, t + dt), (a if dp else 1.0 - a) * (b if dt else 1.0 - b)))
        return found

    def _warped(self, slices: Slices, x: Floats, y: Floats) -> tuple[Floats, Floats]:
        """The point of the unit square into which the cumulative distribution takes (x, y)."""
        rows, columns = self.vndf.shape[2:]
        (i, a), (j, b) = between(y * (rows - 1), rows), between(x * (columns - 1), columns)
        first, second, part, whole, below, above = np.zeros((6, x.size))
        for (p, t), weight in slices:
            weight = weight / self.rows[p, t, -1]  # noqa: PLW2901 (each slice's vndf integrates to 1)

            def row(table: NDArray[Any], column: NDArray[np.intp] | int, at: int, p: Any = p, t: Any = t) -> Floats:
                return table[p, t, i + at, column].astype(np.float64)

            first += weight * ((1.0 - a) * row(self.vndf, j, 0) + a * row(self.vndf, j, 1))
            second += weight * ((1.0 - a) * row(self.vndf, j + 1, 0) + a * row(self.vndf, j + 1, 1))
            part += weight * ((1.0 - a) * row(self.before, j, 0) + a * row(self.before, j, 1))
            low, high = row(self.before, -1, 0), row(self.before, -1, 1)
            whole += weight * ((1.0 - a) * low + a * high)
            below += weight * self.rows[p, t, i]
            above += weight * a * (low + 0.5 * a * (high - low))
        part += b * (first + 0.5 * b * (second - first))
        return np.where(whole > 0, part / np.where(whole > 0, whole, 1.0), 0.0), below + above


def _elevation(v: Floats) -> Floats:
    """Polar angle; an arc cosine alone would lose the digits near the normal."""
    return np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2])


def _as_u(theta: Floats, phi: Floats) -> tuple[Floats, Floats]:
    turn = phi / (2.0 * np.pi) + 0.5
    return np.sqrt(theta * (2.0 / np.pi)), turn - np.floor(turn)


def _plain(table: NDArray[Any], x: Floats, y: Floats) -> Floats:
    nothing = np.zeros(x.shape, np.intp)
    return _bilinear(table[None, None, None], [((nothing, nothing), np.ones(x.shape))], x, y)[0]


def _bilinear(table: NDArray[Any], slices: Slices, x: Floats, y: Floats) -> Floats:
    """A table (phi_i, theta_i, channels, rows, columns) at points of the unit square, (channels, n)."""
    rows, columns = table.shape[3:]
    (i, a), (j, b) = between(y * (rows - 1), rows), between(x * (columns - 1), columns)
    found = np.zeros((table.shape[2], x.size))
    for (p, t), weight in slices:
        for di, dj in np.ndindex(2, 2):
            share = weight * (a if di else 1.0 - a) * (b if dj else 1.0 - b)
            found += share * table[p, t, :, i + di, j + dj].T
    return found


def _rgb(arrays: Mapping[str, NDArray[Any]]) -> tuple[NDArray[Any], NDArray[np.bool_]]:
    """RGB (phi_i, theta_i, 3, rows, columns), and which texels held an impossible value, which is 0 there."""
    spectral = "rgb" not in arrays
    source = arrays["spectra" if spectral else "rgb"]
    weights = (rgb_weights(arrays["wavelengths"]) if spectral else np.eye(3)).astype(np.float32)
    rgb = np.zeros((*source.shape[:2], 3, *source.shape[3:]), np.float32)
    impossible = np.zeros((*source.shape[:2], *source.shape[3:]), bool)
    for slot in np.ndindex(*source.shape[:2]):
        for channel, weight in zip(source[slot], weights, strict=True):
            possible = is_reflectance(channel)
            impossible[slot] |= ~possible
            for into, share in zip(rgb[slot], weight, strict=True):
                np.add(into, share * channel, out=into, where=possible, casting="same_kind")
    return np.maximum(rgb, 0.0, out=rgb), impossible


def _check(arrays: Mapping[str, NDArray[Any]]) -> None:
    """FileError unless the arrays are there, fit each other and hold what they can."""
    spectral = "rgb" not in arrays
    needed = NEEDED | ({"spectra": 5, "wavelengths": 1} if spectral else {"rgb": 5})
    for name, dimensions in needed.items():
        if name not in arrays:
            wanted = '"rgb" or "spectra"' if name == "spectra" else f'"{name}"'
            message = (
                f"has no field {wanted}, so it is no measured BRDF; get RGL's _rgb.bsdf or _spec.bsdf of the material"
            )
            raise FileError(message)
        array = arrays[name]
        if array.ndim != dimensions or array.dtype not in ("<f4", "<f8"):
            message = f'field "{name}" must be float32 of {dimensions} dimensions, got {array.dtype} {array.shape}'
            raise FileError(message)
        floor = 1 if dimensions == 1 else 2
        sides = array.shape if dimensions < 4 else array.shape[-2:]
        if not all(floor <= side <= MOST_SIDE for side in sides):
            message = f'field "{name}" has the shape {array.shape}; each side must be {floor} to {MOST_SIDE}'
            raise FileError(message)
    channels = arrays["wavelengths"].size if spectral else 3
    values = arrays["spectra" if spectral else "rgb"]
    grid = arrays["phi_i"].size, arrays["theta_i"].size
    if arrays["vndf"].shape[:2] != grid or values.shape[:3] != (*grid, channels):
        message = f"its fields do not fit: {grid[0]} phi_i, {grid[1]} theta_i, vndf {arrays['vndf'].shape}"
        message += f", values {values.shape}; get the file again"
        raise FileError(message)
    for name in ("phi_i", "theta_i", *(["wavelengths"] if spectral else [])):
        if not (np.isfinite(arrays[name]).all() and (np.diff(arrays[name]) > 0).all()):
            message = f'field "{name}" must rise, got {arrays[name][:4]}; get the file again'
            raise FileError(message)
    for name in ("sigma", "ndf", "vndf"):
        low, high = arrays[name].min(), arrays[name].max()  # NaN if any entry is
        if not (low >= 0 and high < np.inf) or (name == "sigma" and low == 0):
            message = f'field "{name}" must be positive and finite, got {low:g} to {high:g}; get the file again'
            raise FileError(message)


def read_rgl(content: bytes) -> Rgl:
    """The BRDF in the bytes of a .bsdf file; FileError says what is wrong with them."""
    return Rgl(fields(content))
