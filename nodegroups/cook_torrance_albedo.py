# SPDX-License-Identifier: GPL-3.0-or-later
"""Directional albedo of Cook-Torrance from three facets, as ``cook_torrance_albedo`` of the reference."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ..addon.reference.cook_torrance_albedo import table
from . import ensure, fresnel
from ._tree import Tree, Value, clamp, dot, maximum, minimum
from .cook_torrance_fit import grazing
from .polynomial import horner2

if TYPE_CHECKING:
    from . import cook_torrance

NAME = ".VGroove Albedo Facets"
REVISION = 2
KIND_NAME = ".VGroove Albedo"
KIND_REVISION = 1


def build(tree: Tree) -> None:
    slope = tree.input_float("m", 0.3, low=0.0, high=1.0, tip="RMS slope of the facets")
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    m = clamp(slope)
    x, _ = grazing(tree, m, N)
    with tree.frame("Three facets by the table, one component each"):
        y, n = 2.0 * x - 1.0, 2.0 * m - 1.0
        cosine, weight = (horner2(_rows(name), y, n) for name in ("cosine", "weight"))
        cosine = clamp(dot(N, tree.geometry("Incoming")) + m * cosine)
    tree.output_vector("Cosine", cosine, tip="v.h of each facet")
    tree.output_vector("Weight", maximum(weight, 0.0), tip="Of each facet")


def _rows(name: str) -> list[list[tuple[float, float, float]]]:
    """Coefficients [j][k] of y^j n^k, one component per facet."""
    first, second, third = table()[name].tolist()
    return [[(a, b, c) for a, b, c in zip(*rows, strict=True)] for rows in zip(first, second, third, strict=True)]


def directional_albedo(tree: Tree, kind: str, inputs: cook_torrance.Inputs, N: Value) -> Value:
    """E(wo) of the view direction, a share in [0, 1]; of a coloured F its largest channel."""
    E = albedo(tree, kind, inputs, N)
    with tree.frame("At most 1, of all channels"):
        if E.is_vector:
            r, g, b = E.xyz
            E = maximum(maximum(r, g), b)
        return minimum(E, 1.0)


def albedo(tree: Tree, kind: str, inputs: cook_torrance.Inputs, N: Value) -> Value:
    """E(wo) of the view direction, of a coloured F by channel, up to the fit's error above 1.

    E = sum_j weight_j F(cosine_j) over three facets, fitted to the integral of f cos(theta_i) over the hemisphere.
    """
    group = ensure(f"{KIND_NAME} {kind.title()}", KIND_REVISION, partial(build_kind, kind=kind))
    return Value(tree, tree.group(group, **fresnel.nested(inputs.fresnel, kind), m=inputs.m, N=N).outputs["E"])


def build_kind(tree: Tree, kind: str) -> None:
    terms = fresnel.held(tree, kind)
    m = tree.input_float("m", 0.3, low=0.0, high=10.0, tip="RMS slope of the facets")
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    node = tree.group(ensure(NAME, REVISION, build), m=m, N=N)
    cosines, weights = (Value(tree, node.outputs[name]).xyz for name in ("Cosine", "Weight"))
    with tree.frame("Sum of weight F over three facets"):
        F = [fresnel.reflectance(tree, kind, terms, cosine) for cosine in cosines]
        E = F[0] * weights[0] + F[1] * weights[1] + F[2] * weights[2]
    (tree.output_vector if E.is_vector else tree.output_float)("E", E, tip="Directional albedo, up to the fit's error")
