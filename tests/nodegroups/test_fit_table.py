# SPDX-License-Identifier: GPL-3.0-or-later
"""The image that carries the table of ``fit``: one for all materials, exact, and in the .blend that needs it."""

from contextlib import contextmanager

import numpy as np
import pytest

from vgroove import headless, nodegroups
from vgroove.addon.blender import colour_space, gonio, material
from vgroove.addon.blender.material import Choice
from vgroove.addon.blender.rebuild import rebuild
from vgroove.addon.choose import advice
from vgroove.addon.reference.cook_torrance_fit import FUNCTIONS, interpolated, tables
from vgroove.lab.check.cook_torrance import materials
from vgroove.lab.check.rows import SETUPS
from vgroove.nodegroups import REVISION_KEY, fit_table
from vgroove.nodegroups.versions import empty_material

pytestmark = pytest.mark.blender


def numbers(image):
    """Pixels, row 0 at the bottom."""
    found = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(found)
    return found.reshape(image.size[1], image.size[0], 4)


def images():
    import bpy

    return [image for image in bpy.data.images if image.name.startswith(fit_table.TABLE.name)]


def build(fresnel="schlick", estimator="fit", backend="nodes"):
    return material.build(materials()[fresnel], Choice(backend, estimator))


def test_the_image_holds_the_table(blender):
    """To the last digit, as numbers and not as colours, and small enough for Simplify to leave it alone."""
    image = fit_table.TABLE.ensure()
    np.testing.assert_array_equal(numbers(image), fit_table.pixels())
    assert image.is_float
    assert image.packed_file
    assert image.colorspace_settings.name == "Non-Color"
    assert max(image.size) <= 128  # the least texture limit of Simplify
    assert image.packed_file.size < 101_000


def test_all_materials_share_one_image(blender):
    """Whatever their Fresnel term, estimator and backend; one of another revision stays with what it came with."""
    build()
    build("dielectric", "fit", "osl")
    build("schlick", "hybrid")
    (old,) = images()
    old[REVISION_KEY] = fit_table.TABLE.revision - 1
    new = fit_table.TABLE.ensure()
    assert new is not old
    assert fit_table.TABLE.ensure() is new


def test_the_image_travels_with_a_material(blender, tmp_path):
    """Saved, and appended to a file that has none."""
    import bpy

    made = build()
    made.use_fake_user, name = True, made.name
    path = str(tmp_path / "fit.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert not images()
    with bpy.data.libraries.load(path) as (_, into):
        into.materials = [name]
    (image,) = images()
    assert image.library is None
    np.testing.assert_array_equal(numbers(image), fit_table.pixels())
    build()
    assert images() == [image]


def test_a_deleted_image_comes_back(blender):
    """*Update* restores it, and so does any rebuild, for every material and to the same groups."""
    made = build()
    build("dielectric", "hybrid", "osl")
    groups = {group.name for group in blender.data.node_groups}
    assert not fit_table.TABLE.nodes_without()
    for by in ("advice", "rebuild"):
        blender.data.images.remove(fit_table.TABLE.ensure())
        assert fit_table.TABLE.nodes_without()
        if by == "advice":
            shown = blender.context.scene
            found = {p.key: p for p in advice.problems_with(shown, materials()["schlick"], "nodes", "fit")}
            assert "render pink" in found["table"].text
            found["table"].fix()
        else:
            rebuild(made, blender.context.scene)
        assert not fit_table.TABLE.nodes_without()
        (image,) = images()
        np.testing.assert_array_equal(numbers(image), fit_table.pixels())
        assert {group.name for group in blender.data.node_groups} == groups


@contextmanager
def working_space(name):
    """The file's working space, where this Blender lets one choose."""
    import bpy

    known = getattr(bpy.data, "colorspace", None)
    before = known and known.working_space
    if known:
        bpy.ops.wm.set_working_color_space(convert_colors=False, working_space=name)
    try:
        yield
    finally:
        if known:
            bpy.ops.wm.set_working_color_space(convert_colors=False, working_space=before)


@pytest.mark.parametrize("setup", [SETUPS[0], SETUPS[1]], ids=str)
@pytest.mark.parametrize("space", ["Linear Rec.709", "ACEScg"])
def test_cycles_looks_numbers_up_as_the_reference_does(instrument, setup, space):
    """Between nodes too, in every block, whatever the working space.

    Places round by 2^-24 of up to 82 pixels, a few times, which counts by how much neighbours differ: less than 1. What
    is summed rounds by 2^-24 of numbers below 2.
    """
    places = np.random.default_rng(3).random((6, 2))
    expected = {name: interpolated(tables()[name], places[:, 0], places[:, 1]) for name in FUNCTIONS}
    weight, roughness, anisotropy, tilt = expected.values()
    with working_space(space):
        for place, *of in zip(places, weight, roughness, anisotropy, tilt, strict=True):
            w, r, a, t = of
            blocks = [w, (r[1], a[1], t[1]), (r[2], a[2], t[2])]
            for block, wanted in enumerate(blocks):
                np.testing.assert_allclose(looked_up(setup, block, *place), wanted, atol=1e-5)
            np.testing.assert_allclose(looked_up(setup, 0, *place, alpha=True), np.full(3, r[0]), atol=1e-5)


def looked_up(setup, block, u, root, *, alpha=False):
    """What Cycles gives at u and m^(1/2), as light, which may be negative."""

    def build(tree):
        at = [
            tree.input_float(name, number, low=0.0, high=1.0, tip="Place")
            for name, number in (("u", u), ("root", root))
        ]
        over, of_m = at
        color, fourth = fit_table.look_up(tree, over + 0.25, 0.25 + 0.0 * of_m, of_m)[block]
        shown = tree.node("ShaderNodeEmission", Color=fourth if alpha else color)
        tree.output_shader("Found", shown.outputs[0], tip="As light")

    made = empty_material("Look up")
    group, sink = (made.node_tree.nodes.new(f"ShaderNode{kind}") for kind in ("Group", "OutputMaterial"))
    group.node_tree = nodegroups.make("Look up", 1, build)
    made.node_tree.links.new(group.outputs[0], sink.inputs["Surface"])
    with headless.quiet():
        image = gonio.measure(made, gonio.Geometry(resolution=(4, 4)), shading_osl=setup.shading_osl)
    return colour_space.matrix() @ image[1, 1]  # which was turned into Rec.709
