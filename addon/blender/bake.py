# SPDX-License-Identifier: GPL-3.0-or-later
"""The links of a Principled as image maps, for programs that read no nodes: baked by Cycles in a scene of its own."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import bpy
import numpy as np

from ...nodegroups import versions
from . import colour_space
from .images import srgb
from .material import MaterialError

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from bpy.types import Image, Material, NodeSocket, Object, Scene
    from numpy.typing import NDArray

    from .convert import Converted

    Floats = NDArray[np.float32]

SAMPLES = 4  # per pixel, for textures that are finer than one
MARGIN = 1 / 64  # of a side: how far colours go on beyond the borders of UV islands
CONSTANT = 1.5 / 255.0  # what varies by less than 8 bits can tell is one value
FLAT = np.array((0.5, 0.5, 1.0), np.float32)  # of a normal map
NORMAL = "Normal"


def flaw(item: Object) -> str:
    """Why nothing can be baked for an object, and what to do; empty if it can."""
    if item.type != "MESH":
        return f"{item.name} is no mesh; choose Object > Convert > Mesh first"
    if not item.data.polygons:
        return f"{item.name} has no faces to bake"
    if not item.data.uv_layers:
        return f"{item.name} has no UV map; unwrap it first (U in Edit Mode)"
    return ""


def bake(of: Converted, made: Material, items: list[Object], size: int) -> list[str]:
    """Put an image in place of each link of ``of.node`` that varies over the surface, and a number for the others.

    made: the material that ``items`` have, in whose place ``of.material`` is baked. size: of the images, in pixels.
    Returns what was left out, a phrase each. MaterialError if an object cannot be baked.
    """
    for item in items:
        if text := flaw(item):
            raise MaterialError(text)
    left = []
    with _stage(made, of.material, items) as (scene, copies):
        for socket in [socket for socket in of.node.inputs if socket.is_linked]:
            if socket.type == "VECTOR" and socket.name != NORMAL:
                left.append(f"what is linked to {socket.name}, which has no map")
                socket.id_data.links.remove(socket.links[0])
            else:
                left += _replace(socket, _baked(socket, of, scene, copies, size), of.material.name)
    _tidy(of.material)
    return left


@contextmanager
def _stage(made: Material, new: Material, items: Iterable[Object]) -> Iterator[tuple[Scene, list[Object]]]:
    """A scene with copies of the objects that have ``new`` in place of ``made``, and elsewhere what takes no map."""
    scene, copies = bpy.data.scenes.new("VGroove Bake"), []
    other, blank = versions.empty_material("VGroove Bake"), bpy.data.images.new("VGroove Bake", 1, 1)
    texture = other.node_tree.nodes.new("ShaderNodeTexImage")  # Cycles bakes into the active one of each material
    texture.image, other.node_tree.nodes.active = blank, texture
    scene.render.engine, cycles = "CYCLES", scene.cycles
    cycles.samples, cycles.use_denoising, cycles.use_adaptive_sampling = SAMPLES, False, False
    cycles.shading_system = bpy.context.scene.cycles.shading_system  # of an artist's own scripts
    try:
        for item in items:
            copy = item.copy()
            copies.append(copy)
            scene.collection.objects.link(copy)
            copy.hide_render = copy.hide_viewport = False
            for slot, before in zip(copy.material_slots, item.material_slots, strict=True):
                slot.link, own = "OBJECT", before.material == made
                slot.material = new if own else other
        yield scene, copies
    finally:
        for copy in copies:
            bpy.data.objects.remove(copy)
        bpy.data.scenes.remove(scene)
        bpy.data.materials.remove(other)
        bpy.data.images.remove(blank)


def _baked(socket: NodeSocket, of: Converted, scene: Scene, copies: list[Object], size: int) -> Floats:
    """What is linked to an input over the UV map, (size, size, 4), in the working space; alpha is 0 beside islands."""
    tree, is_normal = of.material.node_tree, socket.name == NORMAL
    image = bpy.data.images.new("VGroove Bake", size, size, alpha=True, float_buffer=True, is_data=True)
    image.generated_color = (0.0, 0.0, 0.0, 0.0)
    texture, emission = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeEmission")
    texture.image, tree.nodes.active = image, texture
    surface = tree.get_output_node("CYCLES").inputs["Surface"]
    shown = surface.links[0].from_socket
    number = tree.nodes.new("ShaderNodeMath")  # what is linked to a number becomes one before it is shown
    number.inputs[1].default_value = 0.0
    tree.links.new(socket.links[0].from_socket, number.inputs[0])
    shade = number.outputs[0] if socket.type == "VALUE" else socket.links[0].from_socket
    tree.links.new(shade, emission.inputs["Color"])
    tree.links.new(of.node.outputs[0] if is_normal else emission.outputs[0], surface)
    pixels = np.empty((size, size, 4), np.float32)
    try:
        for copy in copies:
            _run(scene, copy, "NORMAL" if is_normal else "EMIT", max(1, round(size * MARGIN)))
        image.pixels.foreach_get(pixels.ravel())
    except RuntimeError as error:
        message = f"{of.material.name} cannot be baked: {str(error).strip().removeprefix('Error: ')}"
        raise MaterialError(message) from error
    finally:
        tree.links.new(shown, surface)
        for node in (emission, texture, number):
            tree.nodes.remove(node)
        bpy.data.images.remove(image)
    return pixels


def _run(scene: Scene, item: Object, what: str, margin: int) -> None:
    given = {"scene": scene, "view_layer": scene.view_layers[0], "object": item, "active_object": item}
    uv = next(one.name for one in item.data.uv_layers if one.active_render)  # that images are placed by
    with bpy.context.temp_override(**given, selected_objects=[item], selected_editable_objects=[item]):
        bpy.ops.object.bake(
            type=what, target="IMAGE_TEXTURES", save_mode="INTERNAL", use_clear=False, uv_layer=uv, margin=margin,
            margin_type="EXTEND", use_selected_to_active=False, normal_space="TANGENT",
        )  # fmt: skip


def _replace(socket: NodeSocket, baked: Floats, name: str) -> list[str]:
    """Give an input what was baked in place of its link: an image or, where it is the same everywhere, a number."""
    tree, is_normal = socket.id_data, socket.name == NORMAL
    tree.links.remove(socket.links[0])
    covered = baked[baked[..., 3] > 0.0, :3]
    mean = covered.mean(axis=0) if covered.size else FLAT
    varies = bool(covered.size) and np.max(np.ptp(covered, axis=0)) > CONSTANT
    if is_normal and not varies and np.max(np.abs(mean - FLAT)) <= CONSTANT:
        return []
    if not is_normal and (not varies or np.max(covered) > 1.0 + CONSTANT):  # 8 bits hold 0 to 1
        socket.default_value = (*mean.tolist(), 1.0) if socket.type == "RGBA" else float(mean[0])
        return [f"how {socket.name} varies, as it exceeds 1: it has its mean"] if varies else []
    baked[baked[..., 3] == 0.0, :3] = mean
    texture, place = tree.nodes.new("ShaderNodeTexImage"), socket.node.location
    texture.image = _image(f"{name} {socket.name}", baked[..., :3], is_color=socket.type == "RGBA")
    texture.location = (place.x - 520, place.y + 300 - 300 * sum(one.is_linked for one in socket.node.inputs))
    source = texture.outputs["Color"]
    if is_normal:
        normal = tree.nodes.new("ShaderNodeNormalMap")
        normal.location = (place.x - 220, texture.location.y)
        tree.links.new(source, normal.inputs["Color"])
        source = normal.outputs["Normal"]
    tree.links.new(source, socket)
    return []


def _image(name: str, pixels: Floats, *, is_color: bool) -> Image:
    """An image of 8 bits, packed into the file; colours, which come in the working space, are stored as sRGB."""
    image = bpy.data.images.new(name, *pixels.shape[1::-1], is_data=not is_color)
    stored = srgb(colour_space.to_rec709(pixels)) if is_color else np.clip(pixels, 0.0, 1.0)
    full = np.concatenate([stored, np.ones_like(stored[..., :1])], axis=-1, dtype=np.float32)
    image.pixels.foreach_set(full.ravel())
    image.pack()
    return image


def _tidy(new: Material) -> None:
    """Remove the nodes that no longer feed an output."""
    tree = new.node_tree
    waiting = [node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial"]
    used = {node.name for node in waiting}
    while waiting:
        before = [link.from_node for socket in waiting.pop().inputs for link in socket.links]
        waiting += [node for node in before if node.name not in used]
        used.update(node.name for node in before)
    for node in [node for node in tree.nodes if node.name not in used]:
        tree.nodes.remove(node)
