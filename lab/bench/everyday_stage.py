# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes as artists make them: Blender's own settings, one idea each, a ball "Subject" that takes the material.

Each adds its idea to Blender's start scene in small, without its cube and its light; ``everyday_scenes`` is the table.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np
from mathutils import Vector

from ...addon.blender import gonio
from ...headless import scene
from ...nodegroups import versions
from ..scenery import add_node, add_object, background, light_data, quad, surface, wire, write_exact

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import Collection, Material, Node, NodeSocket, NodeTree, Object, Scene
    from numpy.typing import NDArray

MODERN = versions.since(5, 0)  # 4.5 has other names for some things
NAME = "Subject"
LENS = 170.0  # of the start scene's camera, 11.2 m away: a unit ball fills the picture
SIZE, SAMPLES = 32, 32
SAYS_FRESNEL = ("approximates this Fresnel term",) if not versions.EXACT_CONDUCTOR else ()  # true there


@dataclass(frozen=True)
class Scenario:
    """A scene, the presets that are tried in it, and how its picture is taken.

    adds: what is added to the start scene, in order. says: words of the warnings that are right here. since: the first
    Blender that can do it. slow: tested on the newest Blender alone. timed: whether its time is judged. names: the
    objects that take the material. finish: what is done to the scene and the material after that. render: takes the
    picture. everywhere: judge all pixels, not those alone that show the material.
    """

    title: str
    adds: tuple[Callable[[Scene], Any], ...] = ()
    subjects: tuple[str, ...] = ("copper",)
    says: tuple[str, ...] = ()
    since: tuple[int, int] = (0, 0)
    slow: bool = False
    timed: bool = False
    names: tuple[str, ...] = (NAME,)
    finish: Callable[[Scene, Material], None] = lambda _shown, _made: None
    render: Callable[[Scene], NDArray[np.float32]] = gonio.rendered
    everywhere: bool = False


def prepare(one: Scenario, size: int = SIZE, samples: int = SAMPLES) -> Scene:
    """The scene. Empties the session."""
    bpy.ops.wm.read_factory_settings()
    shown = bpy.context.scene
    shown.render.engine, shown.cycles.device = "CYCLES", "CPU"
    shown.cycles.samples, shown.cycles.use_denoising = samples, False  # a denoiser would hide noise and spots alike
    write_exact(shown, size)
    shown.camera.data.lens = LENS
    for unwanted in ("Cube", "Light"):
        bpy.data.objects.remove(shown.objects[unwanted])
    add_object(shown, NAME, scene.ball_mesh(48, 24))
    for add in one.adds:
        add(shown)
    bpy.context.view_layer.update()
    return shown


# --- what scenes are made of ----------------------------------------------------------------------------------------


def put(make: Callable[..., Any], *given: Any, **named: Any) -> Callable[[Scene], Any]:
    """What does that to a scene: ``make`` with all of its arguments but the first."""
    return lambda shown: make(shown, *given, **named)


def settings(shown: Scene, of: str, **values: Any) -> None:
    """Set properties of what is found by a path from the scene."""
    for name, value in values.items():
        setattr(shown.path_resolve(of), name, value)


def light(shown: Scene, kind: str, energy: float, at: Sequence[float] = (3.0, -3.5, 4.0), **settings: Any) -> Object:
    """A light that looks at the ball."""
    item = add_object(shown, kind.title(), light_data(kind.title(), kind, energy=energy, **settings), at)
    look_at(item)
    return item


def eye(shown: Scene, at: Sequence[float]) -> None:
    """Move the camera, and look at the ball."""
    shown.camera.location = at
    look_at(shown.camera)


def look_at(item: Object, at: Sequence[float] = (0, 0, 0)) -> None:
    item.rotation_euler = (Vector(at) - item.location).to_track_quat("-Z", "Y").to_euler()


def square(
    shown: Scene, name: str, side: float, at: Sequence[float] = (0, 0, 0), make: Callable[[], Material] | None = None,
    toward: Sequence[float] | None = None,
) -> Object:  # fmt: skip
    """A square of the material that ``make`` makes, level unless it looks toward something."""
    item = add_object(shown, name, quad(name, side), at)
    if make is not None:
        item.data.materials.append(make())
    if toward is not None:
        look_at(item, toward)
    return item


def floor(shown: Scene, level: float = 0.3) -> Object:
    return square(shown, "Floor", 30.0, (0, 0, -1), partial(shaded, "BsdfDiffuse", Color=(level, level, level)))


def shaded(kind: str, socket: str = "Surface", **inputs: Any) -> Material:
    """A material of one node."""
    return surface(kind, lambda tree: add_node(tree, kind, **inputs), socket)


def sky(shown: Scene, level: float = 0.5) -> None:
    wire(shown.world.node_tree, (level, level, level), background(shown.world).inputs["Color"])


def map_of(shown: Scene, name: str, strength: float = 1.0) -> None:
    """One of the maps that come with Blender, sampled by a coarse table: that of all its pixels takes seconds."""
    scene.light_by(shown, scene.environments()[name], strength)
    shown.world.cycles.sampling_method, shown.world.cycles.sample_map_resolution = "MANUAL", 512


def uv_sphere(shown: Scene) -> None:
    """Longitude and latitude as the ball's UVs."""
    mesh = shown.objects[NAME].data
    layer = mesh.uv_layers.new(name="UVMap")
    for loop in mesh.loops:
        x, y, z = mesh.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (np.arctan2(y, x) / (2 * np.pi) + 0.5, np.arcsin(np.clip(z, -1, 1)) / np.pi + 0.5)


def driven(what: str, make: Callable[..., Node], **given: Any) -> Callable[[Scene, Material], None]:
    """Link a texture that ``make`` adds to "normal", "colour" or "slope" of the material, ours or a native one."""
    return partial(_drive, what=what, make=partial(make, **given))


def _drive(_shown: Scene, made: Material, what: str, make: Callable[[NodeTree], Node]) -> None:
    tree = made.node_tree
    for socket in _inputs(tree, what):
        source = make(tree)
        if what == "slope":  # which inputs take as its square root
            source = add_node(tree, "Math", operation="SQRT", Value=source)
        wire(tree, source, socket)


def _inputs(tree: NodeTree, what: str) -> list[NodeSocket]:
    wanted = {"normal": ("Normal",), "colour": ("Base Color", "Color"), "slope": ("Roughness",)}[what]
    ours = [node for node in tree.nodes if node.bl_idname == "ShaderNodeGroup" and "Normal" in node.inputs]
    natives = [node for node in tree.nodes if node.bl_idname.startswith("ShaderNodeBsdf")]
    found = [next(node.inputs[name] for name in wanted if name in node.inputs) for node in ours or natives]
    if not found:
        message = f"{tree.name}: nothing takes a {what}"
        raise ValueError(message)
    return found


def bumpy(tree: NodeTree, strength: float, scale: float) -> Node:
    """The normal of a noisy height; 4.5 has another distance than 5.2 unless it is set."""
    return add_node(tree, "Bump", Strength=strength, Distance=1.0, Height=add_node(tree, "TexNoise", Scale=scale))


def normal_map(tree: NodeTree, strength: float) -> Node:
    """A tangent-space picture of round dents."""
    place = (np.arange(64) + 0.5) / 64.0
    u, v = np.meshgrid(place, place)
    slope = np.stack([np.sin(16 * np.pi * u), np.sin(8 * np.pi * v), np.full_like(u, 1.0)], axis=-1)
    slope /= np.linalg.norm(slope, axis=-1, keepdims=True)
    image = bpy.data.images.new("Dents", 64, 64, float_buffer=True, is_data=True)
    pixels = np.concatenate([slope / 2 + 0.5, np.ones((64, 64, 1))], axis=-1)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    return add_node(tree, "NormalMap", Strength=strength, Color=add_node(tree, "TexImage", image=image))


def instances_by_nodes(of: Collection, carrier: Object) -> None:
    """Have geometry nodes put a collection on the carrier's points."""
    tree = bpy.data.node_groups.new("Instances", "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    kinds = ("NodeGroupInput", "GeometryNodeCollectionInfo", "GeometryNodeInstanceOnPoints", "NodeGroupOutput")
    start, info, spread, end = map(tree.nodes.new, kinds)
    info.inputs["Collection"].default_value = of
    wire(tree, start, spread.inputs["Points"])
    wire(tree, info, spread.inputs["Instance"])
    wire(tree, spread, end.inputs[0])
    carrier.modifiers.new("Instances", "NODES").node_group = tree


def collection_of(item: Object) -> Collection:
    """A collection that no scene holds, with the object in it and nowhere else."""
    made = bpy.data.collections.new("Elsewhere")
    for holder in item.users_collection:
        holder.objects.unlink(item)
    made.objects.link(item)
    return made


def render_pass(shown: Scene, name: str) -> NDArray[np.float32]:
    """The three channels of a pass of the first view layer, in place of the picture. A file may have parts."""
    import OpenImageIO as oiio  # noqa: N813 - as in images.write

    settings = shown.render.image_settings
    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        shown.render.filepath = path = str(Path(folder) / "render.exr")
        versions.write_as(settings, "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER")
        bpy.ops.render.render(write_still=True, scene=shown.name)
        versions.write_as(settings, "IMAGE", "OPEN_EXR")
        settings.color_depth = "32"
        for part in range(oiio.ImageBuf(path).nsubimages):
            file = oiio.ImageBuf(path, part, 0)
            order = {channel: "RGBXYZ".find(channel[-1]) for channel in file.spec().channelnames}
            wanted = [k for k, one in enumerate(order) if f".{name}." in f".{one}" and order[one] >= 0]
            if len(wanted) == 3:
                return file.get_pixels(oiio.FLOAT)[..., sorted(wanted, key=list(order.values()).__getitem__)]
    message = f"the render has no pass {name}"
    raise RuntimeError(message)
