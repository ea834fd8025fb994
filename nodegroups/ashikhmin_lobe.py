# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin & Shirley's highlight without F: p(h) min(1, (n.l)/(n.v)) / (4 v.h), which is f cos.

p(h) = sqrt((n_u + 1)(n_v + 1)) / (2 pi) (n.h)^(n_u cos^2 + n_v sin^2) as ``density`` of the reference: by the facet's
slopes, as neither the cosine nor the ratio of the exponents has digits near the normal.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from ._tree import cross, dot, exp, length, less, log, maximum, minimum, normalize, select, sqrt

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Ashikhmin Lobe"
REVISION = 2


def build(tree: Tree) -> None:
    wi, N, T = (
        tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("To Light", "N", "T")
    )
    n_u, n_v = (
        tree.input_float(name, 100.0, low=0.0, high=1e7, tip=f"Exponent {where}")
        for name, where in (("Along", "along the tangent"), ("Across", "across it"))
    )
    wo = tree.geometry("Incoming")
    with tree.frame("The facet's slopes"):
        both = wi + wo
        h, vh = normalize(both), 0.5 * length(both)  # dot(wo, h) would lose a hundredfold at grazing angles
        nh = maximum(dot(N, h), 1e-4)
        x, y = dot(T, h) / nh, dot(cross(N, T), h) / nh
    with tree.frame("log(1 + t^2) / t^2, by a series where 1 + t^2 would round: z = t^2 / (2 + t^2)"):
        t2 = x * x + y * y
        z = t2 / (2.0 + t2)
        z2 = z * z
        small = (2.0 + z2 * (2.0 / 3.0 + z2 * 0.4)) / (2.0 + t2)
        flat = select(less(t2, 0.1), small, log(1.0 + t2) / maximum(t2, 0.1))
    with tree.frame("p(h) / (4 v.h)"):
        power = exp((n_u * x * x + n_v * y * y) * flat * -0.5)
        lobe = sqrt((n_u + 1.0) * (n_v + 1.0)) * power / (8.0 * pi * maximum(vh, 1e-7))
    with tree.frame("0 unless both are above the surface"):
        ni, no = dot(N, wi), dot(N, wo)
        seen = minimum(maximum(ni, 0.0) / maximum(no, 1e-7), 1.0) * less(0.0 * no, no)
    tree.output_float("f cos", lobe * seen, tip="With F = 1, in 1/sr")
    tree.output_float("v.h", vh, tip="Cosine of the view at the facet")
