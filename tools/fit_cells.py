# SPDX-License-Identifier: GPL-3.0-or-later
"""What ``fit_cook_torrance.py`` compares: the V-groove model in single views, and in pictures of a ball under a sun."""

from __future__ import annotations

import numpy as np

from vgroove.addon.reference import cook_torrance_fit as fit
from vgroove.addon.reference.distributions import smith_g, vgroove_g

RADII, TURNS = 30, 22  # grid of facets
SMOOTHING = 3e-4  # of the peak: below this |r| becomes r^2
ALBEDO = 0.005  # relative error of the albedo that costs nothing
MOST = 0.9998  # albedo beyond which a mixture costs: a furnace must not exceed 1
LOBE_PARTS = slice(0, 2), slice(2, 6), slice(6, 10)  # weight and roughness; of leaning lobes also anisotropy and tilt
LOW = np.array([0.0, 0.5, *2 * (0.0, 0.5, 0.0, -0.8)])
HIGH = np.array([1.0, 1.4, *2 * (1.0, 1.4, 1.0, 3.0)])


def slopes(m: float, radii: int, turns: int) -> tuple[np.ndarray, ...]:
    """p, q and dp dq (radii, turns) of facets up to 3.2 m, all but 4e-5 of them; q > 0 counts for its mirror image."""
    x, weight = np.polynomial.legendre.leggauss(radii)
    radius, weight = 1.6 * m * (x + 1.0), 1.6 * m * weight
    phi = (np.arange(turns) + 0.5) * np.pi / turns
    area = 2.0 * np.pi / turns * radius * weight
    return np.outer(radius, np.cos(phi)), np.outer(radius, np.sin(phi)), np.outer(area, np.ones(turns))


class Cell:
    """One slope and view (or light, as the model is reciprocal): the reference on a grid of facets."""

    def __init__(self, m: float, cosine: float, radii: int = RADII, turns: int = TURNS) -> None:
        self.m, self.angle = m, np.arccos(cosine)
        self.wo = np.array([np.sin(self.angle), 0.0, cosine])
        p, q, area = slopes(m, radii, turns)
        nh = 1.0 / np.sqrt(1.0 + p * p + q * q)
        h = np.stack([p * nh, q * nh, nh], axis=-1)
        vh = h @ self.wo
        wi = 2.0 * vh[..., None] * h - self.wo
        lit = (vh > 1e-9) & (wi[..., 2] > 1e-9)
        self.wi = wi[lit] / np.linalg.norm(wi[lit], axis=-1, keepdims=True)
        nh, vh = nh[lit], vh[lit]
        self.parts = [(w[:, 1], w[:, 0], w[:, 2]) for w in (self.wi, self.wo[None], h[lit])]
        D = np.exp(-(p * p + q * q)[lit] / m**2) / (np.pi * m**2 * nh**4)
        self.f_cos = D * vgroove_g(self.wi, self.wo) / (4.0 * cosine)
        self.solid_angle = 4.0 * vh * nh**3 * area[lit]  # dwi = 4 (v.h) dh, dh = (n.h)^3 dp dq
        self.albedo = float(self.f_cos @ self.solid_angle)
        self.share = self.solid_angle / self.albedo
        self.lights = np.degrees(np.arccos(np.clip(self.wi[:, 2], 0.0, 1.0)))  # theta_i
        self.high = HIGH.copy()  # a lobe that leans farther hides from the view
        self.high[[5, 9]] = min(3.0, fit.MOST_LEAN * cosine / max(np.sin(self.angle) ** 2, 1e-9) / m)

    def lobe(self, roughness: float, anisotropy: float = 0.0, tilt: float = 0.0) -> np.ndarray:
        """f cos of a lobe of weight 1; tilt over m."""
        square, aspect = self.m * roughness**2, np.sqrt(1.0 - (1.0 - fit.NARROWEST) * anisotropy)
        lean = np.float64(self.m * tilt * np.sin(self.angle))
        slopes = np.float64(min(square / aspect, 1.0)), np.float64(min(square * aspect, 1.0))
        return fit.smith_lobe(*(fit.turned(*w, lean) for w in self.parts), *slopes)

    def mixture(self, of: dict[str, np.ndarray] | None = None) -> np.ndarray:
        """f cos of the mixture of a table; the committed one by default."""
        return np.sum(fit.weighted_lobes(self.wi, self.wo, fit.lobes(self.wo, self.m, of)), axis=-1)

    def distance(self, of: dict[str, np.ndarray] | None = None) -> float:
        """L1 at this view."""
        return float(np.abs(self.mixture(of) - self.f_cos) @ self.share)

    def distance_under_light(self, of: dict[str, np.ndarray] | None = None) -> float:
        """L1 over all views by their cosine, under a light from where this cell's view is."""
        wo, wi = self.wi, np.broadcast_to(self.wo, self.wi.shape)
        mixture = np.sum(fit.weighted_lobes(wi, wo, fit.lobes(wo, self.m, of)), axis=-1)
        true = self.f_cos / wo[:, 2] * self.wo[2]
        shown = self.solid_angle * wo[:, 2]
        return float(np.abs(mixture - true) @ shown / (true @ shown))

    def loss(
        self, raw: np.ndarray, weight: np.ndarray, square: np.ndarray, *, slopes: bool = True
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Smoothed L1 and what a wrong albedo and values beyond their limits cost; gradient, Gauss-Newton matrix.

        raw: the ten values of all lobes; weight: of each facet's distance; square: of its square.
        """
        values = np.clip(raw, LOW, self.high)
        free, beyond = values == raw, raw - values
        J, r = np.zeros((len(self.f_cos), len(raw))), -self.f_cos
        for part in LOBE_PARTS:
            share, *shape = values[part]
            J[:, part.start] = plain = self.lobe(*shape)
            r = r + share * plain
            for at in range(len(shape) if slopes and share > 0.0 else 0):
                step = -1e-5 if at == 1 and shape[1] > 0.5 else 1e-5
                nudged = [value + step * (at == k) for k, value in enumerate(shape)]
                J[:, part.start + 1 + at] = (self.lobe(*nudged) - plain) / step * share
        size, stray = np.hypot(r, SMOOTHING * np.max(self.f_cos)), 0.05 * weight.sum()
        loss = float(size @ weight + np.square(r) @ square + stray * beyond @ beyond)
        pull = weight / size + 2.0 * square
        gradient, matrix = J.T @ (r * pull), (J * pull[:, None]).T @ J
        error, slope, scale = float(r @ self.share), J.T @ self.share, float(weight @ self.f_cos)
        gain = self.albedo * (1.0 + error) - MOST
        for excess, cost, sign in ((error - ALBEDO, 3e3, 1.0), (-ALBEDO - error, 3e3, -1.0), (gain, 1e5, 1.0)):
            if excess > 0:
                loss += scale * cost * excess**2
                gradient = gradient + 2.0 * scale * cost * excess * sign * slope
                matrix = matrix + 2.0 * scale * cost * np.outer(slope, slope)
        gradient = gradient * free + 2.0 * stray * beyond
        return loss, gradient, matrix * np.outer(free, free) + np.diag(2.0 * stray * ~free)


class Picture:
    """A ball under a sun that is ``degrees`` from the camera: n over the facets with normal h that reflect it."""

    def __init__(self, m: float, degrees: float, radii: int = 40, turns: int = 24) -> None:
        self.m = m
        p, q, area = slopes(m, radii, turns)
        n = np.stack([p, q, np.ones_like(p)], axis=-1)
        nh = 1.0 / np.linalg.norm(n, axis=-1)
        n *= nh[..., None]
        s, c = np.sin(np.radians(degrees / 2.0)), np.cos(np.radians(degrees / 2.0))
        camera, sun = np.array([-s, 0.0, c]), np.array([s, 0.0, c])
        lit = (n @ camera > 1e-6) & (n @ sun > 1e-6)
        n, nh = n[lit], nh[lit]
        cosine = n @ camera
        across = camera - cosine[:, None] * n
        across /= np.linalg.norm(across, axis=-1, keepdims=True)
        self.wo = np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)
        self.wi = np.stack([across @ sun, np.cross(n, across) @ sun, n @ sun], axis=-1)
        D = np.exp(-(1.0 / nh**2 - 1.0) / m**2) / (np.pi * m**2 * nh**4)
        self.true = D * vgroove_g(self.wi, self.wo) / (4.0 * cosine)
        self.shown = area[lit] * nh**3 * cosine  # dn = nh^3 dp dq
        self.energy = float(self.true**2 @ self.shown)
        self.native = self._rms(D * smith_g(self.wi, self.wo, m) / (4.0 * cosine))

    def rms(self, of: dict[str, np.ndarray] | None = None) -> float:
        """Error of the mixture over the picture's own root mean square, as ``native`` has it of one native lobe."""
        return self._rms(np.sum(fit.weighted_lobes(self.wi, self.wo, fit.lobes(self.wo, self.m, of)), axis=-1))

    def _rms(self, shown: np.ndarray) -> float:
        return float(np.sqrt((shown - self.true) ** 2 @ self.shown / self.energy))
