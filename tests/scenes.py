# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, lights, cards and worlds that several tests put into a scene."""

import bpy

from vgroove.addon.library import presets
from vgroove.nodegroups import versions

MATERIALS = {  # one of each model
    "metal": presets.find("metals/copper").with_parameters(m=0.2),
    "diffuse": presets.find("diffuse/chalk"),
    "plastic": presets.find("plastics/red_plastic"),
    "car paint": presets.find("car_paints/blue"),
    "glass": presets.find("glasses/frosted_glass").with_parameters(m=0.2),
    "marble": presets.find("translucent/marble"),
}


def add(shown, name, data, at=(0.0, 0.0, 0.0)):
    item = bpy.data.objects.new(name, data)
    item.location = at
    shown.collection.objects.link(item)
    return item


def add_light(shown, name, kind="SUN", at=(0.0, 0.0, 5.0), size=0.0):
    data = bpy.data.lights.new(name, kind)
    setattr(data, {"SUN": "angle", "AREA": "size"}.get(kind, "shadow_soft_size"), size)
    return add(shown, name, data, at)


def nodes_of(owner):
    tree = versions.nodes_of(owner)
    tree.nodes.clear()
    return tree


def add_card(shown, node, socket="Surface", name="Card"):
    """A square metre of one shader node between the objects and the light."""
    mesh, made = bpy.data.meshes.new(name), versions.empty_material(name)
    mesh.from_pydata([(-0.5, -0.5, 0), (0.5, -0.5, 0), (0.5, 0.5, 0), (-0.5, 0.5, 0)], [], [(0, 1, 2, 3)])
    tree = made.node_tree
    shader, out = tree.nodes.new(f"ShaderNode{node}"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], out.inputs[socket])
    mesh.materials.append(made)
    return add(shown, name, mesh, (0.0, 0.0, 1.5))


def add_world(shown, node, socket="Surface"):
    shown.world = bpy.data.worlds.new("World")
    tree = nodes_of(shown.world)
    shader, out = tree.nodes.new(f"ShaderNode{node}"), tree.nodes.new("ShaderNodeOutputWorld")
    tree.links.new(shader.outputs[0], out.inputs[socket])
    return shader


def by_instance(shown):
    rig, sun = bpy.data.collections.new("Rig"), add_light(shown, "Sun")
    shown.collection.objects.unlink(sun)
    rig.objects.link(sun)
    holder = add(shown, "Holder", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", rig
    return holder


def by_nested_instance(shown):
    inner, outer = by_instance(shown), bpy.data.collections.new("Outer")
    shown.collection.objects.unlink(inner)
    outer.objects.link(inner)
    holder = add(shown, "Outer", None)
    holder.instance_type, holder.instance_collection = "COLLECTION", outer


def in_background_set(shown):
    behind, sun = bpy.data.scenes.new("Stage"), add_light(shown, "Sun")
    shown.collection.objects.unlink(sun)
    behind.collection.objects.link(sun)
    shown.background_set = behind
