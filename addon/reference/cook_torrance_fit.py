# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance as a fixed mixture of the lobes that Cycles itself has: what estimator ``fit`` renders.

``hybrid`` takes a share of that mixture and adds what is missing.

Each lobe is a Beckmann microfacet lobe with Smith's G. The first is round and upright. The others have slopes of their
own across and in the plane of view, and a normal tilted within that plane; where the view needs none of them their
weight is 0, and Cycles skips them. Weights, slopes and tilts are interpolated in a table over view and slope, which is
sampled from cubic splines, so that it changes smoothly. ``tools/fit_cook_torrance.py`` finds their control points by
the least L1 distance from the V-groove model, in views and under lights, and writes ``cook_torrance_fit.toml``. F
depends on v.h alone, so that one mixture serves every Fresnel term.

Source of the lobe: Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2), eqs. 85 to 99.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from . import hybrid
from .cook_torrance import cook_torrance
from .directions import above, as_directions, as_pair, as_positive, dot, facet_cosine, half_vector

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from .directions import Floats
    from .fresnel import Fresnel

TABLE = Path(__file__).with_suffix(".toml")
FUNCTIONS = ("weight", "roughness", "anisotropy", "tilt")
LOBES = 3
SIZE = 25, 82  # slopes and views of the table: an image of less than 100 kB
# Where the splines are sampled: below m = 0.0225 all is alike in u and in what is over m.
PLACES = np.maximum(np.linspace(0.0, 1.0, SIZE[0]), 0.15), np.linspace(0.0, 1.0, SIZE[1])
# Of the splines, in m^(1/2) and in u. A light that grazes needs more of the latter where steep views are.
KNOTS = np.linspace(0.0, 1.0, 13), np.concatenate([np.arange(0.0, 0.2, 0.04), np.linspace(0.2, 1.0, 13)])
Begins = tuple[tuple[float, float, float], ...]
BEGINS: Begins = ((2.05, 1.0, 1.35), (1.65, 0.8, 2.0))  # of the second and the third lobe
MOST_LEAN = 0.9  # of the tilt at which the view would pass below a lobe's own horizon
NARROWEST = 0.1  # (within / across)^2 at anisotropy 1: what Cycles' Metallic BSDF offers


@dataclass(frozen=True)
class Lobes:
    """The mixture seen from each wo; arrays (..., lobes). ``across``, ``within``: slopes to the plane of view.

    ``tilt`` is the tangent of the angle by which the normal leans away from the viewer.
    """

    weight: Floats
    across: Floats
    within: Floats
    tilt: Floats


@cache
def control_points() -> dict[str, Floats]:
    """What the table is made of: control points [lobe, m, view] of each of ``FUNCTIONS``, coefficients of ``share``."""
    with TABLE.open("rb") as file:
        return {name: np.array(numbers) for name, numbers in tomllib.load(file).items()}


@cache
def tables() -> dict[str, Floats]:
    """Numbers [lobe, m, view] of each of ``FUNCTIONS`` as shaders look them up."""
    return sampled(control_points())


def sampled(control: dict[str, Floats], begins: Begins | None = None) -> dict[str, Floats]:
    """Numbers [lobe, m, view] of the splines that ``control`` makes, at ``SIZE`` evenly spaced m^(1/2) and views.

    Both are from 0 to 1; views by ``view_coordinate``. Control points of roughness are over m^(1/2), of tilt over m;
    the first lobe, round and upright, has none of tilt and anisotropy. Each number is held to its range.
    """
    weight, roughness, anisotropy, tilt = (_surfaces(control[name]) for name in FUNCTIONS)
    root, (place, u) = np.linspace(0.0, 1.0, SIZE[0])[:, None], np.meshgrid(*PLACES, indexing="ij")
    m, none = place * place, np.zeros_like(weight[:1])
    c = m * (1.0 - u) / (m + u)
    weight = np.clip(weight * needed(c, m, begins), 0.0, 1.0)
    tilt = root * root * np.minimum(tilt, MOST_LEAN * c / np.maximum(1.0 - c * c, 1e-9) / m)
    tilt = tilt / (1.0 + tilt * c)
    found = weight, root * roughness, np.clip([*none, *anisotropy], 0.0, 1.0), np.array([*none, *tilt])
    as_in_shaders = (of.astype(np.float32).astype(np.float64) for of in found)
    return dict(zip(FUNCTIONS, as_in_shaders, strict=True))


def needed(c: Floats, m: Floats, begins: Begins | None = None) -> Floats:
    """How far each lobe may count, (lobes, ...): 1 for the first; of others 0 in views in which none is needed.

    With t the slope of the flattest facets that the V-groove's G clips, and ``BEGINS`` of a lobe (a, b, n):
    x^2 (3 - 2x), x = (a - t / m^n) / (a - b) held to 0..1. Such facets lean from the viewer by e / 3, e the view's
    elevation: they send light to e / 3 above the horizon, where 2 (n.h)(n.l) = v.h.
    """
    t, m = np.tan(np.arcsin(np.clip(c, 0.0, 1.0)) / 3.0), np.maximum(m, 1e-9)
    parts = [np.clip((a - t / m**n) / (a - b), 0.0, 1.0) for a, b, n in begins or BEGINS]
    return np.stack([np.ones_like(t), *(x * x * (3.0 - 2.0 * x) for x in parts)])


def _surfaces(control: Floats) -> Floats:
    """Cubic splines at the table's slopes and views, (lobes, *SIZE), from control points (lobes, slopes, views)."""
    of_m, of_u = (spline(knots, places) for knots, places in zip(KNOTS, PLACES, strict=True))
    return np.asarray(np.einsum("jm,ku,lmu->ljk", of_m, of_u, control))


def spline(knots: Floats, x: Floats) -> Floats:
    """Each cubic B-spline B_k on ``knots`` at x (N,), (N, knots + 2); the first and the last are 1 at their ends.

    By degree n, from 1 between two knots: B_k = (x - t_k) / (t_(k+n) - t_k) B_k' + (t_(k+n+1) - x) /
    (t_(k+n+1) - t_(k+1)) B_(k+1)', B' of degree n - 1. Source: de Boor 1978, A Practical Guide to Splines, chapter IX.
    """
    t = np.concatenate([[knots[0]] * 3, knots, [knots[-1]] * 3])
    last = np.clip(np.searchsorted(knots, x, side="right"), 1, len(knots) - 1) + 2
    found = (np.arange(len(t) - 1) == last[:, None]).astype(np.float64)
    for degree in (1, 2, 3):
        width = t[degree:] - t[:-degree]
        up = (x[:, None] - t[:-degree]) / np.where(width > 0.0, width, 1.0) * (width > 0.0)
        found = up[:, :-1] * found[:, :-1] + (1.0 - up[:, 1:]) * (width[1:] > 0.0) * found[:, 1:]
    return found


def lobes(wo: ArrayLike, m: ArrayLike, of: dict[str, Floats] | None = None) -> Lobes:
    """The mixture for views ``wo`` and slopes ``m``, which are held to Cycles' limit of 1.

    With the table's weight w, roughness r, anisotropy a and tilt t, linear between its nodes, s = sin and c = cos:
    across = r^2 / b, within = r^2 b, each at most 1, b = (1 - 0.9 a)^(1/2);  n' ~ n - t wo, of slope t s / (1 - t c).

    wo: unit vectors (..., 3); m: RMS slope > 0. Raises ValueError outside these ranges.
    of: numbers in place of the committed table's.
    """
    wo, m = as_directions(wo, "wo"), np.minimum(as_positive(m, "m"), 1.0)
    c, s, u, m = np.broadcast_arrays(wo[..., 2], np.hypot(wo[..., 0], wo[..., 1]), view_coordinate(wo, m), m)
    of = of or tables()
    weight, roughness, anisotropy, tilt = (interpolated(of[name], u, np.sqrt(m)) for name in FUNCTIONS)
    square, aspect = roughness**2, np.sqrt(1.0 - (1.0 - NARROWEST) * anisotropy)
    slope = tilt * s[..., None] / (1.0 - tilt * np.maximum(c, 0.0)[..., None])
    return Lobes(weight, np.minimum(square / aspect, 1.0), np.minimum(square * aspect, 1.0), slope)


def view_coordinate(wo: Floats, m: ArrayLike) -> Floats:
    """u = m (1 - c) / (c + m), c = n.v, (...): 0 head-on, 1 at grazing, and alike for all m where m is small.

    Near the normal it is quadratic in the angle, as everything is that does not lean.
    """
    c, m = np.maximum(wo[..., 2], 0.0), np.asarray(m, dtype=np.float64)
    return np.asarray(m * (1.0 - c) / np.maximum(c + m, 1e-300))


def interpolated(numbers: Floats, u: Floats, root: Floats) -> Floats:
    """``numbers`` [lobe, m, view] at views u and m^(1/2) (...), linear in both, (..., lobes)."""
    (j, of_m), (k, of_u) = (_between(v, n) for v, n in zip((root, u), numbers.shape[1:], strict=True))
    below, above_m = (numbers[:, at, k] * (1.0 - of_u) + numbers[:, at, k + 1] * of_u for at in (j, j + 1))
    return np.moveaxis(below * (1.0 - of_m) + above_m * of_m, 0, -1)


def _between(x: Floats, nodes: int) -> tuple[NDArray[np.intp], Floats]:
    """The node below x and the share of the next, for nodes evenly spaced from 0 to 1."""
    place = np.clip(x, 0.0, 1.0) * (nodes - 1)
    node = np.minimum(place.astype(np.intp), nodes - 2)
    return node, place - node


def grazing(wo: Floats, m: ArrayLike) -> Floats:
    """x = m s / (c + m s), (...): 0 head-on, 1 at grazing; the coordinate of the share's table."""
    c, s = np.maximum(wo[..., 2], 0.0), np.hypot(wo[..., 0], wo[..., 1])
    return np.asarray(m * s / np.maximum(c + m * s, 1e-300), dtype=np.float64)


def mixture(wi: ArrayLike, wo: ArrayLike, m: ArrayLike) -> Floats:
    """f cos(theta_i) of the mixture with F = 1: the sum of weight D G / (4 v.n') over its lobes, in 1/sr, (...).

    n' is a lobe's own normal, against which its D and G are taken. 0 unless both directions leave the upper side.

    wi, wo: unit vectors (..., 3), broadcast; m: RMS slope > 0. Raises ValueError outside these ranges.
    """
    wi, wo = as_pair(wi, wo)
    return np.where(above(wi, wo), np.sum(weighted_lobes(wi, wo, lobes(wo, m)), axis=-1), 0.0)


def weighted_lobes(wi: Floats, wo: Floats, of: Lobes) -> Floats:
    """weight D G / (4 v.n') of each lobe, (..., lobes)."""
    h = half_vector(wi, wo)
    sin = np.hypot(wo[..., 0], wo[..., 1])
    aside = sin > 0  # head-on any plane will do: lobes are round
    X = np.where(aside[..., None], wo[..., :2] / np.where(aside, sin, 1.0)[..., None], [1.0, 0.0])  # to the viewer

    def parts(w: Floats) -> tuple[Floats, Floats, Floats]:
        across, toward = w[..., 1] * X[..., 0] - w[..., 0] * X[..., 1], dot(w[..., :2], X)
        return across[..., None], toward[..., None], w[..., 2:]

    turned_wi, turned_wo, turned_h = (turned(*parts(w), of.tilt) for w in (wi, wo, h))
    return of.weight * smith_lobe(turned_wi, turned_wo, turned_h, of.across, of.within)


def turned(across: Floats, toward: Floats, up: Floats, tilt: Floats) -> tuple[Floats, Floats, Floats]:
    """Components across the plane of view, within it and along a normal that leans away from the viewer by ``tilt``."""
    cos_tilt = 1.0 / np.sqrt(1.0 + tilt * tilt)
    return across, (toward + tilt * up) * cos_tilt, (up - tilt * toward) * cos_tilt


def smith_lobe(wi: tuple[Floats, ...], wo: tuple[Floats, ...], h: tuple[Floats, ...], ax: Floats, ay: Floats) -> Floats:
    """D G / (4 v.n) of an anisotropic Beckmann lobe in its own frame; vectors as their three components."""
    lit = (wi[2] > 0) & (wo[2] > 0) & (h[2] > 1e-8)
    hz, no = np.where(lit, h[2], 1.0), np.where(lit, wo[2], 1.0)
    with np.errstate(under="ignore"):
        D = np.exp(-np.square(h[0] / hz / ax) - np.square(h[1] / hz / ay)) / (np.pi * ax * ay * hz**4)
    G = 1.0 / (1.0 + _lambda(wi, lit, ax, ay) + _lambda(wo, lit, ax, ay))
    return np.where(lit, D * G / (4.0 * no), 0.0)


def _lambda(w: tuple[Floats, ...], lit: NDArray[np.bool_], ax: Floats, ay: Floats) -> Floats:
    """Smith's Lambda as ``distributions.smith_lambda``, for two slopes."""
    slope = np.sqrt(np.square(w[0] * ax) + np.square(w[1] * ay)) / np.where(lit, w[2], 1.0)
    rough = slope * 1.6 > 1.0
    a = 1.0 / np.where(rough, slope, 1.0)
    return np.where(rough, (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)


def cook_torrance_fit(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel) -> Floats:
    """The BRDF that ``fit`` renders, F(v.h) mixture / (n.l), in 1/sr, RGB (..., 3). Not reciprocal.

    Arguments, zeros and errors as ``cook_torrance``; m > 1 gives what m = 1 gives.
    """
    wi, wo = as_pair(wi, wo)
    lit = above(wi, wo)
    F = fresnel(np.where(lit, facet_cosine(wi, wo, half_vector(wi, wo)), 1.0))
    return F * np.where(lit, mixture(wi, wo, m) / np.where(lit, wi[..., 2], 1.0), 0.0)[..., None]


def hybrid_share(wo: ArrayLike, m: ArrayLike, bound: ArrayLike) -> Floats:
    """c, the share of the mixture that ``hybrid`` leaves to Cycles' own lobes, (...), from 0 to 1.

    The largest c for which what c times the mixture has too much of, the integral of F (c mixture - f cos)+ over wi,
    is at most ``bound`` times that of F f cos: for Schlick's F with F0 from 0.02 to 1 and for water's. A polynomial in
    (2x - 1), (2m - 1) and the logarithm of the bound that lies below all of these (tools/fit_cook_torrance.py).

    wo: unit vectors (..., 3); m: RMS slope > 0; bound: 0.001 to 0.05. Raises ValueError outside these ranges.
    """
    wo, m = as_directions(wo, "wo"), np.minimum(as_positive(m, "m"), 1.0)
    return hybrid.share(control_points()["share"], 2.0 * grazing(wo, m) - 1.0, 2.0 * m - 1.0, bound)


def cook_torrance_hybrid(wi: ArrayLike, wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, bound: ArrayLike) -> Floats:
    """The BRDF that ``hybrid`` renders, max(f, c f_fit) with c = ``hybrid_share``, in 1/sr, RGB (..., 3).

    Arguments, zeros and errors as ``cook_torrance_fit``.
    """
    wi, wo = as_pair(wi, wo)
    c = hybrid_share(wo, m, bound)[..., None]
    true = cook_torrance(wi, wo, np.minimum(m, 1.0), fresnel)
    return np.maximum(true, c * cook_torrance_fit(wi, wo, m, fresnel))
