# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday scenes, one idea each; ``everyday_stage`` says what a maker is given and may return."""

from __future__ import annotations

import tempfile
from functools import partial
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from ...addon.blender import gonio
from ...addon.blender.images import pixels
from ...headless import scene
from ...nodegroups import versions
from .everyday_stage import (
    MODERN,
    NAME,
    SIZE,
    SLOPES,
    Shot,
    add,
    background,
    bumpy,
    checker,
    collection_of,
    drive,
    everyday,
    floor,
    instances_by_nodes,
    light,
    look_at,
    map_of,
    normal_map,
    quad,
    shaded,
    sky,
    uv_sphere,
)

if TYPE_CHECKING:
    import numpy as np
    from bpy.types import Material, Object, Scene
    from numpy.typing import NDArray

SAYS_FRESNEL = ("approximate this Fresnel term",) if not versions.EXACT_CONDUCTOR else ()  # true there
IES = """IESNA:LM-63-1995
TILT=NONE
1 1000 1 5 1 1 2 0 0 0
1 1 100
0 22.5 45 67.5 90
0
1000 800 300 60 0
"""

# --- light ----------------------------------------------------------------------------------------------------------


@everyday("Blender's own start scene, denoised", "copper", "plastic", says=SAYS_FRESNEL)
def start(shown: Scene) -> None:
    shown.objects[NAME].data = bpy.data.meshes["Cube"]
    shown.camera.data.lens = 50.0
    add(shown, "Light", bpy.data.lights["Light"], (4.08, 1.01, 5.9))
    shown.cycles.use_denoising = True


@everyday("sun", "copper", "plaster", timed=True)
def sun(shown: Scene) -> None:
    light(shown, "SUN", 3.0, angle=radians(0.53))


@everyday("point light", "copper", "plastic", says=SAYS_FRESNEL)
def point(shown: Scene) -> None:
    light(shown, "POINT", 800.0)


@everyday("spot light", "copper", "conductor", says=SAYS_FRESNEL)
def spot(shown: Scene) -> None:
    light(shown, "SPOT", 1500.0, spot_size=radians(30.0), spot_blend=0.4)


@everyday("area light", "copper", "plaster", "plastic", "paint", says=SAYS_FRESNEL, timed=True)
def area(shown: Scene) -> None:
    light(shown, "AREA", 300.0, shape="DISK", size=2.0)


@everyday("lights of zero size")
def zero_size(shown: Scene) -> None:
    light(shown, "POINT", 600.0, shadow_soft_size=0.0)
    light(shown, "SUN", 1.0, (-3.0, -3.5, 2.0), angle=0.0)


@everyday("eight mixed lights", "copper", "plaster", timed=True)
def eight_lights(shown: Scene) -> None:
    for side in (-1.0, 1.0):
        light(shown, "SUN", 0.5, (3.0 * side, -4.0, 3.0), angle=0.1)
        light(shown, "POINT", 150.0, (4.0 * side + 2.0, -3.0, 1.0), shadow_soft_size=0.2)
        light(shown, "SPOT", 300.0, (1.0, -5.0, 3.0 * side))
        light(shown, "AREA", 80.0, (5.0, 2.0 * side, 4.0), size=1.0)


@everyday("a small emissive mesh in a dim sky")
def small_emitter(shown: Scene) -> None:
    lamp = add(shown, "Bulb", scene.ball_mesh(16, 8), (3.0, -2.5, 3.0))
    lamp.scale = (0.1, 0.1, 0.1)
    lamp.data.materials.append(shaded("Emission", Strength=800.0))


@everyday("a large emissive mesh", "copper", "plaster", timed=True)
def large_emitter(shown: Scene) -> None:
    panel = add(shown, "Panel", quad("Panel", 4.0), (-2.0, -5.0, 2.0))
    look_at(panel)
    panel.data.materials.append(shaded("Emission", Strength=4.0))


@everyday("environment map", "copper", "plaster", "plastic", says=SAYS_FRESNEL, timed=True)
def hdri(shown: Scene) -> None:
    map_of(shown, "forest")


@everyday("a ball of glass in an environment map", "frosted", "glass", says=("more often than Max Bounces",))
def glass(shown: Scene) -> None:
    map_of(shown, "studio")


@everyday("environment map by night, with bright small lights")
def hdri_night(shown: Scene) -> None:
    map_of(shown, "night")


@everyday("environment map and sun", "copper", "plaster")
def hdri_and_sun(shown: Scene) -> None:
    map_of(shown, "courtyard", 0.5)
    light(shown, "SUN", 2.0, angle=radians(0.53))


@everyday("even sky", "copper", "plaster", "conductor", "paint", says=SAYS_FRESNEL, timed=True)
def even_sky(shown: Scene) -> None:
    sky(shown)


@everyday("sky texture with sun disc", "copper", "plaster")
def sky_sun_disc(shown: Scene) -> None:
    tree = shown.world.node_tree
    texture = tree.nodes.new("ShaderNodeTexSky")
    texture.sky_type = "SINGLE_SCATTERING" if MODERN else "NISHITA"
    texture.sun_disc, texture.sun_elevation, texture.sun_rotation = True, radians(35.0), radians(150.0)
    tree.links.new(texture.outputs[0], background(shown.world).inputs["Color"])
    background(shown.world).inputs["Strength"].default_value = 0.1


@everyday("a room with a portal in its window", timed=True)
def portal(shown: Scene) -> None:
    sky(shown, 4.0)
    floor(shown)
    wall = add(shown, "Wall", quad("Wall", 8.0), (-3.0, 0.0, 0.0), (0, 90, 0))
    wall.data.materials.append(shaded("BsdfDiffuse"))
    window = light(shown, "AREA", 1.0, (2.0, -3.0, 3.0), size=3.0)
    window.data.cycles.is_portal = True


@everyday("a light with an IES profile")
def ies(shown: Scene) -> None:
    lamp = light(shown, "POINT", 400.0)
    tree, profile = _nodes_of(lamp), bpy.data.texts.new("Profile")
    profile.write(IES)
    texture = tree.nodes.new("ShaderNodeTexIES")
    texture.ies = profile
    tree.links.new(texture.outputs[0], tree.nodes["Emission"].inputs["Strength"])


@everyday("a light with nodes: coloured spots that fall off evenly")
def node_light(shown: Scene) -> None:
    lamp = light(shown, "AREA", 15.0, size=1.0)
    tree = _nodes_of(lamp)
    fall, place = tree.nodes.new("ShaderNodeLightFalloff"), tree.nodes.new("ShaderNodeNewGeometry")
    fall.inputs["Strength"].default_value = 1.0
    spots = checker((1.0, 0.2, 0.1), (0.1, 0.3, 1.0))(tree)
    tree.links.new(place.outputs["Position"], spots.node.inputs["Vector"])
    tree.links.new(spots, tree.nodes["Emission"].inputs["Color"])
    tree.links.new(fall.outputs["Linear"], tree.nodes["Emission"].inputs["Strength"])


def _nodes_of(lamp: Object) -> bpy.types.NodeTree:
    return versions.nodes_of(lamp.data)


@everyday("light linking, with the ball left out by one light")
def light_linked(shown: Scene) -> None:
    floor(shown)
    light(shown, "POINT", 500.0)
    other = light(shown, "SUN", 20.0, (-3.0, -3.5, 2.0))
    lit = bpy.data.collections.new("Lit")
    lit.objects.link(shown.objects["Floor"])
    other.light_linking.receiver_collection = lit


@everyday("shadow linking, past a card that blocks no light")
def shadow_linked(shown: Scene) -> None:
    lamp = light(shown, "POINT", 500.0)
    card = add(shown, "Card", quad("Card", 3.0), (1.5, -1.75, 2.0))
    look_at(card, lamp.location)
    blockers = bpy.data.collections.new("Blockers")
    blockers.objects.link(shown.objects[NAME])
    lamp.light_linking.blocker_collection = blockers
    card.visible_camera = False


@everyday("a background set with a sun")
def background_set(shown: Scene) -> None:
    other = bpy.data.scenes.new("Set")
    lamp = light(shown, "SUN", 3.0)
    shown.collection.objects.unlink(lamp)
    other.collection.objects.link(lamp)
    shown.background_set = other


@everyday("a collection instance that brings a light")
def collection_light(shown: Scene) -> None:
    lamp = light(shown, "AREA", 300.0, size=1.0)
    holder = add(shown, "Instance", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", collection_of(lamp)


@everyday("lights that geometry nodes bring")
def lights_by_nodes(shown: Scene) -> None:
    lamp = light(shown, "POINT", 100.0, (0.0, 0.0, 0.0), shadow_soft_size=0.2)
    carrier = add(shown, "Carrier", quad("Carrier", 3.0), (2.0, -3.0, 3.5))
    instances_by_nodes(collection_of(lamp), carrier)


@everyday("three light groups, and the picture of one")
def light_groups(shown: Scene) -> Shot:
    for name, side in (("Key", 1.0), ("Fill", -1.0)):
        shown.view_layers[0].lightgroups.add(name=name)
        light(shown, "POINT", 400.0, (4.0 * side + 1.0, -4.0, 2.0)).lightgroup = name
    shown.view_layers[0].lightgroups.add(name="World")
    shown.world.lightgroup = "World"
    return Shot(render=partial(_pass, name="Combined_Key"))


# --- surfaces -------------------------------------------------------------------------------------------------------


@everyday("a card with holes between ball, light and camera", "copper", "plaster")
def alpha_card(shown: Scene) -> None:
    light(shown, "SUN", 3.0)
    made = shaded("BsdfDiffuse")
    tree = made.node_tree
    mix, clear, output = (
        tree.nodes.new(f"ShaderNode{name}") for name in ("MixShader", "BsdfTransparent", "OutputMaterial")
    )
    tree.nodes.remove(next(node for node in tree.nodes if node.bl_idname == output.bl_idname and node != output))
    tree.links.new(checker((0, 0, 0), (1, 1, 1), 8.0)(tree), mix.inputs[0])
    tree.links.new(clear.outputs[0], mix.inputs[1])
    tree.links.new(tree.nodes["Diffuse BSDF"].outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    card = add(shown, "Card", quad("Card", 3.0), (2.0, -2.1, 2.0))
    look_at(card, (7.0, -7.0, 5.5))
    card.data.materials.append(made)


@everyday("a pane of glass in front", "copper")
def behind_glass(shown: Scene) -> None:
    map_of(shown, "interior")
    pane = add(shown, "Pane", quad("Pane", 3.0), (2.0, -2.0, 1.4))
    look_at(pane, shown.camera.location)
    pane.data.materials.append(shaded("BsdfGlass", IOR=1.0))


@everyday("a thin volume in front")
def volume(shown: Scene) -> None:
    light(shown, "SUN", 3.0)
    fog = add(shown, "Fog", bpy.data.meshes.new("Fog"))
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    fog.data.from_pydata(corners, [], sides)
    fog.location, fog.scale = (2.2, -2.1, 1.5), (1.0, 1.0, 1.0)
    fog.data.materials.append(shaded("VolumeScatter", "Volume", Density=0.2))


@everyday("a mild bump", "copper", "plaster", "plastic", says=SAYS_FRESNEL)
def mild_bump(shown: Scene) -> Shot:
    light(shown, "SUN", 3.0)
    return Shot(finish=partial(drive, what="normal", make=bumpy(0.2, 3.0)))


@everyday("a strong bump", "copper", "rough", "plaster")
def strong_bump(shown: Scene) -> Shot:
    light(shown, "SUN", 3.0)
    sky(shown, 0.3)
    return Shot(finish=partial(drive, what="normal", make=bumpy(1.0, 4.0)))


@everyday("a mild normal map")
def mild_normal_map(shown: Scene) -> Shot:
    light(shown, "SUN", 3.0)
    uv_sphere(shown.objects[NAME])
    return Shot(finish=partial(drive, what="normal", make=normal_map(0.3)))


@everyday("a strong normal map under an environment map", "copper", "plastic", says=SAYS_FRESNEL)
def strong_normal_map(shown: Scene) -> Shot:
    map_of(shown, "forest")
    uv_sphere(shown.objects[NAME])
    return Shot(finish=partial(drive, what="normal", make=normal_map(1.5)))


@everyday("displacement")
def displacement(shown: Scene) -> Shot:
    light(shown, "SUN", 3.0)
    return Shot(finish=_displace)


def _displace(made: Material) -> None:
    tree = made.node_tree
    noise, node = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeDisplacement")
    noise.inputs["Scale"].default_value, node.inputs["Scale"].default_value = 1.5, 0.5
    tree.links.new(noise.outputs[0], node.inputs["Height"])
    tree.links.new(node.outputs[0], tree.get_output_node("CYCLES").inputs["Displacement"])
    made.displacement_method = "BOTH"


@everyday("negative scale, under a bump", "copper", "plaster")
def negative_scale(shown: Scene) -> Shot:
    shown.objects[NAME].scale = (-1.0, 1.0, 1.0)
    light(shown, "SUN", 3.0)
    return Shot(finish=partial(drive, what="normal", make=bumpy(0.5, 3.0)))


@everyday("a ball turned inside out", "copper", "plastic", says=SAYS_FRESNEL)
def backfaces(shown: Scene) -> None:
    shown.objects[NAME].data.flip_normals()
    light(shown, "POINT", 800.0)
    sky(shown, 0.2)


@everyday("a low-poly mesh with smooth shading", "copper", "plaster", "rough")
def low_poly(shown: Scene) -> None:
    shown.objects[NAME].data = scene.ball_mesh(10, 6)
    light(shown, "POINT", 800.0)


@everyday("a flat plane, seen at a low angle", "copper", "plaster")
def plane(shown: Scene) -> None:
    shown.objects[NAME].data = quad("Plane", 12.0)
    shown.camera.location = (6.0, -6.0, 4.0)
    look_at(shown.camera)
    map_of(shown, "courtyard")


@everyday("a text object")
def text(shown: Scene) -> None:
    bpy.data.objects.remove(shown.objects[NAME])
    letters = bpy.data.curves.new("Text", "FONT")
    letters.body, letters.extrude, letters.bevel_depth, letters.size = "Ag", 0.2, 0.05, 1.7
    letters.align_x = letters.align_y = "CENTER"
    add(shown, NAME, letters, turned=(60.0, 0.0, 45.0))
    light(shown, "AREA", 300.0, size=2.0)


@everyday("modifiers: subdivision and a thickness", "copper", "plaster")
def modifiers(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.data = scene.ball_mesh(8, 4)
    item.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    item.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.05
    light(shown, "POINT", 800.0)


@everyday("several materials on one mesh", says=("gets the material",))
def several_slots(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.data.materials.append(shaded("BsdfDiffuse"))
    item.data.materials.append(shaded("BsdfDiffuse"))
    item.active_material_index = 1
    for face in item.data.polygons:
        face.material_index = face.index % 2
    light(shown, "SUN", 3.0)


@everyday("two objects that share a mesh, and a third")
def shared_mesh(shown: Scene) -> Shot:
    item = shown.objects[NAME]
    item.location, item.scale = (-0.5, -0.5, 0.0), (0.6, 0.6, 0.6)
    twin = add(shown, "Twin", item.data, (0.5, 0.5, 0.0))
    twin.scale = item.scale
    light(shown, "AREA", 300.0, size=1.0)
    return Shot(names=(NAME, "Twin"))


@everyday("instances by geometry nodes", "copper", timed=True)
def instances(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.scale = (0.4, 0.4, 0.4)
    carrier = add(shown, "Carrier", quad("Carrier", 1.2))
    instances_by_nodes(collection_of(item), carrier)
    shown.collection.objects.link(item)
    light(shown, "SUN", 3.0)


@everyday("instances by a particle system")
def particles(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.scale = (0.3, 0.3, 0.3)
    emitter = add(shown, "Emitter", quad("Emitter", 2.0))
    settings = emitter.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.render_type = "HAIR", 12, "OBJECT"
    settings.instance_object, settings.particle_size = item, 0.3
    emitter.show_instancer_for_render = False
    light(shown, "SUN", 3.0)


@everyday("a texture in the roughness")
def textured_roughness(shown: Scene) -> Shot:
    map_of(shown, "forest")
    return Shot(finish=partial(drive, what="slope", make=checker((SLOPES[0],) * 3, (SLOPES[1],) * 3)))


@everyday("a texture in the colour", "copper", "plaster")
def textured_colour(shown: Scene) -> Shot:
    map_of(shown, "interior")
    return Shot(finish=partial(drive, what="colour", make=checker((0.9, 0.5, 0.1), (0.2, 0.3, 0.9))))


@everyday("seen in a mirror")
def in_a_mirror(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.location, item.visible_camera = (1.6, -1.6, 1.1), False
    mirror = add(shown, "Mirror", quad("Mirror", 8.0), (-1.0, 1.0, -0.7))
    look_at(mirror, shown.camera.location)
    mirror.rotation_euler.rotate_axis("X", radians(180.0))
    mirror.data.materials.append(shaded("BsdfGlossy", Color=(1.0, 1.0, 1.0, 1.0), Roughness=0.0))
    light(shown, "AREA", 300.0, (-2.0, 2.0, 6.0), size=2.0)  # on the side that the mirror shows


# --- cameras --------------------------------------------------------------------------------------------------------


@everyday("orthographic camera", "copper", "plaster")
def orthographic(shown: Scene) -> None:
    shown.camera.data.type, shown.camera.data.ortho_scale = "ORTHO", 2.2
    light(shown, "SUN", 3.0)


@everyday("panoramic camera near the ball")
def panoramic(shown: Scene) -> None:
    shown.camera.data.type = "PANO"
    shown.camera.data.panorama_type = "EQUIRECTANGULAR"
    shown.camera.location = (1.3, -1.3, 0.3)
    look_at(shown.camera)
    map_of(shown, "interior")


@everyday("depth of field", timed=True)
def depth_of_field(shown: Scene) -> None:
    focus = shown.camera.data.dof
    focus.use_dof, focus.focus_distance, focus.aperture_fstop = True, 8.0, 0.2
    light(shown, "SUN", 3.0)


@everyday("motion blur")
def motion_blur(shown: Scene) -> None:
    shown.render.use_motion_blur = True
    item = shown.objects[NAME]
    for frame, place in ((0, -0.5), (2, 0.5)):
        item.location = (place, place, 0.0)
        item.keyframe_insert("location", frame=frame)
    light(shown, "SUN", 3.0)


# --- settings -------------------------------------------------------------------------------------------------------


@everyday("ACEScg as the working space", "copper", "plaster", "conductor", since=(5, 0))
def acescg(shown: Scene) -> None:
    light(shown, "AREA", 300.0, size=2.0)
    sky(shown, 0.2)
    bpy.ops.wm.set_working_color_space(working_space="ACEScg")


@everyday("millimetres: unit scale 0.001 and a ball of 1 mm", "copper", "plaster")
def millimetres(shown: Scene) -> None:
    shown.unit_settings.scale_length = 0.001
    _shrink(shown, 0.001)
    light(shown, "SUN", 3.0)


def _shrink(shown: Scene, by: float) -> None:
    shown.objects[NAME].scale = (by, by, by)
    shown.camera.location *= by
    shown.camera.data.clip_start *= by


@everyday("100 m from the origin", "copper", "plaster")
def far_100m(shown: Scene) -> None:
    _far(shown, 100.0)


@everyday("10 km from the origin", "copper", "plaster")
def far_10km(shown: Scene) -> None:
    _far(shown, 10_000.0)


def _far(shown: Scene, distance: float) -> None:
    light(shown, "POINT", 800.0)
    for item in shown.objects:
        item.location.x += distance


@everyday("shadow catcher under the ball", "copper", "plaster")
def shadow_catcher(shown: Scene) -> Shot:
    floor(shown, 0.8).is_shadow_catcher = True
    shown.render.film_transparent = True
    light(shown, "AREA", 300.0, size=2.0)
    shown.camera.data.lens /= 2.0
    return Shot(everywhere=True)


@everyday("persistent data: a second render, after the light has moved")
def persistent(shown: Scene) -> Shot:
    shown.render.use_persistent_data = True
    lamp = light(shown, "POINT", 800.0, (-3.0, -4.0, 1.0))

    def again(shown: Scene) -> NDArray[np.float32]:
        lamp.location = (-3.0, -4.0, 1.0)
        gonio.rendered(shown)
        lamp.location = (3.0, -3.5, 4.0)
        return gonio.rendered(shown)

    return Shot(render=again)


@everyday("a view layer that overrides all materials")
def view_layer_override(shown: Scene) -> Shot:
    floor(shown)
    light(shown, "AREA", 300.0, size=1.0)

    def override(made: Material) -> None:
        shown.view_layers[0].material_override = made

    return Shot(finish=override)


@everyday("baking: combined")
def bake(shown: Scene) -> Shot:
    light(shown, "SUN", 3.0)
    return _baked(shown, "COMBINED")


@everyday("baking: diffuse colour", "plaster")
def bake_colour(shown: Scene) -> Shot:
    light(shown, "SUN", 3.0)
    return _baked(shown, "DIFFUSE")


def _baked(shown: Scene, kind: str) -> Shot:
    uv_sphere(shown.objects[NAME])
    image = bpy.data.images.new("Baked", SIZE, SIZE, float_buffer=True)

    def target(made: Material) -> None:
        node = made.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        made.node_tree.nodes.active = node

    def render(shown: Scene) -> NDArray[np.float32]:
        item = shown.objects[NAME]
        bpy.context.view_layer.objects.active = item
        item.select_set(state=True)
        everything = {"DIRECT", "INDIRECT", "DIFFUSE", "GLOSSY", "TRANSMISSION", "EMIT"}
        passes = {"COLOR"} if kind == "DIFFUSE" else everything
        bpy.ops.object.bake(type=kind, pass_filter=passes, margin=0)
        return pixels(image).copy()

    return Shot(finish=target, render=render, everywhere=True)


@everyday("the pass that a denoiser takes as the surface's colour", "copper", "plaster")
def denoising_albedo(shown: Scene) -> Shot:
    shown.view_layers[0].cycles.denoising_store_passes = True
    light(shown, "SUN", 3.0)
    return Shot(render=partial(_pass, name="Denoising Albedo"))


@everyday("no caustics, clamped light, no light tree")
def fast_settings(shown: Scene) -> None:
    cycles = shown.cycles
    cycles.caustics_reflective = cycles.caustics_refractive = cycles.use_light_tree = False
    cycles.sample_clamp_direct, cycles.sample_clamp_indirect = 3.0, 1.0
    floor(shown)
    light(shown, "AREA", 300.0, size=1.0)
    light(shown, "POINT", 200.0, (-1.0, -5.0, 1.0))


@everyday("Open Shading Language switched on", "copper", "plaster")
def osl_on(shown: Scene) -> None:
    shown.cycles.shading_system = True
    map_of(shown, "forest")


@everyday("EEVEE", "copper", "plaster", "plastic", slow=True, says=("engine is not Cycles", *SAYS_FRESNEL))
def eevee(shown: Scene) -> None:
    shown.render.engine = "BLENDER_EEVEE" if MODERN else "BLENDER_EEVEE_NEXT"
    shown.eevee.taa_render_samples = 1  # both materials are seen through the same ones, of which each takes a second
    light(shown, "SUN", 3.0)


def _pass(shown: Scene, name: str) -> NDArray[np.float32]:
    """A pass of the first view layer, in place of the picture."""
    import OpenImageIO as oiio  # noqa: N813 - as in images.write

    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        path = Path(folder) / "render.exr"
        shown.render.filepath = str(path)
        _write_as(shown, "OPEN_EXR_MULTILAYER", "MULTI_LAYER_IMAGE")
        bpy.ops.render.render(write_still=True, scene=shown.name)
        _write_as(shown, "OPEN_EXR", "IMAGE")
        file = oiio.ImageInput.open(str(path))
        try:
            return _channels(file, name)
        finally:
            file.close()


def _write_as(shown: Scene, format_of_file: str, kind: str) -> None:
    if MODERN:
        shown.render.image_settings.media_type = kind
    shown.render.image_settings.file_format = format_of_file
    if format_of_file == "OPEN_EXR":
        shown.render.image_settings.color_depth = "32"


def _channels(file: Any, name: str) -> NDArray[np.float32]:
    """The three channels of a pass in a file of many, which may be parts of it."""
    part = 0
    while file.seek_subimage(part, 0):
        names = list(file.spec().channelnames)
        wanted = [k for k, channel in enumerate(names) if f".{name}." in f".{channel}" and channel[-1] in "RGBXYZ"]
        if len(wanted) == 3:
            picture = file.read_image(part, 0, 0, len(names), "float")
            return picture[..., sorted(wanted, key=lambda k: "RGBXYZ".index(names[k][-1]))]
        part += 1
    message = f"the render has no pass {name}"
    raise RuntimeError(message)
