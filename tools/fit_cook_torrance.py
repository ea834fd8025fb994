# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of ``fit``: native Beckmann lobes that come nearest to the V-groove model, in L1, at every m and view.

python tools/fit_cook_torrance.py              prints, for each slope, the largest L1 of the committed table over views
                                               and over lights
python tools/fit_cook_torrance.py --write      finds the table anew (five minutes of one core) and writes it
python tools/fit_cook_torrance.py --mend       the last part of that alone, from the committed table
python tools/fit_cook_torrance.py --share      hybrid's share alone, of the committed table
python tools/fit_cook_torrance.py --curve      what fewer and more lobes would reach, for a few slopes

L1 at a fixed view is the integral over wi of |f_fit - f| cos(theta_i) over that of f cos(theta_i); under a fixed light
it is that over wo, each view weighted by its cosine, as a surface shows it. Both are integrals of one distance, so that
each node of the table is a problem of its own: an L1 distance in which directions to the light count by the sum of
both. It is made small by weighted least squares, iterated with weights 1/|f_fit - f| (Gauss-Newton with Levenberg's
damping), and each node is held near its neighbours, so that what is between them is good as well. Rounds over all nodes
then have views and lights count for more that are farther off than others.
"""

from __future__ import annotations

import argparse
from functools import cached_property
from multiprocessing import get_context
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from scipy.optimize import brentq
from shares import SHARE_BOUNDS, highest_share

from vgroove.addon.reference import Dielectric, Schlick
from vgroove.addon.reference import cook_torrance_fit as fit
from vgroove.addon.reference.distributions import vgroove_g

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

_Item, _Found = TypeVar("_Item"), TypeVar("_Found")

SLOPES, VIEWS = np.linspace(0.0, 1.0, 17), np.linspace(0.0, 1.0, 33)  # nodes of the table
SECOND, THIRD = 2, 5  # first nodes of view at which there are a second and a third lobe
RADII, TURNS = 34, 26  # of the grid of facets
LIGHTS = np.array([0.0, 10, 20, 30, 40, 50, 55, 60, 65, 70, 73, 76, 78, 80, 81, 82, 83, 84, 85])  # degrees
LAST_VIEW = np.radians(85.3)  # beyond, the model's own shape is extreme; views there count for little by themselves
ROUNDS = 6
PROCESSES = 4
LIGHT = 0.6  # what all lights together count for, of a view
STIFFNESS = 3e-3  # cost of a node's distance from its neighbours' mean
SMOOTHING = 3e-4  # of the peak: below this |r| is taken for r^2
ALBEDO = 0.005  # share by which the mixture's albedo may differ before it costs
MOST = 0.9998  # of what a furnace sends to a mixture that it may send back
# Of each lobe its weight, slope across over m, anisotropy and tilt over m; of the first, round and upright, two.
COUNTS = {1: 2, 2: 6, 3: 10}
STIFF = np.array([1.0, 1.0, 2.0, 0.3, 0.3, 0.3, 2.0, 0.3, 0.3, 0.3])
STARTS = (
    np.array([0.5, 1.0, 0.3, 1.0, 0.6, 0.3, 0.2, 1.0, 0.9, 0.6]),
    np.array([0.3, 1.0, 0.4, 1.0, 0.9, 0.3, 0.3, 0.9, 0.3, 0.9]),
    np.array([0.7, 0.9, 0.2, 1.0, 1.0, 0.8, 0.1, 1.0, 0.0, 0.4]),
)
FIRST_SLOPE = 0.35  # where the search begins


def goals(m: float) -> float:
    """L1 that no view should pass: what tests demand for slopes up to 0.4 and up to 1, less what is between nodes."""
    return 0.034 if m < 0.43 else 0.0415 if m < 0.45 else 0.0775


class Cell:
    """One slope and view (or light, as the model is reciprocal): the reference on a grid of facets."""

    def __init__(self, m: float, cosine: float, radii: int = RADII, turns: int = TURNS) -> None:
        self.m, self.angle = m, np.arccos(cosine)
        self.wo = np.array([np.sin(self.angle), 0.0, cosine])
        radius, weight = np.polynomial.legendre.leggauss(radii)
        radius, weight = 1.6 * (radius + 1.0), 1.6 * weight  # slopes to 3.2 m hold all but 4e-5 of the facets
        phi = (np.arange(turns) + 0.5) * np.pi / turns
        p, q = m * radius[:, None] * np.cos(phi), m * radius[:, None] * np.sin(phi)
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
        # dwi = 4 (v.h) dh, dh = (n.h)^3 dp dq; twice for the mirrored half
        area = (2.0 * np.pi / turns * m * m * radius * weight)[:, None] * np.ones(turns)
        self.solid_angle = 4.0 * vh * nh**3 * area[lit]
        self.albedo = float(self.f_cos @ self.solid_angle)
        self.share = self.solid_angle / self.albedo

    @cached_property
    def lights(self) -> np.ndarray:
        """theta_i of each facet, degrees."""
        return np.degrees(np.arccos(np.clip(self.wi[:, 2], 0.0, 1.0)))

    def lobe(self, slope: float, anisotropy: float = 0.0, tilt: float = 0.0) -> np.ndarray:
        """f cos of a lobe of weight 1; slope and tilt over m, as in a node."""
        across, lean = np.float64(self.m * slope), np.float64(self.m * tilt * np.sin(self.angle))
        within = across * (1.0 - (1.0 - fit.NARROWEST) * anisotropy)
        return fit.smith_lobe(*(fit.turned(*w, lean) for w in self.parts), across, within)

    def limits(self, size: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest value of each number; head-on every lobe is round, and none leans so far that it hides."""
        most = min(3.0, 0.9 * self.wo[2] / max(np.sin(self.angle) ** 2, 1e-9) / self.m)
        widest, aside = min(2.0, 1.0 / self.m), self.angle > 1e-6
        low = [0.0, 0.3, *2 * (0.0, 0.3, 0.0, -3.0 * aside)]
        high = [1.0, widest, *2 * (1.0, widest, 1.0 * aside, most * aside)]
        return np.array(low[:size]), np.array(high[:size])

    def residual(self, node: np.ndarray) -> np.ndarray:
        return sum(weight * self.lobe(*shape) for weight, *shape in split(node)) - self.f_cos

    def distance(self, node: np.ndarray) -> float:
        """L1."""
        return float(np.abs(self.residual(node)) @ self.share)

    def loss(
        self, node: np.ndarray, weight: np.ndarray, near: np.ndarray, stiffness: np.ndarray
    ) -> tuple[float, np.ndarray, np.ndarray]:
        """Smoothed L1, the costs of a wrong albedo and of leaving ``near``; gradient and Gauss-Newton matrix."""
        columns, r = [], -self.f_cos
        for share, *shape in split(node):
            plain = self.lobe(*shape)
            columns.append(plain)
            r = r + share * plain
            for part in range(len(shape)):
                step = -1e-5 if part == 1 and shape[1] > 0.5 else 1e-5
                nudged = [value + step * (k == part) for k, value in enumerate(shape)]
                columns.append((self.lobe(*nudged) - plain) / step * share)
        J = np.stack(columns, axis=1)
        size = np.hypot(r, SMOOTHING * np.max(self.f_cos))
        away = node - near
        loss = float(size @ weight + stiffness @ away**2)
        gradient = J.T @ (r / size * weight) + 2.0 * stiffness * away
        matrix = (J * (weight / size)[:, None]).T @ J + 2.0 * np.diag(stiffness)
        error, slope = float(r @ self.share), J.T @ self.share
        gain = self.albedo * (1.0 + error) - MOST
        for excess, cost, sign in ((error - ALBEDO, 3e3, 1.0), (-ALBEDO - error, 3e3, -1.0), (gain, 3e4, 1.0)):
            if excess > 0:
                loss += cost * excess**2
                gradient = gradient + 2.0 * cost * excess * sign * slope
                matrix = matrix + 2.0 * cost * np.outer(slope, slope)
        return loss, gradient, matrix


def split(node: np.ndarray) -> list[np.ndarray]:
    """Weight and shape of each lobe of a node."""
    return [node[:2], *(node[at : at + 4] for at in range(2, len(node), 4))]


def optimum(
    cell: Cell, starts: list[np.ndarray], weight: np.ndarray, near: np.ndarray, stiffness: np.ndarray, steps: int
) -> np.ndarray:
    """The best node from any of ``starts``."""
    best = None
    low, high = cell.limits(len(near))
    for start in starts:
        node, damping = np.clip(start, low, high), 1e-2
        loss, gradient, matrix = cell.loss(node, weight, near, stiffness)
        for _ in range(steps):
            free = ~((node <= low) & (gradient > 0)) & ~((node >= high) & (gradient < 0))
            if not free.any() or damping > 1e4:
                break
            part = matrix[np.ix_(free, free)]
            step = np.zeros_like(node)
            step[free] = -np.linalg.solve(part + np.diag(damping * np.diag(part) + 1e-9), gradient[free])
            trial = np.clip(node + np.clip(step, -0.3, 0.3), low, high)
            found = cell.loss(trial, weight, near, stiffness)
            if found[0] < loss:
                gain, node, damping = loss - found[0], trial, max(damping / 5.0, 1e-6)
                loss, gradient, matrix = found
                if gain < 1e-6 * max(1.0, loss):
                    break
            else:
                damping *= 4.0
        if best is None or loss < best[0]:
            best = loss, node
    return best[1]


class Search:
    """All nodes, (slopes, views, 10), and what each view and light counts for."""

    def __init__(self, slopes: np.ndarray, second: int = SECOND, third: int = THIRD) -> None:
        self.slopes, self.size = slopes, (len(slopes), len(VIEWS))
        self.lobes = 1 + (np.arange(len(VIEWS)) >= second) + (np.arange(len(VIEWS)) >= third)
        # A mirror and a view along the surface have no lobe: what is next to them stands for them.
        inner = np.maximum(slopes, 0.01)
        views = np.minimum(VIEWS, 1.0 - 0.2 / len(VIEWS))
        self.cells = [[Cell(m, m * (1.0 - u) / (m + u)) for u in views] for m in inner]
        self.lit = [[Cell(m, np.cos(np.radians(max(light, 0.01))), 40, 32) for light in LIGHTS] for m in inner]
        self.albedo = np.array([[cell.albedo for cell in row] for row in self.lit])
        self.judged = np.array([[cell.angle < LAST_VIEW for cell in row] for row in self.cells])
        self.goal = np.array([[goals(m)] for m in slopes])
        self.of_view, self.of_light = np.ones(self.size), np.ones((len(slopes), len(LIGHTS)))
        self.nodes = np.zeros((*self.size, COUNTS[3]))
        self._begin()

    def weight(self, j: int, k: int) -> np.ndarray:
        """What each direction to the light counts for at a node.

        The error under a light is the integral over wo of |r| cos(theta_o) over cos(theta_i) times the albedo there;
        sin(theta_o) over sin(theta_i) is the share of views over that of lights.
        """
        cell = self.cells[j][k]
        s, c = np.sin(cell.angle), np.cos(cell.angle)
        ni = np.maximum(cell.wi[:, 2], 0.03)
        si = np.maximum(np.sqrt(1.0 - cell.wi[:, 2] ** 2), 0.15)
        lights = np.interp(cell.lights, LIGHTS, self.of_light[j]) * np.clip((88.0 - cell.lights) / 3.0, 0.0, 1.0)
        light = s * c * lights / (si * ni * np.interp(cell.lights, LIGHTS, self.albedo[j])) * cell.solid_angle
        return self.of_view[j, k] * (1.0 if self.judged[j, k] else 0.03) * cell.share + LIGHT * light

    def _begin(self) -> None:
        """A few slopes from the first on to both ends, each from grazing views to the normal; between them, linear."""
        few = np.unique(np.linspace(0, len(self.slopes) - 1, min(5, len(self.slopes))).astype(int))
        first = int(np.argmin(np.abs(self.slopes[few] - FIRST_SLOPE)))
        for at in [*range(first, len(few)), *range(first - 1, -1, -1)]:
            j, known = few[at], None if at == first else few[at - 1 if at > first else at + 1]
            for k in reversed(range(len(VIEWS))):
                starts = [] if known is None else [self.nodes[known, k]]
                starts += [self.nodes[j, k + 1]] if k + 1 < len(VIEWS) else []
                near = np.mean(starts, axis=0) if starts else STARTS[0]
                if known is None and (k >= len(VIEWS) - 3 or self.lobes[k] == 1):
                    starts += STARTS if self.lobes[k] > 1 else [np.ones(COUNTS[3])]
                self._settle(j, k, near, starts, 40)
        for k, of_view in enumerate(self.nodes[few].transpose(1, 2, 0)):
            self.nodes[:, k] = np.transpose([np.interp(self.slopes, self.slopes[few], row) for row in of_view])
        self._extend()

    def _settle(self, j: int, k: int, near: np.ndarray, starts: list[np.ndarray], steps: int) -> None:
        size, weight = COUNTS[self.lobes[k]], self.weight(j, k)
        stiffness = STIFFNESS * STIFF[:size] * weight.sum() * (self.lobes[k] > 1)
        found = optimum(self.cells[j][k], [s[:size] for s in starts], weight, near[:size], stiffness, steps)
        self.nodes[j, k, :size] = found

    def _extend(self) -> None:
        """Where a lobe is not, its weight is 0, and its shape that of the first node that has it."""
        for lobe, at in ((2, 2), (3, 6)):
            without = int(np.sum(self.lobes < lobe))
            self.nodes[:, :without, at] = 0.0
            self.nodes[:, :without, at + 1 : at + 4] = self.nodes[:, without : without + 1, at + 1 : at + 4]

    def row(self, j: int) -> tuple[np.ndarray, list[float], list[float]]:
        """A slope's nodes once more, each near its neighbours' mean; L1 of its views, and under each light."""
        for k in range(len(VIEWS))[:: 1 if self.turn % 2 == 0 else -1]:
            beside = [(a, b) for a, b in ((j - 1, k), (j + 1, k), (j, k - 1), (j, k + 1)) if self._has(a, b, k)]
            near = np.mean([self.nodes[at] for at in beside], axis=0) if beside else self.nodes[j, k]
            self._settle(j, k, near, [self.nodes[j, k]], 10)
        self._extend()
        return self.nodes[j], *self.errors(j)

    def errors(self, j: int) -> tuple[list[float], list[float]]:
        """L1 of a slope's views, and under each light."""
        views = [cell.distance(node) for cell, node in zip(self.cells[j], self.nodes[j], strict=True)]
        found = numbers(self.slopes, self.nodes).items()
        of = {name: table[:, j : j + 1].repeat(2, axis=1) for name, table in found}
        return views, [under_light(cell, of) for cell in self.lit[j]]

    def _has(self, j: int, k: int, other: int) -> bool:
        inside = 0 <= j < len(self.slopes) and 0 <= k < len(VIEWS)
        return inside and self.lobes[k] >= self.lobes[other]

    def run(self) -> None:
        """Rounds over all nodes; each prints, for every slope, the worst L1 of a view and of a light, in percent."""
        for self.turn in range(ROUNDS):
            found = parallel(self.row, range(len(self.slopes)))
            self.nodes, views, lights = (np.array(of) for of in zip(*found, strict=True))
            self._extend()
            self.weigh(views, lights)

    def weigh(self, views: np.ndarray, lights: np.ndarray) -> None:
        """Views that are beyond their goal count for more, and the lights that are farthest off."""
        self.worst = np.where(self.judged, views, 0.0).max(axis=1), lights.max(axis=1)
        told = (f"{m:.3g}: {100 * v:.1f} {100 * l:.1f}" for m, v, l in zip(self.slopes, *self.worst, strict=True))
        print(", ".join(told), flush=True)
        self.of_light *= np.clip(lights / lights.max(axis=1, keepdims=True), 0.3, 1.0) ** 1.5
        self.of_light = np.clip(self.of_light / self.of_light.mean(axis=1, keepdims=True), 0.1, 6.0)
        more = np.clip(views / self.goal, 0.9, 1.6) ** 4
        self.of_view = np.where(self.judged, np.clip(self.of_view * more, 0.5, 300.0), 1.0)


def parallel(of: Callable[[_Item], _Found], items: Iterable[_Item]) -> list[_Found]:
    """``of`` each item, in processes that have what this one has."""
    global _task  # noqa: PLW0603 - so that processes inherit it, whatever it holds
    _task = of
    with get_context("fork").Pool(PROCESSES) as pool:
        return pool.map(_run, items, chunksize=1)


def _run(item: _Item) -> _Found:
    return _task(item)


def numbers(slopes: np.ndarray, nodes: np.ndarray) -> dict[str, np.ndarray]:
    """The table [lobe, m, view] of ``fit.FUNCTIONS`` from all nodes."""
    m, none = slopes[:, None], np.zeros(nodes.shape[:2])
    lobes = [(*np.moveaxis(nodes[..., :2], -1, 0), none, none)]
    lobes += [np.moveaxis(nodes[..., at : at + 4], -1, 0) for at in (2, 6)]
    weight, across, anisotropy, tilt = (np.stack(of) for of in zip(*lobes, strict=True))
    tilt = np.where(VIEWS < 1.0, tilt * m, 0.0)  # a view along the surface is hidden from a lobe that leans
    roughness = np.sqrt(across * np.sqrt(1.0 - (1.0 - fit.NARROWEST) * anisotropy))
    return dict(zip(fit.FUNCTIONS, (weight, roughness, anisotropy, tilt), strict=True))


def committed() -> np.ndarray:
    """The nodes of the committed table."""
    weight, roughness, anisotropy, tilt = (fit.tables()[name] for name in fit.FUNCTIONS)
    across = np.square(roughness) / np.sqrt(1.0 - (1.0 - fit.NARROWEST) * anisotropy)
    tilt = tilt / np.maximum(SLOPES, 0.01)[:, None]
    tilt[:, 0] = tilt[:, 1]  # a mirror's lobes do not lean
    first, *others = (np.stack(of, axis=-1) for of in zip(weight, across, anisotropy, tilt, strict=True))
    return np.concatenate([first[..., :2], *others], axis=-1)


def mended(nodes: np.ndarray) -> np.ndarray:
    """Nodes about views that are still beyond their bar, found once more for these views alone."""
    of = numbers(SLOPES, nodes)
    lobes = 1 + (np.arange(len(VIEWS)) >= SECOND) + (np.arange(len(VIEWS)) >= THIRD)
    about = set()

    def beyond(m: float) -> list[tuple[int, int]]:
        found = []
        for degrees in np.arange(0.0, 85.5, 2.0):
            cell = Cell(m, np.cos(np.radians(max(degrees, 0.01))))
            mixture = np.sum(fit.weighted_lobes(cell.wi, cell.wo, fit.lobes(cell.wo, m, of)), axis=-1)
            if np.abs(mixture - cell.f_cos) @ cell.share > (0.0385 if m <= 0.4 else 0.082):
                found.append((int(m * (len(SLOPES) - 1)), int(fit.view_coordinate(cell.wo, m) * (len(VIEWS) - 1))))
        return found

    for near in parallel(beyond, (0.02, *np.arange(0.05, 1.0, 0.025), 0.999)):
        about |= {(j + a, k + b) for j, k in near for a in (0, 1) for b in (0, 1)}
    print("mended:", sorted(about), flush=True)
    for _ in range(3):
        for j, k in sorted(about):
            m, u = max(SLOPES[j], 0.01), min(VIEWS[k], 1.0 - 0.2 / len(VIEWS))
            cell, size = Cell(m, m * (1.0 - u) / (m + u)), COUNTS[lobes[k]]
            beside = [(a, b) for a, b in ((j - 1, k), (j + 1, k), (j, k - 1), (j, k + 1)) if _inside(nodes, a, b)]
            near = np.mean([nodes[at] for at in beside], axis=0)[:size]
            stiffness = STIFFNESS * STIFF[:size] * (lobes[k] > 1)
            nodes[j, k, :size] = optimum(cell, [nodes[j, k, :size], near], cell.share, near, stiffness, 20)
    return nodes


def _inside(nodes: np.ndarray, j: int, k: int) -> bool:
    return 0 <= j < nodes.shape[0] and 0 <= k < nodes.shape[1]


def under_light(cell: Cell, of: dict[str, np.ndarray] | None = None) -> float:
    """L1 under a fixed light, over all views by their cosine; ``cell``: with the light for its view."""
    wo, wi = cell.wi, np.broadcast_to(cell.wo, cell.wi.shape)
    mixture = np.sum(fit.weighted_lobes(wi, wo, fit.lobes(wo, cell.m, of)), axis=-1)
    true = cell.f_cos / wo[:, 2] * cell.wo[2]
    shown = cell.solid_angle * wo[:, 2]
    return float(np.abs(mixture - true) @ shown / (true @ shown))


def albedo(m: float, cosine: float, of: dict[str, np.ndarray]) -> float:
    """Directional albedo of the mixture."""
    cell = Cell(m, cosine, 48, 40)
    return float(np.sum(fit.weighted_lobes(cell.wi, cell.wo, fit.lobes(cell.wo, m, of)), axis=-1) @ cell.solid_angle)


def held(of: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The table with weights so far down that nowhere between its nodes a furnace sends back more than ``MOST``."""
    steps = 2 * (len(SLOPES) - 1), 2 * (len(VIEWS) - 1)

    def row(j: int) -> list[float]:
        m, u = j / steps[0], np.arange(steps[1]) / steps[1]
        return [albedo(m, cosine, of) for cosine in m * (1.0 - u) / (m + u)]

    for j, sent in enumerate(parallel(row, range(1, steps[0] + 1)), 1):
        for k in np.flatnonzero(np.array(sent) > MOST):
            at = np.s_[:, j // 2 : (j + 1) // 2 + 1, k // 2 : (k + 1) // 2 + 1]
            of["weight"][at] *= (MOST - 1e-5) / sent[k]
    return of


def toml(found: dict[str, np.ndarray]) -> str:
    """The table as committed."""
    lines = [
        "# Numbers [lobe][m][view], of anisotropy and tilt from the second lobe on. Of share, coefficients [j][k][l]",
        "# of powers of 2x - 1, of 2m - 1 and of the bound's logarithm.",
        "# addon/reference/cook_torrance_fit.py says what they are for.",
        "# Written by tools/fit_cook_torrance.py --write",
    ]
    for name, grid in found.items():
        lines.append(f"{name} = [")
        for part in grid[1:] if name in {"anisotropy", "tilt"} else grid:
            digits = ".9g" if name == "share" else ".6g"
            rows = ",\n".join("    [" + ", ".join(f"{number:{digits}}" for number in row) + "]" for row in part)
            lines.append("  [\n" + rows + "\n  ],")
        lines.append("]")
    return "\n".join(lines) + "\n"


def write(found: dict[str, np.ndarray]) -> None:
    fit.TABLE.write_text(toml(found), encoding="utf-8")
    fit.tables.cache_clear()


SHARE_DEGREES = 8, 6, 2  # in x, m and the logarithm of the bound
SHARE_FRESNELS = (Schlick(1.0), Schlick(0.02), Dielectric(1.33))


def largest_share(cell: Cell, bound: float) -> float:
    """The largest c <= 1 for which the integral of F (c mixture - f cos)+ is at most ``bound`` of that of F f cos."""
    mixture = np.sum(fit.weighted_lobes(cell.wi, cell.wo, fit.lobes(cell.wo, cell.m)), axis=-1)
    vh = 0.5 * np.linalg.norm(cell.wi + cell.wo, axis=-1)
    weights = [fresnel(vh)[..., 0] * cell.solid_angle for fresnel in SHARE_FRESNELS]

    def excess(c: float) -> float:
        too_much = np.maximum(c * mixture - cell.f_cos, 0.0)
        return max(float(too_much @ weight / (cell.f_cos @ weight)) for weight in weights) - bound

    return 1.0 if excess(1.0) <= 0 else float(brentq(excess, 0.0, 1.0))


def shares() -> np.ndarray:
    """Coefficients [j][k][l] of ``hybrid_share``."""
    slopes = (0.02, 0.05, 0.075, *np.arange(0.1, 1.01, 0.0375).tolist())
    views = np.radians([0.01, *np.arange(3.0, 88.0, 3.0), 88.0, 89.0, 89.6, 89.95])
    # A coarse grid of facets blurs small bounds.
    cells = [Cell(m, np.cos(view), 2 * RADII, 2 * TURNS) for m in slopes for view in views]
    limits = parallel(lambda cell: [largest_share(cell, bound) for bound in SHARE_BOUNDS], cells)
    points = np.array([(2.0 * float(fit.grazing(cell.wo, cell.m)) - 1.0, 2.0 * cell.m - 1.0) for cell in cells])
    found = highest_share(points, np.array(limits), SHARE_DEGREES)
    found[0, 0, 0] -= 0.012  # the mixture has kinks at its nodes, between which no view here stands
    return found


def print_table() -> None:
    """The committed table's largest L1 over views to 85 degrees and over lights to 85, in percent, and where."""
    print("     m   view               light")
    for m in (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.38, 0.4, 0.45, 0.5, 0.6, 0.7, 0.8, 0.9, 0.93, 1.0):
        cells = [Cell(m, np.cos(np.radians(max(degrees, 0.01))), 48, 40) for degrees in np.arange(0.0, 86.0, 2.5)]
        views = []
        for cell in cells:
            mixture = np.sum(fit.weighted_lobes(cell.wi, cell.wo, fit.lobes(cell.wo, m)), axis=-1)
            views.append(np.abs(mixture - cell.f_cos) @ cell.share)
        lights = [under_light(cell) for cell in cells]
        worst = (
            f"{100 * np.max(of):5.2f} at {np.degrees(cells[int(np.argmax(of))].angle):4.1f}" for of in (views, lights)
        )
        print(f"{m:6.2f}", *worst, sep="   ", flush=True)


def print_curve() -> None:
    """Largest L1 over nodes' views and over lights by where the second and the third lobe begin."""
    slopes = np.array([0.2, 0.3, 0.38, 0.6, 0.93])
    for second, third in ((0, 0), (0, THIRD), (SECOND, THIRD), (SECOND, 99), (99, 99)):
        search = Search(slopes, second, third)
        search.run()
        of = zip(slopes, *search.worst, strict=True)
        told = (f"{m:g}: {100 * v:.1f} {100 * l:.1f};" for m, v, l in of)
        print(f"lobes from nodes {second}, {third}:", *told, flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, what in (
        ("write", "find the table anew and write it"),
        ("mend", "views of the committed table that are beyond their bar"),
        ("share", "hybrid's share alone"),
        ("curve", "fewer and more lobes"),
    ):
        parser.add_argument(f"--{name}", action="store_true", help=what)
    options = parser.parse_args()
    if options.curve:
        print_curve()
        return
    if options.write or options.mend:
        nodes = committed()
        if options.write:
            search = Search(SLOPES)
            search.run()
            nodes = search.nodes
        write(held(numbers(SLOPES, mended(nodes))) | {"share": fit.tables()["share"]})
    if options.write or options.mend or options.share:
        write(fit.tables() | {"share": shares()})
    print_table()


if __name__ == "__main__":
    main()
