# SPDX-License-Identifier: GPL-3.0-or-later
"""Beckmann's density of facet normals: D = exp(-tan^2(t) / m^2) / (pi m^2 cos^4(t)), t between h and N."""

from math import pi

from ._tree import Tree, dot, exp, less, maximum, scale

NAME = ".VGroove Beckmann D"
REVISION = 2


def build(tree: Tree) -> None:
    h = tree.input_vector("h", (0, 0, 1), tip="Facet normal, unit length")
    N = tree.input_vector("N", (0, 0, 1), tip="Surface normal, unit length")
    m = tree.input_float("Slope m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    with tree.frame("tan^2 by components: 1 - (n.h)^2 would cancel in float32"):
        nh = maximum(dot(N, h), 1e-4)  # lower facets have exp(-1e8/m^2) = 0, and 1/cos^4 must not overflow
        tangential = h - scale(N, nh)
        tan2 = dot(tangential, tangential) / (nh * nh)
    with tree.frame("Walter et al. 2007, eq. 25"):
        m2 = m * m
        D = exp(-(tan2 / m2)) / (pi * m2 * nh**4)
    tree.output_float("D", D * less(0.0 * nh, dot(N, h)), tip="Facet density in 1/sr")
