# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: Lambert, and two of Cycles' own Beckmann lobes in place of Ward's. Nothing is random.

As ``ward_fit`` of the reference: one lobe is upright, with Ward's slopes, the other leans and is narrower. Both are
stretched as those of ``anisotropic_fit``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ..addon.models.ward import MODEL
from ..addon.reference.cook_torrance_fit import NARROWEST
from ..addon.reference.ward_fit import HIGH, LOW, NARROWING_1992, coefficients
from . import anisotropic_fit, over_lambert, ward
from ._tree import Value, cross, dot, maximum, minimum, output, scale, sqrt, vector
from .polynomial import horner2
from .shading_normal import raised, specular_normal, typical_smoothing

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ._tree import Tree

    Rows = list[list[float]]

NAME = "VGroove Ward Fit"
REVISION = 2


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial, native=True)  # Cycles clamps alpha to 1
    tree.output_shader("BSDF", shader(tree, inputs), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = ward.interface(tree, kind, radial=radial, native=True)
    tree.output_shader("BSDF", shader_osl(tree, inputs), tip="To the material's Surface")


def shader(tree: Tree, inputs: ward.Inputs) -> NodeSocket:
    """Lambert, and the lobes about the normal, raised where it has to be."""

    def about(N: Value) -> NodeSocket:
        T = inputs.tangent_to(N)
        narrowed, share = effective(tree, inputs, N, T)
        found = anisotropic_fit.lobes(tree, narrowed.m, narrowed.anisotropy, N, T, TABLES[inputs.kind])
        return tree.add_shaders([
            over_lambert.glossy(tree, inputs.specular * (lobe.weight * share), lobe.slopes, lobe.normal, lobe.tangent)
            for lobe in found
        ])  # fmt: skip

    color = inputs.albedo * typical_smoothing(tree, inputs.normal)  # Cycles' own is off, as lobes lean
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0, Normal=inputs.normal)
    return tree.add_shaders([output(diffuse, "BSDF"), raised(tree, inputs.normal, about)])


def shader_osl(tree: Tree, inputs: ward.Inputs) -> NodeSocket:
    """The same from a script."""
    return ward.script(tree, "fit", inputs, **for_script(tree, inputs)).outputs[0]


def for_script(tree: Tree, inputs: ward.Inputs) -> dict[str, Value]:
    """The lobes as parameters of the OSL shaders."""
    narrowed, share = effective(tree, inputs, specular_normal(tree, inputs.normal), inputs.T)
    found = anisotropic_fit.for_script(tree, narrowed, TABLES[inputs.kind])
    return found | {"weight": scale(found["weight"], share)}


def effective(tree: Tree, inputs: ward.Inputs, N: Value, T: Value) -> tuple[ward.Inputs, Value]:
    """The same with the slopes of the lobe itself, as the viewer sees it, and what it weighs then.

    ``effective`` and ``narrowing`` of the reference.
    """
    along, across = inputs.m / inputs.aspect, inputs.m * inputs.aspect
    with tree.frame("Narrowing, and the slopes that it leaves"):
        narrowing: Value | float = NARROWING_1992
        if inputs.kind == "bounded":
            wo = tree.geometry("Incoming")
            x, y, c = along * dot(T, wo), across * dot(cross(N, T), wo), maximum(dot(N, wo), 0.0)
            seen = sqrt(x * x + y * y + inputs.m * inputs.m * c * c)
            narrowing = 1.0 - seen * (1.0 - c) / (c + seen)
        along, across = (m / sqrt(1.0 + narrowing * m * m) for m in (along, across))
        both = along * across
        anisotropy = maximum((1.0 - across / along) / (1.0 - NARROWEST), 0.0)
    return replace(inputs, m=sqrt(both), anisotropy=anisotropy), both / (inputs.m * inputs.m)


def _table(kind: str) -> anisotropic_fit.Table:
    first, second, roughness, anisotropy, lean = coefficients()[kind].tolist()
    none = [[0.0] * len(row) for row in first]
    low, high = LOW.tolist(), HIGH.tolist()

    def look_up(tree: Tree, m: Value, N: Value) -> tuple[Value, Value, list[Value]]:
        with tree.frame("u = m (1 - c)/(c + m): 0 head-on, 1 at grazing"):
            c = maximum(dot(N, tree.geometry("Incoming")), 0.0)
            u = m * (1.0 - c) / (c + m)
        with tree.frame("Weights"):
            weight = horner2(_triples(first, second, none), u, m)
            weight = minimum(maximum(weight, (low[0], low[1], 0.0)), (high[0], high[1], 0.0))
            if kind == "ward_1992":
                weight = scale(weight, c + 0.5 * m)
        with tree.frame("Roughness, anisotropy and tilt of the second lobe"):
            root, shape = sqrt(m), horner2(_triples(roughness, anisotropy, lean), u, m)
            most = minimum(0.9 * c / (m * (1.0 - 0.1 * c * c)), high[4])
            held = minimum(maximum(shape, (low[2], low[3], low[4])), vector(high[2], high[3], most))
            second_lobe = held * vector(root, 1.0, m)
        return weight, root, [second_lobe]

    label = f".VGroove Ward {MODEL.kinds[kind]}".rstrip()
    return anisotropic_fit.Table(f"{label} Fit", REVISION, look_up)


def _triples(a: Rows, b: Rows, c: Rows) -> list[list[tuple[float, float, float]]]:
    """[j][k] of three numbers, from three times [j][k]."""
    return [list(zip(*rows, strict=True)) for rows in zip(a, b, c, strict=True)]


TABLES = {kind: _table(kind) for kind in MODEL.kinds}
