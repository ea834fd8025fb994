# SPDX-License-Identifier: GPL-3.0-or-later
"""How ``fit`` of Ashikhmin & Shirley's model shapes its Beckmann lobe for a view: ``shape`` of the reference."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..addon.reference import ashikhmin_shirley_fit as fit
from ..addon.reference.cook_torrance_fit import NARROWEST
from . import ensure
from ._tree import Value, clamp, cross, dot, hold, maximum, minimum, scale, sqrt
from .polynomial import horner2
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from . import ashikhmin_shirley as model
    from ._tree import Number, Tree

NAME = ".VGroove Ashikhmin Shape"
REVISION = 2
LEAST = 1e-5  # along B, for axes that are B itself, of which rounding leaves nothing


@dataclass(frozen=True)
class Shape:
    """The Beckmann lobe as the view sees it, as Metallic BSDF takes it; ``Shape`` of the reference."""

    weight: Value
    more: Value
    flat: Value
    rise: Value
    mean: Value
    roughness: Value
    anisotropy: Value
    tangent: Value

    @property
    def parameters(self) -> dict[str, Number]:
        """Of OSL shaders."""
        lobe = {"roughness": self.roughness, "lean": self.anisotropy, "axis": self.tangent}
        return {name: getattr(self, name) for name in ("weight", "more", "flat", "rise", "mean")} | lobe

    @property
    def slopes(self) -> tuple[Value, Value]:
        """Along the tangent and across it, as Cycles makes them."""
        square, aspect = self.roughness**2, sqrt(1.0 - (1.0 - NARROWEST) * self.anisotropy)
        return minimum(square / aspect, 1.0), minimum(square * aspect, 1.0)


def shape(tree: Tree, inputs: model.Inputs) -> Shape:
    """Through the nested group."""
    N = specular_normal(tree, inputs.normal)
    n_u, n_v = inputs.exponents
    group = ensure(NAME, REVISION, build)
    node = tree.group(group, N=N, T=inputs.turned_tangent(N), Along=n_u, Across=n_v)
    return Shape(**{socket.name.lower(): Value(tree, socket) for socket in node.outputs})


def _rows(names: Sequence[str]) -> list[list[tuple[float, float, float]]]:
    """[j][k] of up to three functions, one component each; 0 in those that are none's."""
    functions = [fit.table()[name].tolist() for name in names]
    nothing = [[[0.0] * len(row) for row in functions[0]]] * (3 - len(functions))
    return [list(zip(*rows, strict=True)) for rows in zip(*functions, *nothing, strict=True)]


def build(tree: Tree) -> None:
    """In units of m_u m_v, the product of both slopes, so that float32 keeps the narrowest."""
    N, T = (tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("N", "T"))
    n_u, n_v = (
        tree.input_float(name, 100.0, low=0.0, high=1e7, tip=f"Exponent {where}")
        for name, where in (("Along", "along the tangent"), ("Across", "across it"))
    )
    wo, B = tree.geometry("Incoming"), cross(N, T)
    with tree.frame("Slopes"):
        U = sqrt((n_v + 2.0) / (n_u + 2.0))
        V, unit = 1.0 / U, 2.0 / sqrt((n_u + 2.0) * (n_v + 2.0))
    with tree.frame("The view"):
        x, y, z = dot(T, wo), dot(B, wo), maximum(dot(N, wo), 1e-7)
        d2 = maximum(tree.fused(U * x, x, V * y * y), 1e-14)
        w = sqrt(unit * d2)
        at, m = w / (w + z), minimum(sqrt(unit * tree.fused(z, z, d2)), 1.0)
    with tree.frame("How it narrows, and what each closure sends"):
        first, second = (horner2(_rows(names), at, m).xyz for names in (fit.NAMES[:3], fit.NAMES[3:]))
        k, weight, more, flat, mean, _ = *first, *second
        k, weight = hold(tree.fused(at, k, 1.0), 0.1, 1.0), maximum(tree.fused(at, weight, 1.0), 0.0)
        fallen = 1.0 - minimum(z, 1.0)
        rise, mean = fallen**5, clamp(tree.fused(m, mean, fallen)) ** 5
        more, flat = clamp(rise * (at * more)), clamp(tree.fused(at, flat, 1.0))
    with tree.frame("Squares of its slopes"):
        lost = (1.0 - k * k) / d2
        Ux, Vy = U * x, V * y
        xx, yy, xy = U - lost * Ux * Ux, V - lost * Vy * Vy, -1.0 * (lost * x * y)
        half = 0.5 * (xx - yy)
        root = sqrt(tree.fused(half, half, xy * xy))
    with tree.frame("As Metallic BSDF takes it"):
        ratio = k / (0.5 * (xx + yy) + root)
        anisotropy = minimum(tree.fused(ratio, -1.0 / (1.0 - NARROWEST), 1.0 / (1.0 - NARROWEST)), 1.0)
        axis = scale(T, half + root) + scale(B, xy + LEAST)
    for name, value in {
        "Weight": weight, "More": more, "Flat": flat, "Rise": rise, "Mean": mean,
        "Roughness": sqrt(sqrt(unit * k)), "Anisotropy": anisotropy,
    }.items():  # fmt: skip
        tree.output_float(name, value, tip="As of the reference")
    tree.output_vector("Tangent", axis, tip="Of the wider slope, not of length 1")
