# SPDX-License-Identifier: GPL-3.0-or-later
"""A diffuse base under several Cook-Torrance lobes, as measured car paints are fitted: f = f_base + sum of s_k f_k.

Every lobe is the same nested group, with inputs of its own in a panel; the normal and the lamps are asked for once.
Source: Günther, Chen, Goesele, Wald & Seidel 2005; ``CarPaint`` of the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..addon.models import label
from ..addon.models.car_paint import MODEL, SHARE
from . import eevee
from .parameters import add_input, renamed
from .shading_normal import typical_smoothing

if TYPE_CHECKING:
    import bpy

    from ..addon.models import Form
    from ._tree import Tree

NAME = "VGroove Car Paint"
REVISION = 8


def build(
    tree: Tree, base: bpy.types.ShaderNodeTree, lobe: bpy.types.ShaderNodeTree, lobes: int, *, averaged: bool = False
) -> None:
    """``base`` and ``lobe``: the groups of the parts, by the same estimator and backend; ``averaged``: as of sums."""
    of_base = renamed(MODEL.name, "oren_nayar")
    tree.inputs_of(base, of_base)
    shaders = [tree.nested_with_inputs(base, of_base).outputs[0]]
    if averaged:
        smoothing = typical_smoothing(tree, tree.input_named("Normal"))
        shaders[0] = tree.weighted(shaders[0], eevee.by_closures(tree, smoothing))
    for k in range(1, lobes + 1):
        own = {one.label: label(MODEL.name, f"{one.name}_{k}") for one in MODEL.lobes if one != SHARE}
        with tree.panel(f"Lobe {k}"):
            s = add_input(tree, SHARE, prefix=f"Lobe {k} ")
            tree.inputs_of(lobe, own)
        with tree.frame(f"Lobe {k}"):
            shaders.append(tree.weighted(tree.nested_with_inputs(lobe, own).outputs[0], s))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def variant(
    form: Form, estimator: str, parts: dict[str, bpy.types.ShaderNodeTree]
) -> tuple[str, dict[str, Any]]:  # fmt: skip
    """What the name of a preset's group says of its form, and what its builder has to know."""
    base, *lobes = parts.values()  # the lobes' groups are one
    label = f"{MODEL.kinds[form.kind]} {estimator.title()}, {len(lobes)} lobe{'s' * (len(lobes) > 1)}"
    return label, {"base": base, "lobe": lobes[0], "lobes": len(lobes), "averaged": estimator == "fit"}
