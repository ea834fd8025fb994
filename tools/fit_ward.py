# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit two of Cycles' Beckmann lobes to Ward's: writes addon/reference/ward_fit.toml and prints how near they come.

python tools/fit_ward.py [--print-only]

Errors are L1: the integral over wi of |f_fit - f| cos over that of f cos, in per cent, of the lobe alone. All cells of
slope and view together are one problem for the polynomials' coefficients, solved by Gauss-Newton steps with weights
1/|f_fit - f|; between rounds cells beyond their goal count for more.
"""

from __future__ import annotations

import sys

import numpy as np
from fit_cells import Cell

from vgroove.addon.reference import ward_fit
from vgroove.addon.reference.ward import lobe_over_d

MOST = 0.9985  # albedo beyond which a mixture costs: a furnace must not exceed 1
KINDS = ("bounded", "ward_1992")
SLOPES = (0.01, 0.03, 0.05, 0.09, 0.13, 0.17, 0.21, 0.26, 0.31, 0.36, 0.42, 0.48, 0.54, 0.6, 0.7, 0.8, 0.9, 1.0)
VIEWS = (0.5, 12, 24, 34, 43, 50, 56, 61, 65, 68, 71, 74, 76.5, 79, 81, 83, 85, 87)
DEGREES = 6, 4  # coefficients in u and in m
START = 0.5, 0.3, 0.92, 0.1, 0.05  # weights of both lobes; roughness, anisotropy and lean of the second
STIFF = np.array([1.0, 1.0, 3.0, 1.0, 1.0]) * 1e-4
ROUNDS, STEPS = 22, 3
SHOWN, SHOWN_VIEWS = (0.05, 0.15, 0.3, 0.45, 0.6, 1.0), (0, 30, 45, 60, 70, 75, 80, 85)


class WardCell(Cell):
    """One slope and view: Ward's lobe on a grid of facets, and the mixture's."""

    def __init__(self, kind: str, m: float, degrees: float) -> None:
        super().__init__(m, float(np.cos(np.radians(max(degrees, 0.01)))), 24, 20)
        both = self.wi + self.wo
        both2 = np.einsum("fi,fi->f", both, both)
        nh, ni, no = both[:, 2] / np.sqrt(both2), self.wi[:, 2], np.full(len(both), self.wo[2])
        D = np.exp((1.0 - 1.0 / nh**2) / m**2) / (np.pi * m**2 * nh**4)
        self.f_cos = D * lobe_over_d(kind, ni, no, both2, nh) * ni
        self.albedo = float(self.f_cos @ self.solid_angle)
        self.share = self.solid_angle / self.albedo
        narrowing = ward_fit.narrowing(kind, self.wo, np.asarray(m))
        self.m = float(ward_fit.effective(m, narrowing))  # of the lobes
        self.scale = ward_fit.scale(kind, no[0], self.m) * (self.m / m) ** 2
        m, slope = self.m, m
        u = m * (1.0 - no[0]) / (no[0] + m)
        self.terms = np.array([u**j * m**k for j in range(DEGREES[0]) for k in range(DEGREES[1])])
        self.goal = np.interp(degrees, (70, 85), (0.032, 0.075)) * np.interp(
            slope, (0.1, 0.3, 0.6, 1.0), (0.6, 0.75, 0.85, 2.5)
        )
        self.held = ward_fit.HIGH.copy()
        self.held[4] = min(self.held[4], ward_fit.most_lean(no[0], m))
        self.first = self.scale * self.lobe(1.0)

    def second(self, roughness: float, anisotropy: float, lean: float) -> np.ndarray:
        """f cos of the second lobe, of weight 1."""
        tilt = lean / (1.0 - self.m * lean * self.wo[2])
        return self.scale * self.lobe(roughness, anisotropy, tilt)

    def equations(self, values: np.ndarray, smooth: float) -> tuple[float, np.ndarray, np.ndarray]:
        """L1, its gradient, and the Gauss-Newton matrix in the five values."""
        held = np.clip(values, ward_fit.LOW, self.held)
        first, second, *shape = held
        plain = self.second(*shape)
        r = first * self.first + second * plain - self.f_cos
        J = [self.first, plain]
        for at in range(3):
            step = -1e-4 if at == 1 and shape[1] > 0.5 else 1e-4
            J.append(second * (self.second(*(v + step * (at == k) for k, v in enumerate(shape))) - plain) / step)
        free = held == values
        slopes = np.stack(J) * free[:, None]
        size = np.hypot(r, smooth * self.f_cos.max())
        pull = self.share / size
        beyond = values - held
        gradient, matrix = slopes @ (r * pull) + 2.0 * beyond, (slopes * pull) @ slopes.T + 2.0 * np.diag(~free)
        loss, slope = float(size @ self.share), slopes @ self.share
        error = float(r @ self.share)  # of the albedo
        for excess, cost in ((self.albedo * (1.0 + error) - MOST, 3e3), (error - 0.01, 30.0), (-0.01 - error, 30.0)):
            if excess > 0.0:
                gradient = gradient + 2.0 * np.copysign(cost * excess, error if cost < 1e3 else 1.0) * slope
                matrix = matrix + 2.0 * cost * np.outer(slope, slope)
                loss += cost * excess**2
        self.l1 = float(np.abs(r) @ self.share)
        return loss + float(beyond @ beyond), gradient, matrix


def solve(kind: str) -> np.ndarray:
    """Coefficients [value][j, k]."""
    cells = [WardCell(kind, m, view) for m in SLOPES for view in VIEWS]
    terms = np.array([cell.terms for cell in cells])
    at = np.zeros((5, terms.shape[1]))
    at[:, 0] = START
    goal = np.array([cell.goal for cell in cells])
    of_cell = goal.min() / goal
    damping, smooth, best = 1e-2, 3e-2, (np.inf, at)
    scale = np.sqrt(np.mean(terms**2, axis=0))

    def state(at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        values = terms @ at.T
        found = [cell.equations(value, smooth) for cell, value in zip(cells, values, strict=True)]
        return tuple(map(np.array, zip(*found, strict=True)))

    for round_ in range(ROUNDS):
        smooth = max(3e-4, smooth * 0.8)
        for _ in range(STEPS):
            losses, gradient, matrix = state(at)
            loss = losses @ of_cell
            g = np.einsum("c,cv,ct->vt", of_cell, gradient, terms)
            M = np.einsum("c,cvw,ct,cs->vtws", of_cell, matrix, terms, terms, optimize=True)
            size = g.size
            M = M.reshape(size, size)
            ridge = np.outer(STIFF, scale**2).ravel() * of_cell.sum()
            for _ in range(5):
                damped = M + np.diag(damping * np.diag(M) + ridge)
                trial = at - np.linalg.solve(damped, g.ravel()).reshape(at.shape)
                if state(trial)[0] @ of_cell < loss:
                    at, damping = trial, max(damping / 3.0, 1e-4)
                    break
                damping *= 4.0
        state(at)
        l1 = np.array([cell.l1 for cell in cells])
        of_cell = np.clip(of_cell * np.clip(l1 / goal, 0.7, 1.6), 0.05, 200.0)
        best = min(best, (float(np.max(l1 / goal)), at), key=lambda one: one[0])
        print(
            round_,
            f"{100 * l1.mean():.2f} {100 * l1.max():.1f} over goal {np.max(l1 / goal):.2f} {damping:.1g}",
            SLOPES[int(np.argmax(l1 / goal)) // len(VIEWS)],
            VIEWS[int(np.argmax(l1 / goal)) % len(VIEWS)],
            flush=True,
        )
    return best[1]


def told(kind: str, at: np.ndarray) -> None:
    """Prints L1 and the albedo's error in per cent."""
    print(kind, *(f"{view:>9} deg" for view in SHOWN_VIEWS))
    for m in SHOWN:
        line = []
        for view in SHOWN_VIEWS:
            cell = WardCell(kind, m, view)
            first, second, *shape = np.clip(at @ cell.terms, ward_fit.LOW, cell.held)
            r = first * cell.first + second * cell.second(*shape) - cell.f_cos
            line.append(f"{100 * np.abs(r) @ cell.share:5.1f} ({100 * r @ cell.share:+5.2f})")
        print(f"m = {m:4} ", *line)


def main() -> None:
    found = {kind: solve(kind) for kind in KINDS}
    for kind, at in found.items():
        told(kind, at)
    if "--print-only" not in sys.argv:
        head = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Coefficients [value][j][k] of u^j m^k\n"
        text = head + "# Written by tools/fit_ward.py\n"
        for kind, at in found.items():
            rows = [[[float(f"{number:.7g}") for number in row] for row in value.reshape(DEGREES)] for value in at]
            parts = ",\n".join("  [\n" + "".join(f"    {row},\n" for row in value) + "  ]" for value in rows)
            text += f"\n{kind} = [\n{parts},\n]\n"
        ward_fit.PATH.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
