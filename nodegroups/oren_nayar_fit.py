# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: two of Cycles' diffuse closures whose sum is near the 1994 model; quiet, and sees every light.

Cycles' Oren-Nayar of roughness 1 carries the retro-reflection, and Lambert the rest of the 1994 model's albedo, which
is kept to 0.6 %. L1 of f cos over all wi in per cent, worst of albedos up to 0.8, for views up to 80 degrees and at 89
(``tools/fit_oren_nayar.py`` prints it by view). No sum of the two closures would be better by more than 1.3 there:

    sigma               6        17        34        57        90 degrees
    full            0.4  0.8   2.2  4.1   4.0  7.2   5.1  9.1   5.8 10.2
    qualitative     0.8  0.9   4.0  4.3   7.1  7.5   9.1  9.6  10.3 10.8
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference.cycles import oren_nayar_power
from . import oren_nayar
from ._tree import Tree, Value, dot, maximum, minimum, output, sqrt
from .oren_nayar_table import MEAN, table
from .polynomial import polynomial
from .polynomial import share as share_by_table
from .shading_normal import average_smoothing, shading_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = "VGroove Oren-Nayar Fit"
REVISION = 5
TIP = "To the material's Surface. Differs from the model by up to {}, from 80 degrees of view {}"
OFF = {"full": ("6 %", "10 %"), "qualitative": ("10 %", "11 %")}


def build(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    shader, _ = closures(tree, kind, inputs)
    tree.output_shader("BSDF", shader, tip=TIP.format(*OFF[kind]))


def build_osl(tree: Tree, kind: str) -> None:
    inputs = oren_nayar.interface(tree)
    node = oren_nayar.script(tree, "fit", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip=TIP.format(*OFF[kind]))


def closures(
    tree: Tree, kind: str, inputs: oren_nayar.Inputs, *, averaged: bool = False
) -> tuple[NodeSocket, tuple[Value, Value]]:
    """Both closures added up, and their colours.

    ``averaged``: with the average of Cycles' bump smoothing, where Bump Map Correction is off.
    """
    colors = weights(tree, kind, inputs)
    if averaged:
        share = average_smoothing(tree, inputs.normal)
        colors = (colors[0] * share, colors[1] * share)
    sockets = []
    for color, roughness in zip(colors, (0.0, 1.0), strict=True):
        diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=color, Roughness=roughness, Normal=inputs.normal)
        sockets.append(output(diffuse, "BSDF"))
    return tree.add_shaders(sockets), colors


def weights(tree: Tree, kind: str, inputs: oren_nayar.Inputs) -> tuple[Value, Value]:
    """Colours of Lambert and of Cycles' Oren-Nayar of roughness 1, as ``weights`` of the reference.

    What depends on sigma alone is folded into constants by Cycles where Roughness is not linked.
    """
    of_albedo, of_retro, single = _of_view(tree, kind, inputs)
    energy, facing = _energy(tree, kind, inputs, of_albedo)
    rho = inputs.albedo
    with tree.frame("Retro-reflection, and what albedo it has"):
        retro = rho * facing * of_retro
        lost = tree.math("MULTIPLY_ADD", single, -MEAN, MEAN)
        again = retro ** oren_nayar_power() * lost / tree.math("MULTIPLY_ADD", retro, MEAN - 1.0, 1.0)
        lambert = maximum(energy - tree.math("MULTIPLY_ADD", retro, single, again), 0.0)
    return lambert, retro


def _of_view(tree: Tree, kind: str, inputs: oren_nayar.Inputs) -> tuple[Value, Value, Value]:
    """What the table has of the view: for the 1994 model's albedo, for retro-reflection, and Cycles' albedo."""
    of, x = table(kind), half_tangent(tree, shading_normal(tree, inputs.normal))
    with tree.frame("The polynomials of the table, all at once"):
        return polynomial(list(zip(of.albedo, of.retro, of.native, strict=True)), x).rgb


def _energy(tree: Tree, kind: str, inputs: oren_nayar.Inputs, of_albedo: Value) -> tuple[Value, Value]:
    """The 1994 model's albedo, of the polynomial for it; and s2/(s2 + 0.09)."""
    with tree.frame("The 1994 model's albedo"):
        s2, rho = inputs.sigma * inputs.sigma, inputs.albedo
        facing = s2 / (s2 + 0.09)
        flat = oren_nayar.C1(s2)
        if kind == "full":
            flat = flat + rho * (0.17 * s2 / (s2 + 0.13))
        return minimum(tree.math("MULTIPLY_ADD", rho * facing, of_albedo, rho * flat), 1.0), facing


def albedo(tree: Tree, kind: str, inputs: oren_nayar.Inputs) -> Value:
    """The 1994 model's directional albedo E(wo), RGB."""
    return _energy(tree, kind, inputs, _of_view(tree, kind, inputs)[0])[0]


def half_tangent(tree: Tree, N: Value) -> Value:
    """tan(theta_o/2)."""
    with tree.frame("x = tan(theta_o/2)"):
        mu = maximum(dot(N, tree.geometry("Incoming")), 0.0)  # the root of less than 0 is 0
        return sqrt((1.0 - mu) / (1.0 + mu))


def share(tree: Tree, kind: str, inputs: oren_nayar.Inputs, N: Value, bound: Value) -> Value:
    """c of ``hybrid_share``: how much of the fit stays below the model but for ``bound`` of the albedo."""
    x = half_tangent(tree, N)
    with tree.frame("Share of the fit, by the table"):
        s2 = inputs.sigma * inputs.sigma
        return share_by_table(table(kind).share, 2.0 * x - 1.0, 2.0 * s2 / (s2 + 0.09) - 1.0, bound)
