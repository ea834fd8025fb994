# SPDX-License-Identifier: GPL-3.0-or-later
"""What the mixture of ``fit`` sends from wi to the viewer, f cos with F = 1: ``mixture`` of the reference."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import cook_torrance_fit, ensure, smith_lobe
from ._tree import Tree, Value, cross, dot, less, normalize, select, tangents

if TYPE_CHECKING:
    from ._tree import Number

NAME = ".VGroove Fit Mixture"
REVISION = 5


def build(tree: Tree) -> None:
    wi, h, N = (
        tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("To Light", "h", "N")
    )
    m = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    mixture = cook_torrance_fit.lobes(tree, m, N)
    with tree.frame("Across the plane of view; head-on any tangent will do, as lobes are round"):
        across = cross(N, tree.geometry("Incoming"))
        T = select(less(1e-12 + 0.0 * m, dot(across, across)), normalize(across), tangents(N)[0])
    group = ensure(smith_lobe.NAME, smith_lobe.REVISION, smith_lobe.build)
    total: Number = 0.0
    for lobe in mixture:
        wide, narrow = lobe.slopes
        node = tree.group(
            group, To_Light=wi, To_Viewer=tree.geometry("Incoming"), h=h, Normal=normalize(lobe.normal), Tangent=T,
            Across=wide, Within=narrow,
        )  # fmt: skip
        total = lobe.weight * Value(tree, node.outputs["f cos"]) + total
    tree.output_float("f cos", total, tip="In 1/sr")


def fit_mixture(tree: Tree, wi: Value, h: Value, N: Value, m: Value) -> Value:
    """f cos of the mixture with F = 1 through the nested group."""
    node = tree.group(ensure(NAME, REVISION, build), To_Light=wi, h=h, N=N, m=m)
    return Value(tree, node.outputs["f cos"])
