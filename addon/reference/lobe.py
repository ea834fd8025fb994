# SPDX-License-Identifier: GPL-3.0-or-later
"""A BRDF under one light as a surface around the point that is lit: in each direction as far away as f is large.

Drawn so, a BRDF is a lobe. What is drawn is f, or f times one or both cosines, linear or in decades.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from .anisotropic import Anisotropic, turned
from .cook_torrance import CookTorrance
from .directions import as_directions, as_pair, facet_cosine, half_vector, spherical
from .distributions import beckmann_d, vgroove_g
from .generator import Generator

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .directions import Floats
    from .model import Brdf

TIMES = ("one", "cos_o", "cos_io")  # what f is multiplied by: 1, cos theta_o, cos theta_i cos theta_o
PLOTS = PLANE, ACROSS, ALBEDO, THETA_H = "PLANE", "ACROSS", "ALBEDO", "THETA_H"  # of the BRDF Viewer
CHANNELS = ("luminance", "red", "green", "blue")
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear Rec.709
DECADES = 4.0  # that a logarithmic lobe shows, down from the peak
RINGS, AROUND = 48, 96
STEP = 0.5  # degrees between the angles of a slice, where none is denser
NEAR = np.concatenate([[0.0], np.geomspace(1e-3, 20.0, 120)])  # degrees from a peak
LAST = 89.99  # degrees: at 90 f is 0 by convention
LOWEST = np.radians(89.9)  # a mirror direction nearer the horizon would leave no room for rings beyond it
RIM = 1.0 - 1e-6  # of the way to the horizon, where f would be 0


def directions(wi: Floats, rings: int = RINGS, around: int = AROUND) -> Floats:
    """Directions (rings, around, 3) all over the hemisphere, denser toward the mirror direction of ``wi``.

    Ring k is (k / (rings - 1))^2 of the way from the mirror direction to the horizon, so lobes of a slope down to 0.01
    are resolved. The first ring is a point; columns go once around, and the last is next to the first.
    wi: a unit vector (3,) above the surface.
    """
    wi = as_directions(wi, "wi")
    theta = min(float(np.arctan2(np.hypot(wi[0], wi[1]), wi[2])), LOWEST)
    phi = float(np.arctan2(wi[1], wi[0])) if theta > 0.0 else 0.0
    sin, cos = np.sin(theta), np.cos(theta)
    b = 2.0 * np.pi * np.arange(around) / around
    horizon = np.arctan2(cos, np.cos(b) * sin)
    a = horizon * RIM * np.square(np.arange(rings) / (rings - 1.0))[:, None]
    x = np.cos(a) * sin + np.sin(a) * np.cos(b) * cos
    z = np.cos(a) * cos - np.sin(a) * np.cos(b) * sin
    return turned(np.stack([x, np.sin(a) * np.sin(b), z], axis=-1), -(phi + np.pi))


def slice_angles(wi: Floats) -> Floats:
    """theta_o (n,) in degrees from one horizon to the other, for ``slice_directions``.

    Half a degree apart, and denser around the mirror direction and the light's own.
    """
    theta = float(np.degrees(np.arctan2(np.hypot(wi[0], wi[1]), wi[2])))
    near = [side * theta + sign * NEAR for side in (1, -1) for sign in (1, -1)]
    every = np.concatenate([np.arange(-90.0 + STEP, 90.0, STEP), [-LAST, LAST], *near])
    return np.unique(np.round(every[np.abs(every) <= LAST], 6))


def slice_directions(theta_o: Floats, phi: float) -> Floats:
    """Directions (n, 3) at ``theta_o`` in the plane of azimuth ``phi``, both in degrees: on that side if negative.

    phi is the light's azimuth for a slice in the plane of incidence.
    """
    return spherical(np.radians(np.abs(theta_o)), np.radians(phi + np.where(theta_o < 0, 0.0, 180.0)))


def weighted(f: Floats, wi: Floats, wo: Floats, times: str) -> Floats:
    """``f`` (..., 3), multiplied by the cosines that ``times``, one of ``TIMES``, names."""
    if times == "one":
        return f
    wi, wo = as_pair(wi, wo)
    cosine = np.maximum(wo[..., 2:], 0.0)
    return f * cosine if times == "cos_o" else f * cosine * np.maximum(wi[..., 2:], 0.0)


def channel_of(rgb: Floats, channel: str) -> Floats:
    """One number (...) of RGB (..., 3): its luminance or a channel, of ``CHANNELS``."""
    return rgb @ LUMINANCE if channel == "luminance" else rgb[..., CHANNELS.index(channel) - 1]


def radii(values: Floats, peak: float, *, log: bool) -> Floats:
    """How far from the point ``values`` are drawn, (...): 1 at ``peak``.

    log: 0 at ``DECADES`` below the peak and less, and evenly between.
    """
    share = np.maximum(values, 0.0) / peak if peak > 0.0 else np.zeros(np.shape(values))
    if not log:
        return share
    with np.errstate(divide="ignore"):
        return np.maximum(1.0 + np.log10(share) / DECADES, 0.0)


def triangles(rings: int = RINGS, around: int = AROUND) -> NDArray[np.int32]:
    """Three vertices of each triangle between the rings of ``directions``, (n, 3), seen from outside anticlockwise."""
    here = np.arange(rings * around, dtype=np.int32).reshape(rings, around)
    beside = np.roll(here, -1, axis=1)
    a, b, c, d = here[:-1], beside[:-1], here[1:], beside[1:]
    return np.stack([np.stack([a, c, d], axis=-1), np.stack([a, d, b], axis=-1)]).reshape(-1, 3)


@dataclass(frozen=True)
class Lobe:
    """A lobe under one light. wo: (rings, around, 3). rgb: what is drawn there, (rings, around, 3)."""

    wo: Floats
    rgb: Floats

    def values(self, channel: str) -> Floats:
        """(rings, around)."""
        return channel_of(self.rgb, channel)

    def vertices(self, channel: str, peak: float, *, log: bool) -> Floats:
        """The surface, (rings, around, 3): at most 1 away where nothing exceeds ``peak``."""
        return self.wo * radii(self.values(channel), peak, log=log)[..., None]

    def colors(self) -> Floats:
        """RGB of each direction, scaled so that its strongest channel is 1; white where nothing is reflected."""
        strongest = self.rgb.max(axis=-1, keepdims=True)
        return np.where(strongest > 0.0, self.rgb / np.where(strongest > 0.0, strongest, 1.0), 1.0)


def lobe(brdf: Brdf, wi: Floats, times: str = "one", *, isotropic: bool = False) -> Lobe:
    """The lobe of ``brdf`` under a light at ``wi`` (3,).

    isotropic: it is as at the right of the plane of incidence, so at its left: one side is evaluated.
    """
    wo = directions(wi)
    if not isotropic:
        return Lobe(wo, weighted(brdf(wi, wo), wi, wo, times))
    side = np.arange(AROUND)
    half = wo[:, : AROUND // 2 + 1]
    return Lobe(wo, weighted(brdf(wi, half), wi, half, times)[:, np.minimum(side, AROUND - side)])


def is_isotropic(model: Any) -> bool:
    """Whether a model looks the same however it is turned about the normal."""
    return not any(isinstance(part, Anisotropic) for part in (model, getattr(model, "specular", None)))


def normals(vertices: Floats) -> Floats:
    """Unit normals (rings, around, 3) of a surface of such ``vertices``, outward; for shading."""
    along = np.gradient(vertices, axis=0)
    across = np.roll(vertices, -1, axis=1) - np.roll(vertices, 1, axis=1)
    across[0] = across[1]  # the first ring is a point
    normal = np.cross(along, across)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    return np.where(length > 0.0, normal / np.where(length > 0.0, length, 1.0), [0.0, 0.0, 1.0])


def terms(model: Any) -> dict[str, Brdf]:
    """D in 1/sr, G and F of a model's facets, each alone, as functions (wi, wo) -> (..., 3); {} of one without facets.

    Of a sum those of its specular part, of several lobes those of the first.
    """
    model = getattr(model, "specular", model) if hasattr(getattr(model, "specular", None), "evaluate") else model
    model = (getattr(model, "lobes", None) or (model,))[0]
    if isinstance(model, CookTorrance):
        m = model.m
        return _terms(lambda h: beckmann_d(h, m), model.fresnel)
    if isinstance(model, Anisotropic):
        x, y, azimuth = model.m_x, model.m_y, model.azimuth
        return _terms(lambda h: beckmann_d(turned(h, azimuth), x, y), model.fresnel)
    return _terms(model.distribution, model.fresnel) if isinstance(model, Generator) else {}


def _terms(distribution: Any, fresnel: Any) -> dict[str, Brdf]:
    def grey(values: Floats) -> Floats:
        return np.repeat(values[..., None], 3, axis=-1)

    def F(wi: Any, wo: Any) -> Floats:
        wi, wo = as_pair(wi, wo)
        return fresnel(facet_cosine(wi, wo, half_vector(wi, wo)))

    def D(wi: Any, wo: Any) -> Floats:
        return grey(distribution(half_vector(*as_pair(wi, wo))))

    return {"D": D, "G": lambda wi, wo: grey(vgroove_g(wi, wo)), "F": F}
