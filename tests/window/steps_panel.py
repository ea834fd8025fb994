"""What artists do in the panel. Scenarios for tools/window/hands.py, each a generator of one test."""

import bpy

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
    first = material()
    yield from hands.press(area, "vgroove.apply")
    assert material() != first
    assert material().name == "Gold"
    hands.picture("applied")
    yield from edits(hands, area)


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
