# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's textures at one point: what a ray hits there, and the values that image textures give its inputs.

Read are images that reach an input through UV, with a mapping or without, whole or by a channel, and constants. What
else an artist's nodes may compute stays unread, and is named.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from mathutils import Euler, Vector
from mathutils.geometry import barycentric_transform

from ..models import PLAIN, parameter
from ..reference.lobe import LUMINANCE
from . import colour_space, roles
from .inputs import scale_of
from .links import feeder
from .reading import parameter_sockets

if TYPE_CHECKING:
    from bpy.types import Depsgraph, Image, Material, Node, NodeSocket, Object, Scene
    from numpy.typing import NDArray

ACTIVE = ""  # the UV map that textures take by themselves
AXES = [Vector((1.0, 0.0, 0.0)), Vector((0.0, 1.0, 0.0)), Vector((0.0, 0.0, 0.0))]


@dataclass(frozen=True)
class Hit:
    """A point of a surface in world space, its normal toward the ray's start, the material there, and (u, v) by map."""

    point: Vector
    normal: Vector
    material: Material | None
    uvs: dict[str, tuple[float, float]]


def surface_at(scene: Scene, depsgraph: Depsgraph, start: Vector, direction: Vector) -> Hit | None:
    """The surface that a ray meets first; None if it meets none."""
    found, point, normal, face, item, matrix = scene.ray_cast(depsgraph, start, direction)
    if not found:
        return None
    normal = normal if normal.dot(direction) < 0.0 else -normal
    return Hit(point, normal, *_at_face(item.evaluated_get(depsgraph), face, matrix.inverted() @ point))


def _at_face(item: Object, face: int, point: Vector) -> tuple[Material | None, dict[str, tuple[float, float]]]:
    """The material of a face of an evaluated object, and the UVs at a point of it in the object's space."""
    mesh = item.to_mesh()
    try:
        slot = mesh.polygons[face].material_index
        slots = item.material_slots
        material = slots[min(slot, len(slots) - 1)].material if slots else None
        mesh.calc_loop_triangles()
        of = np.empty(len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get("polygon_index", of)
        uvs: dict[str, tuple[float, float]] = {}
        for layer in mesh.uv_layers:
            shares = _shares(mesh, np.flatnonzero(of == face), point)
            u, v = np.sum([share * np.array(layer.uv[loop].vector) for loop, share in shares], axis=0).tolist()
            uvs |= {layer.name: (u, v)} | ({ACTIVE: (u, v)} if layer.active_render else {})
    finally:
        item.to_mesh_clear()
    return material and material.original, uvs


def _shares(mesh: Any, triangles: NDArray[np.int64], point: Vector) -> list[tuple[int, float]]:
    """Loops of the triangle that holds a point, and how much each counts there."""
    best, least = [], -np.inf
    for index in triangles:
        triangle = mesh.loop_triangles[int(index)]
        corners = [mesh.vertices[vertex].co for vertex in triangle.vertices]
        x, y, _ = barycentric_transform(point, *corners, *AXES)
        shares = (x, y, 1.0 - x - y)
        if min(shares) > least:
            best, least = list(zip(triangle.loops, shares, strict=True)), min(shares)
    return best


@dataclass(frozen=True)
class Read:
    """Parameters that textures give at a point, in linear Rec.709, and the inputs that could not be read."""

    values: dict[str, Any]
    unread: tuple[str, ...]


def read(of: Material, uvs: dict[str, tuple[float, float]]) -> Read:
    """What feeds the inputs of a material of ours at a point of UVs ``uvs``."""
    values, unread = {}, []
    for name, socket in parameter_sockets(of).items():
        source = feeder(socket)
        if source is None or roles.role_of(source.node) == roles.TRAJECTORY:
            continue
        value = _value(source, uvs)
        if value is None:
            unread.append(socket.name)
        else:
            values[name] = _parameter(name, socket, value)
    node = roles.node(of, roles.MODEL)
    normal = node.inputs.get("Normal") if node else None
    if normal is not None and feeder(normal) is not None:
        unread.append("Normal")
    return Read(values, tuple(unread))


def _parameter(name: str, socket: NodeSocket, rgb: NDArray[np.float64]) -> Any:
    """A color as Cycles gives it to an input, as the parameter that the input holds."""
    known = parameter(name)
    if socket.type != "VALUE":
        return tuple(np.clip(rgb, known.low, known.high).tolist())
    held, scale = float(rgb @ LUMINANCE), scale_of(name, socket)
    return min(max(float(held if scale is PLAIN else scale.of_input(held)), known.low), known.high)


def _value(source: NodeSocket, uvs: dict[str, tuple[float, float]]) -> NDArray[np.float64] | None:
    """What a node gives there, RGB in linear Rec.709; of a number three times the same. None if it is not read."""
    node = source.node
    if node.bl_idname == "ShaderNodeTexImage":
        rgba = _sampled(node, uvs)
        return rgba if rgba is None else rgba[:3] if source.name == "Color" else np.full(3, rgba[3])
    if node.bl_idname == "ShaderNodeRGB":
        return colour_space.to_rec709(np.array(source.default_value[:3])).astype(np.float64)
    if node.bl_idname == "ShaderNodeValue":
        return np.full(3, float(source.default_value))
    if node.bl_idname == "ShaderNodeSeparateColor" and node.mode == "RGB":
        above = feeder(node.inputs[0])
        rgb = None if above is None else _value(above, uvs)
        return None if rgb is None else np.full(3, rgb[list(node.outputs).index(source)])
    return None


def _sampled(node: Node, uvs: dict[str, tuple[float, float]]) -> NDArray[np.float64] | None:
    """RGBA of an image texture."""
    image, uv = node.image, _uv(node.inputs["Vector"], uvs)
    if image is None or uv is None or node.projection != "FLAT" or image.source not in {"FILE", "GENERATED"}:
        return None
    space = image.colorspace_settings
    is_srgb = not image.is_float and space.name == "sRGB"
    if not (image.is_float or is_srgb or space.is_data) or not all(image.size):
        return None
    width, height = image.size
    x, y = uv[0] * width, uv[1] * height
    if node.extension == "CLIP" and not (0.0 <= x <= width and 0.0 <= y <= height):
        return np.zeros(4)
    if node.interpolation == "Closest":
        cells = [(int(np.floor(x)), int(np.floor(y)), 1.0)]
    else:  # between the centres of four texels
        left, low = int(np.floor(x - 0.5)), int(np.floor(y - 0.5))
        a, b = x - 0.5 - left, y - 0.5 - low
        cells = [(left, low, (1 - a) * (1 - b)), (left + 1, low, a * (1 - b))]
        cells += [(left, low + 1, (1 - a) * b), (left + 1, low + 1, a * b)]
    place = {"REPEAT": _repeated, "MIRROR": _mirrored}.get(node.extension, _ended)
    rgba = np.sum([share * _texel(image, place(i, width), place(j, height)) for i, j, share in cells], axis=0)
    if is_srgb:
        c = rgba[:3]
        rgba[:3] = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)  # IEC 61966-2-1
    else:
        rgba[:3] = colour_space.to_rec709(rgba[:3].astype(np.float32))
    return rgba


def _repeated(k: int, count: int) -> int:
    return k % count


def _mirrored(k: int, count: int) -> int:
    k %= 2 * count
    return min(k, 2 * count - 1 - k)


def _ended(k: int, count: int) -> int:
    return min(max(k, 0), count - 1)


_texels: dict[tuple[int, int, int], NDArray[np.float64]] = {}  # as Blender copies a whole image for one


def _texel(image: Image, x: int, y: int) -> NDArray[np.float64]:
    """RGBA as stored."""
    key = (image.session_uid, x, y)
    if key not in _texels:
        flat = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(flat)
        found = flat.reshape(image.size[1], image.size[0], -1)[y, x].astype(np.float64)
        found = np.repeat(found, 3) if len(found) == 1 else found
        _texels[key] = np.append(found, 1.0) if len(found) == 3 else found
    return _texels[key].copy()


def forget() -> None:
    """Texels that were read: images may have changed."""
    _texels.clear()


def _uv(socket: NodeSocket, uvs: dict[str, tuple[float, float]]) -> Vector | None:
    """(u, v, 0) that reaches an input for a vector; None where that is something else."""
    source = feeder(socket)
    if source is None:
        return _vector(uvs.get(ACTIVE))
    node = source.node
    if node.bl_idname == "ShaderNodeTexCoord":
        return _vector(uvs.get(ACTIVE)) if source.name == "UV" and not node.from_instancer else None
    if node.bl_idname == "ShaderNodeUVMap":
        return _vector(uvs.get(node.uv_map)) if not node.from_instancer else None
    if node.bl_idname == "ShaderNodeMapping":
        inner = _uv(node.inputs["Vector"], uvs)
        fixed = all(feeder(one) is None for one in node.inputs[1:])
        return _mapped(node, inner) if inner is not None and fixed else None
    return None


def _vector(uv: tuple[float, float] | None) -> Vector | None:
    return None if uv is None else Vector((*uv, 0.0))


def _mapped(node: Node, v: Vector) -> Vector | None:
    """What a Mapping node makes of a vector."""
    turn = Euler(node.inputs["Rotation"].default_value).to_matrix()
    scale = Vector(node.inputs["Scale"].default_value)
    move = Vector(node.inputs["Location"].default_value) if "Location" in node.inputs else Vector()
    if node.vector_type == "TEXTURE":
        inner = turn.transposed() @ (v - move)
        return Vector([a / b if b else 0.0 for a, b in zip(inner, scale, strict=True)])
    if node.vector_type not in {"POINT", "VECTOR"}:
        return None
    return turn @ (scale * v) + (move if node.vector_type == "POINT" else Vector())


def dumps(uvs: dict[str, tuple[float, float]]) -> str:
    return json.dumps(uvs)


def loads(text: str) -> dict[str, tuple[float, float]]:
    """What ``dumps`` wrote; nothing for anything else."""
    try:
        return {name: (float(u), float(v)) for name, (u, v) in json.loads(text or "{}").items()}
    except (ValueError, TypeError, AttributeError):
        return {}
