# SPDX-License-Identifier: GPL-3.0-or-later
"""One of our materials as a material of its own made with Principled: what is linked stays linked, or becomes maps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy

from . import beside, colour_space, material, origin, principled, roles, slots
from .material import MaterialError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from bpy.types import Material, Node, Object

SUFFIX = " Principled"
KEYS = (roles.KEY, colour_space.KEY, origin.STATE_1, origin.TIME_1)
NO_NODE = "its node group was deleted; press Reset to Preset, which makes it again"


REPLACED = (roles.MODEL, roles.LIGHT, roles.TRAJECTORY, roles.EEVEE)
SIZES = (16, 8192)  # pixels along a side


@dataclass(frozen=True)
class Converted:
    """A material made with Principled, that node, and what could not be carried over, a sentence each."""

    material: Material
    node: Node
    left: list[str]


def convert(made: Material) -> Converted:
    """A copy of ``made`` with Principled in place of the model's node; MaterialError, with nothing left behind."""
    if roles.node(made, roles.MODEL) is None:
        message = f"{made.name}: {NO_NODE}"
        raise MaterialError(message)
    new = made.copy()
    try:
        left = []
        if material.plays(new):
            material.stop(new)
            left.append("its animation, which stands still")
        inputs = principled.describe(new)
        left += [f"what is linked to {name}" for name in principled.left_out(new, inputs)]
        node = _exchange(new, inputs)
    except Exception:
        bpy.data.materials.remove(new)
        raise
    new.name = made.name + SUFFIX
    new.cycles.use_bump_map_correction, new.cycles.emission_sampling = True, "AUTO"
    for key in KEYS:
        if key in new:
            del new[key]
    return Converted(new, node, left)


def _exchange(new: Material, inputs: dict[str, principled.Input]) -> Node:
    tree, output, model = new.node_tree, roles.node(new, roles.OUTPUT), roles.node(new, roles.MODEL)
    assert model is not None  # noqa: S101 - convert saw to it
    place = model.location.copy()
    node, *others = principled.add_node(tree, inputs, inputs)
    shown, joined = beside.chain(new), beside.joined(new)
    targets = [link.to_socket for one in shown for socket in one.outputs for link in socket.links]
    for target in targets:
        tree.links.new(node.outputs[0], target)
    if output is not None:
        output.target = "ALL"
    olds = [one for role in REPLACED for one in roles.nodes(new, role)]
    for old in (*olds, *shown[1:], *joined):
        tree.nodes.remove(old)
    node.location = place
    for index, one in enumerate(others):
        one.location = (place.x - 180, place.y - 180 * index)
    for one in tree.nodes:
        if roles.KEY in one:
            del one[roles.KEY]
    return node


def give(made: Material, new: Material, items: Iterable[Object]) -> None:
    """Put ``new`` into the slots of objects that have ``made``, which stays in the file, to go back to."""
    for item in items:
        for index, slot in enumerate(item.material_slots):
            if slot.material == made:
                slots.give(new, item, index)
    if not made.users:
        made.use_fake_user = True


def in_slots(items: Iterable[Object]) -> dict[Material, list[Object]]:
    """The materials of ours in any slot of objects, each with the objects that have it."""
    found: dict[Material, list[Object]] = {}
    for item in items:
        for made in dict.fromkeys(slot.material for slot in item.material_slots):
            if made is not None and material.is_ours(made):
                found.setdefault(made, []).append(item)
    return found
