# SPDX-License-Identifier: GPL-3.0-or-later
"""What the stretched mixture of ``fit`` sends from wi to the viewer, f cos with F = 1: ``mixture`` of the reference."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from . import anisotropic_fit, ensure, smith_lobe
from ._tree import Tree, Value, dot, normalize, scale
from .anisotropic_fit import VGROOVE, Table

if TYPE_CHECKING:
    from . import anisotropic
    from ._tree import Number


def build(tree: Tree, table: Table) -> None:
    wi, h, N, T = (
        tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("To Light", "h", "N", "T")
    )
    m = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    anisotropy = tree.input_float("Anisotropy", 0.5, low=0.0, high=1.0, tip="As of Metallic BSDF")
    group = ensure(smith_lobe.NAME, smith_lobe.REVISION, smith_lobe.build)
    total: Number = 0.0
    for lobe in anisotropic_fit.lobes(tree, m, anisotropy, N, T, table):
        wide, narrow = lobe.slopes
        normal = normalize(lobe.normal)
        along = normalize(lobe.tangent - scale(normal, dot(normal, lobe.tangent)))
        node = tree.group(
            group, To_Light=wi, To_Viewer=tree.geometry("Incoming"), h=h, Normal=normal, Tangent=along,
            Across=wide, Within=narrow,
        )  # fmt: skip
        total = lobe.weight * Value(tree, node.outputs["f cos"]) + total
    tree.output_float("f cos", total, tip="In 1/sr")


def fit_mixture(tree: Tree, wi: Value, h: Value, N: Value, inputs: anisotropic.Inputs, table: Table = VGROOVE) -> Value:
    """f cos of the mixture with F = 1 through the nested group."""
    given = {"N": N, "T": inputs.T, "m": inputs.m, "Anisotropy": inputs.anisotropy}
    group = ensure(f"{table.name} Mixture", table.revision, partial(build, table=table))
    node = tree.group(group, To_Light=wi, h=h, **given)
    return Value(tree, node.outputs["f cos"])
