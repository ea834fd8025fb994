# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that bounces within the groove: one more of Cycles' own lobes, beside any estimator's first bounce.

``groove_fit`` of the reference says which: its weight fills what the first bounce leaves of the light, by a table over
slope and view, and its colour is that of two or three bounces. A material without it has none of these nodes.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ..addon.reference.groove_fit import COSINE, NAMES, WIDEST, of_estimator, tables
from . import cook_torrance, ensure, fresnel
from ._tree import Tree, Value, clamp, dot, maximum, minimum, output, scale, sqrt, vector
from .image_table import ImageTable
from .shading_normal import specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = ".VGroove Bounces"
REVISION = 2


def pixels() -> np.ndarray:
    """(slopes, views, 4) float32: three weights and q, by m^(1/2) and view, each from 0 to 1."""
    return np.moveaxis(tables(), 0, -1).astype(np.float32)


TABLE = ImageTable("VGroove Groove Table", 1, pixels)


def add_bounces(tree: Tree, kind: str, estimator: str) -> None:
    """Add the light of further bounces to what the group's first output gives."""
    of = of_estimator(estimator)
    group = ensure(f"{NAME} {of.title()} {kind.title()}", REVISION, partial(build, kind=kind, of=of))
    with tree.frame("Light that bounces within the groove"):
        node = tree.nested_with_inputs(group)

        def added(first: NodeSocket) -> NodeSocket:
            return tree.add_shaders([first, node.outputs[0]])

        tree.replace_output(0, added)


def build(tree: Tree, kind: str, of: str) -> None:
    inputs = cook_torrance.interface(tree, kind)
    N, m = specular_normal(tree, inputs.normal), minimum(inputs.m, 1.0)
    c = dot(N, tree.geometry("Incoming"))
    with tree.frame("The table, at u = m (1 - c) / (c + m) = m (1 + m) / (c + m) - m"):
        weights, q = look_up(tree, m * (1.0 + m) / maximum(m + c, m), m, sqrt(m))
        weight = weights.rgb[NAMES.index(of)]
    with tree.frame("F^2 (1 - q + q F)"):
        F = fresnel.reflectance(tree, kind, inputs.fresnel, clamp(COSINE * c))
        F = F if F.is_vector else vector(F, F, F)
        color = F * F * (scale(F, q) + (1.0 - q))
    lobe = tree.node(
        "ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=color, Normal=N,
        Roughness=sqrt(minimum(0.5 * m, WIDEST)),
    )  # fmt: skip
    # Where one bounce leaves nothing, Cycles skips what a weight of 0 mixes in
    shader = tree.weighted(output(lobe, "BSDF"), weight)
    tree.output_shader("BSDF", shader, tip="Light of the second bounce and of further ones")


def look_up(tree: Tree, over: Value, under: Value, root: Value) -> tuple[Value, Value]:
    """The weights and q at u = over - under and m^(1/2), linear between nodes."""
    width, height = TABLE.ensure().size
    wide = (width - 1) / width
    start = tree.math("MULTIPLY_ADD", under, (-wide, 0.0, 0.0), (0.5 / width, 0.5 / height, 0.0))
    start = tree.math("MULTIPLY_ADD", root, (0.0, (height - 1) / height, 0.0), start)
    return TABLE.node(tree, tree.math("MULTIPLY_ADD", over, (wide, 0.0, 0.0), start))
