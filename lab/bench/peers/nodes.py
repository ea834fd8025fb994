# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own shader nodes, as peers use them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from mathutils import Color

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from bpy.types import NodeSocket, ShaderNodeTree

    from ....addon.library.presets import Preset

BECKMANN = {"distribution": "BECKMANN"}
LOBE = "GGX in place of Beckmann's D, and energy lost between facets is added back"
COAT = "the base under a coat that dims it and reflects everything at the edge, where the preset adds shares of each"
LEVEL = 0.5  # Principled's Specular IOR Level at which its IOR applies


@dataclass(frozen=True)
class Peer:
    """One BSDF node with the preset's numbers. differs: how its model differs from the preset's."""

    label: str
    differs: str
    node: str
    inputs: Mapping[str, Any]
    properties: Mapping[str, str] = field(default_factory=dict)

    def socket(self, tree: ShaderNodeTree) -> NodeSocket:
        """Its output, in a tree."""
        return bsdf(tree, self.node, self.properties, **self.inputs)


def principled(differs: str, **inputs: Any) -> Peer:
    """A Principled BSDF; inputs by name, with underscores for spaces."""
    return Peer(
        "Principled BSDF", differs, "Principled", {name.replace("_", " "): value for name, value in inputs.items()}
    )


def bsdf(tree: ShaderNodeTree, kind: str, properties: Mapping[str, str] | None = None, /, **inputs: Any) -> NodeSocket:
    """The output of a new BSDF node. A colour may be given without its alpha."""
    node = tree.nodes.new(f"ShaderNodeBsdf{kind}")
    for name, value in (properties or {}).items():
        setattr(node, name, value)
    for name, value in inputs.items():
        lacks_alpha = node.inputs[name].type == "RGBA" and len(value) == 3
        node.inputs[name].default_value = (*value, 1.0) if lacks_alpha else value
    return node.outputs[0]


def colour(linear: Sequence[float]) -> tuple[float, ...]:
    """A colour of linear Rec.709 in the file's working space."""
    return tuple(Color(tuple(linear)[:3]).from_rec709_linear_to_scene_linear())


def weighted_sum(tree: ShaderNodeTree, terms: Iterable[tuple[float, NodeSocket]]) -> NodeSocket:
    """The sum of shaders, each weighted by a share of 0 to 1."""
    total: NodeSocket | None = None
    for weight, shader in terms:
        mix = tree.nodes.new("ShaderNodeMixShader")
        mix.inputs[0].default_value = weight
        tree.links.new(shader, mix.inputs[2])
        if total is None:
            total = mix.outputs[0]
            continue
        add = tree.nodes.new("ShaderNodeAddShader")
        tree.links.new(total, add.inputs[0])
        tree.links.new(mix.outputs[0], add.inputs[1])
        total = add.outputs[0]
    assert total is not None  # noqa: S101 - a sum has terms
    return total


def native_parts(tree: ShaderNodeTree, preset: Preset, weights: Sequence[float]) -> NodeSocket:
    """The nearest native material of a preset made of parts."""
    from . import of

    parts = preset.parts().values()
    shaders = ((weight, of(part).native(tree, part)) for weight, part in zip(weights, parts, strict=True))
    return weighted_sum(tree, shaders)
