# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: the mixture of Cook-Torrance, stretched with the slopes. Nothing is random.

As ``anisotropic_fit`` of the reference has it: the table is looked up where a round surface looks like this one from
the viewer, and each lobe's slopes and lean are stretched. In units of m, so that float32 keeps the narrowest.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from ..addon.reference.anisotropic_fit import EXCESS, ROUGH
from ..addon.reference.cook_torrance_fit import NARROWEST
from . import anisotropic, cook_torrance, ensure
from . import cook_torrance_fit as fit
from ._tree import Tree, Value, cross, dot, maximum, minimum, scale, sqrt
from .shading_normal import raised, specular_normal

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

NAME = "VGroove Anisotropic Fit"
REVISION = 2
LEAST = 1e-5  # along B, for axes that are B itself, of which rounding leaves nothing


@dataclass(frozen=True)
class Table:
    """The mixture of a round surface, which is stretched.

    look_up: (m, N) -> weights of the lobes, roughness of the first, which is upright; roughness, anisotropy and tilt of
    each other one. gains: whether it would send back more light than arrives where slopes are wide.
    """

    name: str  # of its groups begins so
    revision: int
    look_up: Callable[[Tree, Value, Value], tuple[Value, Value, list[Value]]]
    gains: bool = False


def _look_up(tree: Tree, m: Value, N: Value) -> tuple[Value, Value, list[Value]]:
    node = tree.group(ensure(fit.LOOK_UP_NAME, fit.REVISION, fit.build_look_up), m=m, N=N)
    weight, first, *others = (Value(tree, socket) for socket in node.outputs)
    return weight, first, others


VGROOVE = Table(".VGroove Anisotropic Fit", REVISION, _look_up, gains=True)


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial, native=True)  # Cycles clamps alpha to 1
    tree.output_shader("BSDF", shader(tree, kind, inputs), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial, native=True)
    node = cook_torrance.script(tree, "fit", kind, inputs, **for_script(tree, inputs))
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")


def shader(tree: Tree, kind: str, inputs: anisotropic.Inputs) -> NodeSocket:
    """The mixture about the normal, raised where it has to be."""

    def about(N: Value) -> NodeSocket:
        leaning = lobes(tree, inputs.m, inputs.anisotropy, N, inputs.tangent_to(N))
        return fit.mixture(tree, kind, inputs.fresnel, leaning)

    return raised(tree, inputs.normal, about)


@dataclass(frozen=True)
class Lobe(fit.Lobe):
    """A lobe that need not lie along or across the plane of view."""

    anisotropy: Value
    tangent: Value


def lobes(tree: Tree, m: Value, anisotropy: Value, N: Value, T: Value, table: Table = VGROOVE) -> list[Lobe]:
    """The mixture as seen from the viewer; normals not yet of length 1."""
    node = looked_up(tree, m, anisotropy, N, T, table)
    weight = Value(tree, node["Weight"])
    found = []
    for index, share in enumerate(weight.rgb, 1):
        if f"Normal {index}" not in node:
            break
        of = (Value(tree, node[f"{name} {index}"]) for name in ("Roughness", "Normal", "Anisotropy", "Tangent"))
        found.append(Lobe(share, *of))
    return found


def looked_up(tree: Tree, m: Value, anisotropy: Value, N: Value, T: Value, table: Table) -> dict[str, NodeSocket]:
    """The outputs of the nested group by name."""
    group = ensure(f"{table.name} Lobes", table.revision, partial(build_look_up, table=table))
    node = tree.group(group, m=m, Anisotropy=anisotropy, N=N, T=T)
    return {socket.name: socket for socket in node.outputs}


def for_script(tree: Tree, inputs: anisotropic.Inputs, table: Table = VGROOVE) -> dict[str, Value]:
    """The same as parameters of the OSL shaders, which cannot read an image of a .blend themselves."""
    N = specular_normal(tree, inputs.normal)
    found = looked_up(tree, inputs.m, inputs.anisotropy, N, inputs.T, table)
    return {name.lower().replace(" ", "_"): Value(tree, socket) for name, socket in found.items()}


def build_look_up(tree: Tree, table: Table) -> None:
    """``lobes`` of the reference."""
    slope = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    anisotropy = tree.input_float("Anisotropy", 0.5, low=0.0, high=1.0, tip="As of Metallic BSDF")
    N, T = (tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("N", "T"))
    wo, m, B = tree.geometry("Incoming"), minimum(slope, 1.0), cross(N, T)
    with tree.frame("Slopes over m: 1/s along T, s along B"):
        narrow = 1.0 - (1.0 - NARROWEST) * anisotropy  # s^2, one slope over the other
        wide = 1.0 / narrow
    with tree.frame("The round slope that looks like this one"):
        x, y, z = dot(T, wo) * wide, dot(B, wo) * narrow, dot(N, wo)
        G, z2 = scale(T, x) + scale(B, y), z * z
        across2 = maximum(dot(G, wo), 1e-14)
        round_slope = minimum(m * sqrt(across2 + z2), 1.0)
    weight, first, others = table.look_up(tree, round_slope, N)
    if table.gains:
        with tree.frame("No more light than arrives"):
            excess = EXCESS * maximum(minimum(m * sqrt(wide), 1.0) - ROUGH, 0.0) * (1.0 - narrow)
            kept = tree.math("MULTIPLY_ADD", z2, excess, 1.0 - excess)
            weight = scale(weight, kept)
    tree.output_color("Weight", weight, tip="Of each lobe")
    with tree.frame("Upright lobe"):
        _lobe(tree, 1, sqrt(m * minimum(first * first, 1.0) / round_slope), N, anisotropy, T)
    with tree.frame("g over m, and what a lobe leans by"):
        over = tree.math("INVERSE_SQRT", across2)
        gx, gy, inverse = x * over, y * over, 1.0 / round_slope
        gxx, gyy, gxy = gx * gx, gy * gy, 2.0 * gx * gy
        side = m * over * inverse * sqrt(1.0 - z2)
        lean, inverse2 = scale(N, z) + scale(G, side), inverse * inverse
    for index, of in enumerate(others, 2):
        with tree.frame("Lobe, stretched: squares of its slopes over m"):
            roughness, aniso, tilt = of.rgb
            fourth, aspect = roughness**4, tree.math("MULTIPLY_ADD", aniso, NARROWEST - 1.0, 1.0)
            within, across = (minimum(square, 1.0) * inverse2 for square in (fourth * aspect, fourth / aspect))
            more = within - across
            xx, yy = (tree.math("MULTIPLY_ADD", more, *pair) for pair in ((gxx, across * wide), (gyy, across * narrow)))
            twice, half = more * gxy, xx - yy
            root = sqrt(tree.math("MULTIPLY_ADD", half, half, twice * twice))
            both = sqrt(within * across)  # the product of its two slopes
        with tree.frame("As Metallic BSDF takes it"):
            axis = scale(T, half + root) + scale(B, twice + LEAST)
            ratio = both / (xx + yy + root)
            narrower = tree.math("MULTIPLY_ADD", ratio, -2.0 / (1.0 - NARROWEST), 1.0 / (1.0 - NARROWEST))
            _lobe(tree, index, sqrt(m * sqrt(both)), N - scale(lean, tilt), minimum(narrower, 1.0), axis)


def _lobe(tree: Tree, index: int, roughness: Value, normal: Value, anisotropy: Value, tangent: Value) -> None:
    tree.output_float(f"Roughness {index}", roughness, tip="As of Metallic BSDF")
    tree.output_vector(f"Normal {index}", normal, tip="Not of length 1")
    tree.output_float(f"Anisotropy {index}", anisotropy, tip="As of Metallic BSDF")
    tree.output_vector(f"Tangent {index}", tangent, tip="Of the wider slope, not of length 1")
