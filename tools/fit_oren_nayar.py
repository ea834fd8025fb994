# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit Cycles' diffuse closures to Oren-Nayar 1994: writes addon/reference/oren_nayar_fit.toml and prints how near.

python tools/fit_oren_nayar.py [--print-only]

Errors are L1: the integral over wi of |f_closure - f| cos over that of f cos, in per cent.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, linprog, minimize, minimize_scalar
from scipy.sparse import csr_matrix, eye, hstack, vstack
from shares import SHARE_BOUNDS, highest_share

from vgroove.addon.reference import cycles, oren_nayar, spherical
from vgroove.addon.reference import oren_nayar_fit as fit
from vgroove.addon.reference.quadrature import diffuse_albedo, panels

PATH = Path(__file__).parent.parent / "addon" / "reference" / "oren_nayar_fit.toml"
DEGREE = 5
SHARE_DEGREES = 6, 4, 2  # in tan(theta_o/2), in s2/(s2 + 0.09) and in the logarithm of the bound
NODES = 16  # quadrature in each angle; 32 move no figure below by 0.1 %
SIGMAS = (0.1, 0.3, 0.6, 1.0, np.pi / 2)
ALBEDOS = np.array([0.2, 0.5, 0.8])  # as the three channels of one colour
THETAS = (0.0, 20.0, 45.0, 60.0, 70.0, 80.0, 85.0, 89.0)


class View:
    """Directions wi over the hemisphere for one cos(theta_o), and their projected solid angles."""

    def __init__(self, mu: float) -> None:
        theta_o = np.arccos(mu)
        theta, theta_weight = panels(np.unique([0.0, theta_o, np.pi / 2]), NODES)
        phi, phi_weight = panels(np.array([0.0, np.pi / 2, np.pi]), NODES)
        t, p = (grid.ravel() for grid in np.meshgrid(theta, phi, indexing="ij"))
        self.mu, self.wi = mu, spherical(t, p)
        self.wo = np.broadcast_to(spherical(theta_o), self.wi.shape)
        self.weight = 2.0 * np.outer(theta_weight, phi_weight).ravel() * np.sin(t) * np.cos(t)

    def exact(self, sigma: float, *, qualitative: bool) -> np.ndarray:
        return oren_nayar(self.wi, self.wo, ALBEDOS, sigma, qualitative=qualitative)

    def l1(self, f: np.ndarray, exact: np.ndarray) -> np.ndarray:
        """Per cent, for each albedo."""
        return 100.0 * (self.weight @ np.abs(f - exact)) / (self.weight @ exact)

    def optimum(self, exact: np.ndarray) -> np.ndarray:
        """The least L1 of any non-negative mixture of Lambert and single-scattering Fujii, by a linear program."""
        basis = np.stack([np.full(len(self.wi), 1.0 / np.pi), single_fujii(self.wi, self.wo)], axis=-1)
        a, one = csr_matrix(basis * self.weight[:, None]), eye(len(basis))
        matrix = vstack([hstack([a, -one]), hstack([-a, -one])])
        cost = np.concatenate([np.zeros(2), np.ones(len(basis))])
        errors = []
        for channel in exact.T:
            aim = channel * self.weight
            done = linprog(cost, A_ub=matrix, b_ub=np.concatenate([aim, -aim]), method="highs")
            errors.append(100.0 * done.fun / aim.sum())
        return np.array(errors)


def single_fujii(wi: np.ndarray, wo: np.ndarray) -> np.ndarray:
    """Cycles' Oren-Nayar of roughness 1 over its colour, for a colour so dark that light bounces once."""
    return fit.cycles_diffuse(wi, wo, 1e-9, 1.0)[:, 0] / 1e-9


def at(mu: float) -> np.ndarray:
    return spherical(np.arccos(mu))


def cosines(count: int, low: float = 0.0) -> np.ndarray:
    """Of angles whose tan(theta_o/2) are Chebyshev nodes in [low, 1]."""
    t = low + (1.0 - low) * (0.5 - 0.5 * np.cos(np.pi * (np.arange(count) + 0.5) / count))
    return (1.0 - t * t) / (1.0 + t * t)


def polynomial(mu: np.ndarray, values: list[float]) -> list[float]:
    return [round(float(c), 5) for c in np.polynomial.polynomial.polyfit(fit.half_tangent(mu), values, DEGREE)]


def albedo(*, qualitative: bool) -> list[float]:
    """P from the albedo at one sigma, for it factors; this sigma is below where f is cut at 0."""
    s2, mu = 0.25, cosines(40)
    bounce = 0.0 if qualitative else 0.17 * s2 / (s2 + 0.13)  # at white

    def energy(cosine: float) -> float:
        f = partial(oren_nayar, albedo=1.0, sigma=0.5, qualitative=qualitative)
        return float(diffuse_albedo(at(cosine), f, 64)[0])

    once = np.array([energy(cosine) for cosine in mu]) - bounce
    return polynomial(mu, (once - 1.0 + 0.5 * s2 / (s2 + 0.33)) / (s2 / (s2 + 0.09)))


def retro(*, qualitative: bool) -> list[float]:
    """W: at each angle what gives the least L1 over all sigmas and albedos, the albedo being kept."""
    mu = cosines(24, low=0.12)  # nearer the normal W hardly matters

    def best(view: View) -> float:
        exact = [view.exact(sigma, qualitative=qualitative) for sigma in SIGMAS]

        def error(W: float) -> float:
            total = 0.0
            for sigma, f in zip(SIGMAS, exact, strict=True):
                lobe = fit.cycles_diffuse(view.wi, view.wo, ALBEDOS * W * sigma**2 / (sigma**2 + 0.09), 1.0)
                rest = view.weight @ (f - lobe)
                total += float(np.sum(view.l1(lobe + rest / np.pi, f)))
            return total

        return float(minimize_scalar(error, bounds=(0.0, 0.8), method="bounded").x)

    return polynomial(mu, [best(View(cosine)) for cosine in mu])


def roughness(*, qualitative: bool) -> list[float]:
    """k and c that make Cycles' own closure nearest, on average over sigma, albedo and projected views."""
    x, weight = np.polynomial.legendre.leggauss(6)
    views = [View(float(mu)) for mu in (x + 1.0) / 2.0]
    share = weight * (x + 1.0) / 2.0
    sigmas = (0.05, 0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0, 1.25, np.pi / 2)
    exact = [[view.exact(sigma, qualitative=qualitative) for view in views] for sigma in sigmas]

    def error(kc: np.ndarray) -> float:
        total = 0.0
        for sigma, row in zip(sigmas, exact, strict=True):
            r = float(np.clip(kc[0] * sigma**2 / (sigma**2 + abs(kc[1])), 0.0, 1.0))
            for view, f, part in zip(views, row, share, strict=True):
                # Relative to how far Lambert is off: each sigma counts alike.
                total += part * float(np.mean(view.l1(fit.cycles_diffuse(view.wi, view.wo, ALBEDOS, r), f))) / sigma
        return total

    found = minimize(error, [1.0, 0.3], method="Nelder-Mead", options={"xatol": 1e-3, "fatol": 1e-3})
    return [round(float(value), 2) for value in found.x]


def native() -> list[float]:
    mu = cosines(40)
    return polynomial(mu, fit.fujii_albedo(mu, 1.0))


def write() -> None:
    """The data file, then read back so that the table below shows what it holds."""
    lines = [
        "# SPDX-License-Identifier: GPL-3.0-or-later",
        "# Made by tools/fit_oren_nayar.py; meanings in oren_nayar_fit.py",
    ]
    for version, kind in product(cycles.VERSIONS, fit.KINDS):
        with cycles.as_of(version):
            numbers = _found(fit.TABLES[version], kind)
        lines += ["", f"[{version}.{kind}]", *(f"{name} = {_wrapped(values)}" for name, values in numbers.items())]
    PATH.write_text("\n".join(lines) + "\n", encoding="utf-8")
    fit.TABLES.update(fit.load(PATH))


def _found(tables: dict[str, fit.Table], kind: str) -> dict[str, list]:
    """The numbers of a kind for the Cycles that is meant."""
    qualitative = kind == "qualitative"
    numbers = {
        "albedo": albedo(qualitative=qualitative),
        "retro": retro(qualitative=qualitative),
        "native": native(),
        "roughness": roughness(qualitative=qualitative),
    }
    tables[kind] = replace(tables[kind], **{name: tuple(values) for name, values in numbers.items()})
    return numbers | {"share": [[[float(f"{c:.9g}") for c in row] for row in rows] for rows in shares(kind)]}


def _wrapped(values: list) -> str:
    """One line for a list of numbers, one for each of its lists."""
    if not isinstance(values[0], list):
        return str(values)
    return "[\n" + "".join(f"  {row},\n" for row in values) + "]"


def shares(kind: str) -> np.ndarray:
    """Coefficients [j][k][l] of ``hybrid_share``: below the largest share of every albedo."""
    albedos = np.array([1e-6, 0.2, 0.5, 0.8, 0.9, 1.0])
    qualitative = kind == "qualitative"
    points, limits = [], []
    for degrees in (0, 4, 9, 15, 21, 27, 33, 39, 45, 51, 57, 63, 68, 72, 76, 80, 83, 86, 88, 89.5):
        view = View(float(np.cos(np.radians(degrees))))
        for sigma in (0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.75, 0.9, 1.1, 1.3, np.pi / 2):
            f, near = [], []
            for colors in (albedos[:3], albedos[3:]):
                f.append(oren_nayar(view.wi, view.wo, colors, sigma, qualitative=qualitative))
                near.append(fit.oren_nayar_fit(view.wi, view.wo, colors, sigma, qualitative=qualitative))
            limit = partial(largest_share, view, np.concatenate(f, axis=1), np.concatenate(near, axis=1))
            limits.append([limit(bound) for bound in SHARE_BOUNDS])
            facing = sigma**2 / (sigma**2 + 0.09)
            points.append((2.0 * float(fit.half_tangent(view.mu)) - 1.0, 2.0 * facing - 1.0))
    return highest_share(np.array(points), np.array(limits), SHARE_DEGREES)


def largest_share(view: View, f: np.ndarray, near: np.ndarray, bound: float) -> float:
    """The largest c <= 1 for which the integral of (c near - f)+ cos is at most ``bound`` of that of f cos."""

    def excess(c: float) -> float:
        return float(np.max(view.weight @ np.maximum(c * near - f, 0.0) / (view.weight @ f))) - bound

    return 1.0 if excess(1.0) <= 0 else float(brentq(excess, 0.0, 1.0))


def report() -> None:
    """Optimum, fit and plain closure for every sigma and view; the worst of three albedos each."""
    for version, kind in product(cycles.VERSIONS, fit.KINDS):
        cycles.set_version(version)
        qualitative = kind == "qualitative"
        print(f"\n{kind}, Cycles {version}: L1 in % of the best mixture / fit / closure at its roughness / at sigma")
        print("theta_o   " + "".join(f"{degrees:^22.0f}" for degrees in THETAS))
        for sigma in SIGMAS:
            cells = []
            for degrees in THETAS:
                view = View(float(np.cos(np.radians(degrees))))
                exact = view.exact(sigma, qualitative=qualitative)
                r = float(fit.closure_roughness(sigma, qualitative=qualitative))
                models = (
                    fit.oren_nayar_fit(view.wi, view.wo, ALBEDOS, sigma, qualitative=qualitative),
                    fit.cycles_diffuse(view.wi, view.wo, ALBEDOS, r),
                    fit.cycles_diffuse(view.wi, view.wo, ALBEDOS, min(sigma, 1.0)),
                )
                errors = [view.optimum(exact), *(view.l1(f, exact) for f in models)]
                cells.append(" /".join(f"{np.max(error):4.1f}" for error in errors))
            print(f"sigma {sigma:.2f}" + "".join(f"{cell:^22}" for cell in cells), flush=True)


if __name__ == "__main__":
    if "--print-only" not in sys.argv:
        write()
    report()
