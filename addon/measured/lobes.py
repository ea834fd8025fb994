# SPDX-License-Identifier: GPL-3.0-or-later
"""What measured BRDFs are fitted with: sums of parts, each a function of a few bounded numbers, at fixed pairs."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np

from ..library.preset import Preset
from ..models import car_paint, cook_torrance, generator, ward
from ..reference.directions import above, spherical
from ..reference.distributions import beckmann_d, vgroove_g
from ..reference.facet_distribution import Distribution, Term
from ..reference.fresnel import f82, fresnel_dielectric
from ..reference.oren_nayar import oren_nayar
from .merl import directions

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..models import Number
    from ..reference.directions import Floats

GRAZING = np.radians(80.0)  # beyond, in wi or wo, measured values are too uncertain (Ngan et al. 2005)
SLOPES = (0.002, 1.0)  # of lobes; Cycles' closures end at 1
DIGITS = 6  # of numbers in presets
IDENTITY, TAGS = "mine/fit", ("measured",)


class Pairs:
    """Directions at centres of MERL's cells: each theta_h, every fifth theta_d, every thirtieth phi_d.

    weight: cos(theta_i) cos(theta_o) dwi dwo of each pair, (n,), which adds up to 1. dwi dwo = 4 cos(theta_d)
    dwh dwd, as d wo = 4 (wi . h) d wh.
    """

    def __init__(self) -> None:
        edges = np.square(np.arange(91) / 90.0) * np.pi / 2
        theta_h = np.square((np.arange(90) + 0.5) / 90.0) * np.pi / 2
        theta_d, phi_d = np.radians(np.arange(2.5, 90.0, 5.0)), np.radians(np.arange(7.5, 180.0, 30.0))
        h, d, phi = np.meshgrid(range(theta_h.size), range(theta_d.size), phi_d, indexing="ij")
        wi, wo = directions(theta_h[h], theta_d[d], phi)
        kept = above(wi, wo) & (np.minimum(wi[..., 2], wo[..., 2]) >= np.cos(GRAZING))
        self.wi, self.wo, self._h, self._d = wi[kept], wo[kept], h[kept], d[kept]
        self._facets, self._cosines = spherical(theta_h), np.cos(theta_d)
        ring = np.sin(theta_h) * np.diff(edges)
        weight = ring[self._h] * self._cosines[self._d] * np.sin(theta_d)[self._d] * self.wi[:, 2] * self.wo[:, 2]
        self.weight = weight / weight.sum()
        self._masking = vgroove_g(self.wi, self.wo) / (4.0 * self.wi[:, 2] * self.wo[:, 2])

    def microfacets(self, D: Floats, F: Floats) -> Floats:
        """F D G / (4 (n.l)(n.v)), (n, 3), from D at the facets (90,) and F at the cosines (18, 3)."""
        return (D[self._h] * self._masking)[:, None] * F[self._d]

    def products(self, D: Floats, F: Floats) -> Floats:
        """D F, (n, 3), of the same."""
        return D[self._h][:, None] * F[self._d]

    @property
    def facets(self) -> Floats:
        """The half vectors' angles as unit vectors, (90, 3)."""
        return self._facets

    @property
    def cosines(self) -> Floats:
        """cos(theta_d) = v.h, (18,)."""
        return self._cosines


class Part(ABC):
    """One part of the sum. low, high: ranges of its numbers, slopes and B as logarithms."""

    low: Sequence[float]
    high: Sequence[float]

    @abstractmethod
    def evaluate(self, pairs: Pairs, p: Floats) -> Floats:
        """Its f at the pairs, (n, 3)."""

    @abstractmethod
    def reflects(self, p: Floats) -> Floats:
        """RGB that counts against 1 in the preset: what all parts reflect together must not exceed it."""


class Diffuse(Part):
    """Oren-Nayar: albedo R, G, B and sigma; Lambert without ``rough``."""

    def __init__(self, *, rough: bool) -> None:
        self.low, self.high = (0.0,) * (3 + rough), (0.95,) * 3 + (1.2,) * rough

    def evaluate(self, pairs: Pairs, p: Floats) -> Floats:
        return oren_nayar(pairs.wi, pairs.wo, p[:3], p[3] if p.size > 3 else 0.0)

    def reflects(self, p: Floats) -> Floats:
        return p[:3]


class Lobe(Part):
    """s times Cook-Torrance with F82: log m, s, f0 and tint at 82 degrees."""

    low = (np.log(SLOPES[0]), *(0.0,) * 7)
    high = (np.log(SLOPES[1]), *(1.0,) * 7)

    def evaluate(self, pairs: Pairs, p: Floats) -> Floats:
        F = f82(pairs.cosines, p[2:5], p[5:8])
        return p[1] * pairs.microfacets(beckmann_d(pairs.facets, np.exp(p[0])), F)

    def reflects(self, p: Floats) -> Floats:
        return np.full(3, p[1])


class Facets(Part):
    """The generator's lobe: specular R, G, B; eta; and of each ABC term log B, C and the logarithm of its weight."""

    def __init__(self, terms: int) -> None:
        self.low = (0.0, 0.0, 0.0, 1.02, *(0.0, 0.02, -8.0) * terms)
        self.high = (1.0, 1.0, 1.0, 10.0, *(16.0, 20.0, 8.0) * terms)

    def evaluate(self, pairs: Pairs, p: Floats) -> Floats:
        F = fresnel_dielectric(pairs.cosines, p[3])[:, None] * p[:3]
        return pairs.microfacets(Distribution(self.terms(p))(pairs.facets), F)

    def reflects(self, p: Floats) -> Floats:
        return p[:3] * float(fresnel_dielectric(1.0, p[3]))

    @staticmethod
    def terms(p: Floats) -> tuple[Term, ...]:
        """The tables [[distribution]], with weights that add up to 1."""
        log_b, power, log_w = p[4:].reshape(-1, 3).T
        share = np.exp(log_w - np.max(log_w))
        share = share / share.sum()
        rows = zip(np.exp(log_b), power, share, strict=True)
        return tuple(Term("abc", (float(B), float(C)), float(w)) for B, C, w in rows)


class Gaussian(Part):
    """Ward's bounded lobe, D / (4 (v.h)^2): specular R, G, B and log m."""

    low = (*(0.0,) * 3, np.log(SLOPES[0]))
    high = (*(1.0,) * 3, np.log(SLOPES[1]))

    def evaluate(self, pairs: Pairs, p: Floats) -> Floats:
        return pairs.products(beckmann_d(pairs.facets, np.exp(p[3])), p[:3] / (4.0 * pairs.cosines[:, None] ** 2))

    def reflects(self, p: Floats) -> Floats:
        return p[:3]


class Lobes(ABC):
    """A model to fit. Its numbers stand in one array, part after part. most: lobes."""

    most: int

    @abstractmethod
    def parts(self, lobes: int) -> list[Part]: ...

    @abstractmethod
    def start(self, albedo: Floats) -> Floats:
        """Numbers without a lobe."""

    @abstractmethod
    def with_lobe(self, p: Floats, slope: float) -> Floats:
        """These numbers and one lobe more, of about this slope."""

    @abstractmethod
    def within(self, p: Floats, full: float) -> Floats:
        """The numbers, with lobes scaled down to where all parts reflect at most ``full``."""

    @abstractmethod
    def preset(self, p: Floats, name: str, source: dict[str, str]) -> Preset:
        """The numbers as a preset, rounded; lobes from narrow to wide."""


class CookTorranceLobes(Lobes):
    """Oren-Nayar and lobes: a preset of the model for car paints."""

    most = 4

    def parts(self, lobes: int) -> list[Part]:
        return [Diffuse(rough=True), *(Lobe() for _ in range(lobes))]

    def start(self, albedo: Floats) -> Floats:
        return np.array([*albedo, 0.3])

    def with_lobe(self, p: Floats, slope: float) -> Floats:
        return np.array([*p, np.log(slope), 0.1, *(0.5,) * 3, *(0.9,) * 3])

    def within(self, p: Floats, full: float) -> Floats:
        each = p[4:].reshape(-1, 8).copy()
        each[:, 1] *= min(1.0, (full - float(np.max(p[:3]))) / max(float(each[:, 1].sum()), 1e-12))
        return np.concatenate([p[:4], each.ravel()])

    def preset(self, p: Floats, name: str, source: dict[str, str]) -> Preset:
        numbers: dict[str, Number] = {"albedo": _rgb(p[:3]), "sigma": _rounded(p[3])}
        for k, lobe in enumerate(sorted(p[4:].reshape(-1, 8), key=lambda one: float(one[0])), 1):
            of: dict[str, Number] = {"s": _rounded(lobe[1]), "m": _rounded(np.exp(lobe[0]))}
            of |= {"f0": _rgb(lobe[2:5]), "f82_tint": _rgb(lobe[5:8])}
            numbers |= {f"{key}_{k}": value for key, value in of.items()}
        return Preset(IDENTITY, name, car_paint.MODEL.name, "f82", numbers, source, TAGS)


class GeneratorLobes(Lobes):
    """Lambert and ABC facets of one Fresnel term: a preset of the microfacet generator."""

    most = 3

    def parts(self, lobes: int) -> list[Part]:
        return [Diffuse(rough=False), Facets(lobes)]

    def start(self, albedo: Floats) -> Floats:
        return np.array([*albedo, 0.5, 0.5, 0.5, 1.5])

    def with_lobe(self, p: Floats, slope: float) -> Floats:
        return np.array([*p, np.log(2.0 / slope**2), 1.5, 0.0])

    def within(self, p: Floats, full: float) -> Floats:
        share = (full - p[:3]) / np.maximum(self.parts(1)[1].reflects(p[3:]), 1e-12)
        return np.concatenate([p[:3], p[3:6] * min(1.0, float(np.min(share))), p[6:]])

    def preset(self, p: Floats, name: str, source: dict[str, str]) -> Preset:
        numbers: dict[str, Number] = {"albedo": _rgb(p[:3]), "specular": _rgb(p[3:6]), "eta": _rounded(p[6])}
        terms = tuple(
            Term(of.kind, tuple(map(_rounded, of.numbers)), _rounded(of.weight)) for of in Facets.terms(p[3:])
        )
        return Preset(IDENTITY, name, generator.MODEL.name, "dielectric", numbers, source, TAGS, distribution=terms)


class WardLobes(Lobes):
    """Lambert and one round Gaussian: a preset of Ward's model in its bounded form."""

    most = 1

    def parts(self, lobes: int) -> list[Part]:
        return [Diffuse(rough=False), *(Gaussian() for _ in range(lobes))]

    def start(self, albedo: Floats) -> Floats:
        return albedo

    def with_lobe(self, p: Floats, slope: float) -> Floats:
        return np.array([*p, *(0.1,) * 3, np.log(slope)])

    def within(self, p: Floats, full: float) -> Floats:
        share = (full - p[:3]) / np.maximum(p[3:6], 1e-12)
        return np.concatenate([p[:3], p[3:6] * min(1.0, float(np.min(share))), p[6:]])

    def preset(self, p: Floats, name: str, source: dict[str, str]) -> Preset:
        numbers: dict[str, Number] = {"albedo": _rgb(p[:3]), "specular": _rgb(p[3:6]), "m": _rounded(np.exp(p[6]))}
        numbers |= {"anisotropy": 0.0, "rotation": 0.0}
        return Preset(IDENTITY, name, ward.MODEL.name, next(iter(ward.MODEL.kinds)), numbers, source, TAGS)


KINDS: dict[str, Lobes] = {
    cook_torrance.MODEL.name: CookTorranceLobes(),
    generator.MODEL.name: GeneratorLobes(),
    ward.MODEL.name: WardLobes(),
}


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _rgb(values: Floats) -> tuple[float, float, float]:
    r, g, b = map(_rounded, values)
    return r, g, b
