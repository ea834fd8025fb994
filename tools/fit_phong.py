# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit Cycles' closures to Phong's and Blinn's lobes: writes addon/reference/phong_fit.toml and prints how near.

python tools/fit_phong.py [--print-only]

Errors are L1: the integral over wi of |f_closure - f| cos over that of f cos, in per cent, of the lobe alone.
"""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np

from vgroove.addon.reference import phong_fit, spherical
from vgroove.addon.reference.cook_torrance_fit import weighted_lobes
from vgroove.addon.reference.phong import BlinnPhong, Phong

MODELS = {"phong": Phong, "blinn_phong": BlinnPhong}
# The least L1 over exponents to 100 and views to 82 degrees; ``round`` and whether Lambert helps are the lobes' own.
STARTS = {
    "phong": phong_fit.Table(0.32, 0.0, round=True, weight=(), energy=()),
    "blinn_phong": phong_fit.Table(0.23, 1.0, round=False, weight=(), energy=()),
}
EXPONENTS = (0, 0.2, 0.5, 1, 2, 4, 8, 16, 32, 64, 128, 300, 1000, 4000)
COSINES = np.concatenate([np.linspace(0.002, 1.0, 14) ** 1.3, [0.05, 0.1]])
DEGREES = 4, 5  # in q and in m
SHOWN, VIEWS = (1, 3, 10, 30, 100, 1000), (0, 30, 60, 75, 85)
NODES = 100


def around(degrees: float, m: float) -> tuple[np.ndarray, np.ndarray]:
    """wi above the surface, dense about a direction in the plane of view across from the viewer; solid angles."""
    axis = spherical(np.radians(degrees), np.pi)
    x, weight = np.polynomial.legendre.leggauss(NODES)
    power = max(1.0, np.log(max(2.5 * m, 0.01) / np.pi) / np.log(0.35))  # a third of the nodes within 2.5 m
    a, d_a = np.pi * ((x + 1.0) / 2.0) ** power, weight / 2.0 * np.pi * power * ((x + 1.0) / 2.0) ** (power - 1.0)
    phi = (np.arange(NODES) + 0.5) / NODES * 2.0 * np.pi
    T, B = spherical(np.radians(degrees) + np.pi / 2, np.pi), np.array([0.0, 1.0, 0.0])
    ring = np.cos(phi)[:, None] * T + np.sin(phi)[:, None] * B
    wi = np.cos(a)[:, None, None] * axis + np.sin(a)[:, None, None] * ring
    solid_angle = np.outer(d_a * np.sin(a), np.full(NODES, 2.0 * np.pi / NODES))
    lit = wi[..., 2] > 0
    return wi[lit], solid_angle[lit]


def fitted(name: str) -> phong_fit.Table:
    """The table whose weights keep the lobe's albedo, by least squares of the relative error."""
    start, found = STARTS[name], []
    for n in EXPONENTS:
        model = MODELS[name](0.0, 1.0, n)
        for c, energy in zip(COSINES, model.lobe_albedo(spherical(np.arccos(COSINES))), strict=True):
            wo = spherical(np.arccos(c))
            lobe = phong_fit.lobes(wo, model.slope, start)
            toward = np.degrees(np.arccos(c) + 2.0 * np.arctan(lobe.tilt[0]))
            wi, solid_angle = around(max(toward, 0.0), max(float(lobe.across[0]), float(lobe.within[0])))
            native = solid_angle @ weighted_lobes(wi, np.broadcast_to(wo, wi.shape), lobe)[:, 0]
            left = 1.0 - start.lambert * model.slope**3
            found.append((c, model.slope, energy, energy * left / native))
    c, m, energy, weight = np.array(found).T
    q = 0.5 * (c + np.sqrt(c * c + phong_fit.KNEE * m * m))
    terms = np.stack([q**j * m**k for j in range(DEGREES[0]) for k in range(DEGREES[1])], axis=-1)

    def least(of: np.ndarray) -> tuple[tuple[float, ...], ...]:
        scale = 1.0 / (of + 0.05)
        rows = np.linalg.lstsq(terms * scale[:, None], of * scale)[0].reshape(DEGREES)
        return tuple(tuple(float(f"{number:.7g}") for number in row) for row in rows)

    return replace(start, weight=least(weight), energy=least(energy))


def l1(name: str, n: float, degrees: float, table: phong_fit.Table) -> tuple[float, float]:
    """The error in per cent, and by how many per cent the albedo is off."""
    model, wo = MODELS[name](0.0, 1.0, n), spherical(np.radians(degrees))
    wi, solid_angle = around(degrees, model.slope)
    weight = solid_angle * wi[:, 2]
    f, exact = phong_fit.closure(wi, wo, model.slope, table)[:, 0], model.lobe(wi, wo)
    energy = weight @ exact
    return 100.0 * float(weight @ np.abs(f - exact) / energy), 100.0 * float(weight @ (f - exact) / energy)


def written(table: phong_fit.Table) -> str:
    lines = [f"{key} = {str(getattr(table, key)).lower()}" for key in ("narrower", "lambert", "round")]
    for key in ("weight", "energy"):
        rows = ",\n    ".join(str(list(row)) for row in getattr(table, key))
        lines.append(f"{key} = [\n    {rows},\n]")
    return "\n".join(lines)


def main() -> None:
    tables = {name: fitted(name) for name in MODELS}
    for name, table in tables.items():
        print(name, *(f"{view:>12} deg" for view in VIEWS))
        for n in SHOWN:
            print(f"n = {n:4}  ", *("{:7.1f} ({:+5.1f})".format(*l1(name, n, view, table)) for view in VIEWS))
    if "--print-only" not in sys.argv:
        head = "# SPDX-License-Identifier: GPL-3.0-or-later\n# Written by tools/fit_phong.py\n"
        text = "".join(f"\n[{name}]\n{written(table)}\n" for name, table in tables.items())
        phong_fit.PATH.write_text(head + text, encoding="utf-8")


if __name__ == "__main__":
    main()
