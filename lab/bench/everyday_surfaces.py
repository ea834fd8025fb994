# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday scenes whose idea is the surface; ``everyday_stage`` says what a maker gets and may return."""

from __future__ import annotations

from functools import partial
from math import radians
from typing import TYPE_CHECKING

import bpy

from ...headless import scene
from .everyday_stage import (
    NAME,
    SAYS_FRESNEL,
    SLOPES,
    Shot,
    add,
    bumpy,
    checker,
    collection_of,
    drive,
    everyday,
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
    from bpy.types import Material, Scene


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
