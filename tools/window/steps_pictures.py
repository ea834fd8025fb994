# SPDX-License-Identifier: GPL-3.0-or-later
"""What the pictures of README.md and docs/ show of Blender. Scenarios for hands.py."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import bpy

if TYPE_CHECKING:
    from collections.abc import Generator

    Steps = Generator[float, None, None]

WORD = "red"  # in the picture of a search; of many families
SUBPANELS = "VGROOVE_PT_advice", "VGROOVE_PT_parameters", "VGROOVE_PT_source"
GRID = 620  # pixels that it needs beside the panel


def panel(hands: Any) -> Steps:
    """Gold, applied, with its parameters open; and the grid of what a search found."""
    bpy.context.scene.vgroove.preset = "metals/gold"
    area = hands.area("VIEW_3D")
    yield from hands.tab(area, "V-Groove")
    yield from hands.press(area, "vgroove.apply")
    yield from hands.unfold(area, "VGROOVE_PT_parameters", SUBPANELS)
    region = hands.region(area, "UI")
    yield from hands.move(region.x - 200, region.y + 200)  # nothing is highlighted
    yield 2.0
    hands.picture("panel", (region.x, region.y, region.width, region.height))
    settings = bpy.context.scene.vgroove
    settings.search = WORD
    yield 1.0
    x, y = yield from hands.find(area, "vgroove.shown")
    yield from hands.click((x, y + 80))
    yield 3.0
    left = region.x - GRID
    hands.picture("grid", (left, region.y, region.x + region.width - left, region.height))


def nodes(hands: Any) -> Steps:
    """The node of a metal, mixed with Principled."""
    area = hands.area("VIEW_3D")
    area.ui_type = "ShaderNodeTree"
    area.spaces.active.show_region_ui = False
    yield 1.0
    tree = area.spaces.active.edit_tree
    principled, output = tree.nodes["Principled BSDF"], tree.nodes["Material Output"]
    metal = sys.modules["bl_ext.user_default.vgroove.addon.blender.shader_nodes"].add(tree, "metal")
    mix = tree.nodes.new("ShaderNodeMixShader")
    for node, place in ((principled, (-320, 420)), (metal, (-320, 20)), (mix, (20, 260)), (output, (260, 260))):
        node.location, node.select = place, False
    tree.links.new(principled.outputs[0], mix.inputs[1])
    tree.links.new(metal.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs[0])
    region = hands.region(area, "WINDOW")
    yield from hands.move(region.x + 20, region.y + 20)
    yield 1.0  # nodes take their sizes
    with hands.within(area):
        bpy.ops.node.view_all()
    yield 1.0
    hands.picture("nodes", (region.x + 240, region.y + 110, 830, 630))


def assets(hands: Any) -> Steps:
    """The library in the Asset Browser."""
    bpy.ops.vgroove.asset_library(shown=True)
    area = hands.area("VIEW_3D")
    area.ui_type = "ASSETS"
    yield 1.0
    space = area.spaces.active
    space.show_region_tool_props = False
    space.params.asset_library_reference = "V-Groove"
    space.params.filter_search = WORD
    yield from hands.move(area.x + 50, area.y + 50)
    yield 5.0
    hands.picture("assets", (area.x, area.y, area.width, area.height))
