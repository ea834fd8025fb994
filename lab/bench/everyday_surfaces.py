# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday scenes whose idea is the surface; ``everyday_stage`` says what a maker gets and may return."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING

import bpy

from ...headless import scene
from ..scenery import add_node, add_object, checker, quad, surface, wire
from . import everyday_stage as stage
from .everyday_stage import Shot, everyday

if TYPE_CHECKING:
    from bpy.types import Material, Node, NodeTree, Scene

SLOPES = (0.1, 0.4)  # of the two halves of a checkered surface


@everyday("a card with holes between ball, light and camera", "copper", "plaster")
def alpha_card(shown: Scene) -> None:
    stage.light(shown, "SUN", 3.0)

    def holes(tree: NodeTree) -> Node:
        clear, paper = (add_node(tree, kind) for kind in ("BsdfTransparent", "BsdfDiffuse"))
        return add_node(tree, "MixShader", Fac=checker(tree, (0, 0, 0), (1, 1, 1), 8.0), Shader=clear, Shader_001=paper)

    stage.square(shown, "Card", 3.0, (2.0, -2.1, 2.0), surface("Holes", holes), toward=(7.0, -7.0, 5.5))


@everyday("a pane of glass in front", "copper")
def behind_glass(shown: Scene) -> None:
    stage.map_of(shown, "interior")
    glass = stage.shaded("BsdfGlass", IOR=1.0)
    stage.square(shown, "Pane", 3.0, (2.0, -2.0, 1.4), glass, toward=shown.camera.location)


@everyday("a thin volume in front")
def volume(shown: Scene) -> None:
    stage.light(shown, "SUN", 3.0)
    fog = add_object(shown, "Fog", bpy.data.meshes.new("Fog"), (2.2, -2.1, 1.5))
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    fog.data.from_pydata(corners, [], sides)
    fog.data.materials.append(stage.shaded("VolumeScatter", "Volume", Density=0.2))


@everyday("a mild bump", "copper", "plaster", "plastic", says=stage.SAYS_FRESNEL)
def mild_bump(shown: Scene) -> Shot:
    stage.light(shown, "SUN", 3.0)
    return stage.driven("normal", stage.bumpy, strength=0.2, scale=3.0)


@everyday("a strong bump", "copper", "rough", "plaster")
def strong_bump(shown: Scene) -> Shot:
    stage.light(shown, "SUN", 3.0)
    stage.sky(shown, 0.3)
    return stage.driven("normal", stage.bumpy, strength=1.0, scale=4.0)


@everyday("a mild normal map")
def mild_normal_map(shown: Scene) -> Shot:
    stage.light(shown, "SUN", 3.0)
    stage.uv_sphere(shown.objects[stage.NAME])
    return stage.driven("normal", stage.normal_map, strength=0.3)


@everyday("a strong normal map under an environment map", "copper", "plastic", says=stage.SAYS_FRESNEL)
def strong_normal_map(shown: Scene) -> Shot:
    stage.map_of(shown, "forest")
    stage.uv_sphere(shown.objects[stage.NAME])
    return stage.driven("normal", stage.normal_map, strength=1.5)


@everyday("displacement")
def displacement(shown: Scene) -> Shot:
    stage.light(shown, "SUN", 3.0)
    return Shot(finish=_displace)


def _displace(made: Material) -> None:
    tree = made.node_tree
    displaced = add_node(tree, "Displacement", Scale=0.5, Height=add_node(tree, "TexNoise", Scale=1.5))
    wire(tree, displaced, tree.get_output_node("CYCLES").inputs["Displacement"])
    made.displacement_method = "BOTH"


@everyday("negative scale, under a bump", "copper", "plaster")
def negative_scale(shown: Scene) -> Shot:
    shown.objects[stage.NAME].scale = (-1.0, 1.0, 1.0)
    stage.light(shown, "SUN", 3.0)
    return stage.driven("normal", stage.bumpy, strength=0.5, scale=3.0)


@everyday("a ball turned inside out", "copper", "plastic", says=stage.SAYS_FRESNEL)
def backfaces(shown: Scene) -> None:
    shown.objects[stage.NAME].data.flip_normals()
    stage.light(shown, "POINT", 800.0)
    stage.sky(shown, 0.2)


@everyday("a low-poly mesh with smooth shading", "copper", "plaster", "rough")
def low_poly(shown: Scene) -> None:
    shown.objects[stage.NAME].data = scene.ball_mesh(10, 6)
    stage.light(shown, "POINT", 800.0)


@everyday("a flat plane, seen at a low angle", "copper", "plaster")
def plane(shown: Scene) -> None:
    shown.objects[stage.NAME].data = quad("Plane", 12.0)
    shown.camera.location = (6.0, -6.0, 4.0)
    stage.look_at(shown.camera)
    stage.map_of(shown, "courtyard")


@everyday("a text object")
def text(shown: Scene) -> None:
    bpy.data.objects.remove(shown.objects[stage.NAME])
    letters = bpy.data.curves.new("Text", "FONT")
    letters.body, letters.extrude, letters.bevel_depth, letters.size = "Ag", 0.2, 0.05, 1.7
    letters.align_x = letters.align_y = "CENTER"
    add_object(shown, stage.NAME, letters, turned=(60.0, 0.0, 45.0))
    stage.light(shown, "AREA", 300.0, size=2.0)


@everyday("modifiers: subdivision and a thickness", "copper", "plaster")
def modifiers(shown: Scene) -> None:
    item = shown.objects[stage.NAME]
    item.data = scene.ball_mesh(8, 4)
    item.modifiers.new("Subdivision", "SUBSURF").render_levels = 3
    item.modifiers.new("Solidify", "SOLIDIFY").thickness = 0.05
    stage.light(shown, "POINT", 800.0)


@everyday("several materials on one mesh", says=("gets the material",))
def several_slots(shown: Scene) -> None:
    item = shown.objects[stage.NAME]
    item.data.materials.append(stage.shaded("BsdfDiffuse"))
    item.data.materials.append(stage.shaded("BsdfDiffuse"))
    item.active_material_index = 1
    for face in item.data.polygons:
        face.material_index = face.index % 2
    stage.light(shown, "SUN", 3.0)


@everyday("two objects that share a mesh, and a third")
def shared_mesh(shown: Scene) -> Shot:
    item = shown.objects[stage.NAME]
    item.location, item.scale = (-0.5, -0.5, 0.0), (0.6, 0.6, 0.6)
    twin = add_object(shown, "Twin", item.data, (0.5, 0.5, 0.0))
    twin.scale = item.scale
    stage.light(shown, "AREA", 300.0, size=1.0)
    return Shot(names=(stage.NAME, "Twin"))


@everyday("instances by geometry nodes", "copper", timed=True)
def instances(shown: Scene) -> None:
    item = shown.objects[stage.NAME]
    item.scale = (0.4, 0.4, 0.4)
    stage.instances_by_nodes(stage.collection_of(item), stage.square(shown, "Carrier", 1.2))
    shown.collection.objects.link(item)
    stage.light(shown, "SUN", 3.0)


@everyday("instances by a particle system")
def particles(shown: Scene) -> None:
    item = shown.objects[stage.NAME]
    item.scale = (0.3, 0.3, 0.3)
    emitter = stage.square(shown, "Emitter", 2.0)
    settings = emitter.modifiers.new("Particles", "PARTICLE_SYSTEM").particle_system.settings
    settings.type, settings.count, settings.render_type = "HAIR", 12, "OBJECT"
    settings.instance_object, settings.particle_size = item, 0.3
    emitter.show_instancer_for_render = False
    stage.light(shown, "SUN", 3.0)


@everyday("a texture in the roughness")
def textured_roughness(shown: Scene) -> Shot:
    stage.map_of(shown, "forest")
    return stage.driven("slope", checker, one=(SLOPES[0],) * 3, other=(SLOPES[1],) * 3)


@everyday("a texture in the colour", "copper", "plaster")
def textured_colour(shown: Scene) -> Shot:
    stage.map_of(shown, "interior")
    return stage.driven("colour", checker, one=(0.9, 0.5, 0.1), other=(0.2, 0.3, 0.9))


@everyday("seen in a mirror")
def in_a_mirror(shown: Scene) -> None:
    item = shown.objects[stage.NAME]
    item.location, item.visible_camera = (1.6, -1.6, 1.1), False
    silver = stage.shaded("BsdfGlossy", Color=(1.0, 1.0, 1.0), Roughness=0.0)
    mirror = stage.square(shown, "Mirror", 8.0, (-1.0, 1.0, -0.7), silver, toward=shown.camera.location)
    mirror.rotation_euler.rotate_axis("X", radians(180.0))
    stage.light(shown, "AREA", 300.0, (-2.0, 2.0, 6.0), size=2.0)  # on the side that the mirror shows
