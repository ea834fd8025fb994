# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of maps, known by the usual endings of their names, as textures for a material of ours."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import bpy

from ..library.errors import InputError
from .textures import Textures

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from bpy.types import Node, NodeSocket, ShaderNodeTree

# The last of these words in a name says what a map is. Those of the last line have no input of ours.
WORDS = {
    "Base Color": r"base_?colou?r|albedo|diff|diffuse|colou?r|col",
    "Roughness": r"rough|roughness|rgh",
    "Glossiness": r"gloss|glossiness",
    "Normal": r"nor|norm|normal|nrm|normal_?gl|nor_gl|normal_?opengl",
    "Normal DX": r"normal_?dx|nor_dx|normal_?directx",
    "Bump": r"bump|bmp",
    "Displacement": r"disp|displacement|height",
    "Alpha": r"alpha|opacity",
    "Emission Color": r"emission|emissive|emit",
    "Metallic": r"metal|metallic|metalness",
    "Ambient Occlusion": r"ao|occlusion|ambient_?occlusion",
}
LEFT_OUT = ("Metallic", "Ambient Occlusion")
IN_COLOUR = ("Base Color", "Emission Color")  # the rest are data
PICTURES = (".png", ".jpg", ".jpeg", ".exr", ".tif", ".tiff", ".tga", ".webp", ".bmp", ".hdr")
HEIGHT = 0.05  # scene units between black and white, by eye


class ImageSetError(InputError):
    """A folder in which no map is found."""


def kind_of(name: str) -> str:
    """What a map is by the name of its file; "" if that does not say. Of several words the last counts."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name)
    stem = "_" + re.sub(r"[^a-z0-9]+", "_", spaced.lower()) + "_"
    found = [(match.end(), len(match[0]), kind)
             for kind, words in WORDS.items() for match in re.finditer(rf"(?<=_)(?:{words})(?=_)", stem)]  # fmt: skip
    return max(found)[2] if found else ""


def find(folder: Path) -> dict[str, Path]:
    """The maps of a folder by kind, of several of one kind the first by name. ImageSetError if there is none."""
    pictures = sorted(path for path in folder.iterdir() if path.suffix.lower() in PICTURES) if folder.is_dir() else []
    found: dict[str, Path] = {}
    for path in pictures:
        if kind := kind_of(path.stem):
            found.setdefault(kind, path)
    if not found.keys() - set(LEFT_OUT):
        message = (
            f"{folder}: no picture whose name tells what it is; name them such as wall_color.png, wall_roughness.png"
        )
        raise ImageSetError(message)
    return found


def load(tree: ShaderNodeTree, maps: dict[str, Path]) -> Textures:
    """Texture nodes of the maps, on the active UV map, and where they lead."""
    place = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeMapping")
    tree.links.new(place[0].outputs["UV"], place[1].inputs["Vector"])
    nodes = {kind: _image(tree, path, kind, place[1]) for kind, path in maps.items() if kind not in LEFT_OUT}
    colors = {kind: node.outputs["Color"] for kind, node in nodes.items()}
    found = Textures(lost=[f"{kind} ({maps[kind].name})" for kind in LEFT_OUT if kind in maps])
    for kind in ("Base Color", "Roughness"):
        if kind in colors:
            found.inputs[kind] = colors[kind]
    if "Glossiness" in colors and "Roughness" not in colors:
        found.inputs["Roughness"] = _through(tree, "ShaderNodeInvert", "Color", colors["Glossiness"])
    if (normal := _normal(tree, colors)) is not None:
        found.inputs["Normal"] = normal
    if "Displacement" in colors:
        found.displacement = _through(
            tree, "ShaderNodeDisplacement", "Height", colors["Displacement"], Scale=HEIGHT, Midlevel=0.5
        )
    if "Alpha" in colors:
        found.alpha = colors["Alpha"], False
    if "Emission Color" in colors:
        found.emission = colors["Emission Color"], 1.0
    _arrange([*place, *nodes.values()])
    return found


def _image(tree: ShaderNodeTree, path: Path, kind: str, mapping: Node) -> Node:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.label = bpy.data.images.load(str(path), check_existing=True), kind
    if kind not in IN_COLOUR:
        node.image.colorspace_settings.is_data = True
    tree.links.new(mapping.outputs[0], node.inputs["Vector"])
    return node


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
