# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of maps, known by the usual endings of their names, as textures for a material of ours."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import bpy

from ..library.errors import InputError
from . import roles
from .textures import Textures

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from bpy.types import Image, Node, NodeSocket, ShaderNodeTree

# The last of these words in a name says what a map is.
WORDS = {
    "Base Color": r"base_?colou?r|albedo|diff|diffuse|colou?r|col|bc",
    "Packed": r"orm|arm|metallic_?roughness|occlusion_?roughness_?metallic",  # roughness in green, as glTF has it
    "Roughness": r"rough|roughness|rgh",
    "Glossiness": r"gloss|glossiness",
    "Normal": r"nor|norm|normal|nrm|normal_?gl|nor_gl|normal_?opengl",
    "Normal DX": r"(?:nor|norm|normal|nrm)_?(?:dx|directx)",
    "Bump": r"bump|bmp",
    "Displacement": r"disp|displacement|height",
    "Alpha": r"alpha|opacity",
    "Emission Color": r"emission|emissive|emit",
    "Metallic": r"metal|metallic|metalness",
    "Ambient Occlusion": r"ao|occlusion|ambient_?occlusion",
    "Specular": r"spec|specular",
    "Mask": r"mask|id",
}
LEFT_OUT = ("Ambient Occlusion", "Specular", "Mask")  # no model of ours has an input for them
IN_COLOUR = ("Base Color", "Emission Color")  # the rest are data
PICTURES = (".png", ".jpg", ".jpeg", ".exr", ".tif", ".tiff", ".tga", ".webp", ".bmp", ".hdr")
UDIM = r"[._]1\d{3}$"  # the number of a tile ends the name
SET = "set"  # role of the nodes that one set brings, and the next takes away
HEIGHT = 0.05  # scene units between black and white, by eye


class ImageSetError(InputError):
    """A folder in which no map is found."""


def kind_of(name: str) -> str:
    """What a map is by the name of its file; "" if that does not say. Of several words the last counts."""
    stem = _spaced(name)
    found = [(match.end(), len(match[0]), kind)
             for kind, words in WORDS.items() for match in re.finditer(rf"(?<=_)(?:{words})(?=_)", stem)]  # fmt: skip
    return max(found)[2] if found else ""


def _spaced(name: str) -> str:
    """A name in small letters, each word between underscores."""
    apart = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)
    return "_" + re.sub(r"[^a-z0-9]+", "_", apart.lower()) + "_"


def find(folder: Path) -> dict[str, Path]:
    """The maps of a folder by kind; of several sets the largest, by what their names share. ImageSetError if none."""
    pictures = sorted(path for path in folder.iterdir() if path.suffix.lower() in PICTURES) if folder.is_dir() else []
    sets: dict[str, dict[str, Path]] = {}
    for path in pictures:
        if kind := kind_of(path.stem):
            sets.setdefault(_set_of(path.stem, kind), {}).setdefault(kind, path)
    found: dict[str, Path] = max(sets.values(), key=len, default={})
    if not found.keys() - set(LEFT_OUT):
        message = f"{folder}: no picture whose name tells what it is; name them such as wall_color.png"
        raise ImageSetError(message)
    return found


def _set_of(stem: str, kind: str) -> str:
    """What is left of a name without the words of its kind, and without the number of a UDIM tile."""
    return re.sub(rf"(?<=_)(?:{WORDS[kind]})(?=_)", "", _spaced(re.sub(UDIM, "", stem)))


def images(maps: dict[str, Path]) -> dict[str, Image]:
    """The pictures of maps that ours have an input for; ImageSetError for one that Blender cannot read."""
    found: dict[str, Image] = {}
    for kind, path in maps.items():
        if kind in LEFT_OUT:
            continue
        image = bpy.data.images.load(str(path))
        if re.search(UDIM, path.stem):
            image.source = "TILED"
        image.colorspace_settings.is_data = kind not in IN_COLOUR
        found[kind] = image
        if not image.size[0]:
            for one in found.values():
                bpy.data.images.remove(one)
            message = f"{path}: is no picture that Blender can read; take it out of the folder, or mend it"
            raise ImageSetError(message)
        if bpy.data.filepath and bpy.context.preferences.filepaths.use_relative_paths:
            image.filepath = bpy.path.relpath(image.filepath)
    return found


def load(tree: ShaderNodeTree, maps: dict[str, Path]) -> Textures:
    """Texture nodes of the maps, on the active UV map, and where they lead; those of the set before go.

    Raises ImageSetError as ``images``.
    """
    pictures = images(maps)
    for node in [node for node in tree.nodes if node.get(roles.KEY) == SET]:
        tree.nodes.remove(node)
    others = {node.name for node in tree.nodes}
    place = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    tree.links.new(place[0].outputs["UV"], place[1].inputs["Vector"])
    nodes = {kind: _image(tree, image, kind, place[1]) for kind, image in pictures.items()}
    colors = {kind: node.outputs["Color"] for kind, node in nodes.items()}
    found = Textures(lost=[f"{kind} ({maps[kind].name})" for kind in LEFT_OUT if kind in maps])
    if "Packed" in colors:
        found.lost.append(f"occlusion and metalness in {maps['Packed'].name}")
    inputs = {
        "Base Color": colors.get("Base Color"),
        "Roughness": _roughness(tree, colors),
        "Normal": _normal(tree, colors),
    }
    found.inputs = {name: one for name, one in inputs.items() if one is not None}
    if "Displacement" in colors:
        found.displacement = _through(
            tree, "ShaderNodeDisplacement", "Height", colors["Displacement"], Scale=HEIGHT, Midlevel=0.5
        )
    found.alpha, found.metallic = colors.get("Alpha", 1.0), colors.get("Metallic")
    if "Emission Color" in colors:
        found.emission = colors["Emission Color"], 1.0
    _arrange([*place, *nodes.values()])
    for node in tree.nodes:
        if node.name not in others:
            node[roles.KEY] = SET
    return found


def _image(tree: ShaderNodeTree, image: Image, kind: str, mapping: Node) -> Node:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.label = image, kind
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    return node


def _roughness(tree: ShaderNodeTree, colors: dict[str, NodeSocket]) -> NodeSocket | None:
    """A map of its own, green of a packed one, or the inverse of gloss."""
    if "Roughness" in colors:
        return colors["Roughness"]
    if "Packed" in colors:
        return _through(tree, "ShaderNodeSeparateColor", "Color", colors["Packed"]).node.outputs["Green"]
    if "Glossiness" in colors:
        return _through(tree, "ShaderNodeInvert", "Color", colors["Glossiness"])
    return None


def _normal(tree: ShaderNodeTree, colors: dict[str, NodeSocket]) -> NodeSocket | None:
    """A normal map, whose green a DirectX map has upside down, with the bump on it."""
    normal = None
    if "Normal" in colors:
        normal = _through(tree, "ShaderNodeNormalMap", "Color", colors["Normal"])
    elif "Normal DX" in colors:
        apart = tree.nodes.new("ShaderNodeSeparateColor")
        together = tree.nodes.new("ShaderNodeCombineColor")
        tree.links.new(colors["Normal DX"], apart.inputs[0])
        green = _through(tree, "ShaderNodeInvert", "Color", apart.outputs["Green"])
        for name, source in (("Red", apart.outputs["Red"]), ("Green", green), ("Blue", apart.outputs["Blue"])):
            tree.links.new(source, together.inputs[name])
        normal = _through(tree, "ShaderNodeNormalMap", "Color", together.outputs[0])
    if "Bump" in colors:
        bumped = _through(tree, "ShaderNodeBump", "Height", colors["Bump"], Distance=HEIGHT)
        if normal is not None:
            tree.links.new(normal, bumped.node.inputs["Normal"])
        normal = bumped
    return normal


def _through(tree: ShaderNodeTree, kind: str, name: str, source: NodeSocket, **values: float) -> NodeSocket:
    node = tree.nodes.new(kind)
    for key, value in values.items():
        node.inputs[key].default_value = value
    tree.links.new(source, node.inputs[name])
    return node.outputs[0]


def _arrange(nodes: Iterable[Node]) -> None:
    """In a column left of the model, what places them further left."""
    coordinates, mapping, *images = nodes
    coordinates.location, mapping.location = (-1300, 0), (-1100, 0)
    for index, node in enumerate(images):
        node.location = (-850, 300 - 300 * index)
