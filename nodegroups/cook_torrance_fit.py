# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: the V-groove model as a fixed mixture of Cycles' own Beckmann lobes. Nothing is random.

Weights, slopes and tilts as in ``cook_torrance_fit`` of the reference, from the same table. Whatever depends on m
alone is folded by Cycles into constants, unless m is textured.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..addon.reference.cook_torrance_fit import ALONE, FUNCTIONS, HALF_CLIPPED, MOST_LEAN, NARROWEST
from . import cook_torrance, ensure
from . import cook_torrance_closure as closure
from ._tree import Tree, Value, cross, dot, exp, length, maximum, minimum, scale, sqrt
from .cook_torrance_table import by_lobe, count, shared
from .cook_torrance_table import share as of_share
from .polynomial import chebyshev, series2
from .polynomial import share as share_by_table
from .shading_normal import raised

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import NodeSocket

    from ._tree import Number

NAME = "VGroove Cook-Torrance Fit"
REVISION = 6
LOBES_NAME = "VGroove Fit Lobes"


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=1.0)  # Cycles clamps alpha to 1
    tree.output_shader("BSDF", shader(tree, kind, inputs), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=1.0)
    node = cook_torrance.script(tree, "fit", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")


def shader(tree: Tree, kind: str, inputs: cook_torrance.Inputs) -> NodeSocket:
    """The mixture about the normal, raised where it has to be."""
    return raised(tree, inputs.normal, lambda N: mixture(tree, kind, inputs, N))


def mixture(tree: Tree, kind: str, inputs: cook_torrance.Inputs, N: Value) -> NodeSocket:
    """One Metallic BSDF a lobe, which makes the lobe's normal a unit vector itself."""
    of = lobes(tree, inputs.m, N)
    with tree.frame("Roughness^4 = across^2 aspect: Metallic BSDF's slopes are roughness^2 times aspect^(+-1/2)"):
        fourth = scale(of.aspect, of.across**2).xyz
    shaders = []
    for lobe, power in zip(of.lobes, fourth, strict=False):
        with tree.frame("Lobe"):
            roughness = sqrt(sqrt(power))
            native = closure.lobe(tree, kind, inputs.fresnel, roughness, lobe.normal, lobe.anisotropy, of.tangent)
            shaders.append(tree.weighted(native, lobe.weight))  # which holds the weight to 0..1
    return tree.add_shaders(shaders)


@dataclass(frozen=True)
class Lobe:
    """One lobe of the mixture; its weight not yet held to 0..1, its normal not yet of length 1."""

    weight: Value
    anisotropy: Value
    normal: Value


@dataclass(frozen=True)
class Mixture:
    """The lobes as seen from the viewer, and what they share: slope ``across`` the plane of view, along ``tangent``.

    ``aspect``: of each lobe the slope within the plane of view over that across.
    """

    lobes: list[Lobe]
    aspect: Value
    across: Value
    tangent: Value


def lobes(tree: Tree, m: Value, N: Value) -> Mixture:
    """The mixture through the nested group that holds the table."""
    node = tree.group(ensure(LOBES_NAME, REVISION, build_lobes), m=m, N=N)
    outputs = {output.name: Value(tree, output) for output in node.outputs}
    weights, anisotropies = (outputs[name].xyz for name in ("Weight", "Anisotropy"))
    each = [Lobe(weights[k], anisotropies[k], outputs[f"Normal {k + 1}"]) for k in range(count())]
    with tree.frame("Aspect of each lobe, as Cycles' Metallic BSDF has it"):
        aspect = tree.math("MULTIPLY_ADD", outputs["Anisotropy"], NARROWEST - 1.0, 1.0)
    return Mixture(each, aspect, outputs["Across"], outputs["Tangent"])


def build_lobes(tree: Tree) -> None:
    """Each shading runs all of this that is not constant, so it is laid out for few nodes.

    Numbers are linked to vectors as they are: Cycles then takes one step, for Combine XYZ three.
    """
    slope = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    wo = tree.geometry("Incoming")
    m = minimum(slope, 1.0)
    x, aside = grazing(tree, m, N)
    g = clipped_share(tree, m, N, aside)
    with tree.frame("The table's polynomials, one component a lobe"):
        y, n = (tree.math("MULTIPLY_ADD", v, (2.0, 2.0, 2.0), (-1.0, -1.0, -1.0)) for v in (x, m))
        functions = [*map(by_lobe, FUNCTIONS[:3]), shared("across")]
        weight, anisotropy, tilt, across = table(y, n, *functions)
        weight = tree.math("MULTIPLY_ADD", g, weight, (ALONE, 0.0, 0.0))
        widened = minimum(m * tree.math("MULTIPLY_ADD", g, across.xyz[0], 1.0), 1.0)
    with tree.frame("Normals that lean away from the viewer"):
        lean, most = scale(aside, tree.math("MULTIPLY_ADD", x, -m, m)), MOST_LEAN / maximum(x * length(aside), 0.01)
        normals = [N - scale(lean, part) for part in minimum(g * tilt, most).xyz]
    tree.output_vector("Weight", weight, tip="Of each lobe, not yet held to 0..1")
    tip = "How much narrower each lobe is within the plane of view: slope across times 1 - 0.9 of this"
    tree.output_vector("Anisotropy", minimum(maximum(scale(anisotropy, x * g), 0.0), 1.0), tip=tip)
    tree.output_float("Across", widened, tip="RMS slope across the plane of view, of all lobes")
    for k in range(count()):
        tree.output_vector(f"Normal {k + 1}", normals[k], tip="The lobe's own normal, not yet of length 1")
    tree.output_vector("Tangent", cross(N, wo), tip="Across the plane of view")


def table(y: Value, n: Value, *functions: Sequence[Sequence[Number]]) -> list[Value]:
    """Each function's polynomial at (y, n)."""
    rows, columns = max(map(len, functions)), max(len(row) for rows in functions for row in rows)
    U_y, U_n = chebyshev(y, rows - 1), chebyshev(n, columns - 1)
    return [series2(of, U_y[: len(of) - 1], U_n) for of in functions]


def grazing(tree: Tree, m: Value, N: Value) -> tuple[Value, Value]:
    """x = m s / (c + m s), 0 head-on and 1 at grazing, and the view's part along the surface, of length s."""
    wo = tree.geometry("Incoming")
    with tree.frame("x = m s / (c + m s): 0 head-on, 1 at grazing"):
        c = dot(N, wo)
        aside = wo - scale(N, c)
        ms = m * length(aside)
        return ms / (maximum(c, 0.0) + ms), aside


def clipped_share(tree: Tree, m: Value, N: Value, aside: Value) -> Value:
    """How far the polynomials count: little where the V-groove clips next to no facet."""
    with tree.frame("Share of facets that the V-groove clips"):
        c = maximum(dot(N, tree.geometry("Incoming")), 0.0)
        steepest = c / tree.math("MULTIPLY_ADD", length(aside), 3.0 - 3.0**0.5, 3.0**0.5)
        q = exp(steepest * steepest * (-1.0 / (m * m)))
        return q / (q + HALF_CLIPPED)


def share(tree: Tree, slope: Value, N: Value, bound: Value) -> Value:
    """c of ``hybrid_share``: how much of the mixture stays below the model but for ``bound`` of the albedo."""
    m = minimum(slope, 1.0)
    x, _ = grazing(tree, m, N)
    with tree.frame("Share of the mixture, by the table"):
        return share_by_table(of_share(), 2.0 * x - 1.0, 2.0 * m - 1.0, bound)
