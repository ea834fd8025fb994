# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday scenes whose idea is the light; ``everyday_stage`` says what a maker gets and may return."""

from __future__ import annotations

from functools import partial
from math import radians
from typing import TYPE_CHECKING

import bpy

from ...headless import scene
from ...nodegroups import versions
from ..scenery import add_node, add_object, background, checker, wire
from . import everyday_stage as stage
from .everyday_stage import Shot, everyday

if TYPE_CHECKING:
    from bpy.types import Scene

IES = """IESNA:LM-63-1995
TILT=NONE
1 1000 1 5 1 1 2 0 0 0
1 1 100
0 22.5 45 67.5 90
0
1000 800 300 60 0
"""


@everyday("Blender's own start scene, denoised", "copper", "plastic", says=stage.SAYS_FRESNEL)
def start(shown: Scene) -> None:
    shown.objects[stage.NAME].data = bpy.data.meshes["Cube"]
    shown.camera.data.lens = 50.0
    add_object(shown, "Light", bpy.data.lights["Light"], (4.08, 1.01, 5.9))
    shown.cycles.use_denoising = True


@everyday("sun", "copper", "plaster", timed=True)
def sun(shown: Scene) -> None:
    stage.light(shown, "SUN", 3.0, angle=radians(0.53))


@everyday("point light", "copper", "plastic", says=stage.SAYS_FRESNEL)
def point(shown: Scene) -> None:
    stage.light(shown, "POINT", 800.0)


@everyday("spot light", "copper", "conductor", says=stage.SAYS_FRESNEL)
def spot(shown: Scene) -> None:
    stage.light(shown, "SPOT", 1500.0, spot_size=radians(30.0), spot_blend=0.4)


@everyday("area light", "copper", "plaster", "plastic", "paint", says=stage.SAYS_FRESNEL, timed=True)
def area(shown: Scene) -> None:
    stage.light(shown, "AREA", 300.0, shape="DISK", size=2.0)


@everyday("lights of zero size")
def zero_size(shown: Scene) -> None:
    stage.light(shown, "POINT", 600.0, shadow_soft_size=0.0)
    stage.light(shown, "SUN", 1.0, (-3.0, -3.5, 2.0), angle=0.0)


@everyday("eight mixed lights", "copper", "plaster", timed=True)
def eight_lights(shown: Scene) -> None:
    for side in (-1.0, 1.0):
        stage.light(shown, "SUN", 0.5, (3.0 * side, -4.0, 3.0), angle=0.1)
        stage.light(shown, "POINT", 150.0, (4.0 * side + 2.0, -3.0, 1.0), shadow_soft_size=0.2)
        stage.light(shown, "SPOT", 300.0, (1.0, -5.0, 3.0 * side))
        stage.light(shown, "AREA", 80.0, (5.0, 2.0 * side, 4.0), size=1.0)


@everyday("a small emissive mesh in a dim sky")
def small_emitter(shown: Scene) -> None:
    lamp = add_object(shown, "Bulb", scene.ball_mesh(16, 8), (3.0, -2.5, 3.0))
    lamp.scale = (0.1, 0.1, 0.1)
    lamp.data.materials.append(stage.shaded("Emission", Strength=800.0))


@everyday("a large emissive mesh", "copper", "plaster", timed=True)
def large_emitter(shown: Scene) -> None:
    stage.square(shown, "Panel", 4.0, (-2.0, -5.0, 2.0), stage.shaded("Emission", Strength=4.0), toward=(0, 0, 0))


@everyday("environment map", "copper", "plaster", "plastic", says=stage.SAYS_FRESNEL, timed=True)
def hdri(shown: Scene) -> None:
    stage.map_of(shown, "forest")


@everyday("a ball of glass in an environment map", "frosted", "glass", says=("Too few bounces for glass",))
def glass(shown: Scene) -> None:
    stage.map_of(shown, "studio")


@everyday("environment map by night, with bright small lights")
def hdri_night(shown: Scene) -> None:
    stage.map_of(shown, "night")


@everyday("environment map and sun", "copper", "plaster")
def hdri_and_sun(shown: Scene) -> None:
    stage.map_of(shown, "courtyard", 0.5)
    stage.light(shown, "SUN", 2.0, angle=radians(0.53))


@everyday("even sky", "copper", "plaster", "conductor", "paint", says=stage.SAYS_FRESNEL, timed=True)
def even_sky(shown: Scene) -> None:
    stage.sky(shown)


@everyday("sky texture with sun disc", "copper", "plaster")
def sky_sun_disc(shown: Scene) -> None:
    tree, kind = shown.world.node_tree, "SINGLE_SCATTERING" if stage.MODERN else "NISHITA"
    sun = {"sun_disc": True, "sun_elevation": radians(35.0), "sun_rotation": radians(150.0)}
    wire(tree, add_node(tree, "TexSky", sky_type=kind, **sun), background(shown.world).inputs["Color"])
    background(shown.world).inputs["Strength"].default_value = 0.1


@everyday("a room with a portal in its window", timed=True)
def portal(shown: Scene) -> None:
    stage.sky(shown, 4.0)
    stage.floor(shown)
    wall = stage.square(shown, "Wall", 8.0, (-3.0, 0.0, 0.0), stage.shaded("BsdfDiffuse"))
    wall.rotation_euler.y = radians(90.0)
    window = stage.light(shown, "AREA", 1.0, (2.0, -3.0, 3.0), size=3.0)
    window.data.cycles.is_portal = True


@everyday("a light with an IES profile")
def ies(shown: Scene) -> None:
    lamp = stage.light(shown, "POINT", 400.0)
    tree, profile = versions.nodes_of(lamp.data), bpy.data.texts.new("Profile")
    profile.write(IES)
    wire(tree, add_node(tree, "TexIES", ies=profile), tree.nodes["Emission"].inputs["Strength"])


@everyday("a light with nodes: coloured spots that fall off evenly")
def node_light(shown: Scene) -> None:
    lamp = stage.light(shown, "AREA", 15.0, size=1.0)
    tree = versions.nodes_of(lamp.data)
    emission, place = tree.nodes["Emission"], add_node(tree, "NewGeometry").outputs["Position"]
    wire(tree, checker(tree, (1.0, 0.2, 0.1), (0.1, 0.3, 1.0), Vector=place), emission.inputs["Color"])
    wire(tree, add_node(tree, "LightFalloff", Strength=1.0).outputs["Linear"], emission.inputs["Strength"])


@everyday("light linking, with the ball left out by one light")
def light_linked(shown: Scene) -> None:
    stage.floor(shown)
    stage.light(shown, "POINT", 500.0)
    other = stage.light(shown, "SUN", 20.0, (-3.0, -3.5, 2.0))
    lit = bpy.data.collections.new("Lit")
    lit.objects.link(shown.objects["Floor"])
    other.light_linking.receiver_collection = lit


@everyday("shadow linking, past a card that blocks no light")
def shadow_linked(shown: Scene) -> None:
    lamp = stage.light(shown, "POINT", 500.0)
    card = stage.square(shown, "Card", 3.0, (1.5, -1.75, 2.0), toward=lamp.location)
    blockers = bpy.data.collections.new("Blockers")
    blockers.objects.link(shown.objects[stage.NAME])
    lamp.light_linking.blocker_collection = blockers
    card.visible_camera = False


@everyday("a background set with a sun")
def background_set(shown: Scene) -> None:
    other = bpy.data.scenes.new("Set")
    lamp = stage.light(shown, "SUN", 3.0)
    shown.collection.objects.unlink(lamp)
    other.collection.objects.link(lamp)
    shown.background_set = other


@everyday("a collection instance that brings a light")
def collection_light(shown: Scene) -> None:
    lamp = stage.light(shown, "AREA", 300.0, size=1.0)
    holder = add_object(shown, "Instance", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", stage.collection_of(lamp)


@everyday("lights that geometry nodes bring")
def lights_by_nodes(shown: Scene) -> None:
    lamp = stage.light(shown, "POINT", 100.0, (0.0, 0.0, 0.0), shadow_soft_size=0.2)
    carrier = stage.square(shown, "Carrier", 3.0, (2.0, -3.0, 3.5))
    stage.instances_by_nodes(stage.collection_of(lamp), carrier)


@everyday("three light groups, and the picture of one")
def light_groups(shown: Scene) -> Shot:
    for name, side in (("Key", 1.0), ("Fill", -1.0)):
        shown.view_layers[0].lightgroups.add(name=name)
        stage.light(shown, "POINT", 400.0, (4.0 * side + 1.0, -4.0, 2.0)).lightgroup = name
    shown.view_layers[0].lightgroups.add(name="World")
    shown.world.lightgroup = "World"
    return Shot(render=partial(stage.render_pass, name="Combined_Key"))
