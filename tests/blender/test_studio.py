# SPDX-License-Identifier: GPL-3.0-or-later
"""The studio of the presets' pictures: shapes by what a material is, right geometry, and an exposure for white."""

import bmesh
import numpy as np
import pytest
from mathutils.bvhtree import BVHTree

from vgroove import headless
from vgroove.addon.blender import material, shapes, slots, studio
from vgroove.addon.library import presets
from vgroove.lab import scenery

from ..commands import read_exr

pytestmark = pytest.mark.blender


def test_the_shape_follows_from_what_a_material_is():
    """Gems are cut, liquids stand in a glass, a sheet stands, cloth hangs. Opaque water is a ball."""
    shown = {}
    for preset in presets.shipped().values():
        shown.setdefault(preset.family, set()).add(studio.shape_of(preset))
    assert shown["gems"] == {"Gem"}
    assert shown["liquids"] == {"Liquid"}
    assert shown["cloth"] == shown["leather"] == {"Cloth"}
    assert shown["glasses"] == {"Ball", "Pane"}
    assert shown["metals"] == shown["car_paints"] == shown["lecture"] == {"Ball"}
    assert {shape for of in shown.values() for shape in of} == set(studio.SHAPES)
    assert studio.shape_of(presets.find("glasses/window")) == "Pane"


@pytest.mark.parametrize("make", [make for make, _ in studio.SHAPES.values()] + [shapes.tumbler, shapes.frame])
def test_shapes_are_whole_and_face_outward(blender, make):
    """Solids have an inside, which glass needs; sheets have one edge around. All stand on the ground."""
    made = bmesh.new()
    made.from_mesh(make())
    open_edges = sum(not edge.is_manifold for edge in made.edges)
    assert not any(edge.is_wire or len(edge.link_faces) > 2 for edge in made.edges)
    if make in {shapes.cloth, shapes.sheet, shapes.pane}:
        assert open_edges
    else:
        assert open_edges == 0
        assert made.calc_volume(signed=True) > 0.0
    assert -1e-6 < min(vertex.co.z for vertex in made.verts) < 0.009  # m; the liquid lies on the tumbler's base
    made.free()


def test_a_brilliant_has_57_flat_facets(blender):
    """Beside 16 of the girdle; its table is 57 % wide, its pavilion lies on the ground."""
    made = bmesh.new()
    made.from_mesh(shapes.gem())
    flat = [max(abs((corner.co - face.verts[0].co).dot(face.normal)) for corner in face.verts) for face in made.faces]
    assert max(flat) < 1e-8  # m: float32 rounds 4 cm by 2e-9
    girdle = [
        face
        for face in made.faces
        if abs(face.normal.dot((0, -np.sin(np.radians(40.75)), np.cos(np.radians(40.75))))) < 1e-3
    ]
    assert len(made.faces) - len(girdle) == 57
    table = max(made.faces, key=lambda face: len(face.verts))
    across = max((one.co - other.co).length for one in table.verts for other in table.verts)
    width = max((one.co - other.co).length for one in made.verts for other in made.verts)
    assert across / width == pytest.approx(0.57, abs=1e-3)
    lowest = sorted(vertex.co.z for vertex in made.verts)[:4]
    assert lowest == pytest.approx([0.0] * 4, abs=1e-8)  # a main facet of the pavilion
    made.free()


def wall(mesh, height):
    """How far it is to the mesh from the axis at a height, m."""
    made = bmesh.new()
    made.from_mesh(mesh)
    hit = BVHTree.FromBMesh(made).ray_cast((0.0, 0.0, height), (np.cos(0.01), np.sin(0.01), 0.0))
    made.free()
    return hit[3]


def test_the_liquid_reaches_a_little_into_its_glass(blender):
    """All the way up to its level: a gap would mirror. Not halfway through the wall of 2 mm or more."""
    glass, liquid = shapes.tumbler(), shapes.liquid()
    for height in np.linspace(0.9, shapes.LEVEL - 0.01, 10) * shapes.CM:
        assert 5e-5 < wall(liquid, height) - wall(glass, height) < 1e-3, height


def picture(shown, path):
    """In full precision, of few pixels."""
    scenery.write_exact(shown, 64)
    shown.cycles.samples = 64
    with headless.quiet():
        studio.picture(shown, path)
    return read_exr(path)[0]


def test_white_is_exposed_to_four_fifths_and_silver_is_not_burnt_out(blender, tmp_path):
    """White: the mean of the brightest hundredth, which two seeds give within 0.01. Silver: the glow of the key light
    alone is above 1, where a lamp's mirror image has to be; the body is two fifths of the picture.
    """
    with headless.quiet():
        shown = studio.scene()
    for one in shown.collection.children:
        one.hide_render = one.name != studio.BALL
    white = scenery.surface("White", lambda tree: scenery.add_node(tree, "BsdfDiffuse", Color=(1.0, 1.0, 1.0)))
    slots.apply(white, [shown.objects[studio.BALL]])
    light = picture(shown, tmp_path / "white.exr")
    brightest = np.sort(light[..., 1], axis=None)[-light[..., 1].size // 100 :]
    assert brightest.mean() == pytest.approx(0.8, abs=0.02)
    preset = presets.find("metals/silver")
    studio.show(shown, preset, material.build(preset, material.Choice("nodes", "closure")))
    assert np.mean(np.any(picture(shown, tmp_path / "silver.exr") > 1.0, axis=-1)) < 0.03


class WithoutDenoiser:
    """Settings of Cycles as Debian's Blender has them."""

    @property
    def denoiser(self):
        return ""

    @denoiser.setter
    def denoiser(self, value):
        message = f'enum "{value}" not found in ()'
        raise TypeError(message)


def test_where_blender_has_no_denoiser_more_samples_take_its_place(blender):
    """Debian's is built without one, and the picture of one's own preset has to be made there too."""
    less = WithoutDenoiser()
    studio.remove_noise(less)
    assert (less.use_denoising, less.samples) == (False, 4 * studio.SAMPLES)
    cycles = blender.context.scene.cycles
    studio.remove_noise(cycles)
    assert cycles.use_denoising
