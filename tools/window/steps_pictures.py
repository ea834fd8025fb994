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


def viewer(hands: Any) -> Steps:
    """Lobes of copper and red plastic on a ball, with the panel."""
    area = hands.area("VIEW_3D")
    with hands.within(area):
        bpy.ops.object.delete()
        bpy.ops.mesh.primitive_uv_sphere_add(segments=64, ring_count=32, radius=1.0)
        bpy.ops.object.shade_smooth()
    settings, library = bpy.context.scene.vgroove, "bl_ext.user_default.vgroove.addon"
    presets, material = (sys.modules[f"{library}.{one}"] for one in ("library.presets", "blender.material"))
    settings.preset = "lecture/copper"
    bpy.ops.vgroove.apply()
    shown = bpy.context.scene.vgroove_viewer
    shown.other = material.build(presets.find("plastics/red_plastic"), material.Choice())
    shown.place, shown.log, shown.show, shown.size = "POINT", True, True, 1.0
    shown.point, shown.normal = (0.42, -0.37, 0.83), (0.42, -0.37, 0.83)
    shown.light_from, shown.theta, shown.phi = "ANGLES", 1.05, 1.0
    yield from hands.tab(area, "V-Groove")
    view = area.spaces.active.region_3d
    view.view_distance, view.view_location = 5.6, (-0.2, -0.2, 0.1)
    region = hands.region(area, "UI")
    yield from hands.click((region.x + 100, region.y + region.height - 20))  # closes the first panel
    yield from hands.unfold(area, "VGROOVE_PT_viewer", ("VGROOVE_PT_viewer", *SUBPANELS))
    yield from hands.move(area.x + 60, area.y + 60)
    yield 2.0
    window = hands.region(area, "WINDOW")
    hands.picture("viewer", (window.x, window.y, region.x + region.width - window.x, window.height - 60))
