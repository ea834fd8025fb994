# SPDX-License-Identifier: GPL-3.0-or-later
"""Beckmann's D with slopes m_x along the tangent, m_y across: exp(-(x/m_x)^2 - (y/m_y)^2) / (pi m_x m_y cos^4(t))."""

from math import pi

from ._tree import Tree, cross, dot, exp, less, maximum

NAME = ".VGroove Anisotropic D"
REVISION = 2


def build(tree: Tree) -> None:
    h, N, T = (
        tree.input_vector(name, (0, 0, 1), tip=f"{what}, unit length")
        for name, what in (("h", "Facet normal"), ("N", "Surface normal"), ("T", "Tangent"))
    )
    mx, my = (
        tree.input_float(name, 0.3, low=1e-5, high=100.0, tip=f"RMS slope {where}")
        for name, where in (("Along", "along the tangent"), ("Across", "across it"))
    )
    with tree.frame("A facet's slopes, over the surface's"):
        nh = maximum(dot(N, h), 1e-4)  # lower facets have exp(-1e8/m^2) = 0, and 1/cos^4 must not overflow
        x, y = dot(T, h) / (nh * mx), dot(cross(N, T), h) / (nh * my)
    with tree.frame("Heitz 2014, eq. 80"):
        D = exp(-(x * x + y * y)) / (pi * mx * my * nh**4)
    tree.output_float("D", D * less(0.0 * nh, dot(N, h)), tip="Facet density in 1/sr")
