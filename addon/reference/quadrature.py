# SPDX-License-Identifier: GPL-3.0-or-later
"""Directional albedo by Gauss-Legendre panels whose edges lie on the kinks of the integrand.

Source of the substitution to facet slopes: Walter et al. 2007, eqs. 14 and 25 (dh = cos^3 dp dq, D cos^4 is Gaussian
in the slopes p, q).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from .directions import TANGENT, add_product, as_directions, as_positive
from .fresnel import Dielectric, fresnel_dielectric

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.polynomial import Polynomial
    from numpy.typing import ArrayLike

    from .directions import Floats
    from .fresnel import Fresnel

    Weight = Callable[[Floats, Floats, Floats], Floats]

NODES = 16
REACH = 7.0  # slopes beyond 7 m carry exp(-49) of the facets
LADDER = np.array(
    [0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0]
)  # features of F and of reflection have slopes of order 1
SPREAD = np.array([0.5, 1.0, 1.5, 2.0, 3.0, 4.5])  # the Gaussian's own scale, in units of m


@cache
def gauss_legendre(nodes: int) -> tuple[Floats, Floats]:
    """Points and weights on [0, 1] after the substitution 3 s^2 - 2 s^3.

    It flattens square-root behaviour at both ends, as critical angles and vanishing panels bring.
    """
    x, weight = np.polynomial.legendre.leggauss(nodes)
    s = 0.5 * (x + 1.0)
    return s * s * (3.0 - 2.0 * s), 0.5 * weight * 6.0 * s * (1.0 - s)


def panels(edges: Floats, nodes: int) -> tuple[Floats, Floats]:
    """Points and weights (..., panels * nodes) of all panels between sorted ``edges`` (..., panels + 1)."""
    x, weight = gauss_legendre(nodes)
    width = np.diff(edges, axis=-1)[..., None]
    points = edges[..., :-1, None] + width * x
    flat = (*edges.shape[:-1], -1)
    return points.reshape(flat), (width * weight).reshape(flat)


def per_direction(wo: ArrayLike, one: Callable[[float, int], Floats]) -> Floats:
    """``one(cos(theta_o), index)`` -> RGB for each direction of ``wo`` (..., 3); 0 on and below the horizon."""
    wo = as_directions(wo, "wo")
    flat = wo.reshape(-1, 3)
    result = np.zeros_like(flat)
    for index, cosine in enumerate(flat[:, 2]):
        if cosine > TANGENT:
            result[index] = one(float(np.minimum(cosine, 1.0)), index)
    return result.reshape(wo.shape)


def vgroove_albedo(
    wo: ArrayLike, m: ArrayLike, fresnel: Fresnel, *, m_y: ArrayLike | None = None, moment: int = 1, nodes: int = NODES
) -> Floats:
    """Directional albedo of Cook-Torrance, RGB (..., 3), or a higher moment of its sampler's weight.

    With slopes p (in the plane of view) and q, A = v_x p + v_z = (v.h)/(n.h) and the Gaussian P of slopes:
    E[w^moment] = 1/v_z  integral of  P(p, q) A G1 (F G2/G1)^moment dp dq,
    G1 = min(1, 2 v_z/A), G2 = min(G1, 4/(1 + p^2 + q^2) - 2 v_z/A)+, the last being 2 (n.h)(n.l)/(v.h).
    The first moment is the albedo; the second gives the variance of one sample under a white sky.
    m_y: the slope along y, if not that along x; then views of all azimuths differ.
    """
    wo = as_directions(wo, "wo")
    slopes, of_y = (
        np.broadcast_to(as_positive(v, name), wo.shape[:-1]).ravel()
        for v, name in ((m, "m"), (m if m_y is None else m_y, "m_y"))
    )
    azimuth = np.arctan2(wo[..., 1], wo[..., 0]).ravel()

    def one(cosine: float, index: int) -> Floats:
        facets = Facets(float(slopes[index]), float(of_y[index]), float(azimuth[index]))
        return _vgroove_moment(cosine, facets, fresnel, moment, nodes)

    return per_direction(wo, one)


class Facets:
    """The Gaussian of facet slopes p in the plane of view and q across it, where slopes m_x, m_y are along x and y.

    exp(-a p^2 - 2 b p q - c q^2) / (pi m_x m_y). ``along``: the spread of p; ``across``: of q at one p, about -b p / c.
    """

    def __init__(self, m_x: float, m_y: float, azimuth: float) -> None:
        cos, sin = np.cos(azimuth), np.sin(azimuth)
        self.a, self.c = np.hypot(cos / m_x, sin / m_y) ** 2, np.hypot(sin / m_x, cos / m_y) ** 2
        self.b = cos * sin * (1.0 / m_y - 1.0 / m_x) * (1.0 / m_y + 1.0 / m_x)
        self.along, self.across = float(np.hypot(m_x * cos, m_y * sin)), float(self.c**-0.5)
        self.peak = 1.0 / (np.pi * m_x * m_y)

    def density(self, p: Floats, q: Floats) -> Floats:
        """P(p, q) + P(p, -q)."""
        even = np.square(p / self.along)
        return self.peak * sum(np.exp(-even - self.c * np.square(q - side * self.centre(p))) for side in (1.0, -1.0))

    def centre(self, p: Floats) -> Floats:
        """The mean of q at p."""
        return -self.b / self.c * p


def _vgroove_moment(vz: float, facets: Facets, fresnel: Fresnel, moment: int, nodes: int) -> Floats:
    vx = np.sqrt((1.0 - vz) * (1.0 + vz))
    p, p_weight = panels(_outer_edges(vx, vz, facets.along, fresnel.kinks), nodes)
    if p.size == 0:
        return np.zeros(3)
    A = vx * p + vz
    q, q_weight = panels(_inner_edges(p, A, vz, facets, fresnel.kinks), nodes)
    p, A = p[:, None], A[:, None]
    length2 = 1.0 + p * p + q * q
    G1 = np.minimum(1.0, 2.0 * vz / A)
    G2 = np.maximum(np.minimum(G1, 4.0 / length2 - 2.0 * vz / A), 0.0)
    F = fresnel(np.minimum(A / np.sqrt(length2), 1.0))
    integrand = (facets.density(p, q) * (A / vz) * G1)[..., None] * (F * (G2 / G1)[..., None]) ** moment
    return np.einsum("pqc,pq,p->c", integrand, q_weight, p_weight)


def facet_mean(
    wo: ArrayLike, m_x: float, m_y: float, weight: Callable[[float, Floats, Floats], Floats], *, nodes: int = NODES
) -> Floats:
    """Integral of P(p, q) weight(v_z, A, 1 + p^2 + q^2) dp dq over facets that mirror to ``wo``, (...).

    P, A and the slopes as in ``vgroove_albedo``.
    """
    wo = as_directions(wo, "wo")
    azimuth = np.arctan2(wo[..., 1], wo[..., 0]).ravel()

    def one(vz: float, index: int) -> Floats:
        facets, vx = Facets(m_x, m_y, float(azimuth[index])), np.sqrt((1.0 - vz) * (1.0 + vz))
        p, p_weight = panels(_outer_edges(vx, vz, facets.along, ()), nodes)
        if p.size == 0:
            return np.zeros(3)
        A = vx * p + vz
        q, q_weight = panels(_inner_edges(p, A, vz, facets, ()), nodes)
        p, A = p[:, None], A[:, None]
        found = facets.density(p, q) * weight(vz, A, 1.0 + p * p + q * q)
        return np.einsum("pq,pq,p->", found, q_weight, p_weight) * np.ones(3)

    return per_direction(wo, one)[..., 0]


def _outer_edges(vx: float, vz: float, m: float, kinks: Sequence[float]) -> Floats:
    """Panel edges in p: where lines and circles of the inner kinks begin, end or cross q = 0."""
    far = vx / vz + np.sqrt(np.square(vx / vz) + 1.0)
    low, high = max(-1.0 / far, -REACH * m), min(far, REACH * m)  # beyond, light leaves below the surface
    return np.unique(np.clip([low, high, *_outer_kinks(vx, vz, m, kinks)], low, high))


def _outer_kinks(vx: float, vz: float, m: float, kinks: Sequence[float]) -> list[float]:
    t = vx / vz
    scales = np.concatenate([LADDER, SPREAD * m])
    edges = [0.0, t, *scales, *-scales]
    edges += [root.real for root in np.roots([t, 3.0, -3.0 * t, -1.0]) if abs(root.imag) < 1e-9]
    if t > 0:
        edges += [1.0 / t, *((LADDER - 1.0) / t), *((np.logspace(-8, -3, 6) - 1.0) / t)]
    for kink in kinks:
        edges += [root.real for root in np.roots([vx * vx - kink * kink, 2 * vx * vz, vz * vz - kink * kink])]
        if t > 0:  # where the kink's circle meets those of the horizon and of shadowing
            meets = np.array([2.0 * kink**2 / vz, np.sqrt(vz * vz + 4.0 * kink**2) - vz, kink**2 / vz])
            edges += [*((meets - vz) / vx)]
    return edges


def _inner_edges(p: Floats, A: Floats, vz: float, facets: Facets, kinks: Sequence[float]) -> Floats:
    """Panel edges in q for each p, up to where light leaves below the surface."""
    middle, m = np.abs(facets.centre(p)), facets.across

    def circle(length2: Floats) -> Floats:
        return np.sqrt(np.maximum(length2 - 1.0 - p * p, 0.0))

    end = np.minimum(circle(2.0 * A / vz), middle + REACH * m)
    shadow = circle(4.0 / (np.minimum(1.0, 2.0 * vz / A) + 2.0 * vz / A))
    edges = [np.broadcast_to(edge, p.shape) for edge in [0.0, *LADDER]]
    spreads = np.concatenate([-SPREAD, [0.0], SPREAD]) if facets.b else SPREAD
    edges += [np.maximum(middle + spread * m, 0.0) for spread in spreads]
    edges += [shadow, end, *(circle(np.square(A / kink)) for kink in kinks)]
    return np.sort(np.minimum(np.stack(edges, axis=-1), end[:, None]), axis=-1)


def vgroove_mean(wo: ArrayLike, m: ArrayLike, eta: float, weight: Weight, *, nodes: int = NODES) -> Floats:
    """Mean of ``weight(F, R, T)`` over the facets of an interface as ``wo`` sees them; (..., 3), three times a number.

    Or the means of three numbers, if ``weight`` gives three along a last axis.

    F: the facet's reflectance. R = G2/G1 and T = G2t/G1: the shares of reflected and of refracted light that no other
    facet stops. With slopes p (in the plane of view) and q as in ``vgroove_albedo``:
    1/v_z  integral of  P(p, q) A G1 weight dp dq.
    eta: index below over above. F R gives the reflected light, (1 - F) T the transmitted; products give variances.
    """
    wo = as_directions(wo, "wo")
    slopes = np.broadcast_to(as_positive(m, "m"), wo.shape[:-1]).ravel()
    return per_direction(wo, lambda cosine, index: _vgroove_mean(cosine, float(slopes[index]), eta, weight, nodes))


def _vgroove_mean(vz: float, m: float, eta: float, weight: Weight, nodes: int) -> Floats:
    vx = np.sqrt((1.0 - vz) * (1.0 + vz))
    e = (eta - 1.0) * (eta + 1.0)
    kinks = Dielectric(eta).kinks
    p, p_weight = panels(_refraction_outer_edges(vx, vz, m, e, kinks), nodes)
    A = np.maximum(vx * p + vz, 1e-16 * vz)  # rounding may put the first panel's start on the far side of v.h = 0
    q, q_weight = panels(_refraction_inner_edges(p, A, vz, m, e, kinks), nodes)
    p, A = p[:, None], A[:, None]
    length2 = 1.0 + p * p + q * q
    nh, c = 1.0 / np.sqrt(length2), np.minimum(A / np.sqrt(length2), 1.0)
    G1 = np.minimum(1.0, 2.0 * vz / A)
    R = np.maximum(np.minimum(G1, 4.0 / length2 - 2.0 * vz / A), 0.0) / G1
    g = np.sqrt(np.maximum(add_product(np.asarray(e), c, c), 0.0))  # eta |l.h|, 0 in total reflection
    down = np.maximum(vz + e * nh / (g + c), 0.0)  # eta |n.l|
    G1l = np.minimum(1.0, 2.0 * nh * down / np.where(g > 0, g, 1.0))
    T = np.where(g > 0, np.maximum(G1 - (1.0 - G1l), 0.0), 0.0) / G1
    P = np.exp(-np.square(p / m) - np.square(q / m)) / (np.pi * m * m)
    facets = P * (A / vz) * G1 * q_weight * p_weight[:, None]
    return 2.0 * np.tensordot(facets, weight(fresnel_dielectric(c, eta), R, T), axes=2)  # q < 0 mirrors q > 0


def _shadow_terms(A: Floats | Polynomial, b: Floats | Polynomial, vz: float, e: float) -> tuple[Any, Any, Any]:
    """k0, k1, k2 of k0 y^2 + k1 y + k2 = 0 for y = 1 + p^2 + q^2 where the refracted light's G1(l) is b/A.

    2 (n.h)|n.l|/|l.h| = b/A squares to a quadratic in (n.h)^2 = 1/y: the cubes of both sides cancel.
    """
    return e * b * b, A * A * (b * b - 4.0 * vz * vz) - 4.0 * e * b * A, A * A * (4.0 * e + 8.0 * vz * A - 4.0 * b * A)


def _refraction_outer_edges(vx: float, vz: float, m: float, e: float, kinks: Sequence[float]) -> Floats:
    """As ``_outer_edges`` up to all facets that wo sees, with those at which G1(l) = 1 and G2t = 0 begin or end."""
    t = vx / vz
    low, high = (max(-1.0 / t, -REACH * m) if t > 0 else -REACH * m), REACH * m
    far = t + np.sqrt(t * t + 1.0)
    edges = [low, high, -1.0 / far, far, *_outer_kinks(vx, vz, m, kinks)]
    Polynomial = np.polynomial.Polynomial
    A, y = Polynomial([vz, vx]), Polynomial([1.0, 0.0, 1.0])  # y at q = 0
    for b in (A, A - 2.0 * vz, Polynomial([0.0])):
        k0, k1, k2 = _shadow_terms(A, b, vz, e)
        for curve in (k0 * y * y + k1 * y + k2, k1 * k1 - 4.0 * k0 * k2):
            edges += [root.real for root in curve.trim().roots() if abs(root.imag) < 1e-6]
    return np.unique(np.clip(edges, low, high))


def _refraction_inner_edges(p: Floats, A: Floats, vz: float, m: float, e: float, kinks: Sequence[float]) -> Floats:
    """Panel edges in q for each p: those of reflection, and of the refracted light's shadowing."""
    end = REACH * m

    def circle(length2: Floats) -> Floats:
        return np.sqrt(np.clip(np.nan_to_num(length2, nan=0.0) - 1.0 - p * p, 0.0, end * end))

    G1 = np.minimum(1.0, 2.0 * vz / A)
    fixed = np.concatenate([[0.0, end], LADDER, SPREAD * m])
    edges = [np.broadcast_to(edge, p.shape) for edge in fixed]
    edges += [circle(2.0 * A / vz), circle(4.0 / (G1 + 2.0 * vz / A)), *(circle(np.square(A / kink)) for kink in kinks)]
    for b in (A, A - np.minimum(A, 2.0 * vz)):
        k0, k1, k2 = _shadow_terms(A, b, vz, e)
        with np.errstate(divide="ignore", invalid="ignore"):
            s = -0.5 * (k1 + np.copysign(np.sqrt(k1 * k1 - 4.0 * k0 * k2), k1))
            edges += [circle(s / k0), circle(k2 / s)]
    return np.sort(np.minimum(np.stack(edges, axis=-1), end), axis=-1)


def diffuse_albedo(wo: ArrayLike, evaluate: Callable[[Floats, Floats], Floats], nodes: int = 160) -> Floats:
    """Integral of f cos over wi for an isotropic f with kinks at theta_i = theta_o and at 90 degrees of azimuth.

    32 nodes would do but for the kink where Oren-Nayar's full fit is cut at 0 (sigma > 0.66): 2e-5 off there, 160 3e-7.
    """

    def one(cosine: float, _index: int) -> Floats:
        theta_o = np.arccos(cosine)
        theta, theta_weight = panels(np.unique([0.0, theta_o, np.pi / 2]), nodes)
        phi, phi_weight = panels(np.array([0.0, np.pi / 2, np.pi]), nodes)
        sin, cos = np.sin(theta)[:, None], np.cos(theta)[:, None]
        wi = np.stack(np.broadcast_arrays(sin * np.cos(phi), sin * np.sin(phi), cos), axis=-1)
        f = evaluate(wi, np.array([np.sin(theta_o), 0.0, cosine]))
        return 2.0 * np.einsum("tpc,t,p->c", f, theta_weight * np.cos(theta) * np.sin(theta), phi_weight)

    return per_direction(wo, one)
