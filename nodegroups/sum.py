# SPDX-License-Identifier: GPL-3.0-or-later
"""A rough diffuse part under a specular one: f = d f_diffuse + s f_specular, by any estimator.

The parts are nested groups; what both ask for (the normal, the lamps) is one input. Coupled, the diffuse part's weight
is d (1 - s E), E the specular part's directional albedo: what is mirrored cannot be scattered as well.
Source: Cook & Torrance 1982, R = d R_d + s R_s with d + s = 1; ``Sum`` of the reference.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..addon.models.sum import AT_MOST_ONE, COUPLED, MODEL, D, S
from . import cook_torrance, cook_torrance_albedo, eevee
from .parameters import add_input, renamed
from .shading_normal import typical_smoothing

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import bpy

    from ..addon.models import Form, Model
    from ._tree import Tree, Value

    Seen = Callable[[Tree, str, Mapping[str, str]], tuple[cook_torrance.Inputs, Value]]

NAME = "VGroove Sum"
REVISION = 8


def build(
    tree: Tree, diffuse: bpy.types.ShaderNodeTree, specular: bpy.types.ShaderNodeTree, coupled: str | None = None,
    *, averaged: bool = False, spec: Model = MODEL, seen: Seen = cook_torrance.seen,
) -> None:  # fmt: skip
    """``coupled``: the kind of the specular part's Fresnel term, where the diffuse part gets what that leaves.

    ``averaged``: the diffuse part gets a share in place of Cycles' bump smoothing, which is off as specular lobes lean.
    ``spec``, ``seen``: of the model, if it is a sum of other parts, and what its specular part is to the viewer.
    """
    d, s = weights(tree, coupled=coupled is not None)
    names = {name: renamed(spec.name, model) for name, model in spec.parts}
    tree.inputs_of(diffuse, names["diffuse"])
    tree.inputs_of(specular, names["specular"])
    if coupled is not None:
        E = cook_torrance_albedo.directional_albedo(tree, coupled, *seen(tree, coupled, names["specular"]))
        with tree.frame("What the specular part leaves"):
            d = d * (1.0 - s * E)
    if averaged:
        d = d * eevee.by_closures(tree, typical_smoothing(tree, tree.input_named("Normal")))
    shaders = []
    for part, name, weight in ((diffuse, "diffuse", d), (specular, "specular", s)):
        with tree.frame(part.name):
            shaders.append(tree.weighted(tree.nested_with_inputs(part, names[name]).outputs[0], weight))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def weights(tree: Tree, *, coupled: bool) -> tuple[Value, Value]:
    """The inputs Diffuse and Specular; coupled, they need not share what arrives."""
    shared = {one: one.tip.removesuffix(AT_MOST_ONE) for one in (D, S)}
    tips = {D: f"{shared[D]}, of what the specular part leaves", S: shared[S]} if coupled else {D: "", S: ""}
    return add_input(tree, D, tip=tips[D]), add_input(tree, S, tip=tips[S])


def variant(
    form: Form, estimator: str, parts: dict[str, bpy.types.ShaderNodeTree]
) -> tuple[str, dict[str, Any]]:  # fmt: skip
    """What the name of a preset's group says of its form, and what its builder has to know."""
    coupled = COUPLED in form.flags
    label = f"{MODEL.kinds[form.kind]} {estimator.title()}" + " Coupled" * coupled
    return label, parts | {"averaged": estimator == "fit", "coupled": form.kind if coupled else None}
