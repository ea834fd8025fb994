# SPDX-License-Identifier: GPL-3.0-or-later
"""A material changed in place: by another estimator, for other lights, or back to its preset's numbers.

It keeps its name and users, and everything that still has a socket: values, textures, links, keys, drivers, and the
shaders that it is mixed with. The functions return, in words, what could not be kept.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import bpy

from ... import nodegroups
from ...nodegroups import eevee, parameters
from ..models import label, parameter, symbol
from ..reference import cycles
from . import colour_space, colour_update, course, fcurves, material, origin, roles
from .choice import most_lights
from .inputs import DIGITS, converted_keys, give, scale_of
from .lamps import materials_in
from .material import Choice, lamps_to_bind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Driver, Material, Node, NodeSocket, Scene, ShaderNodeTree

    from ...nodegroups.lamp import Slot
    from ..library.presets import Preset
    from .course import Play
    from .lamps import Light
    from .origin import Record

UNCHANGED: Any = object()  # the animation stays as it is


def rebuild(
    made: Material, scene: Scene, *, backend: str | None = None, estimator: str | None = None,
    bound: float | None = None, disperses: bool | None = None, bounces: bool | None = None,
    play: Play | None = UNCHANGED,
) -> list[str]:  # fmt: skip
    """Change ``made`` in place by the arguments, and to the lights of ``scene``; what the arguments leave out stays.

    Returns what could not be kept, a sentence each. MaterialError, with nothing changed, if it cannot be done.
    """
    record = _current(made)
    estimator = estimator or record.estimator
    limit = material.origin_of(made).bound if bound is None else bound
    lamps = _lights(made, scene, estimator, record.preset.model)
    spread = record.disperses if disperses is None else disperses
    more = record.bounces if bounces is None else bounces
    choice = Choice(backend or record.backend, estimator, lamps, record.shadows, limit, spread, more, record.play)
    lost = _exchange(made, record.preset, choice)
    changed = material.record_of(record.preset, choice)
    origin.write(made, replace(changed, state=_as_new(record.preset, choice)))
    if play is UNCHANGED or play == record.play:
        return lost
    if play is None:
        material.stop(made)
    else:
        material.play(made, play)
    choice = replace(choice, play=play)
    origin.write(made, replace(material.record_of(record.preset, choice), state=_as_new(record.preset, choice)))
    return lost


def as_preset(made: Material, scene: Scene, change: Callable[[Preset], Preset]) -> list[str]:
    """Change ``made`` in place to what ``change`` makes of its present numbers; nothing where that is the same.

    Returns what could not be kept, a sentence each.
    """
    record, before = _current(made), material.origin_of(made)
    preset = change(before.preset)
    if preset == before.preset:
        return []
    lamps = _lights(made, scene, record.estimator, preset.model)
    choice = Choice(
        record.backend, record.estimator, lamps, record.shadows, before.bound, record.disperses, record.bounces
    )
    lost = _exchange(made, preset, choice)
    origin.write(made, replace(material.record_of(preset, choice), state=_as_new(preset, choice)))
    numbers = material.numbers_of(preset)
    for name, socket in material.parameter_sockets(made).items():
        give(name, socket, numbers[name])
    return lost


def reset(made: Material, scene: Scene) -> list[str]:
    """Restore the numbers that ``made`` was built with, its animation, and its node group if that was deleted.

    Returns which inputs something else still drives, a sentence each.
    """
    record = _current(made)
    lost = []
    if roles.node(made, roles.MODEL) is None:
        lost = rebuild(made, scene)
        record = material.upgrade(made)
    sockets = material.parameter_sockets(made)
    if record.play is not None:
        course.remove(made, sockets)
    numbers = material.numbers_of(record.preset)
    for name, socket in sockets.items():
        give(name, socket, numbers[name])
    material.animate(made, record)
    material.show_in_solid_view(made, record.preset)
    ours = course.trajectory_node(made)
    courses = {curve.data_path for curve in material.curves(made)} if record.play is None else set()
    drivers = {curve.data_path for curve in _drivers(made.node_tree)}
    for socket in sockets.values():
        path = socket.path_from_id("default_value")
        if any(link.from_node != ours for link in socket.links):
            lost.append(f"{socket.name} keeps what is linked to it")
        elif path in courses or path in drivers:
            lost.append(f"{socket.name} keeps its {'driver' if path in drivers else 'keys'}")
    return lost


def is_of_other_cycles(made: Material) -> bool:
    """Whether a material was built for another Cycles, and renders differently in the running one.

    By Blender 5.3 Cycles' own Oren-Nayar changed, and what OSL's closures of glass make of the IOR.
    """
    kept, node = origin.read(made), roles.node(made, roles.MODEL)
    if kept is None or node is None or nodegroups.cycles_of(node.node_tree) == cycles.version():
        return False
    preset = kept.preset
    return any(of.spec.of_cycles(kept.estimator, kept.backend) for of in (preset, *preset.parts().values()))


def _lights(made: Material, scene: Scene, estimator: str, model: str) -> tuple[Light, ...]:
    """Those to bind of ``scene``, and beside them, where they fit, those of other scenes that show the material."""
    others = (one for one in bpy.data.scenes if one != scene and made in materials_in(one))
    found: dict[Slot, Light] = {}
    for one in (scene, *others):
        for light in lamps_to_bind(one, estimator, model):
            found.setdefault(light.slot, light)
    return tuple(found.values())[: most_lights(estimator, model)]


def _current(made: Material) -> Record:
    """What a material was built from, with its numbers in the open file's working space."""
    record = material.upgrade(made)
    if colour_space.is_stale(made):
        colour_update.refresh(made)
        record = material.upgrade(made)
    return record


def _as_new(preset: Preset, choice: Choice) -> str:
    """The state of a new, unedited material."""
    record, group = material.record_of(preset, choice), material.group_of(preset, choice)
    new = bpy.data.materials.new(preset.name)
    try:
        material.fill(new, preset, choice, group)
        origin.write(new, record)
        material.animate(new, record)
        return material.state_of(new)
    finally:
        if roles.node(new, roles.TRAJECTORY) is not None:
            course.remove(new, material.parameter_sockets(new))  # the group is the material's own
        elif (action := _action(new)) is not None:
            bpy.data.actions.remove(action)
        bpy.data.materials.remove(new)


def _action(made: Material) -> bpy.types.Action | None:
    data = made.node_tree.animation_data
    return data.action if data else None


# Nodes


def _exchange(made: Material, preset: Preset, choice: Choice) -> list[str]:
    """Replace the material's groups by those of ``choice``; returns what could not be kept."""
    group = material.group_of(preset, choice)  # may refuse: nothing is changed before it
    tree, node = made.node_tree, roles.node(made, roles.MODEL)
    for light in roles.nodes(made, roles.LIGHT):
        tree.nodes.remove(light)
    if node is None:
        lost = _restore(made, preset, choice, group)
    else:
        lost = _swap(made, node, group, preset)
        if "Bound" in (inputs := nodegroups.inputs(node)):
            inputs["Bound"].default_value = choice.bound
        material.bind_lights(made, node, choice)
        lost += _show(made, node)
    for inside in roles.nodes(made, roles.ABSORPTION):
        lost += _swap(made, inside, material.absorption_group(), preset)
    material.set_up(made, preset, choice)
    return lost


def _restore(made: Material, preset: Preset, choice: Choice, group: ShaderNodeTree) -> list[str]:
    """The node of a model whose group was deleted, to where its output is free."""
    tree = made.node_tree
    for dead in [node for node in tree.nodes if node.get(roles.KEY) == roles.MODEL]:
        tree.nodes.remove(dead)
    node = material.add_model(made, preset, choice, group)
    output = roles.node(made, roles.OUTPUT)
    if output is None:
        output = tree.nodes.new("ShaderNodeOutputMaterial")
        output.location, output[roles.KEY] = (300, 0), roles.OUTPUT
    text = "The node group had been deleted: it is back with the preset's numbers"
    if output.inputs["Surface"].is_linked:
        return [f"{text}; link it to the output, which shows something else"]
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    for shown in roles.nodes(made, roles.EEVEE):
        if not shown.inputs["Surface"].is_linked:
            tree.nodes.remove(shown)
    if not roles.nodes(made, roles.EEVEE):
        output.target = "ALL"
        material.show_in_eevee(tree, node, output)
    return [text]


def _swap(made: Material, node: Node, group: ShaderNodeTree, preset: Preset) -> list[str]:
    """Replace the node's group. Blender matches sockets by number; here values and links follow their names.

    Those of older files have other names, and some hold their parameter in another way.
    """
    if node.node_tree == group:
        return []
    fcurves.make_own(made)
    tree, before = made.node_tree, _by_present_name(made, node, preset)
    sockets = material.parameter_sockets(made)
    scaled = {label(preset.model, name): name for name, socket in sockets.items()
              if scale_of(name, socket) is not parameter(name).scale}  # fmt: skip
    played = course.courses(made, sockets) if scaled and roles.node(made, roles.TRAJECTORY) is None else {}
    kept = {name: _Input(socket, scaled.get(name, "")) for name, socket in before.items()}
    outputs = [(socket.name, [link.to_socket for link in socket.links]) for socket in node.outputs]
    places = list(node.inputs)
    paths = _paths_to(made, node, {places.index(socket): name for name, socket in before.items()})
    for path in paths:
        path.owner.data_path = ""  # Blender would move or remove it with the sockets that it takes away
    for link in [link for socket in (*node.inputs, *node.outputs) for link in socket.links]:
        tree.links.remove(link)
    node.node_tree = group
    after = nodegroups.inputs(node)
    _fill(tree, group, kept, after)
    numbers = material.numbers_of(preset)
    for name, socket in material.parameter_sockets(made).items():
        if label(preset.model, name) in after.keys() - kept.keys():
            give(name, socket, numbers[name])
    where = {name: socket.path_from_id() for name, socket in after.items()}
    lost = {path.name for path in paths if not path.lead_to(where.get(path.name, ""))}
    lost |= {name for name, one in kept.items() if one.sources and name not in after}
    driven = {path.name for path in paths if path.name in scaled and path.drives}
    keys = {
        name: converted_keys(name, played[name], parameter(name).scale.to_input)
        for name in scaled.values()
        if name in played
    }
    if keys:
        course.replace_curves(made, material.parameter_sockets(made), keys)
    for name, targets in outputs:
        for target in targets:
            tree.links.new(node.outputs.get(name) or node.outputs[0], target)
    said = [f"{name} has no input any more; what was on it is gone" for name in sorted(lost)]
    return said + [f"{name} keeps its driver, which gave {symbol(scaled[name])}: change it" for name in sorted(driven)]


def _by_present_name(made: Material, node: Node, preset: Preset) -> dict[str, NodeSocket]:
    """The inputs of a model's node by the names that they have in groups of today."""
    sockets = material.parameter_sockets(made).items()
    names = {nodegroups.name_of(socket): label(preset.model, name) for name, socket in sockets}
    return {names.get(name, name): socket for name, socket in nodegroups.inputs(node).items()}


def _fill(
    tree: ShaderNodeTree, group: ShaderNodeTree, kept: dict[str, _Input], inputs: dict[str, NodeSocket]
) -> None:  # fmt: skip
    """Fill inputs with the values and links of those of the same name, others with the group's defaults."""
    defaults = {item.name: item for item in group.interface.items_tree if item.item_type == "SOCKET"}
    for name, socket in inputs.items():
        if name in kept and kept[name].kind == socket.type:
            kept[name].give(tree, socket)
        elif hasattr(socket, "default_value"):
            socket.default_value = defaults[name].default_value


class _Input:
    """An input's value, link and visibility; ``scaled``: the parameter that it holds as it is, as inputs once did."""

    def __init__(self, socket: NodeSocket, scaled: str) -> None:
        value: Any = getattr(socket, "default_value", None)
        self.scaled = scaled
        self.kind, self.hidden = socket.type, socket.hide
        self.value = tuple(value) if socket.type in {"RGBA", "VECTOR"} else value
        self.sources = [link.from_socket for link in socket.links]

    def give(self, tree: ShaderNodeTree, socket: NodeSocket) -> None:
        if self.scaled:
            give(self.scaled, socket, float(f"{self.value:.{DIGITS}g}"))  # as a preset's number was, before rounding
        elif self.value is not None:
            socket.default_value = self.value
        socket.hide = self.hidden
        for source in self.sources:
            if self.scaled:
                node = tree.nodes.new("ShaderNodeGroup")
                node.node_tree = parameters.to_input(self.scaled)
                tree.links.new(source, node.inputs[0])
                source = node.outputs[0]  # noqa: PLW2901 - what the input takes now
            tree.links.new(source, socket)


def _show(made: Material, node: Node) -> list[str]:
    """Give EEVEE its own output exactly if the group has one for it, or Cycles shows a mixture."""
    tree, output, own = made.node_tree, roles.node(made, roles.OUTPUT), roles.node(made, roles.EEVEE)
    if output is None:
        return []
    alone, own_is_ours = (of is not None and _feeds(node, of) for of in (output, own))
    if eevee.OUTPUT in node.outputs:
        if own is not None and own_is_ours:
            tree.links.new(node.outputs[eevee.OUTPUT], own.inputs["Surface"])
        elif own is None and output.target == "ALL":
            if not alone:
                return ["EEVEE shows what Cycles renders, as other shaders are mixed in"]
            material.show_in_eevee(tree, node, output)
    elif alone and output.target == "CYCLES" and (own is None or own_is_ours):
        output.target = "ALL"
        if own is not None:
            tree.nodes.remove(own)
    return []


def _feeds(node: Node, output: Node) -> bool:
    return any(link.from_node == node for link in output.inputs["Surface"].links)


# Keys and drivers


@dataclass(frozen=True)
class _Path:
    """A ``data_path`` to an input: of an F-curve or driver in ``among``, or of a driver's target."""

    owner: Any
    among: Any
    name: str
    head: str
    tail: str

    def lead_to(self, place: str) -> bool:
        """Point it to the input's present place, or remove it if there is none, if possible; whether it points."""
        if place:
            self.owner.data_path = f"{self.head}{place}{self.tail}"
        elif self.among is not None:
            self.among.remove(self.owner)
        return bool(place)

    @property
    def drives(self) -> bool:
        """Whether it is a driver's curve."""
        return getattr(self.owner, "driver", None) is not None


def _paths_to(made: Material, node: Node, names: dict[int, str]) -> list[_Path]:
    """What animates or reads the inputs of ``node``; ``names``: theirs by their places."""
    places = {f"{node.path_from_id()}.inputs[{index}]": name for index, name in names.items()}
    tree, found = made.node_tree, []

    def look(owner: Any, among: Any) -> None:
        part = re.search(r'nodes\["(?:[^"\\]|\\.)*"\]\.inputs\[\d+\]', owner.data_path)
        if part is not None and part[0] in places:
            head, tail = owner.data_path[: part.start()], owner.data_path[part.end() :]
            found.append(_Path(owner, among, places[part[0]], head, tail))

    for among in (*_bags(tree), _drivers(tree)):
        for curve in among:
            look(curve, among)
    for driver in _all_drivers():
        for target in (target for variable in driver.variables for target in variable.targets):
            if target.id in {made, tree}:
                look(target, None)
    return found


def _bags(tree: ShaderNodeTree) -> Iterator[Any]:
    """The F-curves of the tree's action, and of those on its NLA tracks."""
    data = tree.animation_data
    if data is None:
        return
    users = [data, *(strip for track in data.nla_tracks for strip in track.strips)]
    for user in users:
        slot = user.action_slot if user.action else None
        if slot is None:
            continue
        for strip in (strip for layer in user.action.layers for strip in layer.strips):
            if (bag := strip.channelbag(slot)) is not None:
                yield bag.fcurves


def _drivers(tree: ShaderNodeTree) -> Any:
    return tree.animation_data.drivers if tree.animation_data else []


def _all_drivers() -> Iterator[Driver]:
    """Every driver of the file, which may read a material's inputs."""
    for name in dir(bpy.data):
        found = getattr(bpy.data, name)
        if not isinstance(found, bpy.types.bpy_prop_collection):
            continue
        for block in found:
            trees = [getattr(block, "node_tree", None)] if hasattr(block, "node_tree") else []
            for owner in (block, *filter(None, trees)):
                data = getattr(owner, "animation_data", None)
                yield from (curve.driver for curve in (data.drivers if data else ()))
