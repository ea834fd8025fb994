# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren-Nayar 1994: V-grooves whose facets are Lambertian; the BRDF as a group, and what its estimators share.

Source: Oren & Nayar 1994, eqs. 27 to 30; ``addon/reference/oren_nayar.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from math import pi
from typing import TYPE_CHECKING, Any

from ..addon.models import PLAIN
from ..addon.models.oren_nayar import ALBEDO, MODEL, SIGMA
from . import ensure, osl_script, shading_normal
from ._tree import Tree, Value, absolute, dot, greater, length, less, maximum, minimum, scale, select
from .parameters import add_input

if TYPE_CHECKING:
    from bpy.types import Node

    from ..addon.models import Form
    from ._tree import Number

NAME = ".VGroove Oren-Nayar"
REVISION = 4
LABELS = MODEL.kinds
KINDS = tuple(LABELS)


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: albedo, sigma, and the normal as linked (or not)."""

    albedo: Value
    sigma: Value
    normal: Value


def interface(tree: Tree) -> Inputs:
    """Base Color; Roughness; Normal. The same for every estimator and backend."""
    return Inputs(add_input(tree, ALBEDO), add_input(tree, SIGMA), shading_normal.interface(tree))


def script(tree: Tree, estimator: str, kind: str, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``oren_nayar_ESTIMATOR`` fed by these inputs."""
    return osl_script.script(
        tree,
        f"oren_nayar_{estimator}",
        kind=KINDS.index(kind),
        albedo=inputs.albedo,
        sigma=inputs.sigma,
        Normal=inputs.normal,
        **more,
    )


def brdf(tree: Tree, kind: str, inputs: Inputs, N: Value, wi: Value, wo: Value) -> Value:
    """f(wi, wo) in 1/sr through the nested group of ``kind``."""
    group = ensure(f"{NAME} {LABELS[kind]}", REVISION, partial(build, kind=kind))
    node = tree.group(group, To_Light=wi, To_Viewer=wo, N=N, Base_Color=inputs.albedo, Sigma=inputs.sigma)
    return Value(tree, node.outputs["f"])


def build(tree: Tree, kind: str) -> None:
    wi, wo, N = (
        tree.input_vector(name, (0, 0, 1), low=-1.0, high=1.0, tip="Unit vector away from the surface")
        for name in ("To Light", "To Viewer", "N")
    )
    plain = replace(SIGMA, label=SIGMA.symbol, subtype="ANGLE", scale=PLAIN)
    albedo, sigma = add_input(tree, ALBEDO), add_input(tree, plain)
    with tree.frame("Cosines and sines of theta_i and theta_o"):
        light, view = dot(N, wi), dot(N, wo)
        lit = greater(light, 0.0)  # a map may turn N away from the viewer, which is then a grazing view
        ni, no = maximum(light, 1e-7), maximum(view, 1e-7)
        across_i, across_o = wi - scale(N, light), wo - scale(N, view)  # sin by components: 1 - ni * ni cancels
        sin_i, sin_o = length(across_i), length(across_o)
    with tree.frame("cos(phi_i - phi_o)"):
        # Along the normal 0 / 0 reads 0 in Cycles; b is 0 there and every factor of cos p vanishes with it.
        cos_p = minimum(maximum(dot(across_i, across_o) / (sin_i * sin_o), -1.0), 1.0)
    s2 = sigma * sigma
    shape = _qualitative if kind == "qualitative" else _full
    bounces = shape(albedo, s2, ni, no, sin_i, sin_o, cos_p)
    tree.output_color("f", albedo * bounces * (lit / pi), tip="The BRDF in 1/sr; 0 below the surface")


def _qualitative(_albedo: Value, s2: Value, ni: Value, no: Value, sin_i: Value, sin_o: Value, cos_p: Value) -> Value:
    with s2.tree.frame("C1 + max(0, cos p) C2 sin a tan b"):
        slope = 0.45 * s2 / (s2 + 0.09)
        tan_b = minimum(sin_i, sin_o) / maximum(ni, no)
        return C1(s2) + maximum(cos_p, 0.0) * slope * maximum(sin_i, sin_o) * tan_b


def _full(albedo: Value, s2: Value, ni: Value, no: Value, sin_i: Value, sin_o: Value, cos_p: Value) -> Value:
    tree = s2.tree
    with tree.frame("1 - 2a/pi and 1 - 2b/pi by elevations, which keep their digits at grazing angles"):
        cos_a, sin_a = minimum(ni, no), maximum(sin_i, sin_o)
        cos_b, sin_b = maximum(ni, no), minimum(sin_i, sin_o)
        x, y = _elevation(cos_a, sin_a), _elevation(cos_b, sin_b)
    with tree.frame("C1 + cos p C2 tan b + (1 - |cos p|) C3 tan((a + b)/2)"):
        facing = s2 / (s2 + 0.09)
        behind = y * (3.0 - y * (3.0 - y)) - cos_a * cos_a / (1.0 + sin_a)  # sin a - (2b/pi)^3
        C2 = 0.45 * facing * select(less(cos_p, 0.0), behind, sin_a)
        C3 = 0.125 * facing * ((1.0 - x) * (1.0 - y)) ** 2
        between = (sin_i + sin_o) / (ni + no)
        once = C1(s2) + cos_p * C2 * (sin_b / cos_b) + (1.0 - absolute(cos_p)) * C3 * between
    with tree.frame("Interreflection"):
        twice = 0.17 * s2 / (s2 + 0.13) * (1.0 - cos_p * (1.0 - y) ** 2)
        return maximum(once + albedo * twice, 0.0)  # the fit dips below 0 where both directions graze


def C1(s2: Value) -> Value:
    """1 - 0.5 s2/(s2 + 0.33)."""
    return 1.0 - 0.5 * s2 / (s2 + 0.33)


def _elevation(cos: Value, sin: Value) -> Value:
    """2/pi of the angle above the horizon, whose half has the tangent cos/(1 + sin)."""
    return 4.0 / pi * cos.tree.math("ARCTANGENT", cos / (1.0 + sin))


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    return LABELS[form.kind], {"kind": form.kind}
