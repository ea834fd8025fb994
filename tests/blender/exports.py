# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials on cubes through Blender's exporters, and what the files hold of them."""

import json

from vgroove import headless, nodegroups
from vgroove.addon.blender import roles
from vgroove.addon.library import families, presets

PER_FAMILY = 4
_stages = []  # of USD, without which their surfaces are gone


def several():
    """Presets of all families, evenly among each family's, and of every model and kind."""
    found = {}
    for title in families.TITLES:
        of = sorted(one for one in presets.shipped() if families.title(one) == title)
        found |= dict.fromkeys(of[:: max(1, len(of) // PER_FAMILY)][:PER_FAMILY])
    known = {(one.model, one.kind) for one in map(presets.find, found)}
    for one in presets.shipped().values():
        if (one.model, one.kind) not in known:
            known.add((one.model, one.kind))
            found[one.id] = None
    return [presets.find(one) for one in found]


def shown(bpy, made):
    """A cube of 2 x 2 x 1 of a material, with a UV map, in the scene."""
    with headless.quiet():
        bpy.ops.mesh.primitive_cube_add(size=1.0)
    item = bpy.context.object
    item.data.transform(((2, 0, 0, 0), (0, 2, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)))
    item.data.materials.append(made)
    return item


def export(bpy, folder, name="scene"):
    """What glTF and USD hold of each material, by Blender's name of it."""
    from pxr import Usd, UsdShade

    with headless.quiet():
        bpy.ops.export_scene.gltf(filepath=str(folder / f"{name}.gltf"), export_format="GLTF_SEPARATE")
        bpy.ops.wm.usd_export(filepath=str(folder / f"{name}.usda"))
    written = json.loads((folder / f"{name}.gltf").read_text(encoding="utf-8"))
    stage = Usd.Stage.Open(str(folder / f"{name}.usda"))
    _stages.append(stage)
    surfaces = {}
    for prim in stage.Traverse():
        if prim.IsA(UsdShade.Material):
            surface = UsdShade.Material(prim).ComputeSurfaceSource()[0]
            named = prim.GetAttribute("userProperties:blender:data_name").Get()
            surfaces[named] = surface
    return written, {one["name"]: one for one in written["materials"]}, surfaces


def picture(bpy, made, socket, name, *, data=False):
    """An image that feeds an input."""
    tree = made.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = bpy.data.images.new(name, 4, 4, is_data=data)
    node.image.pack()
    tree.links.new(node.outputs["Color"], socket)
    return node


def our_input(made, name):
    return nodegroups.inputs(roles.node(made, roles.MODEL))[name]
