# SPDX-License-Identifier: GPL-3.0-or-later
"""What differs between the Blenders that vgroove runs on, here alone, each with the version that it came with.

What asks for 5.0 goes with 4.5 LTS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from ..addon.reference import cycles

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Light, Material, NodeTree, Scene, World

TESTED = ((4, 5), (5, 2), (5, 3))


def version() -> tuple[int, int]:
    """This Blender's, major and minor."""
    return bpy.app.version[:2]


def since(*earliest: int) -> bool:
    """Whether this Blender is of that version or a later one."""
    return version() >= earliest


def is_untested() -> bool:
    """Whether this Blender is newer than any that vgroove was tested with."""
    return version() > TESTED[-1]


def untested() -> str:
    """That it is, in one line; empty where it is not."""
    if not is_untested():
        return ""
    newest = ".".join(map(str, TESTED[-1]))
    return f"vgroove was tested up to Blender {newest}, and not with {bpy.app.version_string}: look twice, or update it"


# Cycles

# Earlier Physical Conductors approximate: up to 0.8 % of the peak, half of it at k = 0.
EXACT_CONDUCTOR = since(5, 2)
# OSL's dielectric_bsdf and refraction turn the IOR over on back faces; before, whoever calls them has to.
OSL_TURNS_IOR = since(5, 3)
# Lobes whose normal leans from the surface's sent back up to this share more than their formula, times m.
LEANING = 0.0 if since(5, 0) else 2.6e-3
# Oren-Nayar of several bounces by another power of the colour.
cycles.set_version(cycles.SINCE_5_3 if since(5, 3) else cycles.UNTIL_5_2)
# Shaders store less on Cycles' stack.
LEAN_STACK = since(5, 0)
# Shader nodes can trace a ray (5.1): the Raycast node.
RAYCAST = hasattr(bpy.types, "ShaderNodeRaycast")
# Cycles' Principled bends each wavelength by an Abbe number (5.3); its Glass and Refraction nodes do not.
DISPERSES = since(5, 3)
# EEVEE evaluates a shader once per light (5.3): the Light Accumulation node.
LIGHT_NODES = hasattr(bpy.types, "ShaderNodeLightAccumulation")
# The base class of what USD exports call; None where a Blender was built without USD.
USD_HOOK: Any = getattr(bpy.types, "USDHook", None)


def osl_header() -> str:
    """What our shaders have to know of the Cycles that runs them."""
    return f"#define CYCLES_TURNS_IOR {int(OSL_TURNS_IOR)}\n"


# Blender

# What scenes call EEVEE.
EEVEE = "BLENDER_EEVEE" if since(5, 0) else "BLENDER_EEVEE_NEXT"


def nodes_of(owner: Material | World | Light) -> NodeTree:
    """The node tree of a material, world or light, which uses it from now on. 5.0 always does, and warns if asked."""
    if not since(5, 0):
        owner.use_nodes = True
    return owner.node_tree


def empty_material(name: str) -> Material:
    """A new material without nodes."""
    material = bpy.data.materials.new(name)
    nodes_of(material).nodes.clear()
    return material


def used_nodes(owner: Material | World | Light) -> NodeTree | None:
    """The node tree that a material, world or light renders with; None where it has none, or does not use it."""
    return owner.node_tree if owner.node_tree is not None and (since(5, 0) or owner.use_nodes) else None


def modifier_inputs(modifier: Any) -> list[object]:
    """The inputs of a Geometry Nodes modifier. 4.5 stores them in custom properties."""
    if not since(5, 0):
        return list(modifier.values())
    inputs = modifier.properties.inputs
    sockets = (getattr(inputs, one.identifier) for one in inputs.bl_rna.properties)
    return [getattr(one, "value", None) for one in sockets]


def working_space() -> str:
    """What EXR files call the open file's working space; "" in 4.5, which has none to choose."""
    return str(bpy.data.colorspace.working_space_interop_id) if since(5, 0) else ""


def write_as(settings: Any, media: str, file_format: str) -> None:
    """Set a scene's output format; media: IMAGE or VIDEO. 4.5 knows one list of formats."""
    if since(5, 0):
        settings.media_type = media
    settings.file_format = file_format


def compositors() -> Iterator[NodeTree]:
    """The node trees of compositors, and their groups. 5.0 took them out of the scenes."""
    yield from (group for group in bpy.data.node_groups if group.bl_idname == "CompositorNodeTree")
    if not since(5, 0):
        yield from (scene.node_tree for scene in bpy.data.scenes if scene.node_tree is not None)


def has_compositor(scene: Scene) -> bool:
    """Whether a scene has compositor nodes that are switched on: several groups from 5.3 on, one before."""
    if since(5, 3):
        return any(effect.enable_for_render and effect.node_group for effect in scene.compositor_effects)
    if since(5, 0):
        return scene.compositing_node_group is not None
    return bool(scene.use_nodes and scene.node_tree)
