# SPDX-License-Identifier: GPL-3.0-or-later
"""The models as single nodes for artists who build their materials themselves: one group, one output."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..library import presets
from .choice import Choice
from .groups import group_of
from .material import write_numbers

if TYPE_CHECKING:
    from bpy.types import Node, ShaderNodeTree


class Entry(NamedTuple):
    """A node: its name, the preset whose form and numbers it begins with, and what it is for."""

    label: str
    preset: str
    tip: str


# Names and tips by everyday words, as the search of the Add menu finds them.
NODES = {
    "metal": Entry("Metal", "metals_schlick/copper_schlick", "Copper, gold, steel, chrome: a colour and an edge tint"),
    "measured_metal": Entry("Measured Metal", "metals/copper", "A metal by its refractive index, as measured"),
    "plastic": Entry("Plastic or Lacquer", "plastics/abs_plastic", "A colour under a clear, glossy surface"),
    "diffuse": Entry("Plaster, Clay or Cloth", "diffuse/clay", "A rough, matt surface without gloss: Oren-Nayar"),
    "glass": Entry("Glass", "glasses/glass", "Glass, water, ice: light passes through, and bends"),
    "pane": Entry("Window Pane", "glasses/window", "A thin sheet of glass: light passes straight through"),
    "car_paint": Entry("Car Paint", "car_paints/blue", "A colour under several layers of gloss"),
    "translucent": Entry("Skin, Wax or Marble", "translucent/marble", "Light scatters below a glossy surface"),
}
ESTIMATORS = ("fit", "closure")  # the first that a model has; both render in Cycles and EEVEE


def add(tree: ShaderNodeTree, name: str) -> Node:
    """A node of ``NODES`` in a material's tree."""
    entry = NODES[name]
    preset = presets.find(entry.preset)
    estimator = next(one for one in ESTIMATORS if one in preset.spec.estimators)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label, node.width = group_of(preset, Choice("nodes", estimator)), entry.label, 220
    write_numbers(node, preset)
    return node
