# SPDX-License-Identifier: GPL-3.0-or-later
"""Textures of an artist's material, given to one of ours: colour, roughness, normal, alpha, emission, displacement.

They are read where Blender's own shaders take them, by the names of their inputs. Ours have the same names.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import bpy

from ...nodegroups import REVISION_KEY, versions
from ..models import MODELS, fresnel, label
from ..reference.fresnel import F82_COSINE, schlick
from . import beside, fcurves, metalness, origin, roles, ungroup
from . import material as building
from .links import feeder
from .reading import state_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from bpy.types import Material, Node, NodeSocket, ShaderNodeTree

    from ..library.presets import Preset
    from .choice import Choice

# Inputs of Blender's shaders that mean the same as an input of ours, by our names.
PLAIN = {"Base Color": "Color", "Roughness": "Roughness", "Normal": "Normal"}
SHADERS: dict[str, dict[str, str]] = {
    "ShaderNodeBsdfPrincipled": {
        name: name for name in ("Base Color", "Roughness", "Diffuse Roughness", "IOR", "Normal")
    },
    "ShaderNodeBsdfMetallic": {name: name for name in ("Base Color", "Edge Tint", "Roughness", "Normal")},
    "ShaderNodeBsdfAnisotropic": PLAIN,
    "ShaderNodeBsdfDiffuse": PLAIN,
    "ShaderNodeBsdfGlass": {"IOR": "IOR", **PLAIN},
    "ShaderNodeBsdfSheen": PLAIN,
}
# What adds to the look whatever the colour is, by names of inputs: no model of ours has it, also where it is a value.
ADDED = ("Anisotropic", "Anisotropy", "Coat Weight", "Sheen Weight", "Thin Film Thickness")
# Of Principled, which no model of ours has.
ALPHA, EMISSION, STRENGTH, METALLIC = "Alpha", "Emission Color", "Emission Strength", "Metallic"
OWN = (*roles.GROUPS, roles.OUTPUT, roles.EEVEE, roles.METALNESS, roles.GLOW, roles.CLEAR)
OURS = {label(model, one.name) for model, spec in MODELS.items() for one in spec.parameters} | {"Normal"}
OURS |= {one.label for kind in fresnel.KINDS.values() for one in kind.parameters}


@dataclass
class Textures:
    """What feeds a shader: the output sockets that are linked, by names of our inputs, and what there is besides.

    alpha: the share of light that the surface takes; inverse: alpha is what it lets through instead.
    emission: colour and strength. Each a socket, or a value. metallic: where the surface is a metal.
    values: what the shader has where nothing is linked, by names of ``metalness.VALUES``; with a metallic map alone.
    lost: what ours have no input for.
    """

    inputs: dict[str, NodeSocket] = field(default_factory=dict)
    alpha: NodeSocket | float = 1.0
    inverse: bool = False
    emission: tuple[NodeSocket | tuple[float, ...], NodeSocket | float] | None = None
    displacement: NodeSocket | None = None
    metallic: NodeSocket | None = None
    values: dict[str, Any] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        """Whether anything comes from a texture."""
        return any(True for _ in self.sources())

    def sources(self) -> Iterator[NodeSocket]:
        """Everything that is linked."""
        found = (*self.inputs.values(), self.alpha, *(self.emission or ()), self.displacement, self.metallic)
        yield from (one for one in found if isinstance(one, bpy.types.NodeSocket))

    def drop(self, is_gone: Callable[[NodeSocket], bool]) -> None:
        """Forget what comes from nodes that go."""
        for name in [name for name, one in self.inputs.items() if is_gone(one)]:
            del self.inputs[name]
            self.lost.append(f"{name}, which a shader feeds")
        if self.displacement is not None and is_gone(self.displacement):
            self.displacement = None
            self.lost.append("Displacement, which a shader feeds")
        if self.metallic is not None and is_gone(self.metallic):
            self.metallic = None
            self.lost.append("Metallic, which a shader feeds")
        if isinstance(self.alpha, bpy.types.NodeSocket) and is_gone(self.alpha):
            self.alpha, self.inverse = 1.0, False
            self.lost.append("Alpha, which a shader feeds")
        if any(isinstance(one, bpy.types.NodeSocket) and is_gone(one) for one in self.emission or ()):
            self.emission = None
            self.lost.append("Emission, which a shader feeds")


def may_have(made: Material | None) -> bool:
    """Whether a material has textures, or an artist's group in which ``build`` looks for them."""
    return bool(read(made)) or ungroup.is_grouped(made)


def read(made: Material | None) -> Textures:
    """The textures of a material's first shader that we know, or of our model; none where there is no such shader.

    Not those in an artist's groups: ``ungroup.take_out`` comes first.
    """
    tree = versions.used_nodes(made) if made is not None else None
    outputs = [tree.get_output_node(target) for target in ("CYCLES", "EEVEE")] if tree is not None else []
    output = next((one for one in outputs if one is not None), None)
    found = Textures()
    if output is None:
        return found
    shader = _shader(output.inputs["Surface"], found)
    if shader is None:
        return Textures()
    found.displacement = feeder(output.inputs["Displacement"])
    if output.inputs["Volume"].is_linked and not roles.nodes(made, roles.ABSORPTION):
        found.lost.append("Volume")
    names = SHADERS.get(shader.bl_idname) or {one.name: one.name for one in shader.inputs if _is_of_ours(one)}
    taken = set()
    for name, theirs in names.items():
        socket = shader.inputs.get(theirs)  # versions of Blender differ in what a shader has
        source = None if socket is None else feeder(socket)
        if source is not None and roles.role_of(source.node) != roles.TRAJECTORY:
            found.inputs[name] = source
            taken.add(theirs)
    if shader.bl_idname == "ShaderNodeBsdfPrincipled":
        taken |= _read_principled(shader, found)
    if found.metallic is not None:
        kept = metalness.other(made) or shader
        inputs = [one for one in kept.inputs if one.name in metalness.VALUES and feeder(one) is None]
        found.values = {one.name: _value(one) for one in inputs}
    if shader.bl_idname in SHADERS:
        unknown = [one.name for one in shader.inputs if one.name not in taken and _matters(one)]
        found.lost += [f"{shader.bl_label}: {name}" for name in dict.fromkeys(unknown)]
    return found


def _is_of_ours(socket: NodeSocket) -> bool:
    """Whether an input of one of our models takes a texture: not what lights are bound to."""
    lobe = socket.name.split(" ", 2)
    return (lobe[2] if lobe[0] == "Lobe" and len(lobe) > 2 else socket.name) in OURS


def _value(socket: NodeSocket) -> Any:
    """An input's own value, which lives on when its node does not."""
    return tuple(socket.default_value) if socket.type == "RGBA" else float(socket.default_value)


def _matters(socket: NodeSocket) -> bool:
    """Whether something is lost with an input."""
    return feeder(socket) is not None or (socket.enabled and socket.name in ADDED and bool(socket.default_value))


def _read_principled(shader: Node, found: Textures) -> set[str]:
    """Alpha, emission and metalness; returns the inputs that were read."""
    alpha, color, strength = (shader.inputs[name] for name in (ALPHA, EMISSION, STRENGTH))
    if alpha.is_linked or alpha.default_value < 1.0:
        found.alpha, found.inverse = feeder(alpha) or float(alpha.default_value), False
    shines = strength.is_linked or strength.default_value > 0.0
    if shines and (color.is_linked or any(tuple(color.default_value)[:3])):
        found.emission = _glow(color, strength)
    found.metallic = feeder(shader.inputs[METALLIC])
    return {ALPHA, EMISSION, STRENGTH, METALLIC}


def _glow(color: NodeSocket, strength: NodeSocket) -> tuple[NodeSocket | tuple[float, ...], NodeSocket | float]:
    return feeder(color) or tuple(color.default_value), feeder(strength) or float(strength.default_value)


def _shader(socket: NodeSocket, found: Textures) -> Node | None:
    """The first known shader upstream; a mix with Transparent is an alpha, another mix loses its other side."""
    source = feeder(socket)
    if source is None:
        return None
    node = source.node
    if node.bl_idname in SHADERS or _is_ours(node):
        return node
    if node.bl_idname == "ShaderNodeMixShader":
        factor, *sides = node.inputs
        own = [side for side in sides if (of := feeder(side)) and roles.role_of(of.node) == roles.METALNESS]
        if own:
            found.metallic = feeder(factor)
            return _shader(next(side for side in sides if side not in own), found)
        clear = [_is(side, "ShaderNodeBsdfTransparent") for side in sides]
        if clear[0] != clear[1]:
            found.alpha, found.inverse = feeder(factor) or float(factor.default_value), clear[1]
        shown = [side for side, is_clear in zip(sides, clear, strict=True) if not is_clear]
    elif node.bl_idname == "ShaderNodeAddShader":
        shown = [side for side in node.inputs if not _is(side, "ShaderNodeEmission")]
        for side in node.inputs:
            if (glow := feeder(side)) is not None and _is(side, "ShaderNodeEmission"):
                found.emission = _glow(glow.node.inputs["Color"], glow.node.inputs["Strength"])
    else:
        return None
    sides = [(_shader(side, found), feeder(side)) for side in shown]
    known = [shader for shader, _ in sides if shader is not None]
    found.lost += [f"{one.bl_label}, which is mixed in" for one in known[1:]]
    found.lost += [f"{of.node.bl_label}, which is mixed in" for one, of in sides if one is None and of is not None]
    return next(iter(known), None)


def _is_ours(node: Node) -> bool:
    """Whether it is a model of ours, of a preset or by itself."""
    return (
        node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None and REVISION_KEY in node.node_tree
        and any(one.type == "SHADER" for one in node.outputs) and "Normal" in node.inputs
    )  # fmt: skip


def _is(socket: NodeSocket, kind: str) -> bool:
    source = feeder(socket)
    return source is not None and source.node.bl_idname == kind


# Into a material of ours


def taking_colour(preset: Preset) -> Preset:
    """The preset with an input for a colour: a metal by n and k as F82 that is equal head-on and at 82 degrees.

    It stands still, as what a texture gives does.
    """
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

    ``source`` stays as it is. Without textures the material is that of ``material.build``, which raises the same
    MaterialErrors.
    """
    made, wanted = source.copy(), preset
    if made.override_library is not None:  # the copy of an override is one too
        made.make_local(clear_liboverride=True)
    made.name = preset.name
    groups: list[ShaderNodeTree] = []
    try:
        fcurves.make_own(made)
        groups = ungroup.take_out(made)
        found = read(made)
        if "Base Color" in found.inputs:
            preset = taking_colour(preset)
        if choice.play is not None and preset.time is None:
            choice = replace(choice, play=None)
        if found:
            record, group = building.record_of(preset, choice), building.group_of(preset, choice)
            found.lost += ["its change over time"] * (wanted.time is not None and preset.time is None)
            _clear_shaders(made, found)
            building.fill(made, preset, choice, group, keep_nodes=True)
            origin.write(made, record)
            building.animate(made, record)
            origin.write(made, replace(record, state=state_of(made)))
            return made, found.lost + give(made, found)
    except Exception:
        _remove(made, groups)
        raise
    _remove(made, groups)
    return building.build(preset, choice), []


def _remove(made: Material, groups: Iterable[ShaderNodeTree]) -> None:
    bpy.data.materials.remove(made)
    for group in groups:
        bpy.data.node_groups.remove(group)


def _clear_shaders(made: Material, found: Textures) -> None:
    """Remove what gives or takes a shader, and what an earlier material of ours had besides."""
    if origin.read(made) is not None:
        building.stop(made)
    tree = made.node_tree
    gone = {
        node.name for node in tree.nodes
        if roles.role_of(node) in OWN or any(one.type == "SHADER" for one in (*node.inputs, *node.outputs))
    }  # fmt: skip
    found.drop(lambda socket: socket.node.name in gone)
    moving = len(bag.fcurves) if (bag := fcurves.channelbag(made)) else 0
    for name in gone:
        tree.nodes.remove(tree.nodes[name])
    if bag is not None and len(bag.fcurves) < moving:
        found.lost.append("keys of what was typed in")


def give(made: Material, found: Textures) -> list[str]:
    """Link textures to the inputs of a material of ours; returns those that it has no input for."""
    tree, node = made.node_tree, roles.node(made, roles.MODEL)
    assert node is not None  # noqa: S101 - whoever calls saw to it
    lost = []
    for name, source in found.inputs.items():
        socket = node.inputs.get(name)
        if socket is None or (socket.type == "VECTOR" and source.type == "VALUE"):
            lost.append(f"{made.name} has no input {name}")
        else:
            tree.links.new(source, socket)
    if found.metallic is not None:
        metalness.give(made, found)
    if found.emission:
        for name, value in zip(("Color", "Strength"), found.emission, strict=True):
            _feed(tree, value, [one.inputs[name] for one in beside.add(made, roles.GLOW)])
    if found.alpha != 1.0:
        beside.add(made, roles.CLEAR)
        for mix in beside.joints(made, roles.CLEAR):
            _feed(tree, found.alpha, [mix.inputs[0]])
            if beside.is_inverse(mix) != found.inverse:
                beside.exchange(tree, mix)
    for output in beside.outputs(made) if found.displacement else ():
        tree.links.new(found.displacement, output.inputs["Displacement"])
    return lost


def _feed(tree: ShaderNodeTree, value: NodeSocket | tuple[float, ...] | float, sockets: list[NodeSocket]) -> None:
    for socket in sockets:
        if isinstance(value, bpy.types.NodeSocket):
            tree.links.new(value, socket)
        else:
            socket.default_value = value
