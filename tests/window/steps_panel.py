"""What artists do in the panel. Scenarios for tools/window/hands.py, each a generator of one test."""

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d

SUBPANELS = "VGROOVE_PT_advice", "VGROOVE_PT_parameters", "VGROOVE_PT_source"


def open_tab(hands):
    """The sidebar's tab, as N and a click on it would; the cube is selected in Blender's start scene."""
    area = hands.area("VIEW_3D")
    area.spaces.active.show_region_ui = True
    yield 0.5
    hands.region(area, "UI").active_panel_category = "V-Groove"
    yield 0.5
    return area


def middle(area):
    region = next(one for one in area.regions if one.type == "WINDOW")
    return region.x + region.width * 0.4, region.y + region.height * 0.3


def material():
    return bpy.context.object.active_material


def picks_and_applies(hands):
    """Family, picture, search, Apply; an edited value, undone and redone by keys."""
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
    """In the grid that a click on the preset's picture opens, by arrow keys; and back."""
    x, y = yield from hands.find(area, "vgroove.shown")
    chosen = [settings.preset]
    for arrow in ("DOWN_ARROW", "UP_ARROW"):
        yield from hands.click((x, y + 80))
        hands.picture("grid")
        yield from hands.key(arrow)
        yield from hands.key("RET")
        chosen.append(settings.preset)
    assert chosen[1] != chosen[0] == chosen[2], chosen


def edits(hands, area):
    """A value typed into the panel; Ctrl-Z and Ctrl-Shift-Z, and back to before Apply."""

    def roughness():
        nodes = bpy.context.object.active_material.node_tree.nodes
        return next(one.inputs["Roughness"] for one in nodes if one.type == "GROUP")

    yield from hands.unfold(area, "VGROOVE_PT_parameters", SUBPANELS)
    yield from hands.find(area, roughness().path_from_id("default_value"))
    yield from hands.key("RET")  # edits the number below the mouse
    yield from hands.type("0.25")
    yield from hands.key("RET")
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
