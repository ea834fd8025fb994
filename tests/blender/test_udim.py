# SPDX-License-Identifier: GPL-3.0-or-later
"""A set of UDIM tiles on one of our materials, rendered: each tile shows where its UVs are."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import gonio, image_set, material, roles, textures
from vgroove.addon.blender.material import Choice
from vgroove.addon.library import presets
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender

TILES = {1001: (200, 60, 30), 1002: (40, 90, 180)}  # sRGB of 8 bits; tile 1002 is where U goes from 1 to 2


def decoded(of):
    """Linear light of sRGB: IEC 61966-2-1."""
    s = np.array(of) / 255.0
    return ((s + 0.055) / 1.055) ** 2.4


@pytest.fixture
def tiles(blender, tmp_path):
    """Two tiles of a colour map, each of one colour."""
    for number, color in TILES.items():
        image = blender.data.images.new("Tile", 4, 4)
        image.pixels[:] = np.tile([*(np.array(color) / 255.0), 1.0], 16).tolist()
        image.filepath_raw, image.file_format = str(tmp_path / f"wall_color.{number}.png"), "PNG"
        image.save()
        blender.data.images.remove(image)
    return tmp_path


def rendered(blender, made):
    """A square under a white sky from above, (4, 4, 3), whose UVs go from 0 to 2 along x."""
    with headless.quiet(), gonio.stage((4, 4), samples=16, seed=0, shading_osl=False) as stage:
        gonio.light(stage, gonio.Geometry(furnace=True))
        mesh = blender.data.meshes.new("Wall")
        mesh.from_pydata([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [], [(0, 1, 2, 3)])
        uv = mesh.uv_layers.new(name="UVMap")
        for loop, place in zip(uv.data, [(0, 0), (2, 0), (2, 1), (0, 1)], strict=True):
            loop.uv = place
        mesh.materials.append(made)
        stage.collection.objects.link(blender.data.objects.new("Wall", mesh))
        gonio.look_down(stage, 2.0)
        return gonio.rendered(stage)


@pytest.mark.parametrize("way", ["image set", "kept"])
def test_tiles_show_where_their_uvs_are(blender, tiles, way):
    """By Add Image Set, and kept as another material's: a Lambertian under a white sky is as bright as its colour.

    Each sample of one is drawn by its cosine and sees 1, so that the mean has no noise; Cycles' textures and rendered
    images hold half floats at worst, which round by 2^-11 each.
    """
    clay = presets.find("diffuse/clay").with_parameters(sigma=0.0)
    made = material.build(clay, Choice(estimator="closure"))
    found = image_set.load(made.node_tree, image_set.find(tiles))
    assert textures.give(made, found) == []
    if way == "kept":
        source = versions.empty_material("Artist's")
        shader, sink = (
            source.node_tree.nodes.new(f"ShaderNode{kind}") for kind in ("BsdfPrincipled", "OutputMaterial")
        )
        image = source.node_tree.nodes.new("ShaderNodeTexImage")
        image.image = roles.node(made, roles.MODEL).inputs["Base Color"].links[0].from_node.image
        source.node_tree.links.new(image.outputs[0], shader.inputs["Base Color"])
        source.node_tree.links.new(shader.outputs[0], sink.inputs["Surface"])
        made, lost = textures.build(clay, Choice(estimator="closure"), source)
        assert lost == []
    seen = rendered(blender, made)
    for number, half in zip(TILES, (seen[:, :2], seen[:, 2:]), strict=True):
        expected = np.broadcast_to(decoded(TILES[number]), half.shape)
        np.testing.assert_allclose(half, expected, rtol=2.0**-10)
