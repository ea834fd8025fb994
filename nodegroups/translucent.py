# SPDX-License-Identifier: GPL-3.0-or-later
"""A translucent body under a coat of V-grooves: light that the coat lets in is scattered below the surface.

The body is Cycles' own subsurface closure, the same for every estimator; its weight is 1 - E, E the coat's directional
albedo, so that what is mirrored cannot be scattered as well. Cycles takes a mean free path of Radius / (4 pi) and finds
the scattering that gives a deep, evenly lit body the wanted diffuse reflectance.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

from ..addon.models.estimators import UPRIGHT
from ..addon.models.translucent import MEAN_FREE_PATH, MODEL, REFLECTANCE
from . import cook_torrance, cook_torrance_albedo
from ._tree import Tree, output
from .parameters import add_input, renamed
from .shading_normal import typical_smoothing

if TYPE_CHECKING:
    import bpy

    from ..addon.models import Form, Model
    from .sum import Seen

NAME = "VGroove Translucent"
REVISION = 8


def build(
    tree: Tree, coat: bpy.types.ShaderNodeTree, kind: str, *,
    averaged: bool = False, spec: Model = MODEL, seen: Seen = cook_torrance.seen,
) -> None:  # fmt: skip
    """``coat``: the group of the coat by the estimator; ``kind``: of its Fresnel term.

    ``averaged``: with what Bump Map Correction does to the body, where it is off as the coat's lobes lean.
    ``spec``, ``seen``: of the model, if its coat is another, and what that is to the viewer.
    """
    color, path = add_input(tree, REFLECTANCE), add_input(tree, MEAN_FREE_PATH)
    names = renamed(spec.name, dict(spec.parts)["specular"])
    tree.inputs_of(coat, names)
    inputs, N = seen(tree, kind, names)
    E = cook_torrance_albedo.directional_albedo(tree, kind, inputs, N)
    with tree.frame("Below the surface"):
        radius, normal = path * (4.0 * pi, 4.0 * pi, 4.0 * pi), N if averaged else inputs.normal
        given = {"Color": color, "Radius": radius, "Scale": 1.0, "Normal": normal}
        body = tree.node("ShaderNodeSubsurfaceScattering", falloff="RANDOM_WALK", **given)
        weight = (1.0 - E) * typical_smoothing(tree, inputs.normal) if averaged else 1.0 - E
        below = tree.weighted(output(body, "BSSRDF"), weight)
    with tree.frame(coat.name):
        above = tree.nested_with_inputs(coat, names).outputs[0]
    tree.output_shader("BSDF", tree.add_shaders([below, above]), tip="To the material's Surface")


def variant(
    form: Form, estimator: str, parts: dict[str, bpy.types.ShaderNodeTree]
) -> tuple[str, dict[str, Any]]:  # fmt: skip
    """What the name of a preset's group says of its form, and what its builder has to know."""
    label = f"{MODEL.kinds[form.kind]} {estimator.title()}"
    return label, {"coat": parts["specular"], "kind": form.kind, "averaged": estimator not in UPRIGHT}
