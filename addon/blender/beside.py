# SPDX-License-Identifier: GPL-3.0-or-later
"""What stands beside a model, which has no input for it: emission, alpha, and the other side of a metalness map.

Emission is added to the surface, Transparent and the other side are mixed with it, once for each output.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import roles

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, Node, NodeSocket, ShaderNodeTree

ADD, MIX = "ShaderNodeAddShader", "ShaderNodeMixShader"
JOINTS = {roles.GLOW: ADD, roles.CLEAR: MIX, roles.METALNESS: MIX}  # what joins each with the surface
KINDS = {roles.GLOW: "ShaderNodeEmission", roles.CLEAR: "ShaderNodeBsdfTransparent"}


def outputs(made: Material) -> Iterator[Node]:
    """The material's outputs of ours."""
    for role in (roles.OUTPUT, roles.EEVEE):
        yield from roles.nodes(made, role)


def join(tree: ShaderNodeTree, output: Node, shader: NodeSocket, role: str, *, first: bool = True) -> None:
    """Have ``output`` show ``shader`` beside what it shows, as the first side of the two or the second."""
    both, surface = tree.nodes.new(JOINTS[role]), output.inputs["Surface"]
    both.location = output.location.x - 180, output.location.y
    sides = (shader, surface.links[0].from_socket)
    for source, side in zip(sides if first else reversed(sides), both.inputs[-2:], strict=True):
        tree.links.new(source, side)
    tree.links.new(both.outputs[0], surface)


def add(made: Material, role: str) -> list[Node]:
    """The node of the role for each output, which is made where there is none."""
    if not roles.nodes(made, role):
        for output in outputs(made):
            more = made.node_tree.nodes.new(KINDS[role])
            more[roles.KEY] = role
            join(made.node_tree, output, more.outputs[0], role)
    return roles.nodes(made, role)


def joints(made: Material, role: str) -> list[Node]:
    """The nodes that join those of the role with the surface."""
    links = [link for node in roles.nodes(made, role) for socket in node.outputs for link in socket.links]
    return [link.to_node for link in links if link.to_node.bl_idname == JOINTS[role]]


def chain(made: Material) -> list[Node]:
    """The model's node, and after it the joints through which it reaches the outputs."""
    known = {node.name for role in JOINTS for node in joints(made, role)}
    found = roles.nodes(made, roles.MODEL)[:1]
    for node in found:
        after = [link.to_node for socket in node.outputs for link in socket.links]
        found += [one for one in after if one.name in known and one not in found]
    return found


def joined(made: Material) -> list[Node]:
    """What stands beside the model at the joints of ``chain``."""
    sides = [link.from_node for joint in chain(made)[1:] for socket in joint.inputs for link in socket.links]
    return [node for node in dict.fromkeys(sides) if roles.role_of(node) in JOINTS]


def emission(made: Material) -> tuple[NodeSocket, NodeSocket] | None:
    """The inputs of colour and strength; None where nothing shines."""
    shown = _shown(made, roles.GLOW)
    node = shown.inputs[0].links[0].from_node if shown is not None else None
    return (node.inputs["Color"], node.inputs["Strength"]) if node is not None else None


def alpha(made: Material) -> tuple[NodeSocket, bool] | None:
    """The input of alpha, and whether it is the share that passes instead; None where nothing passes."""
    shown = _shown(made, roles.CLEAR)
    return (shown.inputs[0], is_inverse(shown)) if shown is not None else None


def set_alpha(made: Material, alpha: float) -> None:
    """Mix Transparent with what every output shows, by the share 1 - ``alpha``; nothing is added for a share of 0."""
    if alpha < 1.0:
        add(made, roles.CLEAR)
    for mix in joints(made, roles.CLEAR):
        mix.inputs[0].default_value = 1.0 - alpha if is_inverse(mix) else alpha


def metalness(made: Material) -> NodeSocket | None:
    """The input of the metalness map; None without one."""
    shown = _shown(made, roles.METALNESS)
    return shown.inputs[0] if shown is not None else None


def _shown(made: Material, role: str) -> Node | None:
    """A joint of the role in the ``chain``."""
    among = {node.name for node in chain(made)}
    return next((one for one in joints(made, role) if one.name in among), None)


def is_inverse(mix: Node) -> bool:
    """Whether the second side is what is clear."""
    return bool(mix.inputs[2].is_linked and roles.role_of(mix.inputs[2].links[0].from_node) == roles.CLEAR)


def exchange(tree: ShaderNodeTree, mix: Node) -> None:
    """The two sides of a mix, each in the other's place."""
    sources = [side.links[0].from_socket for side in mix.inputs[1:]]
    for source, side in zip(reversed(sources), mix.inputs[1:], strict=True):
        tree.links.new(source, side)
