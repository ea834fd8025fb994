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
    """A node: its name, the preset whose form and numbers it begins with, what it is for, and everyday words for it."""

    label: str
    preset: str
    tip: str
    words: str


# The search of the Add menu looks through labels and words.
NODES = {
    "metal": Entry(
        "Metal", "metals_schlick/copper_schlick", "A metal by a color and an edge tint", "copper, gold, steel, chrome"
    ),
    "measured_metal": Entry(
        "Measured Metal", "metals/copper", "A metal by its refractive index, as measured", "IOR and extinction"
    ),
    "brushed_metal": Entry(
        "Brushed Metal", "finished_metals/stainless_steel_hair_line", "A metal with fine grooves along a tangent",
        "anisotropic, hair-line, ground, turned",
    ),
    "plastic": Entry(
        "Plastic", "plastics/abs_plastic", "A color below a clear, glossy surface", "lacquer, ceramic, varnish"
    ),
    "diffuse": Entry(
        "Matte", "diffuse/clay", "A rough surface without gloss: Oren-Nayar", "plaster, clay, cloth, paper"
    ),
    "glass": Entry("Glass", "glasses/glass", "A clear body: light passes through, and bends", "water, ice, gem"),
    "pane": Entry("Thin Glass", "glasses/window", "A sheet of glass: light passes straight through", "window, pane"),
    "car_paint": Entry("Car Paint", "car_paints/blue", "A color under several layers of gloss", "metallic, flakes"),
    "translucent": Entry(
        "Translucent", "translucent/marble", "Light scatters below a glossy surface", "skin, wax, marble, milk"
    ),
    "ward": Entry(
        "Ward", "finished_metals/rolled_steel_sheet", "Ward's brushed highlight over a color",
        "anisotropic, sheet metal, varnish, 1992",
    ),
    "ashikhmin_shirley": Entry(
        "Ashikhmin-Shirley", "ashikhmin_shirley/satin_paint_white_as", "A satin highlight over a color",
        "satin paint, varnish, 2000",
    ),
    "phong": Entry("Phong", "phong/phong_red_plastic", "Phong's highlight over a color, as of old", "classic, 1975"),
}  # fmt: skip
ESTIMATORS = ("fit", "closure")  # the first that a model has; both render in Cycles and EEVEE


def add(tree: ShaderNodeTree, name: str) -> Node:
    """A node of ``NODES`` in a material's tree."""
    entry = NODES[name]
    preset = presets.find(entry.preset)
    estimator = next(one for one in ESTIMATORS if one in preset.spec.estimators)
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label, node.width = group_of(preset, Choice("nodes", estimator)), entry.label, 220
    node.show_options = False  # the menu of all node groups, in which this one has an internal name
    write_numbers(node, preset)
    return node
