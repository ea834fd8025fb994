# SPDX-License-Identifier: GPL-3.0-or-later
"""What all Cook-Torrance groups share: the artist's inputs, and the equations' dot products."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..addon.models.cook_torrance import MODEL, SLOPE
from ..addon.models.fresnel import KINDS
from . import fresnel, osl_script, shading_normal
from .parameters import add_input, existing_input

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bpy.types import Node

    from ..addon.models import Form
    from ._tree import Number, Tree, Value


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: Fresnel parameters by reference name, RMS slope, and the normal as linked (or not)."""

    fresnel: dict[str, Value]
    m: Value
    normal: Value


def interface(tree: Tree, kind: str, *, native: bool = False) -> Inputs:
    """The Fresnel term's own; Roughness, within what Cycles' closures take if ``native``; Normal."""
    terms = fresnel.interface(tree, kind)
    return Inputs(terms, add_input(tree, SLOPE, native=native), shading_normal.interface(tree))


def inherited_inputs(tree: Tree, kind: str, names: Mapping[str, str]) -> Inputs:
    """The same in a group that repeats another group's inputs by these ``names`` (``Tree.inputs_of``)."""
    terms = {one.name: existing_input(tree, one, names) for one in KINDS[kind].parameters}
    return Inputs(terms, existing_input(tree, SLOPE, names), tree.input_named("Normal"))


def script(tree: Tree, estimator: str, kind: str, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``cook_torrance_ESTIMATOR`` fed by these inputs."""
    return osl_script.script(
        tree,
        f"cook_torrance_{estimator}",
        kind=list(fresnel.KINDS).index(kind),
        m=inputs.m,
        Normal=inputs.normal,
        **inputs.fresnel,
        **more,
    )


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    return MODEL.kinds[form.kind], {"kind": form.kind}
