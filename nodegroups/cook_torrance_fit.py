# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: the V-groove model as a fixed mixture of Cycles' own Beckmann lobes. Nothing is random.

Weights, slopes and tilts as in ``cook_torrance_fit`` of the reference, out of the same table. Whatever depends on m
alone is folded by Cycles into constants, unless m is textured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from ..addon.reference.cook_torrance_fit import NARROWEST
from . import cook_torrance, ensure, fit_table, fresnel
from . import cook_torrance_closure as closure
from ._tree import Tree, Value, cross, dot, length, maximum, minimum, scale, sqrt
from .cook_torrance_table import share as of_share
from .polynomial import share as share_by_table
from .shading_normal import raised, specular_normal

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import NodeSocket

NAME = "VGroove Cook-Torrance Fit"
REVISION = 10
MIXTURE_NAME = ".VGroove Cook-Torrance Mixture"
MIXTURE_REVISION = 1
LOOK_UP_NAME = ".VGroove Fit Lobes"


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, native=True)  # Cycles clamps alpha to 1
    tree.output_shader("BSDF", shader(tree, kind, inputs), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, native=True)
    node = cook_torrance.script(tree, "fit", kind, inputs, **for_script(tree, inputs))
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")


def shader(tree: Tree, kind: str, inputs: cook_torrance.Inputs) -> NodeSocket:
    """The mixture about the normal, raised where it has to be."""
    group = ensure(f"{MIXTURE_NAME} {kind.title()}", MIXTURE_REVISION, partial(build_mixture, kind=kind))
    given = fresnel.nested(inputs.fresnel, kind) | {"m": inputs.m}
    return raised(tree, inputs.normal, lambda N: tree.group(group, **given, N=N).outputs["BSDF"])


def build_mixture(tree: Tree, kind: str) -> None:
    terms = fresnel.held(tree, kind)
    m = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    tree.output_shader("BSDF", mixture(tree, kind, terms, lobes(tree, m, N)), tip="About this normal")


def mixture(tree: Tree, kind: str, fresnel: dict[str, Value], of: Sequence[Lobe]) -> NodeSocket:
    """One Metallic BSDF a lobe, which makes the lobe's normal a unit vector itself.

    Cycles skips a lobe of weight 0 with all nodes that serve it alone.
    """
    shaders = []
    for lobe in of:
        with tree.frame("Lobe"):
            leaning = lobe.anisotropy, lobe.tangent
            native = closure.lobe(tree, kind, fresnel, lobe.roughness, lobe.normal, *leaning)
            shaders.append(tree.weighted(native, lobe.weight))
    return tree.add_shaders(shaders)


@dataclass(frozen=True)
class Lobe:
    """One lobe of the mixture, as Metallic BSDF takes it; its normal not yet of length 1.

    ``anisotropy`` and ``tangent``, across the plane of view: None of the first, which is round and upright.
    """

    weight: Value
    roughness: Value
    normal: Value
    anisotropy: Value | None = None
    tangent: Value | None = None

    @property
    def slopes(self) -> tuple[Value, Value]:
        """Across and within the plane of view, as Metallic BSDF makes them."""
        square = self.roughness * self.roughness
        if self.anisotropy is None:
            return minimum(square, 1.0), minimum(square, 1.0)
        aspect = sqrt(square.tree.math("MULTIPLY_ADD", self.anisotropy, NARROWEST - 1.0, 1.0))
        return minimum(square / aspect, 1.0), minimum(square * aspect, 1.0)


def lobes(tree: Tree, m: Value, N: Value) -> list[Lobe]:
    """The mixture as seen from the viewer."""
    weight, first, *others = looked_up(tree, m, N)
    wo = tree.geometry("Incoming")
    tangent, (alone, *shares) = cross(N, wo), weight.rgb
    found = [Lobe(alone, first, N)]
    for of, share in zip(others, shares, strict=True):
        with tree.frame("Lobe, which leans away from the viewer"):
            roughness, anisotropy, tilt = of.rgb
            found.append(Lobe(share, roughness, N - scale(wo, tilt), anisotropy, tangent))
    return found


def for_script(tree: Tree, inputs: cook_torrance.Inputs) -> dict[str, Value]:
    """The same as parameters of the OSL shaders, which cannot read an image of a .blend themselves."""
    found = looked_up(tree, inputs.m, specular_normal(tree, inputs.normal))
    return dict(zip(("weights", "first", "second", "third"), found, strict=True))


def looked_up(tree: Tree, m: Value, N: Value) -> list[Value]:
    """Through the nested group: the weights, and what the table has of each lobe."""
    node = tree.group(ensure(LOOK_UP_NAME, REVISION, build_look_up), m=m, N=N)
    return [Value(tree, output) for output in node.outputs]


def build_look_up(tree: Tree) -> None:
    slope = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    N = tree.input_vector("N", (0, 0, 1), hide_value=True, tip="Unit normal")
    m = minimum(slope, 1.0)
    with tree.frame("u = m (1 - c) / (c + m) = m (1 + m) / (c + m) - m: 0 head-on, 1 at grazing"):
        over = m * (1.0 + m) / maximum(m + dot(N, tree.geometry("Incoming")), m)
    with tree.frame("The table"):
        (weight, first), (second, _), (third, _) = fit_table.look_up(tree, over, m, sqrt(m))
    tree.output_color("Weight", weight, tip="Of each lobe")
    tree.output_float("Lobe 1", first, tip="Roughness")
    tip = "Roughness; anisotropy; how much of the view's direction is taken from the normal"
    tree.output_color("Lobe 2", second, tip=tip)
    tree.output_color("Lobe 3", third, tip=tip)


def grazing(tree: Tree, m: Value, N: Value) -> tuple[Value, Value]:
    """x = m s / (c + m s), 0 head-on and 1 at grazing, and the view's part along the surface, of length s."""
    wo = tree.geometry("Incoming")
    with tree.frame("x = m s / (c + m s): 0 head-on, 1 at grazing"):
        c = dot(N, wo)
        aside = wo - scale(N, c)
        ms = m * length(aside)
        return ms / (maximum(c, 0.0) + ms), aside


def share(tree: Tree, slope: Value, N: Value, bound: Value) -> Value:
    """c of ``hybrid_share``: how much of the mixture stays below the model but for ``bound`` of the albedo."""
    m = minimum(slope, 1.0)
    x, _ = grazing(tree, m, N)
    with tree.frame("Share of the mixture, by the table"):
        return share_by_table(of_share(), 2.0 * x - 1.0, 2.0 * m - 1.0, bound)
