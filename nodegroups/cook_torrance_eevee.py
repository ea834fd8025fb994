# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows from Blender 5.3 on: the formula at every light, and the world by EEVEE's own lobe (``eevee``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..addon.models.cook_torrance import SLOPE
from . import cook_torrance, cook_torrance_albedo, cook_torrance_direct, eevee, ensure, fresnel, shading_normal
from ._tree import Value, minimum
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = ".VGroove Cook-Torrance EEVEE"
REVISION = 2
SEEN_NAME = ".VGroove Cook-Torrance EEVEE Seen"


@dataclass(frozen=True)
class Seen:
    """What does not depend on F: the highlight at F = 1 over the light's radiance, v.h, and the world."""

    highlight: Value
    vh: Value
    world: eevee.World


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind)
    node = tree.group(ensure(SEEN_NAME, REVISION, build_seen), m=inputs.m, Normal=inputs.normal)
    highlight, vh, radiance, factor, alpha, N = (Value(tree, socket) for socket in node.outputs)
    of = Seen(highlight, vh, eevee.World(radiance, factor, alpha))
    output_formula(tree, kind, inputs, of, cook_torrance_albedo.albedo(tree, kind, inputs, N))


def build_seen(tree: Tree) -> None:
    m = tree.input_float("m", 0.3, low=SLOPE.low, high=SLOPE.high, tip="RMS slope of the facets")
    inputs = cook_torrance.Inputs({}, m, shading_normal.interface(tree))
    N = specular_normal(tree, inputs.normal)
    of = seen(tree, inputs, N)
    tree.output_float("Highlight", of.highlight, tip="At F = 1, over the light's radiance")
    tree.output_float("v.h", of.vh, tip="View against half vector")
    tree.output_color("Radiance", of.world.radiance, tip="Of the world")
    tree.output_float("Factor", of.world.factor, tip="What the world holds of a light, over its radiance")
    tree.output_float("Alpha", of.world.alpha, tip="1 in EEVEE, 0 in Cycles")
    tree.output_vector("N", N, tip="Unit normal, raised where it has to be")


def seen(tree: Tree, inputs: cook_torrance.Inputs, N: Value) -> Seen:
    m, wi = minimum(inputs.m, eevee.WIDEST), eevee.to_light(tree)
    f_cos, vh = cook_torrance_direct.lobe(tree, inputs, N, wi)
    return Seen(eevee.received(tree, wi) * f_cos, vh, eevee.world(tree, eevee.mirrored(tree, N, m), m))


def output_formula(tree: Tree, kind: str, inputs: cook_torrance.Inputs, of: Seen, E: Value) -> None:
    """The outputs of a formula's group. E: the share of the world's light that is sent back to the viewer."""
    E = minimum(E, 1.0)
    shown = fresnel.reflectance(tree, kind, inputs.fresnel, of.vh) * of.highlight
    eevee.output_formula(tree, E * of.world.radiance, of.world.alpha, Glossy=shown - E * of.world.factor)
