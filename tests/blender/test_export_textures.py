# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures through Blender's exporters: of presets of all families, and what Keep Textures puts beside a model."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import bake, convert, gltf, material, roles, textures
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.nodegroups import versions

from .exports import export, our_input, picture, several, shown

pytestmark = pytest.mark.blender

# The parameter of each model that means the same as Principled's Base Color; n and k of a conductor do not.
COLOUR = {"cook_torrance": "f0", "sum": "albedo", "oren_nayar": "albedo", "translucent": "reflectance", "glass": "tint"}


def carried(preset):
    """The parameters whose images the formats can carry, by what they feed."""
    inputs = {"color": COLOUR.get(preset.model), "roughness": "m"}
    if (preset.model, preset.kind) == ("glass", "interface") or (preset.model == "sum" and preset.kind != "dielectric"):
        inputs["color"] = None  # of a body's two surfaces, of both parts together
    if preset.model == "car_paint" or preset.parameters.get("m") == 0.0:
        inputs["roughness"] = None  # of several lobes; of none
    return {name: of for name, of in inputs.items() if of in preset.parameters}


@pytest.mark.once
def test_colour_and_roughness_images_of_every_family_are_read_back(exporters, tmp_path):
    """From both formats, at the same presets whose numbers are."""
    built, images = {}, {}
    for preset in several():
        made = built[preset.id] = build(preset, Choice(estimator=preset.spec.estimators[0]))
        shown(exporters, made)
        for what, parameter in carried(preset).items():
            name = f"{preset.id.replace('/', '_')}_{what}"
            picture(exporters, made, material.parameter_sockets(made)[parameter], name, data=what == "roughness")
            images[preset.id, what] = name
    assert len(built) >= 60
    assert len(images) > 0.9 * len(built)  # of smooth, clear and layered ones none, of most others two
    file, written, surfaces = export(exporters, tmp_path)
    uris = [file["images"][one["source"]]["uri"] for one in file["textures"]]
    for identity, made in built.items():
        of, surface = written[made.name]["pbrMetallicRoughness"], surfaces[made.name]
        for what, ours, theirs in (("color", "baseColorTexture", "diffuseColor"),
                                   ("roughness", "metallicRoughnessTexture", "roughness")):  # fmt: skip
            name, linked = images.get((identity, what)), surface.GetInput(theirs).GetConnectedSources()[0]
            assert (ours in of, bool(linked)) == (name is not None,) * 2, (identity, what)
            if name is not None:
                assert name in uris[of[ours]["index"]]
                assert linked[0].source.GetInput("file").Get().path == f"./textures/{name}.png"


def artists(blender, *, mixed=False):
    """A Principled with an image each for colour, alpha, emission and metalness; mixed: alpha as it once was made."""
    made = versions.empty_material("Leaf")
    tree = made.node_tree
    shader, output = tree.nodes.new("ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeOutputMaterial")
    shader.inputs["Emission Strength"].default_value = 2.0
    names = {"Base Color": "colour", "Emission Color": "glow", "Metallic": "metal"}
    for name, label in names.items():
        picture(blender, made, shader.inputs[name], label, data=label == "metal")
    shader.inputs["Roughness"].default_value = 0.25
    if mixed:
        mix = tree.nodes.new("ShaderNodeMixShader")
        mix.inputs[0].default_value = 0.25
        tree.links.new(shader.outputs[0], mix.inputs[1])
        tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[2])
        tree.links.new(mix.outputs[0], output.inputs["Surface"])
    else:
        picture(blender, made, shader.inputs["Alpha"], "leaf", data=True)
        tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


@pytest.mark.parametrize("estimator", ["closure", "mirror"])
def test_emission_alpha_and_metalness_are_read_back(exporters, tmp_path, estimator):
    """What Keep Textures took over; a strength above 1 as the formats have it. The material is as before."""
    made, lost = textures.build(presets.find("plastics/abs_plastic"), Choice(estimator=estimator), artists(exporters))
    assert lost == []
    shown(exporters, made)
    nodes = len(made.node_tree.nodes)
    file, written, surfaces = export(exporters, tmp_path)
    assert len(made.node_tree.nodes) == nodes
    uris = [file["images"][one["source"]]["uri"] for one in file["textures"]]
    one, surface = written[made.name], surfaces[made.name]
    metal = one["pbrMetallicRoughness"]
    assert uris[one["emissiveTexture"]["index"]] == "glow.png"
    assert one["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] == 2.0
    assert one["alphaMode"] == "BLEND"
    assert "leaf" in uris[metal["baseColorTexture"]["index"]]  # colour and alpha in one image
    assert "metal" in uris[metal["metallicRoughnessTexture"]["index"]]
    linked = {
        name: surface.GetInput(name).GetConnectedSources()[0][0] for name in ("emissiveColor", "opacity", "metallic")
    }
    files = {name: of.source.GetInput("file").Get().path for name, of in linked.items()}
    assert files == {
        "emissiveColor": "./textures/glow.png", "opacity": "./textures/leaf.png", "metallic": "./textures/metal.png",
    }  # fmt: skip
    assert tuple(linked["emissiveColor"].source.GetInput("scale").Get())[:3] == (2.0, 2.0, 2.0)
    assert {name: of.sourceName for name, of in linked.items()} == {
        "emissiveColor": "rgb", "opacity": "r", "metallic": "r",
    }  # fmt: skip


def test_values_of_emission_and_alpha_are_read_back(exporters, tmp_path):
    """Also an alpha that is the share which passes; what nodes compute is left out: opaque, and dark."""
    source = artists(exporters, mixed=True)
    (link,) = source.node_tree.nodes["Principled BSDF"].inputs["Emission Color"].links
    source.node_tree.links.remove(link)
    source.node_tree.nodes["Principled BSDF"].inputs["Emission Color"].default_value = (0.5, 0.25, 0.125, 1.0)
    made, _ = textures.build(presets.find("plastics/abs_plastic"), Choice(estimator="closure"), source)
    computed = made.copy()
    computed.name = "Computed"
    for node in [*roles.nodes(computed, roles.GLOW), *roles.nodes(computed, roles.CLEAR)]:
        inputs = node.inputs["Color"] if "Strength" in node.inputs else node.outputs[0].links[0].to_node.inputs[0]
        computed.node_tree.links.new(computed.node_tree.nodes.new("ShaderNodeTexNoise").outputs[0], inputs)
    for one in (made, computed):
        shown(exporters, one)
    _, written, surfaces = export(exporters, tmp_path)
    one, surface = written[made.name], surfaces[made.name]
    assert one["pbrMetallicRoughness"]["baseColorFactor"][3] == pytest.approx(0.75)
    assert one["emissiveFactor"] == pytest.approx([1.0, 0.5, 0.25])  # times the strength, which is no more than 1 then
    assert surface.GetInput("opacity").Get() == pytest.approx(0.75)
    assert tuple(surface.GetInput("emissiveColor").Get()) == pytest.approx((1.0, 0.5, 0.25))
    one, surface = written["Computed"], surfaces["Computed"]
    assert "emissiveFactor" not in one
    assert "alphaMode" not in one
    assert (surface.GetInput("opacity").Get(), tuple(surface.GetInput("emissiveColor").Get())) == (1.0, (0.0,) * 3)


@pytest.mark.parametrize("mixed", [False, True])
def test_emission_and_alpha_are_principled_s_own_after_conversion(blender, mixed):
    """So that they can be baked: one node is left, and its inputs have what stood beside the model."""
    made, _ = textures.build(presets.find("metals/gold"), Choice(estimator="fit"), artists(blender, mixed=mixed))
    item = shown(blender, made)
    done = convert.convert(made)
    kinds = {node.bl_idname for node in done.material.node_tree.nodes}
    assert not kinds & {"ShaderNodeMixShader", "ShaderNodeAddShader", "ShaderNodeEmission", "ShaderNodeBsdfTransparent"}
    inputs = done.node.inputs
    assert inputs["Emission Strength"].default_value == 2.0
    assert inputs["Alpha"].is_linked is not mixed
    if mixed:
        assert inputs["Alpha"].default_value == 0.75
    colours = {"Base Color": (0.5, 0.25, 0.0), "Emission Color": (0.0, 0.5, 0.0)}
    for name, color in colours.items():
        inputs[name].links[0].from_node.image.pixels.foreach_set(np.tile((*color, 1.0), 16).astype(np.float32))
    with headless.quiet():
        assert bake.bake(done, made, [item], 16) == []
    for name, color in colours.items():  # one value everywhere: a number
        linear = np.array(color) / 12.92 * (np.array(color) <= 0.04) + (
            ((np.array(color) + 0.055) / 1.055) ** 2.4 * (np.array(color) > 0.04)
        )
        assert not inputs[name].is_linked
        np.testing.assert_allclose(tuple(inputs[name].default_value)[:3], linear, atol=2e-3)


def test_what_an_artist_mixed_further_stays(blender):
    """A shader between the model and its emission is none of ours: only what joins the model directly is taken in."""
    made, _ = textures.build(presets.find("metals/gold"), Choice(estimator="closure"), artists(blender))
    tree, model = made.node_tree, roles.node(made, roles.MODEL)
    coat, mix = tree.nodes.new("ShaderNodeBsdfAnisotropic"), tree.nodes.new("ShaderNodeMixShader")
    (target,) = [link.to_socket for link in model.outputs[0].links]
    tree.links.new(model.outputs[0], mix.inputs[1])
    tree.links.new(coat.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], target)
    done = convert.convert(made)
    assert not done.node.inputs["Emission Color"].is_linked
    kinds = [node.bl_idname for node in done.material.node_tree.nodes]
    assert kinds.count("ShaderNodeBsdfAnisotropic") == kinds.count("ShaderNodeEmission") == 1
    gltf.put_in(made)
    gltf.take_out(made)
    assert our_input(made, "Base Color").is_linked
