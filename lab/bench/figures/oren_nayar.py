# SPDX-License-Identifier: GPL-3.0-or-later
"""How near the short form, ``fit`` and ``closure`` are to Oren and Nayar's full model, for docs/oren_nayar.md.

L1 in a view: the integral over wi of |f - f_1994| cos over that of f_1994 cos; the worst of three albedos. And what the
model has at its extremes: the weight of ``mirror``, pi f, and the light that white facets return.
"""

from __future__ import annotations

from functools import partial
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ....addon.reference import cycles, oren_nayar, spherical
from ....addon.reference.oren_nayar_fit import KINDS, closure_roughness, cycles_diffuse, oren_nayar_fit
from ....addon.reference.quadrature import diffuse_albedo, panels
from ..cells import Table

if TYPE_CHECKING:
    from numpy.typing import NDArray

SIGMAS = (0.1, 0.3, 0.6, 1.0, np.pi / 2)
ALBEDOS = (0.2, 0.5, 0.8)
SHORT_VIEWS = (0.0, 20.0, 45.0, 70.0, 85.0)  # degrees
VIEWS = (0.0, 45.0, 70.0, 80.0, 89.0)
GRAZING, NEAREST = 85.0, 89.9  # degrees: of a single draw, and of a view
NODES = 24  # quadrature in each angle; more change no figure that is shown


def tables() -> dict[str, Table]:
    """The qualitative form against the full one; ``fit`` and ``closure`` against each, by each Cycles."""
    found = {"short": Table(["sigma", *(f"{view:g}" for view in SHORT_VIEWS)], [short(sigma) for sigma in SIGMAS])}
    columns = ["sigma", *(f"{name} {view:g}" for name in ("fit", "closure") for view in VIEWS)]
    for version, kind in product(cycles.VERSIONS, KINDS):
        name = kind if version == cycles.UNTIL_5_2 else f"{kind}_5_3"
        with cycles.as_of(version):
            found[name] = Table(columns, [near(sigma, qualitative=kind == "qualitative") for sigma in SIGMAS])
    found["extremes"] = Table(["weight", "albedo"], [[heaviest(), brightest()]])
    return found


def heaviest() -> float:
    """The weight of ``mirror`` of white facets, where both directions graze on the same side."""
    grazing = spherical(np.radians(GRAZING))
    return float(np.pi * np.max(oren_nayar(grazing, grazing, 1.0, SIGMAS[-1])))


def brightest() -> float:
    """The directional albedo of white facets in a grazing view, at the sigma that has the most."""
    wo = spherical(np.radians(NEAREST))
    return max(float(np.max(diffuse_albedo(wo, partial(oren_nayar, albedo=1.0, sigma=s), NODES))) for s in SIGMAS)


def short(sigma: float) -> list[float]:
    row = [sigma]
    for degrees in SHORT_VIEWS:
        wi, wo, weight = view(degrees)
        form, full = (oren_nayar(wi, wo, ALBEDOS, sigma, qualitative=one) for one in (True, False))
        row.append(l1(form, full, weight))
    return row


def near(sigma: float, *, qualitative: bool) -> list[float]:
    rows: dict[str, list[float]] = {"fit": [], "closure": []}
    roughness = float(closure_roughness(sigma, qualitative=qualitative))
    for degrees in VIEWS:
        wi, wo, weight = view(degrees)
        exact = oren_nayar(wi, wo, ALBEDOS, sigma, qualitative=qualitative)
        rows["fit"].append(l1(oren_nayar_fit(wi, wo, ALBEDOS, sigma, qualitative=qualitative), exact, weight))
        rows["closure"].append(l1(cycles_diffuse(wi, wo, ALBEDOS, roughness), exact, weight))
    return [sigma, *rows["fit"], *rows["closure"]]


def view(degrees: float) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """wi over half the hemisphere, wo, and projected solid angles."""
    theta_o = np.radians(degrees)
    theta, theta_weight = panels(np.unique([0.0, theta_o, np.pi / 2]), NODES)
    phi, phi_weight = panels(np.array([0.0, np.pi / 2, np.pi]), NODES)
    t, p = (grid.ravel() for grid in np.meshgrid(theta, phi, indexing="ij"))
    weight = np.outer(theta_weight, phi_weight).ravel() * np.sin(t) * np.cos(t)
    wi = spherical(t, p)
    return wi, np.broadcast_to(spherical(theta_o), wi.shape), weight


def l1(f: NDArray[np.float64], exact: NDArray[np.float64], weight: NDArray[np.float64]) -> float:
    return float(np.max((weight @ np.abs(f - exact)) / (weight @ exact)))
