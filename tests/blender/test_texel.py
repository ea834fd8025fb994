# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures at a clicked point: the face's material, the UVs, and the values as Cycles itself reads them."""

import numpy as np
import pytest
from mathutils import Vector
from numpy.testing import assert_allclose

from vgroove import headless
from vgroove.addon.blender import gonio, lobes, material, texel
from vgroove.addon.library import presets
from vgroove.addon.reference import spherical
from vgroove.nodegroups import versions

pytestmark = pytest.mark.blender
SIZE = 4
DOWN = Vector((0.0, 0.0, -1.0))


@pytest.fixture
def image(blender):
    """A function that makes an image of random colors: 8 bits in sRGB, or as data."""

    def make(kind="sRGB"):
        made = blender.data.images.new("Noise", SIZE, SIZE, float_buffer=kind == "float")
        if kind != "float":
            made.colorspace_settings.name = kind
        made.pixels.foreach_set(np.random.default_rng(5).random((SIZE, SIZE, 4)).astype(np.float32).ravel())
        made.update()
        return made

    yield make
    texel.forget()


def textured(image, vector=None, **options):
    """Matte with an image for its color; ``vector``: a function that gives the texture's vector."""
    made = material.build(presets.find("diffuse/clay"), material.Choice())
    tree = made.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    for name, value in options.items():
        setattr(node, name, value)
    if vector:
        tree.links.new(vector(tree), node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], material.parameter_sockets(made)["albedo"])
    return made


def mapping(kind):
    def add(tree):
        node, uv = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
        node.vector_type = kind
        node.inputs["Rotation"].default_value = (0.0, 0.0, 0.4)
        node.inputs["Scale"].default_value = (1.5, 0.7, 1.0)
        if kind != "VECTOR":
            node.inputs["Location"].default_value = (0.1, -0.3, 0.0)
        tree.links.new(uv.outputs["UV"], node.inputs["Vector"])
        return node.outputs[0]

    return add


def shown(blender, image, uv, vector=None, **options):
    """What Cycles shows of an emission with the texture on a plane whose UVs are all ``uv``."""
    made = versions.empty_material("Shine")
    tree = made.node_tree
    node, glow, output = (
        tree.nodes.new(kind) for kind in ("ShaderNodeTexImage", "ShaderNodeEmission", "ShaderNodeOutputMaterial")
    )
    node.image = image
    for name, value in options.items():
        setattr(node, name, value)
    if vector:
        tree.links.new(vector(tree), node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], output.inputs["Surface"])
    with headless.quiet(), gonio.stage((4, 4), samples=1, seed=0, shading_osl=False) as scene:
        mesh = blender.data.meshes.new("Plane")
        mesh.from_pydata([(-4, -3, 0), (4, -3, 0), (0, 5, 0)], [], [(0, 1, 2)])
        mesh.materials.append(made)
        for one in mesh.uv_layers.new(name="UVMap").uv:
            one.vector = uv
        scene.collection.objects.link(blender.data.objects.new("Plane", mesh))
        gonio.look_down(scene, 1.0)
        return gonio.rendered(scene)[2, 2]


CASES = {
    "plain": ("sRGB", {}, None),
    "closest": ("sRGB", {"interpolation": "Closest"}, None),
    "data": ("Non-Color", {}, None),
    "float": ("float", {}, None),
    "mirror": ("sRGB", {"extension": "MIRROR"}, None),
    "extend": ("sRGB", {"extension": "EXTEND"}, None),
    "clip": ("sRGB", {"extension": "CLIP", "interpolation": "Closest"}, None),
    "point": ("sRGB", {}, mapping("POINT")),
    "texture": ("sRGB", {}, mapping("TEXTURE")),
    "vector": ("sRGB", {}, mapping("VECTOR")),
}


@pytest.mark.parametrize("case", CASES)
def test_a_texture_is_read_as_cycles_reads_it(blender, image, case):
    """Within what 8 bits of sRGB and float32 UVs leave; between texels, outside the image, through a mapping."""
    kind, options, vector = CASES[case]
    of = image(kind)
    for pixel in range(3, 4 * SIZE * SIZE, 4):
        of.pixels[pixel] = 1.0
    for uv in ((0.31, 0.62), (1.27, -0.4)):
        expected = shown(blender, of, uv, vector, **options)
        found = texel.read(textured(of, vector, **options), {texel.ACTIVE: uv})
        assert found.unread == ()
        assert_allclose(found.values["albedo"], expected, rtol=0.0, atol=2e-3)


def test_what_is_not_read_is_named(blender, image):
    """Other nodes, other coordinates; and a normal map."""

    def generated(tree):
        return tree.nodes.new("ShaderNodeTexCoord").outputs["Generated"]

    made = textured(image(), generated)
    assert texel.read(made, {texel.ACTIVE: (0.5, 0.5)}) == texel.Read({}, ("Base Color",))
    made = textured(image())
    tree = made.node_tree
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[1], material.parameter_sockets(made)["albedo"])
    normal = next(one for node in tree.nodes for one in node.inputs if one.name == "Normal" and node.type == "GROUP")
    tree.links.new(tree.nodes.new("ShaderNodeNormalMap").outputs[0], normal)
    assert texel.read(made, {texel.ACTIVE: (0.5, 0.5)}) == texel.Read({}, ("Base Color", "Normal"))


def test_a_channel_reaches_a_number(blender, image):
    """Green as roughness, whose square is the slope; a named UV map."""
    of = image("Non-Color")
    made = material.build(presets.find("lecture/copper"), material.Choice())
    tree = made.node_tree
    node, split, uv = (
        tree.nodes.new(kind) for kind in ("ShaderNodeTexImage", "ShaderNodeSeparateColor", "ShaderNodeUVMap")
    )
    node.image, node.interpolation, uv.uv_map = of, "Closest", "Second"
    tree.links.new(uv.outputs[0], node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], split.inputs[0])
    tree.links.new(split.outputs[1], material.parameter_sockets(made)["m"])
    uvs = {texel.ACTIVE: (0.9, 0.9), "Second": (0.1, 0.1)}
    green = np.array(of.pixels[:4])[1]
    assert texel.read(made, uvs).values["m"] == pytest.approx(green**2, rel=1e-4)
    wi = spherical(0.5)
    found = lobes.of_material(made, wi, uvs=uvs)
    expected = presets.find("lecture/copper").with_parameters(m=float(green**2)).reference()
    assert_allclose(found.rgb, expected.evaluate(wi, found.wo), rtol=1e-4)


def test_the_clicked_face_has_its_material_and_uvs(blender):
    """A plane of two faces and materials, turned and scaled."""
    mesh = blender.data.meshes.new("Two")
    mesh.from_pydata(
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (1, 1, 0), (2, 1, 0)], [], [(0, 1, 4, 3), (1, 2, 5, 4)]
    )
    both = [blender.data.materials.new(name) for name in ("Left", "Right")]
    for one in both:
        mesh.materials.append(one)
    mesh.polygons[1].material_index = 1
    layer = mesh.uv_layers.new(name="Map")
    for loop in mesh.loops:
        x, y, _ = mesh.vertices[loop.vertex_index].co
        layer.uv[loop.index].vector = (x / 2.0, y)
    item = blender.data.objects.new("Two", mesh)
    item.scale = (3.0, 2.0, 1.0)
    blender.context.collection.objects.link(item)
    blender.context.view_layer.update()
    for x, expected in ((0.3, both[0]), (1.9, both[1])):
        graph = blender.context.evaluated_depsgraph_get()
        hit = texel.surface_at(blender.context.scene, graph, Vector((3.0 * x, 2.0 * 0.8, 5.0)), DOWN)
        assert hit.material == expected
        assert_allclose(hit.uvs["Map"], (x / 2.0, 0.8), atol=1e-6)
        assert hit.uvs[texel.ACTIVE] == hit.uvs["Map"]
        assert texel.loads(texel.dumps(hit.uvs)) == hit.uvs
    assert texel.loads("[1") == {}
