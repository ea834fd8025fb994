# SPDX-License-Identifier: GPL-3.0-or-later
"""F: the reflectance of one smooth facet, for unpolarised light. ``cos`` is v.h, a facet's angle, never n.v.

Shapes: ``cos`` is (...). A parameter that ends in 3 is a colour and adds a channel axis, (...) -> (..., 3); a
parameter of any other shape broadcasts against ``cos``.

Sources:
    Cook & Torrance 1982, doi:10.1145/357290.357293 (the dielectric form in g and c)
    Born & Wolf, Principles of Optics, 7th ed., sections 1.5.2 and 14.2
    Schlick 1994, An Inexpensive BRDF Model for Physically-based Rendering, CGF 13(3), eq. 15
    Kutz, Hasan & Edmondson 2021, Novel Aspects of the Adobe Standard Material (the F82-tint form)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from .directions import add_product, as_finite, as_positive, as_range, as_rgb

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from .directions import Floats

INDEX_RANGE = (1e-50, 1e50)  # squares of an index stay inside float64
F82_COSINE = 1.0 / 7.0  # 81.8 degrees, where Schlick's formula and F82's correction of it part most


def schlick(cos: ArrayLike, f0: ArrayLike) -> Floats:
    """Schlick's approximation F = F0 + (1 - F0) (1 - cos)^5.

    cos: v.h, clipped to [0, 1]. f0: reflectance head-on, in [0, 1], scalar or RGB. Raises ValueError outside.
    Source: Schlick 1994, eq. 15.

    >>> schlick(0.0, [0.95, 0.64, 0.54]).tolist()
    [1.0, 1.0, 1.0]
    """
    cos, f0 = _with_channels(as_cosine(cos), as_range(f0, "f0", 0.0, 1.0))
    return f0 + (1.0 - f0) * (1.0 - cos) ** 5


def f82(cos: ArrayLike, f0: ArrayLike, tint: ArrayLike) -> Floats:
    """Schlick's formula, corrected so that it is multiplied by ``tint`` at cos = 1/7 (82 degrees).

    F = S(cos) - b cos (1 - cos)^6, b = S(1/7) (1 - tint) / (1/7 (1 - 1/7)^6), S Schlick's formula. Not below 0.

    cos: v.h, clipped to [0, 1]. f0, tint: in [0, 1], scalar or RGB. Raises ValueError outside.
    Source: Kutz, Hasan & Edmondson 2021, Novel Aspects of the Adobe Standard Material.

    >>> round(float(f82(1.0 / 7.0, 0.5, 0.8) / schlick(1.0 / 7.0, 0.5)), 15)
    0.8
    """
    f0, tint = as_range(f0, "f0", 0.0, 1.0), as_range(tint, "tint", 0.0, 1.0)
    b = schlick(F82_COSINE, f0) * (1.0 - tint) / (F82_COSINE * (1.0 - F82_COSINE) ** 6)
    c, b = _with_channels(as_cosine(cos), b)
    return np.maximum(schlick(cos, f0) - b * c * (1.0 - c) ** 6, 0.0)


def fresnel_dielectric(cos: ArrayLike, eta: ArrayLike) -> Floats:
    """Exact reflectance of a transparent medium; 1 in total internal reflection.

    With c = cos and g^2 = eta^2 + c^2 - 1:
    F = 1/2 ((g - c) / (g + c))^2 (1 + ((c (g + c) - 1) / (c (g - c) + 1))^2)

    cos: v.h, clipped to [0, 1]. eta: transmitted over incident index, > 0, scalar or RGB. Raises ValueError outside.
    Source: Cook & Torrance 1982 (their eq. for F with k = 0); Born & Wolf 1.5.2.

    >>> round(float(fresnel_dielectric(1.0, 1.5)), 15)
    0.04
    """
    c, eta = _with_channels(as_cosine(cos), as_positive(eta, "eta", *INDEX_RANGE))
    beyond = (eta - 1.0) * (eta + 1.0)  # eta^2 - 1, to the last digit also next to eta = 1
    g2 = add_product(beyond, c, c)
    g = np.sqrt(np.maximum(g2, 0.0))
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # only where 1 is put in below
        g_minus_c = beyond / np.where(g + c > 0, g + c, 1.0)  # g - c itself would cancel
        s = g_minus_c / np.where(g + c > 0, g + c, 1.0)
        p = (c * (g + c) - 1.0) / (c * g_minus_c + 1.0)
        F = 0.5 * s**2 * (1.0 + p**2)
    grazing = (c == 0) & (beyond != 0)  # 0/0 of the form above when eta is next to 1; the limit is 1
    return np.where((g2 <= 0) & (beyond < 0) | grazing, 1.0, np.minimum(F, 1.0))


def fresnel_conductor(cos: ArrayLike, n: ArrayLike, k: ArrayLike) -> Floats:
    """Exact reflectance of an absorbing medium of index n + ik, seen from vacuum.

    With N = n + ik and g^2 = N^2 - sin^2: r_s = (c - g) / (c + g), r_p = (N^2 c - g) / (N^2 c + g),
    F = (|r_s|^2 + |r_p|^2) / 2

    cos: v.h, clipped to [0, 1]. n >= 0, k >= 0 (not both 0), scalar or RGB. Raises ValueError outside.
    Source: Born & Wolf 14.2 with 1.5.2 (complex index in the dielectric formulas).

    >>> round(float(fresnel_conductor(1.0, 1.5, 0.0)), 15)
    0.04
    """
    n, k = np.broadcast_arrays(as_range(n, "n", 0.0, 1e50), as_range(k, "k", 0.0, 1e50))
    if ((n == 0) & (k == 0)).any():
        message = "n and k must not both be 0 (no medium has that index), got n = 0, k = 0"
        raise ValueError(message)
    colour = n.ndim > 0 and n.shape[-1] == 3
    c = as_cosine(cos)[..., None] if colour else as_cosine(cos)
    n2 = (n - k) * (n + k) + 2j * n * k
    # N^2 - 1 by factors keeps its digits next to N = 1: n^2 - 1 - k^2 = (n - 1)(n + 1) - k^2
    beyond = (n - 1.0) * (n + 1.0) - k * k + 2j * n * k
    sin2 = (1.0 - c) * (1.0 + c)
    # g^2 is c^2 + (N^2 - 1), which keeps its digits next to N = 1, and N^2 - sin^2, which does next to N = 0.
    near_zero = 8.0 * np.maximum(np.abs(n2.real), sin2) < np.maximum(c * c, np.abs(beyond.real))
    g2 = np.where(near_zero, n2.real - sin2, add_product(beyond.real, c, c))
    g = np.sqrt(g2 + 1j * beyond.imag)
    # c - g and N^2 c - g cancel next to N = 1; multiplied out with c + g and N^2 c + g they are products.
    sum_s, sum_p = c + g, n2 * c + g
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        r_s = beyond / sum_s / sum_s
        r_p = beyond / sum_p * ((n2 * c * c - sin2) / sum_p)
    F = 0.5 * (np.abs(r_s) ** 2 + np.abs(r_p) ** 2)
    F = np.where((c == 0) & (beyond != 0), 1.0, F)  # grazing: both sums may be 0
    return np.where(beyond == 0, 0.0, np.minimum(F, 1.0))


HIGHEST_HEAD_ON = 0.9999  # reflectance of a conductor, beyond which its n and k have no bounds


def head_on_and_edge(n: ArrayLike, k: ArrayLike) -> tuple[Floats, Floats]:
    """A conductor's reflectance r head-on, and how much g of it goes on towards grazing angles, each channel apart.

    r = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2), n = g (1 - r) / (1 + r) + (1 - g) (1 + sqrt r) / (1 - sqrt r)

    n, k >= 0, scalar or RGB, not both 0. r, g in [0, 1]; g is 0 where r is, as nothing tells it. Raises ValueError.
    Source: Gulbrandsen 2014, "Artist Friendly Metallic Fresnel", eqs. 2, 5 and 6, with his edge tint g turned about: 1
    is the least n of this r.
    """
    n, k = as_range(n, "n", 0.0, 1e50), as_range(k, "k", 0.0, 1e50)
    r = np.minimum(((n - 1.0) ** 2 + k * k) / ((n + 1.0) ** 2 + k * k), HIGHEST_HEAD_ON)
    least, most = _indices_of(r)
    return r, np.where(most > least, np.clip((most - n) / np.where(most > least, most - least, 1.0), 0.0, 1.0), 0.0)


def conductor_of(r: ArrayLike, g: ArrayLike, most: float = np.inf) -> tuple[Floats, Floats]:
    """n and k of ``head_on_and_edge``: k^2 = (r (n + 1)^2 - (n - 1)^2) / (1 - r).

    All n, k of one r lie on a circle about n = c = (1 + r) / (1 - r), of radius sqrt(c^2 - 1). Where n or k would be
    more than ``most``, another point of the circle is taken, where they are not: r stays, and g does not.

    r, g in [0, 1], scalar or RGB, ValueError otherwise; r is held to HIGHEST_HEAD_ON. most: at least 1.

    >>> n, k = conductor_of(*head_on_and_edge(0.2, 3.9))
    >>> round(float(n), 9), round(float(k), 9)
    (0.2, 3.9)
    """
    r, g = np.minimum(as_range(r, "r", 0.0, 1.0), HIGHEST_HEAD_ON), as_range(g, "g", 0.0, 1.0)
    least, greatest = _indices_of(r)
    n = np.minimum(g * least + (1.0 - g) * greatest, most)
    k = np.sqrt(np.maximum((r * (n + 1.0) ** 2 - (n - 1.0) ** 2) / (1.0 - r), 0.0))
    c = (1.0 + r) / (1.0 - r)
    with np.errstate(invalid="ignore"):  # where k is not beyond
        lower = (1.0 + most * most) / (c + np.sqrt(c * c - 1.0 - most * most))  # c - sqrt(...), without cancelling
    return np.where(k > most, lower, n), np.minimum(k, most)


def _indices_of(r: Floats) -> tuple[Floats, Floats]:
    """The least and the greatest n that reflect r head-on."""
    root = np.sqrt(r)
    return (1.0 - r) / (1.0 + r), (1.0 + root) / (1.0 - root)


class Fresnel(Protocol):
    """What a model asks of F: reflectance for v.h of shape (...), as RGB (..., 3)."""

    def __call__(self, cos: ArrayLike) -> Floats:
        """Reflectance (..., 3) at cos = v.h, shape (...)."""
        ...

    @property
    def kinks(self) -> tuple[float, ...]:
        """Cosines v.h in (0, 1), ascending, near which F bends sharply; () if F is smooth. Quadrature splits there."""
        ...

    def __hash__(self) -> int:
        """By the parameters, so that results for one F can be cached."""
        ...


@dataclass(frozen=True)
class Schlick:
    """F by Schlick 1994 from the reflectance head-on, ``f0`` in [0, 1], one number or linear RGB."""

    f0: ArrayLike

    def __post_init__(self) -> None:
        as_rgb(self.f0, "f0", 0.0, 1.0)

    def __call__(self, cos: ArrayLike) -> Floats:
        return _as_rgb_reflectance(schlick, cos, self.f0)

    @property
    def kinks(self) -> tuple[float, ...]:
        return ()


@dataclass(frozen=True)
class F82:
    """F of the F82-tint form from ``f0`` and ``tint``, each in [0, 1], one number or linear RGB."""

    f0: ArrayLike
    tint: ArrayLike

    def __post_init__(self) -> None:
        as_rgb(self.f0, "f0", 0.0, 1.0)
        as_rgb(self.tint, "tint", 0.0, 1.0)

    def __call__(self, cos: ArrayLike) -> Floats:
        return _as_rgb_reflectance(f82, cos, self.f0, self.tint)

    @property
    def kinks(self) -> tuple[float, ...]:
        return ()


@dataclass(frozen=True)
class Dielectric:
    """Exact F of a transparent medium, ``eta`` > 0 transmitted over incident index, one number or one a channel."""

    eta: ArrayLike

    def __post_init__(self) -> None:
        as_rgb(as_positive(self.eta, "eta", *INDEX_RANGE), "eta", *INDEX_RANGE)

    def __call__(self, cos: ArrayLike) -> Floats:
        return _as_rgb_reflectance(fresnel_dielectric, cos, self.eta)

    @property
    def kinks(self) -> tuple[float, ...]:
        return _critical_cosines(np.asarray(self.eta, dtype=np.float64), np.zeros(()))


@dataclass(frozen=True)
class Conductor:
    """Exact F of an absorbing medium, complex index n + ik, ``n``, ``k`` >= 0, one number or one a channel."""

    n: ArrayLike
    k: ArrayLike

    def __post_init__(self) -> None:
        as_rgb(self.n, "n", 0.0, 1e50)
        as_rgb(self.k, "k", 0.0, 1e50)
        fresnel_conductor(1.0, self.n, self.k)

    def __call__(self, cos: ArrayLike) -> Floats:
        return _as_rgb_reflectance(fresnel_conductor, cos, self.n, self.k)

    @property
    def kinks(self) -> tuple[float, ...]:
        return _critical_cosines(np.asarray(self.n, dtype=np.float64), np.asarray(self.k, dtype=np.float64))


def as_cosine(cos: ArrayLike) -> Floats:
    """v.h clipped to [0, 1]; rounding can lift it above 1. ValueError beyond what rounding explains."""
    return np.clip(as_range(cos, "cos", -1.0 - 1e-6, 1.0 + 1e-6), 0.0, 1.0)


def _with_channels(cos: Floats, parameter: Floats) -> tuple[Floats, Floats]:
    colour = parameter.ndim > 0 and parameter.shape[-1] == 3
    return (cos[..., None] if colour else cos), parameter


def _as_rgb_reflectance(formula: Callable[..., Floats], cos: ArrayLike, *parameters: ArrayLike) -> Floats:
    as_colours = [np.broadcast_to(p, (*np.shape(p)[:-1], 3)) if np.ndim(p) else np.full(3, p) for p in parameters]
    return formula(as_finite(cos, "cos"), *as_colours)


def _critical_cosines(n: Floats, k: Floats) -> tuple[float, ...]:
    """Where F bends sharply: at sin^2 = Re N^2 (total internal reflection sets in, or nearly does for k > 0).

    A small k rounds that bend over a few n k / cos. Next to N = 1 all of F happens within a few sqrt(|N^2 - 1|) of
    grazing, so a ladder of cosines covers that.
    """
    beyond = np.ravel((n - 1.0) * (n + 1.0) - k * k)
    total = (beyond < 0) & (beyond > -1)
    critical = np.sqrt(-beyond[total])
    width = np.broadcast_to(np.ravel(n * k), beyond.shape)[total] / critical
    critical = np.concatenate([critical, critical - 6.0 * width, critical + 6.0 * width])
    scale = np.sqrt(np.hypot(beyond, 2.0 * np.ravel(n * k)))
    near_one = np.outer(scale[(scale > 0) & (scale < 0.3)], [0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0]).ravel()
    return tuple(sorted({float(value) for value in (*critical, *near_one) if 0.0 < value < 1.0}))
