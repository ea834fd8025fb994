# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Diffuse BSDF, and one leaning lobe of its Glossy BSDF (Beckmann).

As ``closure`` of the reference, which says why the lobe leans. L1 of f cos over all wi, of the lobe alone and in per
cent, for exponents of the same Roughness (``tools/fit_phong.py`` prints more of them):

    view in degrees               0   30   60   75   85
    Phong, n = 3                  7    7   14   28   44
    Phong, n = 30                 3    3    5   16   38
    Phong, n = 100                2    2    3    7   26
    Blinn-Phong, n = 10          10    8   10   20   28
    Blinn-Phong, n = 100          3    3    5    9   19
    Blinn-Phong, n = 1000         1    1    1    2    5
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import TYPE_CHECKING

from ..addon.reference.phong_fit import KNEE
from . import ensure, over_lambert, phong, smith_lobe
from ._tree import Value, cross, dot, greater, maximum, minimum, normalize, output, scale, select, sqrt, tangents
from .polynomial import horner2
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ._tree import Tree

NAME = "VGroove Phong Closure"
REVISION = 2
TIP = "To the material's Surface. Near the formula; toward grazing views it differs the more, the rougher it is"


def build(tree: Tree, of: phong.Lobe) -> None:
    inputs = phong.interface(tree, of)
    tree.output_shader("BSDF", closures(tree, inputs, native(tree, of, inputs)), tip=TIP)


def build_osl(tree: Tree, of: phong.Lobe) -> None:
    node = phong.script(tree, "closure", of, phong.interface(tree, of))
    tree.output_shader("BSDF", node.outputs[0], tip=TIP)


@dataclass(frozen=True)
class Native:
    """Cycles' lobe as the viewer sees it: weight, slopes across and within the plane of view, normal, tangent across.

    lambert: what Lambert carries of the lobe's light, as an albedo; 0 where it carries none.
    """

    weight: Value
    across: Value
    within: Value
    normal: Value
    tangent: Value
    lambert: Value | float


def native(tree: Tree, of: phong.Lobe, inputs: phong.Inputs) -> Native:
    """``lobes`` of the reference, and what they weigh."""
    N, wo, table = specular_normal(tree, inputs.normal), tree.geometry("Incoming"), of.table
    with tree.frame("The view"):
        c = maximum(dot(N, wo), 0.0)
        aside = wo - scale(N, c)
        s2 = dot(aside, aside)
        across = cross(N, wo)
        T = select(greater(dot(across, across), 1e-12), normalize(across), tangents(N)[0])  # head-on lobes are round
    with tree.frame("How the lobe leans, and how steep its facets are"):
        m = of.slope(inputs.n)
        slope = m * (1.0 - table.narrower * m)
        both = slope * slope * s2
        lean = 2.0 * slope * slope / (c + sqrt(c * c + 8.0 * both))
        within = slope / sqrt(1.0 + 2.0 * both / (c + 2.0 * lean * s2) ** 2)
        wide = slope
        if table.round:
            wide = minimum(slope * sqrt(1.0 + lean * lean * s2) / (c + lean * s2), 1.0)
        normal = normalize(N + scale(aside, lean))
    with tree.frame("Weights, which keep the lobe's albedo"):
        q = 0.5 * (c + sqrt(c * c + KNEE * m * m))
        weight = maximum(horner2(table.weight, q, m), 0.0)
        lambert = table.lambert and table.lambert * m**3 * maximum(horner2(table.energy, q, m), 0.0)
    return Native(weight, wide, within, normal, T, lambert)


def closures(tree: Tree, inputs: phong.Inputs, of: Native) -> NodeSocket:
    """Both added up."""
    color = inputs.albedo + inputs.specular * of.lambert if isinstance(of.lambert, Value) else inputs.albedo
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0, Normal=inputs.normal)
    lobe = over_lambert.glossy(tree, inputs.specular * of.weight, (of.across, of.within), of.normal, of.tangent)
    return tree.add_shaders([output(diffuse, "BSDF"), lobe])


def carried(tree: Tree, of: Native, wi: Value) -> tuple[Value, Value | float]:
    """What both send from wi with a white Specular Color: f cos of the lobe, and f of Lambert."""
    wo = tree.geometry("Incoming")
    node = tree.group(
        ensure(smith_lobe.NAME, smith_lobe.REVISION, smith_lobe.build), To_Light=wi, To_Viewer=wo, h=normalize(wi + wo),
        Normal=of.normal, Tangent=of.tangent, Across=of.across, Within=of.within,
    )  # fmt: skip
    return of.weight * Value(tree, node.outputs["f cos"]), of.lambert * (1.0 / pi)
