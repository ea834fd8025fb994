# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own shader nodes, as peers use them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Any

from mathutils import Color

from ...scenery import add_node, surface

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bpy.types import Material, Node, Scene, ShaderNodeTree

    from ....addon.library.presets import Preset

BECKMANN = {"distribution": "BECKMANN"}
LOBE = "GGX in place of Beckmann's D, and energy lost between facets is added back"
COAT = "the base under a coat that dims it and reflects everything at the edge, where the preset adds shares of each"
LEVEL = 0.5  # Principled's Specular IOR Level at which its IOR applies


@dataclass(frozen=True)
class Peer:
    """One BSDF node with the preset's numbers, as ``add_node`` takes them. differs: from the preset's model."""

    label: str
    differs: str
    kind: str
    given: Mapping[str, Any]

    def material(self, _shown: Scene) -> Material:
        return surface(self.label, lambda tree: add_node(tree, self.kind, **self.given))


def principled(differs: str, **given: Any) -> Peer:
    return Peer("Principled BSDF", differs, "BsdfPrincipled", given)


def colour(linear: Sequence[float]) -> tuple[float, ...]:
    """A colour of linear Rec.709 in the file's working space."""
    return tuple(Color(tuple(linear)[:3]).from_rec709_linear_to_scene_linear())


def weighted_sum(tree: ShaderNodeTree, terms: Iterable[tuple[float, Node]]) -> Node:
    """The sum of shaders, each weighted by a share of 0 to 1."""
    shaders = [add_node(tree, "MixShader", Fac=weight, Shader_001=shader) for weight, shader in terms]
    return reduce(lambda total, one: add_node(tree, "AddShader", Shader=total, Shader_001=one), shaders)


def native_parts(tree: ShaderNodeTree, preset: Preset, weights: Sequence[float]) -> Node:
    """The nearest native material of a preset made of parts."""
    from . import of

    parts = preset.parts().values()
    return weighted_sum(tree, ((w, of(part).native(tree, part)) for w, part in zip(weights, parts, strict=True)))
