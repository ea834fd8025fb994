# SPDX-License-Identifier: GPL-3.0-or-later
"""Apply keeps what an artist has textured, and a folder of maps comes in by one operator."""

import pytest

from vgroove import headless
from vgroove.addon.blender import image_set, material, roles, textures
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender


def run(extension, operator, /, **settings):
    with headless.quiet():
        return getattr(extension.ops.vgroove, operator)(**settings)


def bricks(extension):
    """The cube with a Principled material whose colour is an image."""
    made = extension.context.object.active_material
    tree = versions.nodes_of(made)
    image = tree.nodes.new("ShaderNodeTexImage")
    image.image = extension.data.images.new("Bricks", 8, 8)
    tree.links.new(image.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    return made


@pytest.mark.parametrize("keep", [True, False])
def test_apply_keeps_textures_if_the_panel_says_so(extension, keep):
    """The artist's own material stays in the file, as it was."""
    before = bricks(extension)
    extension.context.scene.vgroove.preset = "metals/copper"
    extension.context.scene.vgroove.keep_textures = keep
    assert run(extension, "apply") == {"FINISHED"}
    made = extension.context.object.active_material
    assert made != before
    assert (textures.read(made).inputs.keys() == {"Base Color"}) is keep
    assert material.preset_of(made).kind == ("f82" if keep else "conductor")
    assert textures.read(before).inputs.keys() == {"Base Color"}
    run(extension, "apply")  # the next preset takes them as well
    assert bool(textures.read(extension.context.object.active_material)) is keep


def test_a_metalness_map_says_what_shows_where(extension):
    """The other side keeps the artist's values; the message, which is a warning, names both."""
    from vgroove.addon.blender import metalness

    source = bricks(extension)
    tree = source.node_tree
    shader = tree.nodes["Principled BSDF"]
    tree.links.new(tree.nodes["Image Texture"].outputs["Color"], shader.inputs["Metallic"])
    shader.inputs["Roughness"].default_value = 0.75
    extension.context.scene.vgroove.preset = "metals/gold"
    assert run(extension, "apply") == {"FINISHED"}
    made = extension.context.object.active_material
    assert metalness.says(made) == "Gold where the metalness map is white, plastic elsewhere"
    assert metalness.other(made).inputs["Roughness"].default_value == 0.75
    extension.context.scene.vgroove.preset = "plastics/red_plastic"
    run(extension, "apply")
    made = extension.context.object.active_material
    assert metalness.says(made) == "metal where the metalness map is white, Red Plastic elsewhere"
    assert metalness.other(made).inputs["Roughness"].default_value == 0.75


def test_an_image_set_comes_in_by_its_folder(extension, tmp_path):
    """A measured metal takes the colour as F82; without maps, or with a broken one, one line says so."""
    extension.context.scene.vgroove.preset = "metals/copper"
    run(extension, "apply")
    made = extension.context.object.active_material
    with pytest.raises(RuntimeError, match="no picture whose name tells"):
        run(extension, "add_image_set", directory=str(tmp_path))
    assert material.preset_of(made).kind == "conductor"
    for name in ("wall_color", "wall_roughness"):
        image = extension.data.images.new(name, 4, 4)
        image.filepath_raw, image.file_format = str(tmp_path / f"{name}.png"), "PNG"
        image.save()
    assert run(extension, "add_image_set", directory=str(tmp_path)) == {"FINISHED"}
    assert material.preset_of(made).kind == "f82"
    inputs = roles.node(made, roles.MODEL).inputs
    assert [inputs[name].is_linked for name in ("Base Color", "Roughness", "Normal")] == [True, True, False]
    assert made.name == "Copper"
    assert image_set.find(tmp_path).keys() == {"Base Color", "Roughness"}
