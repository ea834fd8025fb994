# SPDX-License-Identifier: GPL-3.0-or-later
"""What all Cook-Torrance groups share: the artist's inputs, and the equations' dot products."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..addon.models.cook_torrance import MODEL, SLOPE
from ..addon.models.fresnel import KINDS
from . import beckmann_d, ensure, fresnel, osl_script, shading_normal, visible_facet
from ._tree import Value
from .parameters import add_input, existing_input

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bpy.types import Node

    from ..addon.models import Form
    from ._tree import Number, Tree


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: Fresnel parameters by reference name, RMS slope, and the normal as linked (or not).

    And what only they know: how facets lie about a normal N.
    """

    fresnel: dict[str, Value]
    m: Value
    normal: Value

    model: ClassVar[str] = MODEL.name

    def density(self, tree: Tree, h: Value, N: Value) -> Value:
        """D(h) in 1/sr, through the nested group."""
        node = tree.group(ensure(beckmann_d.NAME, beckmann_d.REVISION, beckmann_d.build), h=h, N=N, Slope_m=self.m)
        return Value(tree, node.outputs["D"])

    def facet(self, tree: Tree, N: Value, wo: Value) -> Value:
        """A random facet as ``wo`` sees them."""
        return visible_facet.visible_facet(tree, N, wo, self.m)

    def for_script(self, _tree: Tree) -> dict[str, Value]:
        """The numbers as parameters of the OSL shaders."""
        return {"m": self.m, "Normal": self.normal, **self.fresnel}


def interface(tree: Tree, kind: str, *, native: bool = False) -> Inputs:
    """The Fresnel term's own; Roughness, within what Cycles' closures take if ``native``; Normal."""
    terms = fresnel.interface(tree, kind)
    return Inputs(terms, add_input(tree, SLOPE, native=native), shading_normal.interface(tree))


def inherited_inputs(tree: Tree, kind: str, names: Mapping[str, str]) -> Inputs:
    """The same in a group that repeats another group's inputs by these ``names`` (``Tree.inputs_of``)."""
    terms = {one.name: existing_input(tree, one, names) for one in KINDS[kind].parameters}
    return Inputs(terms, existing_input(tree, SLOPE, names), tree.input_named("Normal"))


def seen(tree: Tree, kind: str, names: Mapping[str, str]) -> tuple[Inputs, Value]:
    """Of a coat whose group's inputs were repeated so: what its directional albedo depends on, and its normal."""
    inputs = inherited_inputs(tree, kind, names)
    return inputs, shading_normal.specular_normal(tree, inputs.normal)


def script(tree: Tree, estimator: str, kind: str, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``MODEL_ESTIMATOR`` fed by these inputs."""
    given = inputs.for_script(tree) | more
    return osl_script.script(tree, f"{inputs.model}_{estimator}", kind=list(fresnel.KINDS).index(kind), **given)


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    return MODEL.kinds[form.kind], {"kind": form.kind}
