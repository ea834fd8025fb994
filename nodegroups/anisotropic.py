# SPDX-License-Identifier: GPL-3.0-or-later
"""What the groups of anisotropic Cook-Torrance share: the artist's inputs, and how facets lie about a tangent.

All else is that of ``cook_torrance``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, ClassVar

from ..addon.models.anisotropic import ANISOTROPY, MODEL, RADIAL, ROTATION
from ..addon.reference.cook_torrance_fit import NARROWEST
from . import anisotropic_d, cook_torrance, ensure, tangent
from ._tree import Value, cross, dot, scale, sqrt
from .parameters import add_input, existing_input
from .shading_normal import specular_normal
from .visible_facet import visible_facet

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import bpy

    from ..addon.models import Form
    from ._tree import Tree

    Variant = Callable[[Form, str, dict[str, bpy.types.ShaderNodeTree]], tuple[str, dict[str, Any]]]


@dataclass(frozen=True)
class Inputs(cook_torrance.Inputs):
    """Beside those of ``cook_torrance``: anisotropy, rotation in turns, and the tangent as linked (or not).

    radial: unlinked it is around the Z axis, even where there is a UV map.
    """

    anisotropy: Value
    rotation: Value
    tangent: Value
    radial: bool

    model: ClassVar[str] = MODEL.name

    @cached_property
    def aspect(self) -> Value:
        """s of slopes m / s along the tangent and m s across it."""
        return sqrt(1.0 - (1.0 - NARROWEST) * self.anisotropy)

    @cached_property
    def T(self) -> Value:
        """The unit tangent, at right angles to ``specular_normal``."""
        return self.tangent_to(specular_normal(self.m.tree, self.normal))

    def tangent_to(self, N: Value) -> Value:
        """The unit tangent at right angles to a normal."""
        return tangent.tangent(self.m.tree, self.tangent, N, self.rotation, radial=self.radial)

    def density(self, tree: Tree, h: Value, N: Value) -> Value:
        group = ensure(anisotropic_d.NAME, anisotropic_d.REVISION, anisotropic_d.build)
        node = tree.group(group, h=h, N=N, T=self.T, Along=self.m / self.aspect, Across=self.m * self.aspect)
        return Value(tree, node.outputs["D"])

    def facet(self, tree: Tree, N: Value, wo: Value) -> Value:
        axes = scale(self.T, 1.0 / self.aspect), scale(cross(N, self.T), self.aspect)
        return visible_facet(tree, N, wo, self.m, axes=axes)

    def round_from_here(self, tree: Tree, N: Value) -> cook_torrance.Inputs:
        """The isotropic surface that sends back nearly as much to the viewer."""
        wo = tree.geometry("Incoming")
        with tree.frame("The round slope that looks like this one"):
            x, y, z = dot(self.T, wo) / self.aspect, dot(cross(N, self.T), wo) * self.aspect, dot(N, wo)
            m = self.m * sqrt(x * x + y * y + z * z)
        return cook_torrance.Inputs(self.fresnel, m, self.normal)

    def for_script(self, tree: Tree) -> dict[str, Value]:
        N = specular_normal(tree, self.normal)
        unturned = tangent.tangent(tree, self.tangent, N, 0.0, radial=self.radial)
        more = {"anisotropy": self.anisotropy, "rotation": self.rotation, "Tangent": unturned}
        return super().for_script(tree) | more


def interface(tree: Tree, kind: str, *, radial: bool, native: bool = False) -> Inputs:
    """As of ``cook_torrance``, with Anisotropy, Rotation and Tangent."""
    of = cook_torrance.interface(tree, kind, native=native)
    more = add_input(tree, ANISOTROPY), add_input(tree, ROTATION), tangent.interface(tree, radial=radial)
    return Inputs(of.fresnel, of.m, of.normal, *more, radial)


def with_radial(
    of: Variant,
) -> Variant:
    """The ``variant`` of an isotropic model's module, for a model whose specular part is brushed."""

    def variant(form: Form, estimator: str, parts: dict[str, bpy.types.ShaderNodeTree]) -> tuple[str, dict[str, Any]]:
        radial = RADIAL in form.flags
        label, given = of(form, estimator, parts)
        return label + " Radial" * radial, given | {"seen": partial(seen, radial=radial)}

    return variant


def seen(tree: Tree, kind: str, names: Mapping[str, str], *, radial: bool) -> tuple[cook_torrance.Inputs, Value]:
    """As of ``cook_torrance``: the isotropic surface that sends back nearly as much to the viewer."""
    of = cook_torrance.inherited_inputs(tree, kind, names)
    more = existing_input(tree, ANISOTROPY, names), existing_input(tree, ROTATION, names), tree.input_named("Tangent")
    inputs = Inputs(of.fresnel, of.m, of.normal, *more, radial)
    N = specular_normal(tree, inputs.normal)
    return inputs.round_from_here(tree, N), N


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    radial = RADIAL in form.flags
    return MODEL.kinds[form.kind] + " Radial" * radial, {"kind": form.kind, "radial": radial}
