# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of ``fit``: native Beckmann lobes that come nearest to the V-groove model, in L1, at every m and view.

python tools/fit_cook_torrance.py              prints, for each slope, the largest L1 of the committed table over views
                                               and over lights, and its largest error in pictures over a native lobe's
python tools/fit_cook_torrance.py --write      finds the table from constants (a quarter of an hour) and writes it
python tools/fit_cook_torrance.py --polish     the same, from the committed table
python tools/fit_cook_torrance.py --share      only the share of ``hybrid``, for the committed table
python tools/fit_cook_torrance.py --curve      what other goals would reach (45 minutes)

L1 at a fixed view is the integral over wi of |f_fit - f| cos(theta_i) over that of f cos(theta_i). Under a fixed light
it is that over wo, each view weighted by its cosine, as a surface shows it. In a picture of a ball under a sun it is
the rms of the pixels that counts, most of all in the highlight, where one native lobe is nearly right. All are sums
over one set of distances |f_fit - f|, at cells of slope and view by facets, so that together they are one problem for
the control points of all splines. Gauss-Newton steps solve it, L1 with weights 1/|f_fit - f|; between rounds views,
lights and pictures beyond their goals count for more.
"""

from __future__ import annotations

import argparse
from multiprocessing import get_context
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from fit_cells import MOST, Cell, Picture
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import brentq
from shares import SHARE_BOUNDS, highest_share

from vgroove.addon.reference import F82, Dielectric, Schlick
from vgroove.addon.reference import cook_torrance_fit as fit

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

_Item, _Found = TypeVar("_Item"), TypeVar("_Found")

# fmt: off
SLOPES = np.array([
    0.02, 0.05, 0.1, 0.15, 0.2, 0.22, 0.24, 0.26, 0.28, 0.3, 0.32, 0.36, 0.4, 0.435, 0.47,
    0.52, 0.57, 0.62, 0.67, 0.72, 0.77, 0.82, 0.87, 0.91, 0.945, 0.975, 1.0,
])
# fmt: on
SUNS = np.array([8.0, 15, 25, 35, 45, 55, 65, 75, 85, 95, 105, 115, 125, 135, 145])  # degrees from the camera
LIGHTS = np.array([0.0, 10, 20, 30, 40, 50, 55, 60, 65, 70, 73, 76, 78, 80, 81, 82, 83, 84, 85])  # degrees
LAST_VIEW = np.radians(85.6)  # beyond, views hardly count
GOALS = 0.0368, 0.0818  # L1 of views up to m = 0.4 and up to 1: what the tests demand, less what lies between cells
LIT = 0.094  # goal for lights
NEAR = 0.01  # rms that pictures may have where one native lobe has less
LIGHT, PICTURE = 1.5, 1.0  # weights of all lights and of all pictures together, over that of all views
STIFFNESS = 1e-3  # cost of the control points' second differences
ROUNDS, STEPS = 25, 4
PROCESSES = 2
HOLDS, WITHIN = 12, 0.0085  # passes that hold the albedo, and how far off it may be
START = np.array([0.6, 1.0, 0.25, 1.0, 0.6, 0.3, 0.15, 0.95, 0.9, 0.6])


def view_cosine(m: float, u: np.ndarray) -> np.ndarray:
    """The inverse of ``fit.view_coordinate``."""
    return m * (1.0 - u) / (m + u)


def basis(axis: int, x: np.ndarray) -> np.ndarray:
    """What each control point counts for at m^(1/2) (axis 0) or u (axis 1), as the table is interpolated linearly."""
    table = fit.spline(fit.KNOTS[axis], fit.PLACES[axis])
    nodes = np.linspace(0.0, 1.0, fit.SIZE[axis])
    return np.stack([np.interp(x, nodes, column) for column in table.T], axis=-1)


def widths(x: np.ndarray) -> np.ndarray:
    """How much each of ascending x stands for."""
    return np.diff(np.concatenate([x[:1], 0.5 * (x[1:] + x[:-1]), x[-1:]]))


class Search:
    """The control points of all splines against all cells."""

    def __init__(self, *, light: float = LIGHT, lit: float = LIT, picture: float = PICTURE) -> None:
        self.light, self.lit_goal, self.picture = light, lit, picture
        knots = fit.KNOTS[1]
        middle = np.concatenate([knots[:-1] + part * np.diff(knots) for part in (0.22, 0.72)])
        self.views = np.array([1e-5, *np.sort([0.004, 0.014, 0.02, 0.042, 0.055, *middle]), 0.995])
        self.cells = [[Cell(m, c) for c in view_cosine(m, self.views)] for m in SLOPES]
        self.lit = [[Cell(m, np.cos(np.radians(max(light, 0.01)))) for light in LIGHTS] for m in SLOPES]
        angle = np.array([[cell.angle for cell in row] for row in self.cells])
        self.step = np.array([widths(row) for row in angle])
        self.judged = angle < LAST_VIEW
        self.goal = np.interp(SLOPES, (0.42, 0.45), GOALS)[:, None]
        self.pictures = [[Picture(m, sun) for sun in SUNS] for m in SLOPES]
        self.native = np.array([[max(picture.native, NEAR) for picture in row] for row in self.pictures])
        self.of_picture, self.rms = np.ones(self.native.shape), np.full(self.native.shape, 0.02)
        self.of_view, self.of_light = np.ones(angle.shape), np.ones((len(SLOPES), len(LIGHTS)))
        self.of_m = basis(0, np.sqrt(SLOPES))
        self.of_u = basis(1, self.views)
        self.size = self.of_m.shape[1], self.of_u.shape[1]
        self.part = np.ones((*angle.shape, len(START)))
        for j, m in enumerate(SLOPES):
            self.part[j][:, [0, 2, 6]] = fit.needed(view_cosine(m, self.views), np.full(len(self.views), m)).T
        self.free = np.ones((len(START), *self.size), bool)
        self.free[[4, 8], :, 0] = False  # head-on lobes are round
        self.free[[5, 9], :, -1] = False  # a view along the surface is hidden from a lobe that leans
        self.roughness = np.kron(np.eye(self.size[0]), _bending(self.size[1]))
        self.roughness += np.kron(_bending(self.size[0]), np.eye(self.size[1]))

    def weight(self, j: int, k: int) -> np.ndarray:
        """What the distance at each facet counts for.

        Of a view's L1, its share of the albedo. L1 under a light at theta_i is the integral over wo of
        |r| cos(theta_o) / (cos(theta_i) albedo); sin(theta_o) / sin(theta_i) turns views into lights.
        """
        cell = self.cells[j][k]
        ni, si = np.maximum(cell.wi[:, 2], 0.05), np.maximum(np.sqrt(1.0 - cell.wi[:, 2] ** 2), 0.08)
        albedo = np.interp(cell.lights, LIGHTS, [lit.albedo for lit in self.lit[j]])
        lights = np.interp(cell.lights, LIGHTS, self.of_light[j]) * np.clip((87.5 - cell.lights) / 2.5, 0.0, 1.0)
        light = self.step[j, k] * cell.wo[0] * cell.wo[2] * lights / (si * ni * albedo) * cell.solid_angle
        stands = 0.5 * (widths(self.views)[k] + self.step[j, k] / (np.pi / 2.0))
        return self.of_view[j, k] * (1.0 if self.judged[j, k] else 0.05) * stands * cell.share + self.light * light

    def square(self, j: int, k: int) -> np.ndarray:
        """What the squared distance at each facet counts for: its share of pictures' squared errors, over their rms.

        dwo dwi = sin(phase) dphase dn dpsi, with phase the angle between wi and wo and psi a turn about the camera.
        """
        cell = self.cells[j][k]
        phase = np.degrees(np.arccos(np.clip(cell.wi @ cell.wo, -1.0, 1.0)))
        energy = np.exp(np.interp(phase, SUNS, np.log([picture.energy for picture in self.pictures[j]])))
        counts = np.interp(phase, SUNS, self.of_picture[j] / np.maximum(self.rms[j], NEAR))
        counts = counts * np.clip((150.0 - phase) / 10.0, 0.0, 1.0) / np.sin(np.radians(np.maximum(phase, SUNS[0])))
        step = self.step[j, k] * cell.wo[0] * cell.wo[2] / np.radians(np.ptp(SUNS))
        return self.picture * step * cell.solid_angle * counts / energy

    def cost(self, control: np.ndarray, *, slopes: bool) -> tuple[float, np.ndarray, np.ndarray]:
        """The loss of all cells and of the splines' bends; gradient and Gauss-Newton matrix in the control points."""
        values = self.part * np.einsum("jm,ku,fmu->jkf", self.of_m, self.of_u, control)

        def row(j: int) -> list[tuple[float, np.ndarray, np.ndarray]]:
            cells = enumerate(self.cells[j])
            return [cell.loss(values[j, k], self.weight(j, k), self.square(j, k), slopes=slopes) for k, cell in cells]

        losses, gradients, matrices = zip(
            *[zip(*cells, strict=True) for cells in parallel(row, range(len(SLOPES)))], strict=True
        )
        bends = STIFFNESS * np.where(np.isin(np.arange(len(START)), (5, 9)), 0.3, 1.0)  # tilts may bend more
        flat = control.reshape(len(START), -1)
        pull = flat @ self.roughness
        loss = float(np.sum(losses) + bends @ np.sum(pull * flat, axis=1))
        gradient = np.einsum("jkf,jm,ku->fmu", self.part * gradients, self.of_m, self.of_u).reshape(flat.shape)
        if not slopes:
            return loss, gradient, gradient
        matrices = self.part[..., None] * self.part[..., None, :] * matrices
        by_view = np.einsum("jkfg,ku,kv->jfguv", matrices, self.of_u, self.of_u, optimize=True)
        matrix = np.einsum("jfguv,jm,jn->fmugnv", by_view, self.of_m, self.of_m, optimize=True).reshape(2 * [flat.size])
        matrix += 2.0 * np.kron(np.diag(bends), self.roughness)
        return loss, (gradient + 2.0 * bends[:, None] * pull).ravel(), matrix

    def run(self, control: np.ndarray, rounds: int = ROUNDS) -> np.ndarray:
        """Each round prints for every slope the largest L1 of a view and of a light, in percent, and a picture's ratio.

        That is the rms of the mixture over that of one native lobe.
        """
        damping = 1e-3
        for _ in range(rounds):
            for _ in range(STEPS):
                control, damping = self._step(control, damping)
            self.weigh(control)
        return control

    def _step(self, control: np.ndarray, damping: float) -> tuple[np.ndarray, float]:
        """One step down, by Levenberg and Marquardt."""
        free = self.free.ravel()
        loss, gradient, matrix = self.cost(control, slopes=True)
        matrix = matrix[np.ix_(free, free)]
        for _ in range(6):
            damped = matrix + np.diag(damping * np.diag(matrix) + 1e-7 * np.mean(np.diag(matrix)))
            step = np.zeros(free.shape)
            step[free] = -cho_solve(cho_factor(damped), gradient[free])
            trial = control + step.reshape(control.shape)
            if self.cost(trial, slopes=False)[0] < loss:
                return trial, max(damping / 4.0, 1e-5)
            damping *= 5.0
        return control, damping

    def weigh(self, control: np.ndarray) -> None:
        """Views, lights and pictures that are beyond their goals count for more."""
        of = fit.sampled(by_function(control))
        views = np.array(parallel(lambda j: [cell.distance(of) for cell in self.cells[j]], range(len(SLOPES))))
        found = parallel(lambda j: [cell.distance_under_light(of) for cell in self.lit[j]], range(len(SLOPES)))
        lights = np.array(found)
        self.rms = np.array(parallel(lambda j: [picture.rms(of) for picture in self.pictures[j]], range(len(SLOPES))))
        beyond = self.rms / self.native
        self.of_picture = np.clip(self.of_picture * np.clip(beyond, 0.6, 2.0) ** 2, 0.1, 50.0)
        self.worst = np.where(self.judged, views, 0.0).max(axis=1), lights.max(axis=1), beyond.max(axis=1)
        told = (f"{m:.3g}: {100 * v:.1f} {100 * l:.1f} {p:.2f}" for m, v, l, p in zip(SLOPES, *self.worst, strict=True))
        print(", ".join(told), flush=True)
        self.of_light = np.clip(self.of_light * np.clip(lights / self.lit_goal, 0.7, 1.4) ** 2, 0.02, 8.0)
        more = np.clip(views / self.goal, 0.9, 1.5) ** 4
        self.of_view = np.where(self.judged, np.clip(self.of_view * more, 0.3, 400.0), 1.0)

    def start(self) -> np.ndarray:
        """Constants."""
        return np.where(self.free, START[:, None, None], 0.0)

    def committed(self) -> np.ndarray:
        """The control points of the committed table."""
        of = fit.control_points()
        first, second, third = ([of[name][k] for name in fit.FUNCTIONS[:2]] for k in range(3))
        leaning = [[of[name][k] for name in fit.FUNCTIONS[2:]] for k in range(2)]
        return np.where(self.free, np.array([*first, *second, *leaning[0], *third, *leaning[1]]), 0.0)


def _bending(count: int) -> np.ndarray:
    """The matrix of the sum of squared second differences."""
    D = np.diff(np.eye(count), 2, axis=0)
    return D.T @ D


def by_function(control: np.ndarray) -> dict[str, np.ndarray]:
    """Control points [lobe, m, view] of each of ``fit.FUNCTIONS``."""
    return dict(
        zip(fit.FUNCTIONS, (control[[0, 2, 6]], control[[1, 3, 7]], control[[4, 8]], control[[5, 9]]), strict=True)
    )


def held(of: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Control points with weights changed so that nowhere a furnace sends back more than ``MOST``, or is off."""
    roots, views = (np.linspace(0.0, 1.0, 2 * n - 1) for n in fit.SIZE)  # the table's nodes, and between them
    roots = roots[roots > 0.0]
    parts = [basis(axis, x) for axis, x in enumerate((roots, views))]
    parts = [part / np.sum(part**2, axis=1, keepdims=True) for part in parts]  # the least change that does it
    for _ in range(HOLDS):
        table = fit.sampled(of)

        def row(root: float) -> list[float]:
            return [_off(Cell(root**2, c), table) for c in view_cosine(root**2, np.minimum(views, 0.999))]  # noqa: B023

        off = np.array(parallel(row, roots))
        print(f"furnace: {100 * off.max():.4f} % too much, {-100 * off.min():.4f} % too little", flush=True)
        change = off[:, :, None, None] * parts[0][:, None, :, None] * parts[1][None, :, None, :]
        of = of | {"weight": of["weight"] * (1.0 - change.max(axis=(0, 1)) - change.min(axis=(0, 1)))}
    return of


def _off(cell: Cell, table: dict[str, np.ndarray]) -> float:
    """By what share a view's weights are too large (above 0) or too small."""
    sent, judged = float(cell.mixture(table) @ cell.solid_angle), cell.angle < LAST_VIEW
    ratio = judged * (sent / cell.albedo - 1.0)
    return max(sent / MOST - 1.0, ratio - WITHIN, 0.0) + min(ratio + WITHIN, 0.0)


def parallel(of: Callable[[_Item], _Found], items: Iterable[_Item]) -> list[_Found]:
    """``of`` each item, in processes that have what this one has."""
    global _task  # noqa: PLW0603 - so that processes inherit it, whatever it holds
    _task = of
    with get_context("fork").Pool(PROCESSES) as pool:
        return pool.map(_run, items, chunksize=1)


def _run(item: _Item) -> _Found:
    return _task(item)


def toml(found: dict[str, np.ndarray]) -> str:
    """The table as committed."""
    lines = [
        "# Control points [lobe][m][view], of anisotropy and tilt from the second lobe on. Of share, coefficients",
        "# [j][k][l] of powers of 2x - 1, of 2m - 1 and of the bound's logarithm.",
        "# addon/reference/cook_torrance_fit.py says what they are for.",
        "# Written by tools/fit_cook_torrance.py",
    ]
    for name, grid in found.items():
        lines.append(f"{name} = [")
        digits = ".9g" if name == "share" else ".5g"
        for part in grid:
            rows = ",\n".join("    [" + ", ".join(f"{number:{digits}}" for number in row) + "]" for row in part)
            lines.append("  [\n" + rows + "\n  ],")
        lines.append("]")
    return "\n".join(lines) + "\n"


def write(found: dict[str, np.ndarray]) -> None:
    fit.TABLE.write_text(toml(found), encoding="utf-8")
    fit.control_points.cache_clear()
    fit.tables.cache_clear()


SHARE_DEGREES = 8, 6, 2  # in x, m and the logarithm of the bound
SHARE_FRESNELS = (Schlick(1.0), Schlick(0.02), Dielectric(1.33), F82(0.95, 0.3))


def largest_share(cell: Cell, bound: float) -> float:
    """The largest c <= 1 for which the integral of F (c mixture - f cos)+ is at most ``bound`` of that of F f cos."""
    mixture = cell.mixture()
    vh = 0.5 * np.linalg.norm(cell.wi + cell.wo, axis=-1)
    weights = [fresnel(vh)[..., 0] * cell.solid_angle for fresnel in SHARE_FRESNELS]

    def excess(c: float) -> float:
        too_much = np.maximum(c * mixture - cell.f_cos, 0.0)
        return max(float(too_much @ weight / (cell.f_cos @ weight)) for weight in weights) - bound

    return 1.0 if excess(1.0) <= 0 else float(brentq(excess, 0.0, 1.0))


def shares() -> np.ndarray:
    """Coefficients [j][k][l] of ``hybrid_share``."""
    slopes = (0.02, 0.03, 0.05, 0.075, *np.arange(0.1, 1.01, 0.0375).tolist())
    views = np.radians([0.01, *np.arange(3.0, 88.0, 3.0), 88.0, 89.0, 89.6, 89.95])
    cells = [Cell(m, np.cos(view), 96, 80) for m in slopes for view in views]  # a coarse grid blurs small bounds
    limits = parallel(lambda cell: [largest_share(cell, bound) for bound in SHARE_BOUNDS], cells)
    points = np.array([(2.0 * float(fit.grazing(cell.wo, cell.m)) - 1.0, 2.0 * cell.m - 1.0) for cell in cells])
    return highest_share(points, np.array(limits), SHARE_DEGREES)


def print_table() -> None:
    """The committed table's largest L1 over views to 85 degrees and over lights to 85, in percent, and where.

    Then of pictures the largest error over a native lobe's, or over ``NEAR`` where that has less.
    """
    print("     m   view               light              picture")
    for m in (*SLOPES, 0.38, 0.93):
        cells = [Cell(m, np.cos(np.radians(max(degrees, 0.01))), 48, 40) for degrees in np.arange(0.0, 86.0, 2.5)]
        of = [cell.distance() for cell in cells], [cell.distance_under_light() for cell in cells]
        worst = [f"{100 * np.max(l1):5.2f} at {np.degrees(cells[int(np.argmax(l1))].angle):4.1f}" for l1 in of]
        ratios = [picture.rms() / max(picture.native, NEAR) for picture in (Picture(m, sun) for sun in SUNS)]
        print(f"{m:6.3f}", *worst, f"{max(ratios):5.2f} at {SUNS[int(np.argmax(ratios))]:5.1f}", sep="   ", flush=True)


CURVE: dict[str, dict[str, float]] = {
    "views alone": {"light": 0.0, "picture": 0.0},
    "views, and lights at 6 %": {"picture": 0.0, "lit": 0.056},
    "views, pictures, and lights at 6 %": {"lit": 0.056},
    "views and pictures": {"light": 0.0},
    "taken": {},
}


def print_curve() -> None:
    """By goals, the largest L1 of a view and of a light, in percent, and a picture's ratio; to m = 0.4 and beyond."""
    for name, goals in CURVE.items():
        print(f"{name}:", flush=True)
        search = Search(**goals)
        search.run(search.committed())
        of = np.array(search.worst)
        for title, slopes in (("m <= 0.4", SLOPES <= 0.4), ("m <= 1", SLOPES > 0.4)):
            view, light, picture = of[:, slopes].max(axis=1)
            print(f"{name}, {title}: {100 * view:.1f} {100 * light:.1f} {picture:.2f}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("write", "polish", "share", "curve"):
        parser.add_argument(f"--{name}", action="store_true")
    options = parser.parse_args()
    if options.curve:
        print_curve()
        return
    if options.write or options.polish:
        search = Search()
        control = search.run(search.start() if options.write else search.committed())
        write(held(by_function(control)) | {"share": fit.control_points()["share"]})
    if options.write or options.polish or options.share:
        write(fit.control_points() | {"share": shares()})
    print_table()


if __name__ == "__main__":
    main()
