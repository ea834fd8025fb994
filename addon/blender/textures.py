# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of an artist's material, given to one of ours: colour, roughness, normal, alpha, emission, displacement.

They are read where Blender's own shaders take them, by the names of their inputs. Ours have the same names.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import bpy

from ...nodegroups import versions
from ..models import fresnel, label
from ..reference.fresnel import F82_COSINE, schlick
from . import material as building
from . import origin, roles
from .reading import state_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Material, Node, NodeSocket, ShaderNodeTree

    from ..library.presets import Preset
    from .choice import Choice

# Inputs of Blender's shaders that mean the same as an input of ours, by our names.
COATED = {"Diffuse Roughness": "Diffuse Roughness", "IOR": "IOR", "Subsurface Radius": "Subsurface Radius"}
PLAIN = {"Base Color": "Color", "Roughness": "Roughness", "Normal": "Normal"}
SHADERS: dict[str, dict[str, str]] = {
    "ShaderNodeBsdfPrincipled": {"Base Color": "Base Color", "Roughness": "Roughness", "Normal": "Normal", **COATED},
    "ShaderNodeBsdfMetallic": {
        "Base Color": "Base Color", "Edge Tint": "Edge Tint", "Roughness": "Roughness", "Normal": "Normal",
    },
    "ShaderNodeBsdfAnisotropic": PLAIN,
    "ShaderNodeBsdfDiffuse": PLAIN,
    "ShaderNodeBsdfGlass": {"IOR": "IOR", **PLAIN},
    "ShaderNodeBsdfSheen": PLAIN,
}  # fmt: skip
ALPHA, EMISSION, STRENGTH = "Alpha", "Emission Color", "Emission Strength"  # of Principled, which no model of ours has


@dataclass
class Textures:
    """What feeds a shader: the output sockets that are linked, by names of our inputs, and what there is besides.

    alpha: the share of light that the surface takes, and whether the socket gives what is let through instead.
    emission: colour and strength, as sockets or, where nothing is linked, as values. lost: what ours have no input for.
    """

    inputs: dict[str, NodeSocket] = field(default_factory=dict)
    alpha: tuple[NodeSocket, bool] | None = None
    emission: tuple[NodeSocket | tuple[float, ...], NodeSocket | float] | None = None
    displacement: NodeSocket | None = None
    lost: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        return bool(self.inputs or self.alpha or self.emission or self.displacement)


def read(made: Material | None) -> Textures:
    """The textures of a material's first shader that we know, or of our model; none where there is no such shader."""
    tree = versions.used_nodes(made) if made is not None else None
    output = tree.get_output_node("CYCLES") if tree is not None else None
    found = Textures()
    if output is None:
        return found
    found.displacement = _source(output.inputs["Displacement"])
    shader = _shader(output.inputs["Surface"], found)
    if shader is None:
        return Textures()
    known = SHADERS.get(shader.bl_idname)
    ours = known is None  # a group, whose inputs are ours
    names = {socket.name: socket.name for socket in shader.inputs} if ours else known
    taken = set()
    for name, theirs in (names or {}).items():
        socket = shader.inputs.get(theirs)  # versions of Blender differ in what a shader has
        if socket is not None and (source := _source(socket)) is not None:
            found.inputs[name] = source
            taken.add(theirs)
    if shader.bl_idname == "ShaderNodeBsdfPrincipled":
        taken |= _read_principled(shader, found)
    unknown = [one.name for one in shader.inputs if one.is_linked and one.name not in taken]
    found.lost += [f"{shader.bl_label}: {name}" for name in dict.fromkeys(unknown) if not ours]
    return found


def _read_principled(shader: Node, found: Textures) -> set[str]:
    """Alpha and emission; returns the inputs that were read."""
    alpha, color, strength = (shader.inputs[name] for name in (ALPHA, EMISSION, STRENGTH))
    if (source := _source(alpha)) is not None:
        found.alpha = source, False
    if color.is_linked or strength.is_linked:
        found.emission = _glow(color, strength)
    return {ALPHA, EMISSION, STRENGTH}


def _glow(color: NodeSocket, strength: NodeSocket) -> tuple[NodeSocket | tuple[float, ...], NodeSocket | float]:
    return _source(color) or tuple(color.default_value), _source(strength) or float(strength.default_value)


def _source(socket: NodeSocket) -> NodeSocket | None:
    return next((link.from_socket for link in socket.links if not link.is_muted), None)


def _shader(socket: NodeSocket, found: Textures) -> Node | None:
    """The first known shader upstream; a mix with Transparent is an alpha, another mix loses its other side."""
    source = _source(socket)
    if source is None:
        return None
    node = source.node
    if node.bl_idname in SHADERS or roles.role_of(node) == roles.MODEL:
        return node
    if node.bl_idname == "ShaderNodeMixShader":
        factor, *sides = node.inputs
        clear = [_is(side, "ShaderNodeBsdfTransparent") for side in sides]
        if any(clear) and (share := _source(factor)) is not None:
            found.alpha = share, clear[1]
        shown = [side for side, is_clear in zip(sides, clear, strict=True) if not is_clear]
    elif node.bl_idname == "ShaderNodeAddShader":
        shown = [side for side in node.inputs if not _is(side, "ShaderNodeEmission")]
        for side in node.inputs:
            if (glow := _source(side)) is not None and _is(side, "ShaderNodeEmission"):
                found.emission = _glow(glow.node.inputs["Color"], glow.node.inputs["Strength"])
    else:
        shown = [one for one in node.inputs if one.type == "SHADER"]
    candidates = [one for side in shown if (one := _shader(side, found)) is not None]
    if len(candidates) > 1:
        found.lost.append(f"{candidates[1].bl_label}, mixed in")
    return next(iter(candidates), None)


def _is(socket: NodeSocket, kind: str) -> bool:
    source = _source(socket)
    return source is not None and source.node.bl_idname == kind


# Into a material of ours


def taking_colour(preset: Preset) -> Preset:
    """The preset with an input for a colour: a metal by n and k as F82 that is equal head-on and at 82 degrees."""
    if preset.kind != "conductor" or any(label(preset.model, name) == "Base Color" for name in preset.parameters):
        return preset
    F = fresnel.reference(preset)
    f0, edge = F(1.0), F(F82_COSINE)
    numbers: dict[str, Any] = {"f0": f0, "f82_tint": (edge / schlick(F82_COSINE, f0)).clip(0.0, 1.0)}
    numbers = {name: tuple(of.tolist()) for name, of in numbers.items()}
    rest = {name: value for name, value in preset.parameters.items() if name not in {"n", "k"}}
    return replace(preset, kind="f82", parameters=numbers | rest, verified={}, time=None)


def build(preset: Preset, choice: Choice, source: Material) -> tuple[Material, list[str]]:
    """A new material of ``preset`` that takes the textures of ``source``; and what could not be carried over.

    ``source`` stays as it is. Raises MaterialError as ``material.build``.
    """
    if "Base Color" in read(source).inputs:
        preset = taking_colour(preset)
    record, group = building.record_of(preset, choice), building.group_of(preset, choice)
    made = source.copy()
    made.name = preset.name
    try:
        found = read(made)
        _clear_shaders(made)
        building.fill(made, preset, choice, group, keep_nodes=True)
        origin.write(made, record)
        origin.write(made, replace(record, state=state_of(made)))
        return made, found.lost + give(made, found)
    except Exception:
        bpy.data.materials.remove(made)
        raise


def _clear_shaders(made: Material) -> None:
    """Remove what gives or takes a shader, and what an earlier material of ours had besides."""
    if roles.KEY in made:
        building.stop(made)
    tree = made.node_tree
    for node in list(tree.nodes):
        sockets = (*node.inputs, *node.outputs)
        if roles.role_of(node) or any(one.type == "SHADER" for one in sockets):
            tree.nodes.remove(node)


def give(made: Material, found: Textures) -> list[str]:
    """Link textures to the inputs of a material of ours; returns those that it has no input for."""
    tree, node = made.node_tree, roles.node(made, roles.MODEL)
    assert node is not None  # noqa: S101 - it was made just now
    lost = []
    for name, source in found.inputs.items():
        socket = node.inputs.get(name)
        if socket is None or (socket.type == "VECTOR" and source.type == "VALUE"):
            lost.append(f"{made.name} has no input {name}")
        else:
            tree.links.new(source, socket)
    if found.emission:
        _wrap(made, lambda shader: _glowing(tree, shader, *found.emission))  # type: ignore[misc]
    if found.alpha:
        _wrap(made, lambda shader: _see_through(tree, shader, *found.alpha))  # type: ignore[misc]
    for output in _outputs(made):
        if found.displacement:
            tree.links.new(found.displacement, output.inputs["Displacement"])
    return lost


def _outputs(made: Material) -> Iterator[Node]:
    for role in (roles.OUTPUT, roles.EEVEE):
        yield from roles.nodes(made, role)


def _wrap(made: Material, around: Callable[[NodeSocket], NodeSocket]) -> None:
    """Put nodes between the surface and each output."""
    for output in _outputs(made):
        surface = output.inputs["Surface"]
        made.node_tree.links.new(around(surface.links[0].from_socket), surface)


def _glowing(
    tree: ShaderNodeTree, shader: NodeSocket, color: NodeSocket | tuple[float, ...], strength: NodeSocket | float
) -> NodeSocket:
    glow, both = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeAddShader")
    for value, name in ((color, "Color"), (strength, "Strength")):
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, glow.inputs[name])
        else:
            glow.inputs[name].default_value = value
    tree.links.new(shader, both.inputs[0])
    tree.links.new(glow.outputs[0], both.inputs[1])
    return both.outputs[0]


def _see_through(tree: ShaderNodeTree, shader: NodeSocket, alpha: NodeSocket, inverse: bool) -> NodeSocket:  # noqa: FBT001
    clear, mix = tree.nodes.new("ShaderNodeBsdfTransparent"), tree.nodes.new("ShaderNodeMixShader")
    sides = (shader, clear.outputs[0]) if inverse else (clear.outputs[0], shader)
    tree.links.new(alpha, mix.inputs[0])
    for side, socket in zip(sides, mix.inputs[1:], strict=True):
        tree.links.new(side, socket)
    return mix.outputs[0]
