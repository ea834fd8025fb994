"""What artists do in the Shader Editor. Scenarios for tools/window/hands.py."""

import bpy

ROW = 22  # the height of a socket's row in a node; the first one's middle is 35 below the top


def open_editor(hands):
    """The Shader Editor in place of the viewport, on the cube's material."""
    area = hands.area("VIEW_3D")
    area.ui_type = "ShaderNodeTree"
    area.spaces.active.show_region_ui = False
    yield 1.0  # the regions take their sizes
    tree = area.spaces.active.edit_tree
    tree.nodes["Principled BSDF"].location = (-500, 200)
    tree.nodes["Material Output"].location = (500, 200)
    with hands.within(area):
        bpy.ops.node.view_all()
        for _ in range(4):  # a link that is dragged near the border moves the view
            bpy.ops.view2d.zoom_out()
    yield 0.5
    return area, tree


def at(hands, area, x, y):
    """A point of the tree, on the screen."""
    region = hands.region(area, "WINDOW")
    x, y = region.view2d.view_to_region(x, y, clip=False)
    return region.x + x, region.y + y


def adds_and_mixes(hands):
    """A node found by a typed word, and a Mix Shader of Blender's; linked by dragging."""
    area, tree = yield from open_editor(hands)
    yield from hands.move(*at(hands, area, -200, -150))
    yield from hands.key("A", shift=True)
    yield from hands.type("metal")
    hands.picture("searched")
    for key in ("DOWN_ARROW", "DOWN_ARROW", "RET"):  # below Blender's Metallic BSDF and Measured Metal
        yield from hands.key(key)
    yield from hands.move(*at(hands, area, -400, -350))  # it follows the mouse
    yield from hands.click()
    metal = tree.nodes.active
    assert (metal.label, metal.select) == ("Metal", True)
    assert metal.location.y < -250, metal.location
    hands.picture("placed")
    yield from hands.key("A", shift=True)
    yield from hands.type("mix shader")
    yield from hands.key("RET")
    yield from hands.move(*at(hands, area, 50, -100))  # not on the link, which would take it in
    yield from hands.click()
    mix = tree.nodes.active
    assert mix.bl_idname == "ShaderNodeMixShader"
    principled, output = tree.nodes["Principled BSDF"], tree.nodes["Material Output"]
    yield from link(hands, area, (principled, 0), (mix, 2))
    yield from link(hands, area, (metal, 0), (mix, 3))
    yield from link(hands, area, (mix, 0), (output, 1.15))  # below a menu, which is a little higher
    hands.picture("mixed")
    links = {(one.from_node.name, one.to_node.name, one.to_socket.identifier) for one in tree.links}
    assert links == {
        (principled.name, mix.name, "Shader"),
        (metal.name, mix.name, "Shader_001"),
        (mix.name, output.name, "Surface"),
    }, links
    yield from hands.key("Z", ctrl=True)
    assert len(bpy.context.object.active_material.node_tree.links) == 3  # Principled is linked to the output again


def link(hands, area, start, end):
    """From a node's output to another's input, each by its row."""
    (node, row), (other, other_row) = start, end
    x, y = node.location
    to_x, to_y = other.location
    first = at(hands, area, x + node.width, y - 35 - ROW * row)
    yield from hands.drag(first, at(hands, area, to_x, to_y - 35 - ROW * other_row))


def menu(hands):
    """Add > Shader > V-Groove by keys: it is the last row, and lists a node for each model."""
    area, tree = yield from open_editor(hands)
    yield from hands.move(*at(hands, area, 0, 250))
    yield from hands.key("A", shift=True)
    for key in (*["DOWN_ARROW"] * 3, "RIGHT_ARROW", "END", "RIGHT_ARROW"):  # from Search... to Shader, and V-Groove
        yield from hands.key(key)
    hands.picture("menu")
    before = set(tree.nodes)
    yield from hands.key("RET")
    yield from hands.click()
    (new,) = set(tree.nodes) - before
    hands.notes["label"] = new.label


def sidebar(hands):
    """The picker and Edit Parameters beside the nodes."""
    area, _ = yield from open_editor(hands)
    yield from hands.tab(area, "V-Groove")
    yield from hands.press(area, "vgroove.apply")
    made = bpy.context.object.active_material
    assert (made.name, area.spaces.active.edit_tree) == ("Copper", made.node_tree)
    parameters = "VGROOVE_PT_parameters_nodes"
    yield from hands.unfold(area, parameters, [parameters])
    rough = next(one.inputs["Roughness"] for one in made.node_tree.nodes if one.type == "GROUP")
    yield from hands.enter(area, rough.path_from_id("default_value"), "0.25")
    assert round(rough.default_value, 6) == 0.25
    hands.picture("sidebar")
