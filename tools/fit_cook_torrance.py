# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of ``fit``: native Beckmann lobes that come nearest to the V-groove model, in L1, at every m and view.

python tools/fit_cook_torrance.py              prints, for each (m, angle), L1 of the plain closure, of the best
                                               mixture for that cell alone, and of the committed table
python tools/fit_cook_torrance.py --write      finds the table anew (half an hour) and writes it
python tools/fit_cook_torrance.py --polish     the last part of that alone, from the committed table

The committed table is what several searches and polishes, with other weights between the cells, left as the best; a new
one will differ from it. Whether it is as good, the printed table and tests/test_reference_fit.py say.

L1 at a fixed view is the integral over wi of |f_fit - f| cos over that of f cos. It is made small by weighted least
squares, iterated with weights 1/|f_fit - f| (Gauss-Newton with Levenberg's damping): first for each cell alone, which
is the optimum that the smooth table is held against, then for the coefficients of all cells together.
"""

from __future__ import annotations

import argparse
from multiprocessing import Pool
from pathlib import Path

import numpy as np
from scipy.linalg import cholesky, solve_triangular
from scipy.optimize import brentq, minimize
from shares import SHARE_BOUNDS, highest_share

from vgroove.addon.reference import Dielectric, Schlick
from vgroove.addon.reference import cook_torrance_fit as fit
from vgroove.addon.reference.distributions import vgroove_g

LOBES = 3
RADII, TURNS = 48, 40  # of the grid of facets
DEGREE_X, DEGREE_M = 8, 8
ACROSS_X = 4  # degree in x of the slope across, which all lobes share
FLOOR = Path(__file__).parent.parent / "tests" / "data" / "fit_best_two.csv"
SLOPES = (0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.0)
ANGLES = (
    0,
    0.2,
    1,
    2.5,
    5,
    10,
    15,
    20,
    25,
    30,
    35,
    40,
    45,
    50,
    55,
    60,
    65,
    68,
    70,
    73,
    75,
    78,
    80,
    82,
    84,
    85,
    87,
    88,
    89,
)
PRINTED = (0, 20, 40, 60, 75, 85)
ROUNDS = 12
NEAR = 1.1  # times the best two lobes is what a cell that is printed should reach; others 1.15
MOST = 0.0375, 0.081  # L1 that no cell should pass, up to m = 0.4 and up to 1: below what tests demand
SMOOTHING = 3e-4  # of the peak: below this |r| is taken for r^2
GAIN = 0.9997  # albedo beyond which a mixture costs
ALBEDO = 0.005  # share by which the mixture's albedo may differ before it costs


class Cell:
    """One slope and view: the reference on a grid of facets, and the mixture's distance from it."""

    def __init__(self, m: float, degrees: float, finer: int = 1) -> None:
        self.m, self.angle = m, np.radians(degrees)
        self.wo = np.array([np.sin(self.angle), 0.0, np.cos(self.angle)])
        turns = TURNS * finer
        radius, weight = np.polynomial.legendre.leggauss(RADII * finer)
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
        self.wi_parts, self.wo_parts, self.h_parts = map(_parts, (self.wi, self.wo[None], h[lit]))
        D = np.exp(-(p * p + q * q)[lit] / m**2) / (np.pi * m**2 * nh**4)
        self.f_cos = D * vgroove_g(self.wi, self.wo) / (4.0 * self.wo[2])
        # dwi = 4 (v.h) dh, dh = (n.h)^3 dp dq; twice for the mirrored half
        area = (2.0 * np.pi / turns * m * m * radius * weight)[:, None] * np.ones(turns)
        self.solid_angle = 4.0 * vh * nh**3 * area[lit]
        self.albedo = float(self.f_cos @ self.solid_angle)
        s, c = np.sin(self.angle), np.cos(self.angle)
        self.x = m * s / (c + m * s)
        share = float(fit.clipped_share(self.wo, m))
        self.basis = share * np.outer(_chebyshev(self.x, DEGREE_X), _chebyshev(m, DEGREE_M)).ravel()

    def lobes(self, functions: np.ndarray) -> fit.Lobes:
        """Lobes from the values of ``fit.FUNCTIONS``, one after the other, as ``fit.lobes`` makes them."""
        weight, anisotropy, tilt, across = split(functions)
        return fit.shaped(np.float64(self.m), np.float64(self.x), np.sin(self.angle), weight, anisotropy, tilt, across)

    def parts(self, functions: np.ndarray) -> np.ndarray:
        """f cos of each lobe of weight 1 on the grid, (N, lobes)."""
        of = self.lobes(functions)
        wi, wo, h = (fit.turned(*w, of.tilt) for w in (self.wi_parts, self.wo_parts, self.h_parts))
        return fit.smith_lobe(wi, wo, h, of.across, of.within)

    def limits(self, lobes: int) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest value of each function."""
        most = min(1.0 / max(self.x, 1e-9), 8.0)
        widest = min(2.0, 1.0 / self.m)
        leaning = min(
            1.2, 0.95 / max(self.x * np.sin(self.angle), 1e-9)
        )  # at 1 a lobe's own normal hides from the view
        low = np.repeat([0.0, 0.0, -3.0], lobes), [0.5]
        high = np.repeat([1.0, most, leaning], lobes), [widest]
        return np.concatenate(low), np.concatenate(high)

    def distance(self, functions: np.ndarray) -> tuple[float, float]:
        """L1 and the albedo's relative error."""
        r = self.parts(functions) @ split(functions)[0] - self.f_cos
        return float(np.abs(r) @ self.solid_angle / self.albedo), float(r @ self.solid_angle / self.albedo)

    def loss(self, functions: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Smoothed L1 and the cost of a wrong albedo; gradient and Gauss-Newton matrix in the values."""
        parts = self.parts(functions)
        weight = split(functions)[0]
        r = parts @ weight - self.f_cos
        columns = [parts]
        for part in range(1, 4):
            nudged = functions.copy()
            split(nudged)[part][...] += 1e-6
            slopes = (self.parts(nudged) - parts) / 1e-6 * weight
            columns.append(slopes if part < 3 else slopes.sum(axis=1, keepdims=True))
        J = np.concatenate(columns, axis=1)
        epsilon = SMOOTHING * np.max(self.f_cos)
        size = np.sqrt(r * r + epsilon * epsilon)
        weight = self.solid_angle / self.albedo
        loss = float(size @ weight)
        gradient, matrix = J.T @ (r / size * weight), (J * (weight / size)[:, None]).T @ J
        error, slope = float(r @ weight), J.T @ weight
        gain = self.albedo * (1.0 + error) - GAIN  # a furnace must not exceed 1
        for excess, cost in ((error - ALBEDO, 3000.0), (-ALBEDO - error, 3000.0), (gain, 3e4)):
            if excess > 0:
                sign = -1.0 if cost == 3000.0 and error < 0 else 1.0
                loss += cost * excess**2
                gradient = gradient + 2.0 * cost * excess * sign * slope
                matrix = matrix + 2.0 * cost * np.outer(slope, slope)
        return loss, gradient, matrix


def _parts(w: np.ndarray) -> tuple[np.ndarray, ...]:
    """Components across the plane of view, toward the viewer and up, (N, 1) each."""
    return w[:, 1:2], w[:, 0:1], w[:, 2:3]


def _chebyshev(x: float, degree: int) -> np.ndarray:
    return np.polynomial.chebyshev.chebvander(np.array([2.0 * x - 1.0]), degree)[0]


def split(functions: np.ndarray) -> tuple[np.ndarray, ...]:
    """Views of weight, anisotropy and tilt (lobes,) and of across (1,)."""
    lobes = (len(functions) - 1) // 3
    return functions[:lobes], functions[lobes : 2 * lobes], functions[2 * lobes : -1], functions[-1:]


def optimum(cell: Cell, starts: list[np.ndarray]) -> np.ndarray:
    """The best mixture for one cell alone, (3 lobes + 1,): the floor for every smooth table."""
    best = None
    for start in starts:
        low, high = cell.limits((len(start) - 1) // 3)
        functions, damping = np.clip(start, low, high), 1e-2
        loss, gradient, matrix = cell.loss(functions)
        for _ in range(150):
            free = ~((functions <= low) & (gradient > 0)) & ~((functions >= high) & (gradient < 0))
            if not free.any():
                break
            step = np.zeros_like(functions)
            damped = matrix[np.ix_(free, free)]
            damped = damped + np.diag(damping * np.diag(damped) + 1e-9)
            step[free] = -np.linalg.solve(damped, gradient[free])
            trial = np.clip(functions + np.clip(step, -0.3, 0.3), low, high)
            trial_loss = cell.loss(trial)
            if trial_loss[0] < loss:
                small = loss - trial_loss[0] < 1e-7
                functions, (loss, gradient, matrix), damping = trial, trial_loss, max(damping / 5.0, 1e-6)
                if small:
                    break
            elif damping > 1e4:
                break
            else:
                damping *= 4.0
        if best is None or loss < best[0]:
            best = loss, functions
    return best[1]


def random_starts(rng: np.random.Generator, count: int, lobes: int) -> list[np.ndarray]:
    return [
        np.concatenate([rng.dirichlet(np.ones(lobes)), rng.exponential(0.7, lobes), rng.normal(0.3, 0.6, lobes), [1.0]])
        for _ in range(count)
    ]


class Table:
    """Chebyshev coefficients of all functions, (3 lobes + 1, basis), against cells that count by ``importance``."""

    def __init__(self, cells: list[Cell], importance: np.ndarray, free: np.ndarray) -> None:
        """free: which coefficients are not 0 for good, (3 lobes + 1, basis)."""
        self.cells, self.importance, self.free = cells, importance, free.ravel()

    def loss(self, coefficients: np.ndarray) -> tuple[float, np.ndarray]:
        """The sum over cells, and its gradient; a function beyond its limits costs a little, that it may return."""
        total, gradient = 0.0, np.zeros(coefficients.shape)
        for cell, importance in zip(self.cells, self.importance, strict=True):
            raw = ALONE + coefficients @ cell.basis
            held, slope, beyond = softly_held(raw, *cell.limits(LOBES))
            loss, g, _ = cell.loss(held)
            total += importance * (loss + 0.02 * float(beyond @ beyond))
            gradient += importance * np.outer(g * slope + 0.04 * beyond, cell.basis)
        return total, gradient

    def curvature(self, coefficients: np.ndarray) -> np.ndarray:
        """The Gauss-Newton matrix of ``loss``, for coefficients as one row."""
        rows, width = coefficients.shape
        matrix = np.zeros((rows, rows, width, width))
        for cell, importance in zip(self.cells, self.importance, strict=True):
            raw = ALONE + coefficients @ cell.basis
            held, slope, _ = softly_held(raw, *cell.limits(LOBES))
            H = cell.loss(held)[2] * np.outer(slope, slope) + np.diag(0.04 * (slope < 0.5))
            matrix += importance * H[:, :, None, None] * np.outer(cell.basis, cell.basis)
        return matrix.transpose(0, 2, 1, 3).reshape(rows * width, rows * width)

    def descend(self, coefficients: np.ndarray, steps: int) -> np.ndarray:
        """Quasi-Newton steps in coordinates that make the Gauss-Newton matrix 1; L1's kinks stop Newton's own."""
        matrix = self.curvature(coefficients)[np.ix_(self.free, self.free)]
        scale = np.diag(1e-3 * np.diag(matrix) + 1e-7 * np.trace(matrix) / len(matrix))
        R = cholesky(matrix + scale)

        def moved(z: np.ndarray) -> np.ndarray:
            step = np.zeros(self.free.shape)
            step[self.free] = solve_triangular(R, z)
            return coefficients + step.reshape(coefficients.shape)

        def loss(z: np.ndarray) -> tuple[float, np.ndarray]:
            total, gradient = self.loss(moved(z))
            return total, solve_triangular(R, gradient.ravel()[self.free], trans="T")

        found = minimize(loss, np.zeros(len(R)), jac=True, method="L-BFGS-B", options={"maxiter": steps, "maxcor": 50})
        return moved(found.x)


SOFTNESS = np.repeat([5e-5, 1e-3, 1e-2, 1e-3], [LOBES, LOBES, LOBES, 1])


def softly_held(raw: np.ndarray, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """``raw`` within its limits, rounded off there for the search's sake; the slope of that; how far it was beyond."""
    d = raw - low
    r = np.hypot(d, SOFTNESS)
    up = high - low - 0.5 * (d + r)
    q = np.hypot(up, SOFTNESS)
    return high - 0.5 * (up + q), 0.25 * (1.0 + d / r) * (1.0 + up / q), raw - np.clip(raw, low, high)


def by_function(coefficients: np.ndarray) -> dict[str, np.ndarray]:
    """Coefficients [lobe, j, k] of T_j(2x - 1) T_k(2m - 1) for each function."""
    grid = coefficients.reshape(-1, DEGREE_X + 1, DEGREE_M + 1)
    parts = grid[:LOBES], grid[LOBES : 2 * LOBES], grid[2 * LOBES : -1], grid[-1:, : ACROSS_X + 1]
    return dict(zip(fit.FUNCTIONS, parts, strict=True))


def toml(numbers: dict[str, np.ndarray]) -> str:
    """The table as committed: nine digits, which is what float32 shaders can hold."""
    lines = [
        "# Coefficients c[lobe][j][k] of Chebyshev's T_j(2x - 1) T_k(2m - 1); of share, [j][k][l] of powers of these",
        "# two and of the bound's logarithm.",
        "# addon/reference/cook_torrance_fit.py says what they are for.",
        "# Written by tools/fit_cook_torrance.py --write",
    ]
    for name, grid in numbers.items():
        lines.append(f"{name} = [")
        for lobe in grid:
            rows = ",\n".join("    [" + ", ".join(f"{number:.9g}" for number in row) + "]" for row in lobe)
            lines.append("  [\n" + rows.replace("nan", "0") + "\n  ],")
        lines.append("]")
    return "\n".join(lines) + "\n"


ALONE = np.concatenate(fit.starts(LOBES))
# A wide lobe and two narrow ones: weight, anisotropy and tilt of each, and the slope across.
START = np.array([0.9, 0.05, 0.05, 0.1, 1.0, 1.5, 0.0, 0.3, 0.6, 1.0])
TWO_STARTS = [np.array([0.9, 0.1, 0.1, 1.0, 0.0, 0.3, across]) for across in (0.88, 1.0)] + [
    np.array([0.9, 0.1, 0.1, 1.5, 0.0, 0.6, across]) for across in (0.88, 1.0)
]


def albedo(cell: Cell) -> float:
    """Directional albedo of the mixture as written."""
    return float(np.sum(fit.weighted_lobes(cell.wi, cell.wo, fit.lobes(cell.wo, cell.m)), axis=-1) @ cell.solid_angle)


def best_two(cell: Cell) -> np.ndarray:
    """The best mixture of two lobes for one cell alone; head-on round and upright, as every table must be there."""
    starts = [*TWO_STARTS, *random_starts(np.random.default_rng(0), 2, 2)]
    if cell.angle == 0:
        starts = [start * [1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0] for start in starts]
    return optimum(cell, starts)


def best_distance(cell: Cell) -> float:
    return cell.distance(best_two(cell))[0]


class Search:
    """Rounds after which those cells count for more that are farther off than they should be."""

    def __init__(self) -> None:
        self.cells = [Cell(m, degrees, finer=2 if degrees < 10 else 1) for m in SLOPES for degrees in ANGLES]  # kinks
        with Pool() as pool:
            floor = np.array(pool.map(best_distance, self.cells, chunksize=4))
        near = np.array([NEAR if round(np.degrees(cell.angle)) in PRINTED else 1.15 for cell in self.cells])
        most = np.array([MOST[cell.m > 0.4] for cell in self.cells])
        # Beyond 85 degrees the model's own shape is extreme; a cell there counts for little.
        self.within = np.array([cell.angle < np.radians(85.5) for cell in self.cells])
        self.goal = np.minimum(near * floor, most)
        self.importance = np.where(self.within, 1.0, 0.1) / (floor + 0.0005)
        self.best = np.inf, np.zeros((START.size, 0))

    def round(self, coefficients: np.ndarray, degrees: tuple[int, int], steps: int) -> np.ndarray:
        """A descent of so many steps; then cells count by how far beyond their goal they are."""
        powers_x = np.repeat(np.arange(DEGREE_X + 1), DEGREE_M + 1)
        powers_m = np.tile(np.arange(DEGREE_M + 1), DEGREE_X + 1)
        most_x = np.append(np.full(START.size - 1, DEGREE_X), ACROSS_X)[:, None]
        free = (powers_x <= np.minimum(most_x, degrees[0])) & (powers_m <= degrees[1])
        coefficients = Table(self.cells, self.importance, free).descend(coefficients, steps)
        held = [np.clip(ALONE + coefficients @ cell.basis, *cell.limits(LOBES)) for cell in self.cells]
        over = np.array([cell.distance(of)[0] for cell, of in zip(self.cells, held, strict=True)]) / self.goal
        worst = float(np.max(over[self.within]))
        print(
            f"degrees {degrees}: {np.sum(over[self.within] > 1)} cells beyond their goal, at {worst:.3f} of it",
            flush=True,
        )
        if worst < self.best[0]:
            self.best = worst, coefficients
        more = np.where(over > 1, np.minimum(over, 1.6) ** 4, np.maximum(over, 0.7))
        self.importance = self.importance * np.where(self.within, more, 1.0)
        self.importance /= np.mean(self.importance)
        return coefficients


def search(start: np.ndarray | None) -> np.ndarray:
    """Coefficients of all cells together: a coarse table first, then one of full degree that starts from it.

    start: coefficients that there are already, of full degree.
    """
    rounds = Search()
    full = DEGREE_X, DEGREE_M
    if start is None:
        start = np.zeros((START.size, (DEGREE_X + 1) * (DEGREE_M + 1)))
        start[:, 0] = START - ALONE
        start = rounds.round(rounds.round(start, (3, 1), 100), full, 150)
    for _ in range(ROUNDS):
        if rounds.best[0] > 1.0:
            start = rounds.round(start, full, 80)
    return rounds.best[1]


def committed() -> np.ndarray:
    """Coefficients of the committed table, as ``search`` gives them."""
    rows = []
    for name in fit.FUNCTIONS:
        for numbers in fit.table()[name]:
            grid = np.zeros((DEGREE_X + 1, DEGREE_M + 1))
            grid[: numbers.shape[0], : numbers.shape[1]] = numbers
            rows.append(grid.ravel())
    return np.array(rows)


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
    slopes = sorted({*SLOPES, *np.linspace(0.075, 0.975, 19).tolist()})
    views = (*np.arange(0.0, 89.0, 2.0), 89.0, 89.6, 89.95)
    cells = [Cell(m, degrees, finer=2) for m in slopes for degrees in views]  # a coarse grid blurs small bounds
    limits = [[largest_share(cell, bound) for bound in SHARE_BOUNDS] for cell in cells]
    points = np.array([(2.0 * cell.x - 1.0, 2.0 * cell.m - 1.0) for cell in cells])
    return highest_share(points, np.array(limits), SHARE_DEGREES)


def print_table(floor: Path | None) -> None:
    """L1 in percent: the plain closure, the best two lobes for the cell alone, the table; and the albedo's error.

    floor: where to write what the best two lobes reach, for the tests.
    """
    print("L1 in %: plain closure / best two lobes for this cell / the table (its albedo's error)")
    print("    m", *(f"{degrees:>24} deg" for degrees in PRINTED))
    title = "# L1 of the best two lobes for each cell alone, by tools/fit_cook_torrance.py --write"
    beyond, written = [], [title, "m,degrees,l1"]
    for m in SLOPES:
        line = []
        for degrees in PRINTED:
            cell = Cell(m, degrees)
            plain = cell.distance(np.array([1.0, 0.0, 0.0, 1.0]))[0]
            best = cell.distance(best_two(cell))[0]
            of = fit.lobes(cell.wo, m)
            r = np.sum(fit.weighted_lobes(cell.wi, cell.wo, of), axis=-1) - cell.f_cos
            table, error = (float(part @ cell.solid_angle / cell.albedo) for part in (np.abs(r), r))
            beyond.append(table - 1.15 * best)
            written.append(f"{m:g},{degrees:g},{best:.6f}")
            line.append(f"{100 * plain:6.2f} /{100 * best:5.2f} /{100 * table:5.2f} ({100 * error:+.2f})")
        print(f"{m:5.2f}", *(f"{text:>28}" for text in line), flush=True)
    over = sum(part > 0 for part in beyond)
    if floor:
        floor.write_text("\n".join([*written, ""]), encoding="utf-8")
    print(
        f"beyond 1.15 of the best two lobes in {over} of {len(beyond)} cells, by at most {100 * max(0, *beyond):.2f} %"
    )


def write(numbers: dict[str, np.ndarray]) -> None:
    fit.TABLE.write_text(toml(numbers), encoding="utf-8")
    fit.table.cache_clear()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="find the table anew and write it")
    parser.add_argument("--polish", action="store_true", help="write a table that starts from the committed one")
    options = parser.parse_args()
    if options.write or options.polish:
        numbers = by_function(search(None if options.write else committed()))
        write(numbers)
        views = [Cell(m, degrees) for m in (*SLOPES, *np.linspace(0.1, 1.0, 19)) for degrees in np.arange(0, 90, 1.5)]
        assert max(map(albedo, views)) < 1.0, "a furnace must not exceed 1"
        write(numbers | {"share": shares()})  # of the mixture as written
    print_table(FLOOR if options.write or options.polish else None)


if __name__ == "__main__":
    main()
