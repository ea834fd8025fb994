# SPDX-License-Identifier: GPL-3.0-or-later
"""Directions and checked parameters: the one place where bad input to the reference is turned away."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

Floats: TypeAlias = NDArray[np.float64]

UNIT_TOLERANCE = 1e-6
# A direction this close to the horizon counts as tangent. Every product of two such cosines with a D of any allowed m
# then stays inside float64's range, so nothing below overflows into infinity or NaN.
TANGENT = 1e-50
# Rounding alone moves the length of a unit vector by up to 2.5e-16. Within that a vector is taken as it stands:
# scaling it would cost the digits that wi + wo needs for narrow lobes.
ROUNDING = 1e-15


def as_finite(values: ArrayLike, name: str) -> Floats:
    """``values`` as float64; ValueError names the argument and the first value that is no finite number."""
    try:
        raw = np.asarray(values)
    except (TypeError, ValueError) as error:
        message = f"{name} must be numbers, got {values!r}"
        raise ValueError(message) from error
    if raw.dtype.kind not in "biuf":  # a conversion would read "0.5" as 0.5, None as NaN, and drop imaginary parts
        message = f"{name} must be numbers, got {values!r}"
        raise ValueError(message)
    array = raw.astype(np.float64, copy=False)
    if not np.isfinite(array).all():
        message = f"{name} must be finite, got {array[~np.isfinite(array)].flat[0]}"
        raise ValueError(message)
    return array


def as_range(values: ArrayLike, name: str, low: float, high: float) -> Floats:
    """``values`` as float64, each within [low, high]; ValueError names argument, value and range otherwise."""
    array = as_finite(values, name)
    outside = (array < low) | (array > high)
    if outside.any():
        message = f"{name} must be between {low:.15g} and {high:.15g}, got {array[outside].flat[0]:.15g}"
        raise ValueError(message)
    return array


def as_positive(values: ArrayLike, name: str, low: float = 1e-100, high: float = 1e6) -> Floats:
    """``values`` as float64, each greater than 0 (and inside the range that float64 can square twice)."""
    array = as_finite(values, name)
    if (array <= 0).any():
        message = f"{name} must be greater than 0, got {array[array <= 0].flat[0]:g}"
        raise ValueError(message)
    return as_range(array, name, low, high)


def as_directions(values: ArrayLike, name: str) -> Floats:
    """Unit vectors (..., 3); ValueError if the shape, a component or a length (to 1e-6) is wrong.

    What is off by more than float64 rounding is scaled to unit length.
    """
    array = as_finite(values, name)
    if array.ndim == 0 or array.shape[-1] != 3:
        message = f"{name} must have shape (..., 3), got {array.shape}"
        raise ValueError(message)
    length = norm(array)
    off = np.abs(length - 1.0)
    if (off > UNIT_TOLERANCE).any():
        wrong = length[off > UNIT_TOLERANCE].flat[0]
        message = f"{name} must have length 1 to within {UNIT_TOLERANCE:g}, got length {wrong:.9g}"
        raise ValueError(message)
    scale = np.where(off > ROUNDING, length, 1.0)
    return array / scale[..., None]


def as_pair(wi: ArrayLike, wo: ArrayLike) -> tuple[Floats, Floats]:
    """Both directions checked and broadcast to one shape (..., 3)."""
    light, view = as_directions(wi, "wi"), as_directions(wo, "wo")
    try:
        shape = np.broadcast_shapes(light.shape, view.shape)
    except ValueError as error:
        message = f"wi and wo must broadcast, got shapes {light.shape} and {view.shape}"
        raise ValueError(message) from error
    return np.broadcast_to(light, shape), np.broadcast_to(view, shape)


def as_rgb(values: ArrayLike, name: str, low: float, high: float) -> Floats:
    """A scalar or an RGB triple (..., 3), each value within [low, high]."""
    array = as_range(values, name, low, high)
    if array.ndim > 0 and array.shape[-1] != 3:
        message = f"{name} must be one number or have shape (..., 3), got {array.shape}"
        raise ValueError(message)
    return array


def norm(v: Floats) -> Floats:
    """Length of (..., 3) vectors; hypot neither overflows nor underflows on the way."""
    return np.hypot(np.hypot(v[..., 0], v[..., 1]), v[..., 2])


def dot(a: Floats, b: Floats) -> Floats:
    """a . b over the last axis."""
    return np.einsum("...i,...i->...", a, b)


def add_product(a: Floats, b: Floats, c: Floats) -> Floats:
    """a + b c with the rounding of the product carried along, for where the two nearly cancel.

    Dekker's product (Numer. Math. 18, 1971): factors split into 26 bits each, so that the error of b c is exact.
    """
    product = b * c
    b_high, c_high = _high(b), _high(c)
    b_low, c_low = b - b_high, c - c_high
    error = ((b_high * c_high - product) + b_high * c_low + b_low * c_high) + b_low * c_low
    return (product + a) + error


def _high(x: Floats) -> Floats:
    split = 134217729.0 * x  # 2^27 + 1
    return split - (split - x)


def above(wi: Floats, wo: Floats) -> NDArray[np.bool_]:
    """Where both directions leave the upper side of the surface; tangent ones do not."""
    return (wi[..., 2] > TANGENT) & (wo[..., 2] > TANGENT)


def through(wi: Floats, wo: Floats) -> NDArray[np.bool_]:
    """Where wi leaves the lower and wo the upper side of the surface; tangent ones do not."""
    return (wi[..., 2] < -TANGENT) & (wo[..., 2] > TANGENT)


def half_vector(wi: Floats, wo: Floats) -> Floats:
    """h = (wi + wo) / |wi + wo|; the normal where both directions are not above the surface."""
    both = np.where(above(wi, wo)[..., None], wi + wo, [0.0, 0.0, 1.0])
    return both / norm(both)[..., None]


def facet_cosine(wi: Floats, wo: Floats, h: Floats) -> Floats:
    """v.h = wo . h, with |wi + wo| / 2, its value for exactly unit vectors, where wi and wo are all but opposite.

    Rounded unit vectors make wo . h uncertain by 4e-15 / |wi + wo|: within 1e-7 of opposite even its sign is.
    """
    length = norm(wi + wo)
    return np.where(length > 1e-7, dot(wo, h), 0.5 * length)


def reflect(wo: Floats, h: Floats) -> Floats:
    """Mirror image of ``wo`` about ``h``: 2 (wo . h) h - wo, scaled back to unit length."""
    mirrored = 2.0 * dot(wo, h)[..., None] * h - wo
    return mirrored / norm(mirrored)[..., None]


def spherical(theta: ArrayLike, phi: ArrayLike = 0.0) -> Floats:
    """Unit vectors (sin t cos p, sin t sin p, cos t) of polar angle ``theta`` and azimuth ``phi``, in radians.

    >>> spherical(0.0).tolist()
    [0.0, 0.0, 1.0]
    """
    theta, phi = np.broadcast_arrays(as_finite(theta, "theta"), as_finite(phi, "phi"))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
