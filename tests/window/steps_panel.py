"""What artists do in the panel. Scenarios for tools/window/hands.py, each a generator of one test."""

import sys
from pathlib import Path

import bpy
import numpy as np
from bpy_extras.view3d_utils import location_3d_to_region_2d

SUBPANELS = "VGROOVE_PT_advice", "VGROOVE_PT_parameters", "VGROOVE_PT_source"
COLORS = {"finished_metals/gold_brushed": (1.0, 0.0, 0.0), "metals/gold": (0.0, 0.0, 1.0)}


def open_tab(hands):
    """In the viewport, whose cube is selected in Blender's start scene."""
    area = hands.area("VIEW_3D")
    yield from hands.tab(area, "V-Groove")
    return area


def middle(area):
    region = next(one for one in area.regions if one.type == "WINDOW")
    return region.x + region.width * 0.4, region.y + region.height * 0.3


def material():
    return bpy.context.object.active_material


def roughness():
    """The input of the cube's material."""
    nodes = material().node_tree.nodes
    return next(one.inputs["Roughness"] for one in nodes if one.type == "GROUP")


def picks_and_applies(hands):
    """Family, picture, search, Apply; an edited value, undone and redone by keys."""
    paint(COLORS)
    area = yield from open_tab(hands)
    settings = bpy.context.scene.vgroove
    hands.picture("start")
    yield from hands.press(area, "vgroove.family")
    for _ in range(5):  # All, Favourites, Recently Used, Metals, Brushed and Finished Metals
        yield from hands.key("DOWN_ARROW")
    yield from hands.key("RET")
    assert settings.preset.startswith("finished_metals/"), settings.preset
    yield from hands.press(area, "vgroove.search")
    yield from hands.type("gold")
    yield from hands.key("RET")
    assert (settings.search, settings.preset) == ("gold", "metals/gold")
    yield from picks_a_picture(hands, area, settings)
    first = material()
    yield from hands.press(area, "vgroove.apply")
    assert material() != first
    assert material().name == "Gold"
    hands.picture("applied")
    yield from edits(hands, area)


def picks_a_picture(hands, area, settings):
    """A click on a picture in the grid that a click on the shown one opens; and back."""
    x, y = yield from hands.find(area, "vgroove.shown")
    for preset, color in COLORS.items():
        yield from hands.click((x, y + 80))
        yield 1.0  # the pictures are read
        rows, columns = np.nonzero(np.abs(hands.look("grid") - color).max(2) < 0.1)
        assert len(rows) > 500, f"the grid has no picture of {preset}"
        yield from hands.click((np.median(columns), np.median(rows)))
        assert settings.preset == preset


def paint(colors):
    """Pictures of one color in place of presets' own, in the extension's folder."""
    folder = Path(sys.modules["bl_ext.user_default.vgroove.addon.ui.thumbnails"].FOLDER)
    for preset, color in colors.items():
        image = bpy.data.images.new("Picture", 64, 64)
        image.pixels.foreach_set(np.tile(np.float32([*color, 1.0]), 64 * 64))
        path = folder / f"{preset}.webp"
        path.parent.mkdir(parents=True, exist_ok=True)
        image.file_format, image.filepath_raw = "WEBP", str(path)
        image.save()
        bpy.data.images.remove(image)


def edits(hands, area):
    """A value typed into the panel; Ctrl-Z and Ctrl-Shift-Z, and back to before Apply."""
    yield from hands.unfold(area, "VGROOVE_PT_parameters", SUBPANELS)
    yield from hands.enter(area, roughness().path_from_id("default_value"), "0.25")
    assert round(roughness().default_value, 6) == 0.25
    hands.picture("edited")
    yield from hands.move(*middle(area))
    yield from hands.key("Z", ctrl=True)
    assert round(roughness().default_value, 6) != 0.25
    yield from hands.key("Z", ctrl=True, shift=True)
    assert round(roughness().default_value, 6) == 0.25
    for _ in range(2):
        yield from hands.key("Z", ctrl=True)
    assert material().name == "Material"
    hands.picture("undone")
    for _ in range(2):
        yield from hands.key("Z", ctrl=True, shift=True)
    assert (material().name, round(roughness().default_value, 6)) == ("Gold", 0.25)


def keeps_textures(hands):
    """The image of a Principled stays linked if the box is ticked, and only then."""
    tree = material().node_tree
    image = tree.nodes.new("ShaderNodeTexImage")
    image.image = bpy.data.images.new("Bricks", 8, 8)
    tree.links.new(image.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    bpy.context.scene.vgroove.preset = "metals/copper"
    bpy.ops.ed.undo_push(message="Bricks")
    area = yield from open_tab(hands)
    yield from hands.press(area, "vgroove.apply")
    assert (material().name, images()) == ("Copper", ["Bricks"])
    hands.picture("textured")
    yield from hands.move(*middle(area))
    yield from hands.key("Z", ctrl=True)
    assert material().name == "Material"
    yield from hands.press(area, "vgroove.keep_textures")
    assert not bpy.context.scene.vgroove.keep_textures
    yield from hands.press(area, "vgroove.apply")
    assert (material().name, images()) == ("Copper", [])


def images():
    return [one.image.name for one in material().node_tree.nodes if one.type == "TEX_IMAGE"]


def faces(hands):
    """Tab, 3, a click on a face, Apply: that face alone has the material."""
    bpy.context.scene.vgroove.preset = "metals/gold"
    area = yield from open_tab(hands)
    region = hands.region(area, "WINDOW")
    x, y = location_3d_to_region_2d(region, area.spaces.active.region_3d, (0.9, -0.9, 1.0))
    yield from hands.move(region.x + x, region.y + y)
    yield from hands.key("TAB")
    yield from hands.key("THREE")
    yield from hands.click()
    yield from hands.press(area, "vgroove.apply")
    hands.picture("faces")
    yield from hands.move(*middle(area))
    yield from hands.key("TAB")
    cube = bpy.context.object
    assert cube.mode == "OBJECT"
    names = [cube.material_slots[one.material_index].name for one in cube.data.polygons]
    assert sorted(names) == ["Gold", *["Material"] * 5]


def material_tab(hands):
    """The picker in the Properties editor gives an object its first material."""
    bpy.ops.object.material_slot_remove()
    bpy.ops.ed.undo_push(message="No Material")
    area = hands.area("PROPERTIES")
    area.spaces.active.context = "MATERIAL"
    yield 1.0
    region = hands.region(area, "WINDOW")
    yield from hands.move(region.x + 20, region.y + region.height - 100)
    picker = "VGROOVE_PT_material_properties"
    yield from hands.unfold(area, picker, [picker], "WINDOW")
    hands.picture("tab")
    for pause in hands.press(area, "vgroove.apply", "WINDOW"):
        if material():
            break  # before the tab draws its picture of it, which takes a software rasteriser a minute
        yield pause
    assert material().name == "Copper"
