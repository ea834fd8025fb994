# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as artists make them: Blender's own settings, one idea each, a ball "Subject" that takes the material.

A maker is given Blender's start scene in small, without its cube and its light, and adds its idea. Where the idea is
in the material or in how the picture is taken, it returns a ``Shot`` that says so.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from mathutils import Vector

from ...addon.blender import gonio
from ...headless import scene
from ...nodegroups import versions

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import Material, Mesh, Node, NodeSocket, Object, Scene, ShaderNodeTree, World
    from numpy.typing import NDArray

MODERN = versions.since(5, 0)  # 4.5 has other names for some things
NAME = "Subject"
LENS = 170.0  # of the start scene's camera, 11.2 m away: a unit ball fills the picture
SIZE, SAMPLES = 32, 32
SAYS_FRESNEL = ("approximates this Fresnel term",) if not versions.EXACT_CONDUCTOR else ()  # true there
SLOPES = (0.1, 0.4)  # of the two halves of a checkered surface


@dataclass(frozen=True)
class Shot:
    """How the picture of a scene is taken, where not as usual.

    names: the objects that take the material. finish: what is done to the material after that. render: takes the
    picture. everywhere: judge all pixels, not those alone that show the material.
    """

    names: tuple[str, ...] = (NAME,)
    finish: Callable[[Material], None] = lambda _made: None
    render: Callable[[Scene], NDArray[np.float32]] = gonio.rendered
    everywhere: bool = False


@dataclass(frozen=True)
class Scenario:
    """A scene and the presets that are tried in it.

    says: words of the warnings that are right here. since: the first Blender that can do it. slow: tested on
    the newest Blender alone. timed: whether its time is judged; a scene's that takes one is.
    """

    title: str
    make: Callable[[Scene], Shot | None]
    subjects: tuple[str, ...]
    says: tuple[str, ...] = ()
    since: tuple[int, int] = (0, 0)
    slow: bool = False
    timed: bool = False


SCENES: dict[str, Scenario] = {}  # filled by ``everyday``


def everyday(title: str, *subjects: str, **more: Any) -> Callable[[Any], Any]:
    """Add the function as a scene, which is called as it is; copper is tried if nothing else is named."""

    def add(make: Callable[[Scene], Shot | None]) -> Callable[[Scene], Shot | None]:
        SCENES[make.__name__] = Scenario(title, make, subjects or ("copper",), **more)
        return make

    return add


def prepare(one: Scenario, size: int = SIZE, samples: int = SAMPLES) -> tuple[Scene, Shot]:
    """A scene and how its picture is taken. Empties the session."""
    bpy.ops.wm.read_factory_settings()
    shown = bpy.context.scene
    shown.render.engine, shown.cycles.device = "CYCLES", "CPU"
    shown.cycles.samples, shown.cycles.use_denoising = samples, False  # a denoiser would hide noise and spots alike
    shown.render.resolution_x = shown.render.resolution_y = size
    shown.render.image_settings.file_format, shown.render.image_settings.color_depth = "OPEN_EXR", "32"
    shown.camera.data.lens = LENS
    for unwanted in ("Cube", "Light"):
        bpy.data.objects.remove(shown.objects[unwanted])
    add(shown, NAME, scene.ball_mesh(48, 24))
    shot = one.make(shown) or Shot()
    bpy.context.view_layer.update()
    return shown, shot


# --- what scenes are made of ----------------------------------------------------------------------------------------


def add(
    shown: Scene, name: str, data: Any, at: Sequence[float] = (0, 0, 0), turned: Sequence[float] = (0, 0, 0)
) -> Object:
    """An object in the scene; turned: degrees about x, y and z."""
    item = bpy.data.objects.new(name, data)
    item.location, item.rotation_euler = at, [radians(angle) for angle in turned]
    shown.collection.objects.link(item)
    return item


def light(shown: Scene, kind: str, energy: float, at: Sequence[float] = (3.0, -3.5, 4.0), **settings: Any) -> Object:
    """A light that looks at the ball."""
    data = bpy.data.lights.new(kind.title(), kind)
    data.energy = energy
    for name, value in settings.items():
        setattr(data, name, value)
    item = add(shown, kind.title(), data, at)
    look_at(item)
    return item


def look_at(item: Object, at: Sequence[float] = (0, 0, 0)) -> None:
    item.rotation_euler = (Vector(at) - item.location).to_track_quat("-Z", "Y").to_euler()


def quad(name: str, side: float) -> Mesh:
    """A square with UVs."""
    half, mesh = side / 2.0, bpy.data.meshes.new(name)
    mesh.from_pydata([(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)], [], [(0, 1, 2, 3)])
    layer = mesh.uv_layers.new(name="UVMap")
    for corner, place in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
        corner.uv = place
    return mesh


def floor(shown: Scene, level: float = 0.3, height: float = -1.0) -> Object:
    item = add(shown, "Floor", quad("Floor", 30.0), (0, 0, height))
    item.data.materials.append(shaded("BsdfDiffuse", Color=(level, level, level, 1.0)))
    return item


def shaded(kind: str, socket: str = "Surface", **inputs: Any) -> Material:
    """A material of one node."""
    made = versions.empty_material(kind)
    tree = made.node_tree
    node, output = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeOutputMaterial")
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    tree.links.new(node.outputs[0], output.inputs[socket])
    return made


def sky(shown: Scene, level: float = 0.5) -> None:
    background(shown.world).inputs["Color"].default_value = (level, level, level, 1.0)


def background(world: World) -> Node:
    return next(node for node in world.node_tree.nodes if node.bl_idname == "ShaderNodeBackground")


def map_of(shown: Scene, name: str, strength: float = 1.0) -> None:
    """One of the maps that come with Blender, sampled by a coarse table: that of all its pixels takes seconds."""
    scene.light_by(shown, scene.environments()[name], strength)
    shown.world.cycles.sampling_method, shown.world.cycles.sample_map_resolution = "MANUAL", 512


def uv_sphere(item: Object) -> None:
    """Longitude and latitude as the ball's UVs."""
    mesh = item.data
    layer = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        x, y, z = mesh.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (np.arctan2(y, x) / (2 * np.pi) + 0.5, np.arcsin(np.clip(z, -1, 1)) / np.pi + 0.5)


def drive(made: Material, what: str, make: Callable[[ShaderNodeTree], NodeSocket]) -> None:
    """Link a texture to "normal", "colour" or "slope" of the material, ours or a native one."""
    tree = made.node_tree
    for socket in _inputs(tree, what):
        source = make(tree)
        if what == "slope":  # which inputs take as its square root
            root = tree.nodes.new("ShaderNodeMath")
            root.operation = "SQRT"
            tree.links.new(source, root.inputs[0])
            source = root.outputs[0]
        tree.links.new(source, socket)


def _inputs(tree: ShaderNodeTree, what: str) -> list[NodeSocket]:
    wanted = {"normal": ("Normal",), "colour": ("Base Color", "Color"), "slope": ("Roughness",)}[what]
    ours = [node for node in tree.nodes if node.bl_idname == "ShaderNodeGroup" and "Normal" in node.inputs]
    natives = [node for node in tree.nodes if node.bl_idname.startswith("ShaderNodeBsdf")]
    found = [next(node.inputs[name] for name in wanted if name in node.inputs) for node in ours or natives]
    if not found:
        message = f"{tree.name}: nothing takes a {what}"
        raise ValueError(message)
    return found


def bumpy(strength: float, scale: float) -> Callable[[ShaderNodeTree], NodeSocket]:
    """The normal of a noisy height."""

    def make(tree: ShaderNodeTree) -> NodeSocket:
        noise, bump = tree.nodes.new("ShaderNodeTexNoise"), tree.nodes.new("ShaderNodeBump")
        noise.inputs["Scale"].default_value, bump.inputs["Strength"].default_value = scale, strength
        bump.inputs["Distance"].default_value = 1.0  # 4.5's own; 5.2 has a thousandth of it
        tree.links.new(noise.outputs[0], bump.inputs["Height"])
        return bump.outputs["Normal"]

    return make


def normal_map(strength: float) -> Callable[[ShaderNodeTree], NodeSocket]:
    """A tangent-space picture of round dents."""

    def make(tree: ShaderNodeTree) -> NodeSocket:
        place = (np.arange(64) + 0.5) / 64.0
        u, v = np.meshgrid(place, place)
        slope = np.stack([np.sin(16 * np.pi * u), np.sin(8 * np.pi * v), np.full_like(u, 1.0)], axis=-1)
        slope /= np.linalg.norm(slope, axis=-1, keepdims=True)
        image = bpy.data.images.new("Dents", 64, 64, float_buffer=True, is_data=True)
        image.pixels.foreach_set(
            np.concatenate([slope / 2 + 0.5, np.ones((64, 64, 1))], axis=-1).astype(np.float32).ravel()
        )
        texture, node = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeNormalMap")
        texture.image, node.inputs["Strength"].default_value = image, strength
        tree.links.new(texture.outputs["Color"], node.inputs["Color"])
        return node.outputs["Normal"]

    return make


def checker(one: Sequence[float], other: Sequence[float], scale: float = 3.0) -> Callable[[ShaderNodeTree], NodeSocket]:
    def make(tree: ShaderNodeTree) -> NodeSocket:
        node = tree.nodes.new("ShaderNodeTexChecker")
        node.inputs["Scale"].default_value = scale
        node.inputs["Color1"].default_value, node.inputs["Color2"].default_value = (*one, 1.0), (*other, 1.0)
        return node.outputs["Color"]

    return make


def instances_by_nodes(of: Any, carrier: Object) -> None:
    """Have geometry nodes put an object, or a collection, on the carrier's points."""
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    tree.interface.new_socket("Geometry", in_out="INPUT", socket_type="NodeSocketGeometry")
    tree.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    start, end, spread = (
        tree.nodes.new(name) for name in ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints")
    )
    kind = "Object" if isinstance(of, bpy.types.Object) else "Collection"
    info = tree.nodes.new(f"GeometryNode{kind}Info")
    info.inputs[kind].default_value = of
    tree.links.new(start.outputs[0], spread.inputs["Points"])
    tree.links.new(info.outputs["Geometry" if kind == "Object" else "Instances"], spread.inputs["Instance"])
    tree.links.new(spread.outputs[0], end.inputs[0])
    carrier.modifiers.new("Instances", "NODES").node_group = tree


def collection_of(*items: Object) -> Any:
    """A collection that no scene holds, with the objects in it and nowhere else."""
    made = bpy.data.collections.new("Elsewhere")
    for item in items:
        for holder in item.users_collection:
            holder.objects.unlink(item)
        made.objects.link(item)
    return made


def render_pass(shown: Scene, name: str) -> NDArray[np.float32]:
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
