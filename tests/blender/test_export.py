# SPDX-License-Identifier: GPL-3.0-or-later
"""Our materials through Blender's own exporters, and back from the files; and as Principled in Blender itself."""

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import bake, convert, gltf, material, principled, roles
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.addon.reference.facet_distribution import Distribution

from .exports import export, our_input, picture, several, shown

pytestmark = pytest.mark.blender

ROUNDING = {"rel": 1e-5, "abs": 1e-6}  # float32 sockets, and the digits of text files


def of_gltf(one):
    """Numbers of a glTF material, with the defaults of its specification."""
    metal, more = one["pbrMetallicRoughness"], one.get("extensions", {})
    volume = more.get("KHR_materials_volume", {})
    return {
        "color": metal.get("baseColorFactor", [1.0] * 4)[:3],
        "metallic": metal.get("metallicFactor", 1.0),
        "roughness": metal.get("roughnessFactor", 1.0),
        "ior": more.get("KHR_materials_ior", {}).get("ior", 1.5),
        "specular": more.get("KHR_materials_specular", {}).get("specularFactor", 1.0),
        "transmission": more.get("KHR_materials_transmission", {}).get("transmissionFactor", 0.0),
        "coat": more.get("KHR_materials_clearcoat", {}).get("clearcoatFactor", 0.0),
        "left": np.array(volume.get("attenuationColor", [1.0] * 3)) ** (1.0 / volume.get("attenuationDistance", 1.0)),
    }


def of_usd(surface):
    """Numbers of a USD preview surface."""
    names = {"color": "diffuseColor", "metallic": "metallic", "roughness": "roughness", "ior": "ior",
             "opacity": "opacity", "coat": "clearcoat"}  # fmt: skip
    found = {name: surface.GetInput(of).Get() for name, of in names.items()}
    return found | {"color": tuple(found["color"])}


def expected(preset):
    """What a material should be in any format, by its numbers."""
    of = preset.parameters
    rough = {"roughness": min(1.0, of["m"] ** 0.5)} if "m" in of else {"roughness": 1.0}
    return rough | EXPECTED[preset.model](preset, of)


def _glass(preset, of):
    color = of["tint"] if preset.kind == "thin" else np.square(of["tint"])
    return {"color": color, "metallic": 0.0, "transmission": 1.0, "ior": of["eta"]}


def _car_paint(preset, of):
    lobes = range(1, preset.lobes + 1)
    coat = min(lobes, key=lambda k: of[f"m_{k}"])
    others = [k for k in lobes if k != coat]
    weights = [of[f"s_{k}"] * np.mean(of[f"f0_{k}"]) for k in others]
    color = np.add(of["albedo"], sum(of[f"s_{k}"] * np.array(of[f"f0_{k}"]) for k in others))
    slope = np.average([of[f"m_{k}"] for k in others], weights=weights)
    return {"color": color, "coat": of[f"s_{coat}"] * np.mean(of[f"f0_{coat}"]) / 0.04, "roughness": slope**0.5}


def _sum(preset, of):
    below, F = of["d"] * np.array(of["albedo"]), preset.reference_fresnel()(1.0)
    if preset.kind == "dielectric":
        return {"color": below, "metallic": 0.0, "specular": of["s"], "ior": of["eta"]}
    return {"color": below + of["s"] * F, "metallic": of["s"] / (of["s"] + of["d"])}


def _anisotropic(preset, of):
    if preset.kind == "dielectric":
        return {"color": (0.0, 0.0, 0.0), "metallic": 0.0, "ior": of["eta"]}
    return {"color": preset.reference_fresnel()(1.0), "metallic": 1.0}


def _phong(_preset, of):
    """Up to the reflectance of an index of 3 a dielectric, above a mixture with a metal."""
    below, specular = np.array(of["albedo"]), np.array(of["specular"])
    m = (2.0 * of["exponent"] + 1.0) ** -0.5 if "exponent" in of else (2.0 / (of["shininess"] + 2.0)) ** 0.5
    if specular.max() <= 0.25:
        index = (1.0 + specular.max() ** 0.5) / (1.0 - specular.max() ** 0.5)
        return {"color": below, "metallic": 0.0, "ior": index, "roughness": m**0.5}
    metallic = specular.mean() / (below + specular).mean()
    return {"color": below + specular, "metallic": metallic, "specular": 0.0, "roughness": m**0.5}


def _ward(preset, of):
    """As Phong's; its roughness is the slope's, as any model's."""
    found = _phong(preset, of | {"shininess": 0.0})
    return {key: value for key, value in found.items() if key != "roughness"}


def _ashikhmin_shirley(preset, of):
    """As Phong, but for what enters the surface: below the share Rs of a mixture with a metal."""
    specular, rough = np.array(of["specular"]) * of["amplitude"], (2.0 / (of["sharpness"] + 2.0)) ** 0.25
    if specular.max() <= 0.25:
        index = (1.0 + specular.max() ** 0.5) / (1.0 - specular.max() ** 0.5)
        return {"color": of["albedo"], "metallic": 0.0, "ior": index, "roughness": rough}
    total = specular + (1.0 - np.array(of["specular"]) * (preset.kind == "plain")) * of["albedo"]
    return {"color": total, "metallic": specular.mean() / total.mean(), "specular": 0.0, "roughness": rough}


def _generator(preset, of):
    below, rough = np.array(of["albedo"]), Distribution(preset.distribution).slope ** 0.5
    f0 = np.array(of["specular"]) * preset.reference_fresnel()(1.0)
    if below.max() == 0.0 or preset.kind in {"conductor", "f82"}:
        return {"color": f0, "metallic": 1.0, "roughness": rough}
    return {
        "color": below,
        "metallic": 0.0,
        "ior": (1.0 + f0.max() ** 0.5) / (1.0 - f0.max() ** 0.5),
        "roughness": rough,
    }


EXPECTED = {
    "ashikhmin_shirley": _ashikhmin_shirley,
    "phong": _phong,
    "blinn_phong": _phong,
    "ward": _ward,
    "generator": _generator,
    "anisotropic": _anisotropic,
    "cook_torrance": lambda preset, _: {"color": preset.reference_fresnel()(1.0), "metallic": 1.0},
    "oren_nayar": lambda _, of: {"color": of["albedo"], "metallic": 0.0, "specular": 0.0},
    "translucent": lambda _, of: {"color": of["reflectance"], "metallic": 0.0, "specular": 1.0, "ior": of["eta"]},
    "glass": _glass,
    "car_paint": _car_paint,
    "sum": _sum,
}


def test_gltf_and_usd_carry_colour_roughness_and_the_rest(exporters, tmp_path):
    """Of presets of every family and kind, by every estimator in turn; the materials are as before, also unedited."""
    built = {}
    for index, preset in enumerate(several()):
        known = preset.spec.estimators
        built[preset.id] = build(preset, Choice(estimator=known[index % len(known)]))
        shown(exporters, built[preset.id])
    assert len(built) >= 60
    nodes = {one.name: len(one.node_tree.nodes) for one in built.values()}
    _, written, surfaces = export(exporters, tmp_path)
    assert {one.name: len(one.node_tree.nodes) for one in built.values()} == nodes
    assert not any(material.is_edited(one) for one in built.values())
    for identity, made in built.items():
        preset = presets.find(identity)
        wanted, has = expected(preset), of_gltf(written[made.name])
        for name, value in wanted.items():
            assert has[name] == pytest.approx(value, **ROUNDING), (identity, name)
        assert has["left"] == pytest.approx(left_after_a_metre(preset), **ROUNDING), identity
        has = of_usd(surfaces[made.name])
        for name, value in (wanted | in_usd(wanted, preset)).items():
            assert name not in has or has[name] == pytest.approx(value, **ROUNDING), (identity, name)


def left_after_a_metre(preset):
    """Of light on its way through."""
    taken = preset.parameters.get("absorption", (0.0,) * 3)
    return np.exp(-np.array(taken))


def in_usd(wanted, preset):
    """What is different there: no volume, no transmission, and one number for IOR and Specular."""
    root = (wanted.get("ior", 1.5) - 1.0) / (wanted.get("ior", 1.5) + 1.0) * wanted.get("specular", 1.0) ** 0.5
    found = {"color": wanted["color"] * left_after_a_metre(preset), "opacity": 1.0 - wanted.get("transmission", 0.0)}
    matters = wanted.get("metallic", 1.0) == 0.0  # a metal has none, and a car paint its coat's
    return found | ({"ior": (1.0 + root) / (1.0 - root)} if matters else {})


# What is linked


TEXTURED = {  # what feeds the colour, and by what its texture is multiplied
    "metals_schlick/aluminium_schlick": ("f0", 1.0),
    "lecture/copper": ("f0", 1.0),
    "ceramics/bone_china": ("albedo", 1.0),
    "plastics/red_plastic": ("albedo", 0.5),
    "diffuse/brick": ("albedo", 1.0),
    "organic/beeswax": ("reflectance", 1.0),
    "glasses/window": ("tint", 1.0),
}


def test_images_are_carried_to_what_means_the_same(exporters, tmp_path):
    """With the share that the model gives them, the placing by a UV map, and a normal map."""
    bpy, made = exporters, {}
    for identity, (parameter, _) in TEXTURED.items():
        made[identity] = build(presets.find(identity), Choice(estimator=presets.find(identity).spec.estimators[0]))
        shown(bpy, made[identity])
        name = identity.replace("/", "_")
        node = picture(bpy, made[identity], material.parameter_sockets(made[identity])[parameter], name)
        mapping, tree = node.id_data.nodes.new("ShaderNodeMapping"), node.id_data
        uv = tree.nodes.new("ShaderNodeUVMap")
        uv.uv_map = "UVMap"
        mapping.inputs["Scale"].default_value = (2.0, 3.0, 1.0)
        tree.links.new(uv.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    brick = made["diffuse/brick"]
    normal = brick.node_tree.nodes.new("ShaderNodeNormalMap")
    normal.inputs["Strength"].default_value = 0.5
    picture(bpy, brick, normal.inputs["Color"], "bumps", data=True)
    brick.node_tree.links.new(normal.outputs["Normal"], our_input(brick, "Normal"))
    file, written, surfaces = export(bpy, tmp_path)
    images = [file["images"][one["source"]]["uri"] for one in file["textures"]]
    for identity, (_, factor) in TEXTURED.items():
        name, one = identity.replace("/", "_"), written[made[identity].name]
        texture = one["pbrMetallicRoughness"]["baseColorTexture"]
        assert images[texture["index"]] == f"{name}.png"
        assert texture["extensions"]["KHR_texture_transform"]["scale"] == [2.0, 3.0]
        assert of_gltf(one)["color"] == pytest.approx([factor] * 3, **ROUNDING)
        image = surfaces[made[identity].name].GetInput("diffuseColor").GetConnectedSources()[0][0].source
        assert image.GetInput("file").Get().path == f"./textures/{name}.png"
        assert image.GetInput("sourceColorSpace").Get() == "sRGB"
        scale = image.GetInput("scale").Get()
        assert (scale or [1.0])[0] == pytest.approx(factor)
        placed = image.GetInput("st").GetConnectedSources()[0][0].source
        assert tuple(placed.GetInput("scale").Get()) == (2.0, 3.0)
        reader = placed.GetInput("in").GetConnectedSources()[0][0].source
        assert reader.GetInput("varname").Get() == "st"  # as Blender calls the active UV map
    brick_in_gltf = written[brick.name]["normalTexture"]
    assert (images[brick_in_gltf["index"]], brick_in_gltf["scale"]) == ("bumps.png", 0.5)
    image = surfaces[brick.name].GetInput("normal").GetConnectedSources()[0][0].source
    assert (tuple(image.GetInput("scale").Get()), tuple(image.GetInput("bias").Get())) == (
        (1.0, 1.0, 2.0, 1.0), (-0.5, -0.5, -1.0, 0.0),
    )  # fmt: skip


def test_a_roughness_map_is_carried(blender):
    """The input holds Principled's own roughness."""
    made = build(presets.find("ceramics/bone_china"), Choice(estimator="closure"))
    picture(blender, made, material.parameter_sockets(made)["m"], "rough", data=True)
    found = principled.describe(made)["Roughness"]
    assert found.image is not None
    assert found.value == pytest.approx(0.02**0.5)


def test_numbers_of_no_material_export_as_nothing(exporters, tmp_path):
    """And do not stop the export: n and k that are both 0."""
    made = build(presets.find("metals/copper"), Choice(estimator="closure"))
    shown(exporters, made)
    for name in "nk":
        material.parameter_sockets(made)[name].default_value = (0.0, 0.0, 0.0)
    with pytest.raises(material.MaterialError, match="Copper: n and k must not both be 0"):
        principled.describe(made)
    _, written, surfaces = export(exporters, tmp_path)
    assert "pbrMetallicRoughness" not in written["Copper"]
    assert not surfaces["Copper"]


# What glTF puts in


@pytest.mark.parametrize(("identity", "estimator"), [("metals/copper", "fit"), ("metals/copper", "closure"),
                                                     ("plastics/abs_plastic", "mirror")])  # fmt: skip
def test_what_gltf_puts_in_changes_no_pixel(balls, identity, estimator):
    """Neither mixed in by 0 nor at an output of its own; and it is taken out again, also if an export failed."""
    preset = presets.find(identity)

    def make(_stage, *, put_in):
        made = build(preset, Choice(estimator=estimator))
        gltf.take_out(made)
        if put_in:
            before = [node.name for node in made.node_tree.nodes]
            for _ in range(2):
                gltf.put_in(made)
            assert made.node_tree.get_output_node("CYCLES").get(roles.KEY) == roles.OUTPUT
            assert sum(node.bl_idname == principled.KIND for node in made.node_tree.nodes) == 1
            gltf.take_out(made)
            assert [node.name for node in made.node_tree.nodes] == before
            assert not material.is_edited(made)
            gltf.put_in(made)
        return [made]

    without, within = (balls(lambda stage, of=of: make(stage, put_in=of)) for of in (False, True))
    np.testing.assert_array_equal(without, within)


# As Principled in Blender

ALIKE = ("metals/copper", "metals_schlick/aluminium_schlick", "ceramics/bone_china", "diffuse/brick",
         "car_paints/polaris_silver", "car_paints/white", "glasses/bk7_crown_glass", "glasses/window")  # fmt: skip


def test_converted_materials_send_back_as_much(balls):
    """In a white furnace. By at most 2.5 %: GGX is another distribution, and Principled replaces what G takes away."""

    def make(_stage, *, converted):
        made = [build(presets.find(one), Choice(estimator="closure")) for one in ALIKE]
        return [convert.convert(one).material for one in made] if converted else made

    ours, theirs = (balls(lambda stage, of=of: make(stage, converted=of), samples=64) for of in (False, True))
    for identity, a, b in zip(ALIKE, ours.mean(axis=(1)), theirs.mean(axis=(1)), strict=True):
        np.testing.assert_allclose(b, a, rtol=0.025, err_msg=identity)


def test_conversion_keeps_links_and_says_what_it_leaves_out(blender):
    """Of a material that is mixed with another shader, plays, and has links that Principled has no place for."""
    made = build(presets.find("metals/copper"), Choice(estimator="fit"))
    tree, sockets = made.node_tree, material.parameter_sockets(made)
    picture(blender, made, sockets["n"], "index")
    rough = picture(blender, made, sockets["m"], "rough", data=True)
    mix, other = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeEmission")
    output = tree.get_output_node("CYCLES")
    tree.links.new(output.inputs["Surface"].links[0].from_socket, mix.inputs[1])
    tree.links.new(other.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    done = convert.convert(made)
    assert done.left == ["what is linked to IOR"]
    new = done.material
    assert (new.name, material.is_ours(new), material.is_ours(made)) == ("Copper Principled", False, True)
    assert not any(node.bl_idname == "ShaderNodeGroup" for node in new.node_tree.nodes)
    assert [node.target for node in new.node_tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"] == ["ALL"]
    assert done.node.outputs[0].links[0].to_node.bl_idname == "ShaderNodeMixShader"
    assert done.node.inputs["Roughness"].links[0].from_node.image == rough.image


def test_a_material_that_plays_stands_still_as_principled(blender):
    """As the current frame shows it; the original goes on."""
    from vgroove.addon.blender.course import Play

    made = build(presets.find("time_varying/copper_patina"), Choice(estimator="fit", play=Play(length=100.0)))
    item = shown(blender, made)
    blender.context.scene.frame_set(60)
    sent = material.origin_of(made).preset.solid
    done = convert.convert(made)
    convert.give(made, done.material, [item])
    assert done.left == ["its animation, which stands still"]
    assert material.plays(made)
    assert done.material.node_tree.animation_data is None or not done.material.node_tree.animation_data.action
    assert sent != presets.find("time_varying/copper_patina").solid
    assert item.active_material == done.material
    assert made.use_fake_user


def test_conversion_of_a_material_without_its_group_is_refused(blender):
    """In words; nothing is left behind."""
    made = build(presets.find("metals/copper"), Choice(estimator="closure"))
    blender.data.node_groups.remove(roles.node(made, roles.MODEL).node_tree)
    with pytest.raises(material.MaterialError, match="Copper: its node group was deleted; press Reset to Preset"):
        convert.convert(made)
    assert list(blender.data.materials) == [made]


# Baked


@pytest.fixture
def patterned(blender):
    """A square with a checker as colour, a gradient as slope, a constant index and a bump; its right half is another's.

    Its UV map is all of the image, from left to right.
    """
    made = build(presets.find("ceramics/bone_china"), Choice(estimator="fit"))
    with headless.quiet():
        blender.ops.mesh.primitive_grid_add(x_subdivisions=2, y_subdivisions=1)
    item, tree, sockets = blender.context.object, made.node_tree, material.parameter_sockets(made)
    item.data.materials.append(made)
    item.data.materials.append(blender.data.materials.new("Other"))
    item.data.polygons[1].material_index = 1
    checker, gradient = tree.nodes.new("ShaderNodeTexChecker"), tree.nodes.new("ShaderNodeTexGradient")
    uv = tree.nodes.new("ShaderNodeUVMap")
    uv.uv_map = "UVMap"
    checker.inputs["Color1"].default_value, checker.inputs["Color2"].default_value = (0.5, 0, 0, 1), (0, 0.25, 0, 1)
    checker.inputs["Scale"].default_value = 8.0
    for node in (checker, gradient):
        tree.links.new(uv.outputs["UV"], node.inputs["Vector"])
    tree.links.new(checker.outputs["Color"], sockets["albedo"])
    tree.links.new(gradient.outputs["Fac"], sockets["m"])
    index, bump, noise = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("Value", "Bump", "TexNoise"))
    index.outputs[0].default_value, bump.inputs["Distance"].default_value = 1.7, 1.0
    tree.links.new(index.outputs[0], sockets["eta"])
    tree.links.new(noise.outputs[0], bump.inputs["Height"])
    tree.links.new(bump.outputs["Normal"], our_input(made, "Normal"))
    return made, item


def left_half(socket):
    """Of the image behind an input, whose kind is checked too."""
    node = socket.links[0].from_node
    node = node if node.bl_idname == "ShaderNodeTexImage" else node.inputs["Color"].links[0].from_node
    assert node.image.packed_file is not None
    assert node.image.colorspace_settings.name == ("sRGB" if socket.type == "RGBA" else "Non-Color")
    side = node.image.size[0]
    return np.array(node.image.pixels).reshape(side, side, 4)[:, : side // 2, :3]


def test_what_varies_is_baked_and_what_does_not_is_a_number(blender, patterned):
    """Colours as sRGB, roughness as data, the bump as a normal map; and the scene is as before."""
    made, item = patterned
    before = {name: len(getattr(blender.data, name)) for name in ("scenes", "objects", "meshes")}
    done = convert.convert(made)
    with headless.quiet():
        assert bake.bake(done, made, [item], 64) == []
    assert {name: len(getattr(blender.data, name)) for name in before} == before
    inputs = done.node.inputs
    assert inputs["IOR"].default_value == pytest.approx(1.7, abs=1e-3)  # Cycles bakes halves of floats
    assert not inputs["IOR"].is_linked
    fields = np.add.outer(np.arange(64) // 8, np.arange(32) // 8) % 2
    wanted = np.array([(0.0, 0.5371, 0.0), (0.7354, 0.0, 0.0)])[fields]  # sRGB of 0.25 and 0.5
    inside = np.ix_(
        (np.arange(64) % 8 > 0) & (np.arange(64) % 8 < 7), (np.arange(32) % 8 > 0) & (np.arange(32) % 8 < 7)
    )
    np.testing.assert_allclose(left_half(inputs["Base Color"])[inside], wanted[inside], atol=1.0 / 255.0)
    across = (np.arange(32) + 0.5) / 64.0
    wide = 0.5 / 64.0 + 1.0 / 255.0  # four samples somewhere in a pixel, and 8 bits
    assert np.all(np.abs(left_half(inputs["Roughness"])[..., 0] - across) <= wide)
    assert np.ptp(left_half(inputs["Normal"])[..., 0]) > 0.1
    assert {node.bl_idname for node in done.material.node_tree.nodes} == {
        principled.KIND, "ShaderNodeOutputMaterial", "ShaderNodeTexImage", "ShaderNodeNormalMap",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("spoil", "why"),
    [
        (lambda item: item.data.uv_layers.remove(item.data.uv_layers[0]), "Grid has no UV map; unwrap it first"),
        (lambda item: item.data.clear_geometry(), "Grid has no faces to bake"),
    ],
)
def test_what_cannot_be_baked_is_refused(patterned, spoil, why):
    made, item = patterned
    spoil(item)
    with pytest.raises(material.MaterialError, match=why):
        bake.bake(convert.convert(made), made, [item], 64)
