# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Diffuse BSDF, at the roughness that is nearest to sigma.

It is Fujii's model, and it returns what single scattering loses, which the 1994 model does not: rough surfaces come
out brighter. L1 of f cos over all wi, worst of all views and of albedos up to 0.8, in per cent
(``tools/fit_oren_nayar.py`` prints it by view):

    sigma          6     17     34     57     90 degrees
    full           1      6     16     29     39
    qualitative    1     10     30     52     68
"""

from __future__ import annotations

from . import oren_nayar
from ._tree import Tree, Value, less, minimum, select
from .oren_nayar_table import LAMBERT, TABLES

NAME = "VGroove Oren-Nayar Closure"
REVISION = 3
TIP = "To the material's Surface. Cycles' own model: off by up to {} at 34 degrees of Sigma, {} at 90"
OFF = {"full": ("16 %", "39 %"), "qualitative": ("30 %", "68 %")}


def build(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    diffuse = tree.node("ShaderNodeBsdfDiffuse", inputs.albedo, roughness(kind, inputs.sigma))
    tree.connect(inputs.normal, diffuse.inputs["Normal"])
    tree.output_shader("BSDF", diffuse.outputs["BSDF"], tip=TIP.format(*OFF[kind]))


def build_osl(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    node = oren_nayar.script(tree, "closure", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip=TIP.format(*OFF[kind]))


def roughness(kind: str, sigma: Value) -> Value:
    """``closure_roughness`` of the reference."""
    k, c = TABLES[kind].roughness
    with sigma.tree.frame("Roughness k s2/(s2 + c), 0 where Cycles would divide by 0"):
        s2 = sigma * sigma
        found = minimum(k * s2 / (s2 + c), 1.0)
        return select(less(found, LAMBERT), 0.0, found)
