# SPDX-License-Identifier: GPL-3.0-or-later
"""D G / (4 v.n) of an anisotropic Beckmann lobe with Smith's G: ``smith_lobe`` of the reference.

Source: Heitz 2014, Understanding the Masking-Shadowing Function, JCGT 3(2), eqs. 85 to 99.
"""

from __future__ import annotations

from math import pi

from ._tree import Tree, Value, cross, dot, exp, less, maximum, sqrt

NAME = ".VGroove Smith Lobe"
REVISION = 2


def build(tree: Tree) -> None:
    wi, wo, h, n, T = (
        tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector")
        for name in ("To Light", "To Viewer", "h", "Normal", "Tangent")
    )
    ax = tree.input_float("Across", 0.3, low=1e-5, high=1.0, tip="RMS slope along the tangent")
    ay = tree.input_float("Within", 0.3, low=1e-5, high=1.0, tip="RMS slope at right angles to it")
    B = cross(n, T)
    with tree.frame("D = exp(-x^2 - y^2) / (pi ax ay cos^4), x and y the facet's slopes over the lobe's"):
        nh = maximum(dot(h, n), 1e-4)
        x, y = dot(h, T) / (nh * ax), dot(h, B) / (nh * ay)
        D = exp(-(x * x + y * y)) / (pi * ax * ay * nh**4)
    no = dot(wo, n)
    with tree.frame("G = 1 / (1 + Lambda(wi) + Lambda(wo))"):
        G = 1.0 / (1.0 + _lambda(wi, n, T, B, ax, ay) + _lambda(wo, n, T, B, ax, ay))
    lit = less(0.0 * no, no) * less(0.0 * no, dot(wi, n)) * less(0.0 * no + 1e-4, dot(h, n))
    tree.output_float("f cos", lit * D * G / (4.0 * maximum(no, 1e-7)), tip="With F = 1, in 1/sr")


def _lambda(w: Value, n: Value, T: Value, B: Value, ax: Value, ay: Value) -> Value:
    """The rational form that Cycles takes; 0 where the view is steep."""
    slope = sqrt((dot(w, T) * ax) ** 2 + (dot(w, B) * ay) ** 2) / maximum(dot(w, n), 1e-7)
    a = 1.0 / maximum(slope, 0.625)
    return (1.0 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a) * less(0.0 * slope + 0.625, slope)
