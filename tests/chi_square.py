# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether draws are distributed as a model's ``pdf`` says: a chi-square test over cells of the hemisphere."""

import numpy as np
from scipy import stats

from vgroove.addon.reference import spherical


def viewer(degrees):
    """wo in the plane of x and z, on the side of -x: the mirror direction has azimuth 0."""
    return spherical(np.deg2rad(degrees), np.pi)


def draw(model, wo, count, *key):
    return model.sample(wo, np.random.default_rng(key).random((count, 4)))


CELLS = 16  # in theta and in phi
PARTS = 4  # panels a cell is integrated over, each way, with as many draws in each
ENDS = 6  # the first and the last of them reach from 2 to 4 sigma: they are cut once more
TAIL = np.array([1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3])  # and beyond the pilot's draws follow these shares of what is left


def edges_through(values, low, high):
    """Panel edges that follow the density of ``values`` and go on to low and high, and where cells begin among them."""
    inner = np.quantile(values, np.linspace(0, 1, CELLS * PARTS + 1))
    first, last = np.linspace(inner[0], inner[1], ENDS + 1), np.linspace(inner[-2], inner[-1], ENDS + 1)
    below, above = inner[0] - (inner[0] - low) * TAIL[::-1], inner[-1] + (high - inner[-1]) * TAIL
    edges = np.concatenate([[low], below, first, inner[2:-2], last, above, [high]])
    starts = np.searchsorted(edges, [low, *inner[PARTS:-PARTS:PARTS]])
    return edges, starts


def gauss_panels(edges, nodes):
    """Points and weights of plain Gauss-Legendre on each panel."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    half = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + half * (x + 1)).ravel(), (half * weight).ravel()


def grid(model, wo):
    """Panels in theta and phi that follow the density: quantiles of a pilot draw, which is not used again."""
    wi, _ = draw(model, wo, 20_000, 7)
    wi = wi[wi[:, 2] > 0]
    theta, phi = np.arccos(wi[:, 2]), np.arctan2(wi[:, 1], wi[:, 0])
    return edges_through(theta, 0.0, np.pi / 2), edges_through(phi, -np.pi, np.pi)


def probabilities(model, wo, theta_grid, phi_grid, nodes=5):
    """The integral of ``pdf`` over each cell, (theta, phi)."""
    (theta, theta_weight), (phi, phi_weight) = (gauss_panels(edges, nodes) for edges, _ in (theta_grid, phi_grid))
    density = model.pdf(spherical(theta[:, None], phi), wo)
    assert density.shape == (theta.size, phi.size)
    mass = density * (theta_weight * np.sin(theta))[:, None] * phi_weight
    mass = np.add.reduceat(mass, theta_grid[1] * nodes, axis=0)
    return np.add.reduceat(mass, phi_grid[1] * nodes, axis=1)


def counts(wi, *grids):
    """Draws in each cell, (theta, phi); those below the surface are in none."""
    wi = wi[wi[:, 2] > 0]
    theta, phi = np.arccos(wi[:, 2]), np.arctan2(wi[:, 1], wi[:, 0])
    return np.histogram2d(theta, phi, [[*edges[starts], edges[-1]] for edges, starts in grids])[0]


def merged(observed, expected):
    """Cells with less than 10 expected draws become one; if that still has less than 10, the next larger joins."""
    order = np.argsort(expected)
    observed, expected = observed[order], expected[order]
    small = max(int(np.searchsorted(expected, 10.0)), int(np.searchsorted(np.cumsum(expected), 10.0)) + 1)
    return (np.concatenate([[part[:small].sum()], part[small:]]) for part in (observed, expected))


def chi_square(model, wo, wi, nodes=5, kinks=()):
    """p-value of draws ``wi`` under ``model.pdf``, the draws below the surface being one more cell.

    nodes: of a panel, each way. kinks: thetas at which the density is not smooth.
    """
    (theta, starts), phi_grid = grid(model, wo)
    edges = np.union1d(theta, kinks)
    grids = (edges, np.searchsorted(edges, theta[starts])), phi_grid
    mass = probabilities(model, wo, *grids, nodes)
    assert mass.shape == (CELLS, CELLS)
    below = max(1.0 - mass.sum(), 0.0)
    expected = len(wi) * np.append(mass.ravel(), below)
    observed = counts(wi, *grids)
    assert observed.shape == (CELLS, CELLS)
    observed = np.append(observed.ravel(), len(wi) - observed.sum())
    observed, expected = merged(observed, expected)
    assert expected.size > 100
    return stats.chi2.sf(np.sum((observed - expected) ** 2 / expected), expected.size - 1)
