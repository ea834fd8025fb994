# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of everyday scenes: what each adds to the start scene in small; ``everyday_stage`` has what they share."""

from __future__ import annotations

from functools import partial
from itertools import product
from math import radians
from typing import TYPE_CHECKING, Any

import bpy

from ...addon.blender import gonio
from ...addon.blender.images import pixels
from ...headless import scene
from ...nodegroups import versions
from ..scenery import add_node, add_object, background, checker, quad, surface, wire
from . import everyday_stage as stage
from .everyday_stage import NAME, SAYS_FRESNEL, Scenario, floor, light, map_of, put, settings, shaded, sky, square

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from bpy.types import Material, Mesh, Node, NodeTree, Scene
    from numpy.typing import NDArray

IES = """IESNA:LM-63-1995
TILT=NONE
1 1000 1 5 1 1 2 0 0 0
1 1 100
0 22.5 45 67.5 90
0
1000 800 300 60 0
"""
SLOPES = (0.1, 0.4)  # of the two halves of a checkered surface
HALF_DEGREE = radians(0.53)


# --- lights ---------------------------------------------------------------------------------------------------------


def start(shown: Scene) -> None:
    shown.objects[NAME].data = bpy.data.meshes["Cube"]
    add_object(shown, "Light", bpy.data.lights["Light"], (4.08, 1.01, 5.9))


def eight_lights(shown: Scene) -> None:
    for side in (-1.0, 1.0):
        light(shown, "SUN", 0.5, (3.0 * side, -4.0, 3.0), angle=0.1)
        light(shown, "POINT", 150.0, (4.0 * side + 2.0, -3.0, 1.0), shadow_soft_size=0.2)
        light(shown, "SPOT", 300.0, (1.0, -5.0, 3.0 * side))
        light(shown, "AREA", 80.0, (5.0, 2.0 * side, 4.0), size=1.0)


def small_emitter(shown: Scene) -> None:
    lamp = add_object(shown, "Bulb", scene.ball_mesh(16, 8), (3.0, -2.5, 3.0))
    lamp.scale = (0.1, 0.1, 0.1)
    lamp.data.materials.append(shaded("Emission", Strength=800.0))


def sky_sun_disc(shown: Scene) -> None:
    tree, kind = shown.world.node_tree, "SINGLE_SCATTERING" if stage.MODERN else "NISHITA"
    sun = {"sun_disc": True, "sun_elevation": radians(35.0), "sun_rotation": radians(150.0)}
    wire(tree, add_node(tree, "TexSky", sky_type=kind, **sun), background(shown.world).inputs["Color"])
    background(shown.world).inputs["Strength"].default_value = 0.1


def portal(shown: Scene) -> None:
    wall = square(shown, "Wall", 8.0, (-3.0, 0.0, 0.0), partial(shaded, "BsdfDiffuse"))
    wall.rotation_euler.y = radians(90.0)
    window = light(shown, "AREA", 1.0, (2.0, -3.0, 3.0), size=3.0)
    window.data.cycles.is_portal = True


def ies(shown: Scene) -> None:
    lamp = light(shown, "POINT", 400.0)
    tree, profile = versions.nodes_of(lamp.data), bpy.data.texts.new("Profile")
    profile.write(IES)
    wire(tree, add_node(tree, "TexIES", ies=profile), tree.nodes["Emission"].inputs["Strength"])


def node_light(shown: Scene) -> None:
    lamp = light(shown, "AREA", 15.0, size=1.0)
    tree = versions.nodes_of(lamp.data)
    emission, place = tree.nodes["Emission"], add_node(tree, "NewGeometry").outputs["Position"]
    wire(tree, checker(tree, (1.0, 0.2, 0.1), (0.1, 0.3, 1.0), Vector=place), emission.inputs["Color"])
    wire(tree, add_node(tree, "LightFalloff", Strength=1.0).outputs["Linear"], emission.inputs["Strength"])


def light_linked(shown: Scene) -> None:
    other = light(shown, "SUN", 20.0, (-3.0, -3.5, 2.0))
    lit = bpy.data.collections.new("Lit")
    lit.objects.link(shown.objects["Floor"])
    other.light_linking.receiver_collection = lit


def shadow_linked(shown: Scene) -> None:
    lamp = light(shown, "POINT", 500.0)
    card = square(shown, "Card", 3.0, (1.5, -1.75, 2.0), toward=lamp.location)
    blockers = bpy.data.collections.new("Blockers")
    blockers.objects.link(shown.objects[NAME])
    lamp.light_linking.blocker_collection = blockers
    card.visible_camera = False


def background_set(shown: Scene) -> None:
    other = bpy.data.scenes.new("Set")
    lamp = light(shown, "SUN", 3.0)
    shown.collection.objects.unlink(lamp)
    other.collection.objects.link(lamp)
    shown.background_set = other


def collection_light(shown: Scene) -> None:
    lamp = light(shown, "AREA", 300.0, size=1.0)
    holder = add_object(shown, "Instance", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", stage.collection_of(lamp)


def lights_by_nodes(shown: Scene) -> None:
    lamp = light(shown, "POINT", 100.0, (0.0, 0.0, 0.0), shadow_soft_size=0.2)
    stage.instances_by_nodes(stage.collection_of(lamp), square(shown, "Carrier", 3.0, (2.0, -3.0, 3.5)))


def light_groups(shown: Scene) -> None:
    for name, side in (("Key", 1.0), ("Fill", -1.0)):
        shown.view_layers[0].lightgroups.add(name=name)
        light(shown, "POINT", 400.0, (4.0 * side + 1.0, -4.0, 2.0)).lightgroup = name
    shown.view_layers[0].lightgroups.add(name="World")
    shown.world.lightgroup = "World"


# --- cameras and settings -------------------------------------------------------------------------------------------


def motion_blur(shown: Scene) -> None:
    shown.render.use_motion_blur = True
    item = shown.objects[NAME]
    for frame, place in ((0, -0.5), (2, 0.5)):
        item.location = (place, place, 0.0)
        item.keyframe_insert("location", frame=frame)


def acescg(_shown: Scene) -> None:
    bpy.ops.wm.set_working_color_space(working_space="ACEScg")


def shrink(shown: Scene, by: float) -> None:
    shown.objects[NAME].scale = (by, by, by)
    shown.camera.location *= by
    shown.camera.data.clip_start *= by


def far(shown: Scene, distance: float) -> None:
    for item in shown.objects:
        item.location.x += distance


def catcher(shown: Scene) -> None:
    floor(shown, 0.8).is_shadow_catcher = True


def after_a_move(shown: Scene) -> NDArray[np.float32]:
    lamp = shown.objects["Point"]
    lamp.location = (-3.0, -4.0, 1.0)
    gonio.rendered(shown)
    lamp.location = (3.0, -3.5, 4.0)
    return gonio.rendered(shown)


def override(shown: Scene, made: Material) -> None:
    shown.view_layers[0].material_override = made


def bake_target(_shown: Scene, made: Material) -> None:
    image = bpy.data.images.get("Baked") or bpy.data.images.new("Baked", stage.SIZE, stage.SIZE, float_buffer=True)
    made.node_tree.nodes.active = add_node(made.node_tree, "TexImage", image=image)


def baked(shown: Scene, kind: str, *passes: str) -> NDArray[np.float32]:
    item = shown.objects[NAME]
    bpy.context.view_layer.objects.active = item
    item.select_set(state=True)
    bpy.ops.object.bake(type=kind, pass_filter=set(passes), margin=0)
    return pixels(bpy.data.images["Baked"]).copy()


# --- surfaces -------------------------------------------------------------------------------------------------------


def holes() -> Material:
    def shader(tree: NodeTree) -> Node:
        clear, paper = (add_node(tree, kind) for kind in ("BsdfTransparent", "BsdfDiffuse"))
        return add_node(tree, "MixShader", Fac=checker(tree, (0, 0, 0), (1, 1, 1), 8.0), Shader=clear, Shader_001=paper)

    return surface("Holes", shader)


def fog(shown: Scene) -> None:
    item = add_object(shown, "Fog", bpy.data.meshes.new("Fog"), (2.2, -2.1, 1.5))
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    item.data.from_pydata(list(product((-1, 1), repeat=3)), [], sides)
    item.data.materials.append(shaded("VolumeScatter", "Volume", Density=0.2))


def displace(_shown: Scene, made: Material) -> None:
    tree = made.node_tree
    displaced = add_node(tree, "Displacement", Scale=0.5, Height=add_node(tree, "TexNoise", Scale=1.5))
    wire(tree, displaced, tree.get_output_node("CYCLES").inputs["Displacement"])
    made.displacement_method = "BOTH"


def inside_out(shown: Scene) -> None:
    shown.objects[NAME].data.flip_normals()


def shaped(shown: Scene, make: Callable[..., Mesh], *size: Any) -> None:
    shown.objects[NAME].data = make(*size)


def text(shown: Scene) -> None:
    bpy.data.objects.remove(shown.objects[NAME])
    letters = bpy.data.curves.new("Text", "FONT")
    letters.body, letters.extrude, letters.bevel_depth, letters.size = "Ag", 0.2, 0.05, 1.7
    letters.align_x = letters.align_y = "CENTER"
    add_object(shown, NAME, letters, turned=(60.0, 0.0, 45.0))


def modifiers(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    item.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.05


def several_slots(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.data.materials.append(shaded("BsdfDiffuse"))
    item.data.materials.append(shaded("BsdfDiffuse"))
    item.active_material_index = 1
    for face in item.data.polygons:
        face.material_index = face.index % 2


def twins(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.location, item.scale = (-0.5, -0.5, 0.0), (0.6, 0.6, 0.6)
    add_object(shown, "Twin", item.data, (0.5, 0.5, 0.0)).scale = item.scale


def instances(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.scale = (0.4, 0.4, 0.4)
    stage.instances_by_nodes(stage.collection_of(item), square(shown, "Carrier", 1.2))
    shown.collection.objects.link(item)


def particles(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.scale = (0.3, 0.3, 0.3)
    emitter = square(shown, "Emitter", 2.0)
    hair = emitter.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    hair.type, hair.count, hair.render_type = "HAIR", 12, "OBJECT"
    hair.instance_object, hair.particle_size = item, 0.3
    emitter.show_instancer_for_render = False


def in_a_mirror(shown: Scene) -> None:
    item = shown.objects[NAME]
    item.location, item.visible_camera = (1.6, -1.6, 1.1), False
    silver = partial(shaded, "BsdfGlossy", Color=(1.0, 1.0, 1.0), Roughness=0.0)
    mirror = square(shown, "Mirror", 8.0, (-1.0, 1.0, -0.7), silver, toward=shown.camera.location)
    mirror.rotation_euler.rotate_axis("X", radians(180.0))


# --- the table ------------------------------------------------------------------------------------------------------

PANEL = put(square, "Panel", 4.0, (-2.0, -5.0, 2.0), partial(shaded, "Emission", Strength=4.0), toward=(0, 0, 0))
CARD = put(square, "Card", 3.0, (2.0, -2.1, 2.0), holes, toward=(7.0, -7.0, 5.5))
PANE = put(square, "Pane", 3.0, (2.0, -2.0, 1.4), partial(shaded, "BsdfGlass", IOR=1.0), toward=(7.4, -6.9, 5.0))
SUN, POINT = put(light, "SUN", 3.0), put(light, "POINT", 800.0)
AREA, SMALL_AREA = (put(light, "AREA", 300.0, size=size) for size in (2.0, 1.0))
TWO, PLASTIC, THREE = ("copper", "plaster"), ("copper", "plastic"), ("copper", "plaster", "plastic")
EVERYTHING = ("DIRECT", "INDIRECT", "DIFFUSE", "GLOSSY", "TRANSMISSION", "EMIT")
FAST: dict[str, Any] = {
    "caustics_reflective": False, "caustics_refractive": False, "use_light_tree": False,
    "sample_clamp_direct": 3.0, "sample_clamp_indirect": 1.0,
}  # fmt: skip
PANORAMA = put(settings, "camera.data", type="PANO", panorama_type="EQUIRECTANGULAR")
FOCUS = put(settings, "camera.data.dof", use_dof=True, focus_distance=8.0, aperture_fstop=0.2)

SCENES: dict[str, Scenario] = {
    "start": Scenario(
        "Blender's own start scene, denoised",
        (start, put(settings, "camera.data", lens=50.0), put(settings, "cycles", use_denoising=True)),
        PLASTIC, says=SAYS_FRESNEL,
    ),
    "sun": Scenario("sun", (put(light, "SUN", 3.0, angle=HALF_DEGREE),), TWO, timed=True),
    "point": Scenario("point light", (POINT,), PLASTIC, says=SAYS_FRESNEL),
    "spot": Scenario(
        "spot light", (put(light, "SPOT", 1500.0, spot_size=radians(30.0), spot_blend=0.4),),
        ("copper", "conductor"), says=SAYS_FRESNEL,
    ),
    "area": Scenario(
        "area light", (put(light, "AREA", 300.0, shape="DISK", size=2.0),),
        (*THREE, "paint"), says=SAYS_FRESNEL, timed=True,
    ),
    "zero_size": Scenario(
        "lights of zero size",
        (put(light, "POINT", 600.0, shadow_soft_size=0.0), put(light, "SUN", 1.0, (-3.0, -3.5, 2.0), angle=0.0)),
    ),
    "eight_lights": Scenario("eight mixed lights", (eight_lights,), TWO, timed=True),
    "small_emitter": Scenario("a small emissive mesh in a dim sky", (small_emitter,)),
    "large_emitter": Scenario("a large emissive mesh", (PANEL,), TWO, timed=True),
    "hdri": Scenario("environment map", (put(map_of, "forest"),), THREE, says=SAYS_FRESNEL, timed=True),
    "glass": Scenario(
        "a ball of glass in an environment map", (put(map_of, "studio"),),
        ("frosted", "glass"), says=("Too few bounces for glass",),
    ),
    "hdri_night": Scenario("environment map by night, with bright small lights", (put(map_of, "night"),)),
    "hdri_and_sun": Scenario(
        "environment map and sun", (put(map_of, "courtyard", 0.5), put(light, "SUN", 2.0, angle=HALF_DEGREE)), TWO
    ),
    "even_sky": Scenario("even sky", (sky,), (*TWO, "conductor", "paint"), says=SAYS_FRESNEL, timed=True),
    "sky_sun_disc": Scenario("sky texture with sun disc", (sky_sun_disc,), TWO),
    "portal": Scenario("a room with a portal in its window", (put(sky, 4.0), floor, portal), timed=True),
    "ies": Scenario("a light with an IES profile", (ies,)),
    "node_light": Scenario("a light with nodes: coloured spots that fall off evenly", (node_light,)),
    "light_linked": Scenario(
        "light linking, with the ball left out by one light", (floor, put(light, "POINT", 500.0), light_linked)
    ),
    "shadow_linked": Scenario("shadow linking, past a card that blocks no light", (shadow_linked,)),
    "background_set": Scenario("a background set with a sun", (background_set,)),
    "collection_light": Scenario("a collection instance that brings a light", (collection_light,)),
    "lights_by_nodes": Scenario("lights that geometry nodes bring", (lights_by_nodes,)),
    "light_groups": Scenario(
        "three light groups, and the picture of one", (light_groups,), render=put(stage.render_pass, "Combined_Key")
    ),
    "orthographic": Scenario(
        "orthographic camera", (put(settings, "camera.data", type="ORTHO", ortho_scale=2.2), SUN), TWO
    ),
    "panoramic": Scenario(
        "panoramic camera near the ball", (PANORAMA, put(stage.eye, (1.3, -1.3, 0.3)), put(map_of, "interior"))
    ),
    "depth_of_field": Scenario("depth of field", (FOCUS, SUN), timed=True),
    "motion_blur": Scenario("motion blur", (motion_blur, SUN)),
    "acescg": Scenario("ACEScg as the working space", (AREA, put(sky, 0.2), acescg), (*TWO, "conductor"), since=(5, 0)),
    "millimetres": Scenario(
        "millimetres: unit scale 0.001 and a ball of 1 mm",
        (put(settings, "unit_settings", scale_length=0.001), put(shrink, 0.001), SUN), TWO,
    ),
    "far_100m": Scenario("100 m from the origin", (POINT, put(far, 100.0)), TWO),
    "far_10km": Scenario("10 km from the origin", (POINT, put(far, 10_000.0)), TWO),
    "shadow_catcher": Scenario(
        "shadow catcher under the ball",
        (catcher, put(settings, "render", film_transparent=True), AREA, put(settings, "camera.data", lens=85.0)),
        TWO, everywhere=True,
    ),
    "persistent": Scenario(
        "persistent data: a second render, after the light has moved",
        (put(settings, "render", use_persistent_data=True), put(light, "POINT", 800.0, (-3.0, -4.0, 1.0))),
        render=after_a_move,
    ),
    "view_layer_override": Scenario("a view layer that overrides all materials", (floor, SMALL_AREA), finish=override),
    "bake": Scenario(
        "baking: combined", (SUN, stage.uv_sphere),
        finish=bake_target, render=put(baked, "COMBINED", *EVERYTHING), everywhere=True,
    ),
    "bake_colour": Scenario(
        "baking: diffuse colour", (SUN, stage.uv_sphere), ("plaster",),
        finish=bake_target, render=put(baked, "DIFFUSE", "COLOR"), everywhere=True,
    ),
    "denoising_albedo": Scenario(
        "the pass that a denoiser takes as the surface's colour",
        (put(settings, "view_layers[0].cycles", denoising_store_passes=True), SUN),
        TWO, render=put(stage.render_pass, "Denoising Albedo"),
    ),
    "fast_settings": Scenario(
        "no caustics, clamped light, no light tree",
        (put(settings, "cycles", **FAST), floor, SMALL_AREA, put(light, "POINT", 200.0, (-1.0, -5.0, 1.0))),
    ),
    "osl_on": Scenario(
        "Open Shading Language switched on", (put(settings, "cycles", shading_system=True), put(map_of, "forest")), TWO
    ),
    "eevee": Scenario(  # both materials are seen through the same samples, of which each takes a second
        "EEVEE",
        (put(settings, "render", engine=versions.EEVEE), put(settings, "eevee", taa_render_samples=1), SUN),
        THREE, slow=True, says=("engine is not Cycles", *SAYS_FRESNEL),
    ),
    "alpha_card": Scenario("a card with holes between ball, light and camera", (SUN, CARD), TWO),
    "behind_glass": Scenario("a pane of glass in front", (put(map_of, "interior"), PANE)),
    "volume": Scenario("a thin volume in front", (SUN, fog)),
    "mild_bump": Scenario(
        "a mild bump", (SUN,), THREE, says=SAYS_FRESNEL,
        finish=stage.driven("normal", stage.bumpy, strength=0.2, scale=3.0),
    ),
    "strong_bump": Scenario(
        "a strong bump", (SUN, put(sky, 0.3)), ("copper", "rough", "plaster"),
        finish=stage.driven("normal", stage.bumpy, strength=1.0, scale=4.0),
    ),
    "mild_normal_map": Scenario(
        "a mild normal map", (SUN, stage.uv_sphere), finish=stage.driven("normal", stage.normal_map, strength=0.3)
    ),
    "strong_normal_map": Scenario(
        "a strong normal map under an environment map", (put(map_of, "forest"), stage.uv_sphere), PLASTIC,
        says=SAYS_FRESNEL, finish=stage.driven("normal", stage.normal_map, strength=1.5),
    ),
    "displacement": Scenario("displacement", (SUN,), finish=displace),
    "negative_scale": Scenario(
        "negative scale, under a bump", (put(settings, 'objects["Subject"]', scale=(-1.0, 1.0, 1.0)), SUN), TWO,
        finish=stage.driven("normal", stage.bumpy, strength=0.5, scale=3.0),
    ),
    "backfaces": Scenario("a ball turned inside out", (inside_out, POINT, put(sky, 0.2)), PLASTIC, says=SAYS_FRESNEL),
    "low_poly": Scenario(
        "a low-poly mesh with smooth shading", (put(shaped, scene.ball_mesh, 10, 6), POINT), (*TWO, "rough")
    ),
    "plane": Scenario(
        "a flat plane, seen at a low angle",
        (put(shaped, quad, "Plane", 12.0), put(stage.eye, (6.0, -6.0, 4.0)), put(map_of, "courtyard")), TWO,
    ),
    "text": Scenario("a text object", (text, AREA)),
    "modifiers": Scenario(
        "modifiers: subdivision and a thickness", (put(shaped, scene.ball_mesh, 8, 4), modifiers, POINT), TWO
    ),
    "several_slots": Scenario("several materials on one mesh", (several_slots, SUN), says=("gets the material",)),
    "shared_mesh": Scenario("two objects that share a mesh, and a third", (twins, SMALL_AREA), names=(NAME, "Twin")),
    "instances": Scenario("instances by geometry nodes", (instances, SUN), timed=True),
    "particles": Scenario("instances by a particle system", (particles, SUN)),
    "textured_roughness": Scenario(
        "a texture in the roughness", (put(map_of, "forest"),),
        finish=stage.driven("slope", checker, one=(SLOPES[0],) * 3, other=(SLOPES[1],) * 3),
    ),
    "textured_colour": Scenario(
        "a texture in the colour", (put(map_of, "interior"),), TWO,
        finish=stage.driven("colour", checker, one=(0.9, 0.5, 0.1), other=(0.2, 0.3, 0.9)),
    ),
    "in_a_mirror": Scenario(  # the light stands on the side that the mirror shows
        "seen in a mirror", (in_a_mirror, put(light, "AREA", 300.0, (-2.0, 2.0, 6.0), size=2.0))
    ),
}  # fmt: skip
