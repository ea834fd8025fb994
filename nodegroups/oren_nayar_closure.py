# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Diffuse BSDF, at the roughness that is nearest to sigma.

It is Fujii's model, and it returns what single scattering loses, which the 1994 model does not: rough surfaces come
out brighter. L1 of f cos over all wi, worst of all views and of albedos up to 0.8, in per cent
(``tools/fit_oren_nayar.py`` prints it by view):

    sigma          6     17     34     57     90 degrees
    full           1      6     16     29     39
    qualitative    1     10     30     52     68
    from Blender 5.3 on
    full           1      6     17     30     41
    qualitative    1     11     32     56     73
"""

from __future__ import annotations

from ..addon.reference import cycles
from . import oren_nayar
from ._tree import Tree, Value, greater, minimum, output
from .oren_nayar_table import LAMBERT, table

NAME = "VGroove Oren-Nayar Closure"
REVISION = 5
TIP = "To the material's Surface. Cycles' own model: off by up to {} at a Roughness of 0.65, {} at 1"
OFF = {
    cycles.UNTIL_5_2: {"full": ("16 %", "39 %"), "qualitative": ("30 %", "68 %")},
    cycles.SINCE_5_3: {"full": ("17 %", "41 %"), "qualitative": ("32 %", "73 %")},
}


def build(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    r = roughness(kind, inputs.sigma)
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=inputs.albedo, Roughness=r, Normal=inputs.normal)
    tree.output_shader("BSDF", output(diffuse, "BSDF"), tip=TIP.format(*OFF[cycles.version()][kind]))


def build_osl(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    node = oren_nayar.script(tree, "closure", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip=TIP.format(*OFF[cycles.version()][kind]))


def roughness(kind: str, sigma: Value) -> Value:
    """``closure_roughness`` of the reference."""
    k, c = table(kind).roughness
    with sigma.tree.frame("Roughness k s2/(s2 + c), 0 where Cycles would divide by 0"):
        s2 = sigma * sigma
        found = minimum(k * s2 / (s2 + c), 1.0)
        return found * greater(found, LAMBERT)
