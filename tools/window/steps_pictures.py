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
RENDERS = 25.0  # seconds in which the picture of the viewport is done
GRID = 620  # pixels that it needs beside the panel
FILM = (
    ("red car", "car_paints/candy_red_car_paint"),
    ("gold", "metals/gold"),
    ("candle wax", "organic/candle_wax"),
)  # search, preset


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


def film(hands: Any) -> Steps:
    """A search is typed, a picture chosen, Apply pressed, and Cycles renders it in the viewport; three times.

    Notes of each frame: milliseconds, and where the mouse is, as a screen without a display shows no pointer.
    """
    area = hands.area("VIEW_3D")
    stage(hands, area)
    frames = hands.notes["frames"] = []

    def frame(milliseconds: int) -> None:
        hands.picture(f"film_{len(frames):03}")
        frames.append((milliseconds, hands.x, hands.window.height - hands.y))

    yield from hands.tab(area, "V-Groove")
    region, window = hands.region(area, "UI"), hands.region(area, "WINDOW")
    hands.notes["part"] = (window.x, hands.window.height - window.y - window.height, window.width, window.height)
    yield from hands.move(region.x - 200, region.y + 200)
    yield RENDERS
    frame(1000)
    settings = bpy.context.scene.vgroove
    for word, preset in FILM:
        at = yield from hands.find(area, "vgroove.search")
        frame(400)
        yield from hands.click(at)
        yield from hands.key("A", ctrl=True)
        for letter in word:
            yield from hands.type(letter)
            frame(110)
        yield from hands.key("RET")
        frame(700)
        x, y = yield from hands.find(area, "vgroove.shown")
        yield from hands.click((x, y + 80))
        yield 2.0
        frame(1200)
        yield from hands.key("ESC")
        settings.preset = preset
        at = yield from hands.find(area, "vgroove.apply")
        frame(500)
        yield from hands.click(at)
        for seconds, shown in ((1.0, 300), (2.0, 400), (RENDERS, 2200)):
            yield seconds
            frame(shown)


def stage(hands: Any, area: Any) -> None:
    """Blender's monkey on a floor below a window, rendered by Cycles in the viewport."""
    scene = bpy.context.scene
    lights = ((3.0, -2.0, 4.0), (0.6, 0.55, 0.0), 150.0), ((-4.0, -1.0, 2.0), (0.3, -1.1, 0.0), 80.0)
    with hands.within(area):
        bpy.ops.object.delete()
        bpy.ops.mesh.primitive_plane_add(size=30.0, location=(0.0, 0.0, -0.95))
        grey = bpy.data.materials.new("Floor")
        grey.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.1, 0.1, 0.11, 1.0)
        bpy.context.object.data.materials.append(grey)
        bpy.ops.mesh.primitive_monkey_add(size=2.0, rotation=(-0.45, 0.0, 0.75))
        monkey = bpy.context.object
        monkey.modifiers.new("Subdivision", "SUBSURF").levels = 2
        bpy.ops.object.shade_smooth()
        for place, turn, power in lights:
            bpy.ops.object.light_add(type="AREA", location=place, rotation=turn)
            bpy.context.object.data.energy, bpy.context.object.data.size = power, 2.5
        bpy.ops.object.select_all(action="DESELECT")
    bpy.data.objects.remove(bpy.data.objects["Light"])
    monkey.select_set(state=True)
    bpy.context.view_layer.objects.active = monkey
    scene.render.engine, scene.cycles.preview_samples = "CYCLES", 24
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = space.show_region_toolbar = False
    space.shading.type = "RENDERED"
    space.region_3d.view_distance, space.region_3d.view_location = 4.2, (0.35, 0.2, -0.1)
