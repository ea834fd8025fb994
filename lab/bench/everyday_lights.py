# SPDX-License-Identifier: GPL-3.0-or-later
"""Everyday scenes whose idea is the light; ``everyday_stage`` says what a maker gets and may return."""

from __future__ import annotations

from functools import partial
from math import radians
from typing import TYPE_CHECKING

import bpy

from ...headless import scene
from ...nodegroups import versions
from .everyday_stage import (
    MODERN,
    NAME,
    SAYS_FRESNEL,
    Shot,
    add,
    background,
    checker,
    collection_of,
    everyday,
    floor,
    instances_by_nodes,
    light,
    look_at,
    map_of,
    quad,
    render_pass,
    shaded,
    sky,
)

if TYPE_CHECKING:
    from bpy.types import Object, Scene

IES = """IESNA:LM-63-1995
TILT=NONE
1 1000 1 5 1 1 2 0 0 0
1 1 100
0 22.5 45 67.5 90
0
1000 800 300 60 0
"""


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


@everyday("a ball of glass in an environment map", "frosted", "glass", says=("Too few bounces for glass",))
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
    return Shot(render=partial(render_pass, name="Combined_Key"))
