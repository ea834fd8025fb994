# SPDX-License-Identifier: GPL-3.0-or-later
"""One of our materials as Blender's Principled BSDF: its numbers as they are now, and what is linked to its inputs.

A model's own file says which of its parameters means the same as which input of Principled (``addon/models``).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import log
from typing import TYPE_CHECKING, Any

import bpy

from ... import nodegroups
from ..models import parameter as known
from ..models.glass import ABBE
from ..models.principled import Feed
from . import beside, colour_space, roles
from .material import MaterialError, absorbs, origin_of, parameter_sockets

if TYPE_CHECKING:
    from collections.abc import Container, Iterator, Mapping

    from bpy.types import Material, Node, NodeSocket, NodeTree

    from ..library.presets import Preset
    from ..models import Number

KIND = "ShaderNodeBsdfPrincipled"
COLOURS = {"Base Color", "Specular Tint"}  # what is converted to the file's working space
EMISSION, ALPHA = ("Emission Color", "Emission Strength"), "Alpha"
# What a material may have beside its parameters, under Principled's own names.
BESIDE = ("Normal", "Tangent")


@dataclass(frozen=True)
class Input:
    """What an input of Principled gets: ``bias + factor * source ** exponent``, or where nothing is linked a value.

    value: in the file's working space; None where the input's own default is right.
    """

    value: Number | None
    source: NodeSocket | None = None
    factor: float = 1.0
    exponent: float = 1.0
    bias: float = 0.0

    @property
    def image(self) -> Node | None:
        """The Image Texture that exporters carry, which know factors, but neither powers nor sums."""
        carried = self.source is not None and self.exponent == 1.0 and not self.bias
        return _image_node(self.source) if carried else None


def describe(material: Material) -> dict[str, Input]:
    """What the inputs of Principled get, by their names. What is not named keeps its default.

    MaterialError if the material is not ours, or has numbers that no material can have.
    """
    preset, sockets = origin_of(material).preset, parameter_sockets(material)
    try:
        given = preset.spec.principled(preset) if preset.spec.principled else _at_least(preset)
        found = {name: _input(name, of, preset, sockets) for name, of in given.items()}
    except ValueError as error:  # n and k that are both 0
        message = f"{material.name}: {error}"
        raise MaterialError(message) from error
    found |= dict(_beside(material))
    if (metallic := beside.metalness(material)) is not None:
        found["Metallic"] = Input(found["Metallic"].value if "Metallic" in found else 0.0, _source(metallic))
    return found


def left_out(material: Material, inputs: Mapping[str, Input]) -> list[str]:
    """Names of the material's inputs whose links have no place in Principled."""
    carried = {of.source for of in inputs.values()}
    node = roles.node(material, roles.MODEL)
    sources = {name: _source(socket) for name, socket in nodegroups.inputs(node).items()} if node else {}
    return [name for name, of in sources.items() if of and of not in carried and roles.role_of(of.node) != roles.LIGHT]


def _at_least(preset: Preset) -> dict[str, Number | Feed]:
    """For a model that does not say what it is as Principled."""
    return {"Base Color": preset.solid, "Roughness": preset.roughness, "Specular IOR Level": 0.0}


def _input(name: str, what: Number | Feed, preset: Preset, sockets: Mapping[str, NodeSocket]) -> Input:
    value: Any = what.value(preset) if isinstance(what, Feed) else what
    if name in COLOURS:
        value = tuple(colour_space.colour(value, colour_space.matrix()).tolist())
    elif name == "Roughness":
        value = min(value, 1.0)
    if not isinstance(what, Feed):
        return Input(value)
    return Input(value, _source(sockets.get(what.parameter)), what.factor, what.exponent / _power(what.parameter))


def _power(parameter: str) -> float:
    """The power of a parameter that its socket holds."""
    return log(known(parameter).scale.to_input(0.25)) / log(0.25)


def _beside(material: Material) -> Iterator[tuple[str, Input]]:
    node = roles.node(material, roles.MODEL)
    inputs = nodegroups.inputs(node) if node else {}
    for name in BESIDE:
        if (socket := inputs.get(name)) is not None:
            value = float(socket.default_value) if socket.type == "VALUE" else None
            yield name, Input(value, _source(socket))
    if (abbe := inputs.get(ABBE.label)) is not None:
        yield "Transmission Dispersion Scale", Input(1.0)
        yield "Transmission Dispersion Abbe Number", _as_typed(abbe, float(abbe.default_value))
    for name, socket in zip(EMISSION, beside.emission(material) or (), strict=False):
        yield name, _as_typed(socket, (0.0, 0.0, 0.0) if socket.type == "RGBA" else 1.0)
    if (passing := beside.alpha(material)) is not None:
        socket, inverse = passing
        of = _as_typed(socket, 0.0 if inverse else 1.0)
        less: Any = of.value
        yield ALPHA, Input(1.0 - less, of.source, -1.0, bias=1.0) if inverse else of


def _as_typed(socket: NodeSocket, unknown: Number) -> Input:
    """An input that is taken over as it is; unknown: its value where nodes that are not carried compute it."""
    source, own = _source(socket), socket.default_value
    own = tuple(own)[:3] if socket.type == "RGBA" else float(own)
    return Input(unknown if source is not None else own, source)


def _source(socket: NodeSocket | None) -> NodeSocket | None:
    """What is linked to an input, before reroutes; None where nothing is."""
    while socket is not None and socket.is_linked and not socket.links[0].is_muted:
        source = socket.links[0].from_socket
        if source.node.bl_idname != "NodeReroute":
            return source
        socket = source.node.inputs[0]
    return None


# What is inside


def absorption(material: Material) -> tuple[float, ...]:
    """What a body takes from light on its way through, in 1/m of red, green and blue, linear Rec.709; () for none."""
    preset = origin_of(material).preset
    taken: Any = preset.parameters["absorption"] if absorbs(preset) else ()
    return tuple(taken)


def depth(material: Material, *, local: bool = False) -> float:
    """How thick the first object of this material is along its shortest side, in the scene's units; 0 for a plane.

    local: in its mesh's units.
    """
    for item in bpy.data.objects:
        if any(slot.material == material for slot in item.material_slots):
            corners = list(zip(*item.bound_box, strict=True))
            sides = [max(along) - min(along) for along in corners] if local else item.dimensions
            return float(min(sides))
    return 0.0


# Nodes


def add_node(tree: NodeTree, inputs: Mapping[str, Input], linked: Container[str]) -> list[Node]:
    """Principled in a material's tree, and before it what turns a link into what the input gets.

    linked: the inputs that are linked, where something is; the others get their values. Principled is the first of the
    nodes. Inputs that this Blender's has not are left out.
    """
    node = tree.nodes.new(KIND)
    made = [node]
    for name, of in inputs.items():
        socket = node.inputs.get(name)
        if socket is None:
            continue
        if of.value is not None:
            _set(socket, of.value)
        if of.source is not None and name in linked:
            source = of.source
            for operation, number in (("POWER", of.exponent), ("MULTIPLY", of.factor), ("ADD", of.bias)):
                if number != (0.0 if operation == "ADD" else 1.0):
                    made.append(_arithmetic(tree, socket.type, operation, source, number))
                    made[-1].location.y -= 160 * len(made)
                    source = _output(made[-1])
            tree.links.new(source, socket)
    return made


def _set(socket: NodeSocket, value: Any) -> None:
    if socket.type == "RGBA":
        value = (*value, 1.0)
    socket.default_value = bool(value) if socket.type == "BOOLEAN" else value


def _arithmetic(tree: NodeTree, kind: str, operation: str, source: NodeSocket, number: float) -> Node:
    """A node that applies a number to a link: of a kind that Blender's exporters see through, where it multiplies."""
    if kind == "RGBA" and operation == "MULTIPLY":
        node = tree.nodes.new("ShaderNodeMix")
        node.data_type, node.blend_type = "RGBA", operation
        given = {"Factor_Float": 1.0, "A_Color": source, "B_Color": (number, number, number, 1.0)}
    elif kind == "VALUE":
        node = tree.nodes.new("ShaderNodeMath")
        node.operation = operation
        given = {"Value": source, "Value_001": number}
    else:
        node = tree.nodes.new("ShaderNodeVectorMath")
        node.operation = operation
        given = {"Vector": source, "Vector_001": (number, number, number)}
    for socket in node.inputs:
        what = given.get(socket.identifier)
        if isinstance(what, float | tuple):
            socket.default_value = what
        elif what is not None:
            tree.links.new(what, socket)
    return node


def _output(node: Node) -> NodeSocket:
    """The output that is in use: Mix has one for each type."""
    return next(socket for socket in node.outputs if socket.enabled)


def _image_node(source: NodeSocket) -> Node | None:
    """The first Image Texture behind a link, through other nodes; None where there is none."""
    waiting, seen = [source.node], set()
    while waiting:
        node = waiting.pop(0)
        if node.bl_idname == "ShaderNodeTexImage" and node.image is not None:
            return node
        before = [link.from_node for socket in node.inputs for link in socket.links]
        waiting += [one for one in before if one not in seen]
        seen.update(before)
    return None
