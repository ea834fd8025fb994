# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material is now: the preset behind it, its numbers and course, and whether an artist changed them."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import nodegroups
from ...nodegroups import trajectory
from ..library.timeline import Timeline
from ..models import PLAIN, label, parameter, symbol
from ..reference.hybrid import BOUNDS
from . import colour_space, course, origin, roles
from .choice import MaterialError
from .inputs import converted_keys, scale_of, value_of

if TYPE_CHECKING:
    from bpy.types import FCurve, Material, Node, NodeSocket

    from ..library.presets import Preset
    from ..reference.keyframes import Keyframes
    from .origin import Record


@dataclass(frozen=True)
class Origin:
    """What a material was built from, with the numbers that it has now."""

    preset: Preset
    backend: str
    estimator: str
    bound: float


def is_ours(material: Material) -> bool:
    """Whether ``build`` made this material, and this version can read what it was built from."""
    return origin.read(material) is not None


def parameter_sockets(material: Material) -> dict[str, NodeSocket]:
    """The inputs that hold the parameters of a material, by their reference names.

    Smooth glass and the like have no input for their slope. What an artist took away is not there: none of a material
    whose group was deleted, or that is not ours.
    """
    record = origin.read(material)
    if record is None:
        return {}
    inputs: dict[str, NodeSocket] = {}
    for role in (roles.ABSORPTION, roles.MODEL):
        node = roles.node(material, role)
        inputs |= nodegroups.inputs(node) if node else {}
    found = {}
    for name, value in record.preset.parameters.items():
        socket = inputs.get(label(record.preset.model, name)) or inputs.get(symbol(name))
        smooth = parameter(name).zero_is_smooth and value == 0.0
        if socket is not None and not smooth and (socket.type == "VALUE") == isinstance(value, float):
            found[name] = socket
    return found


def bound_slots(material: Material) -> set[str]:
    """The lights of a scene that a material reads; of format 1 none, which is driven by lights itself."""
    record = origin.read(material)
    return {slot for slot in record.lights if isinstance(slot, str)} if record else set()


def origin_of(material: Material) -> Origin:
    """The preset and choice behind a material; the numbers are those of its inputs now, where it still has them."""
    record = record_in(material)
    now = dict(record.preset.parameters)
    now |= colour_space.read(values_of(material), now, colour_space.of(material))
    # How the preset was verified, and what is noted of it, holds for its own numbers.
    preset = replace(record.preset, parameters=now, verified={}, m_range=None, notes="", time=None)
    node = roles.node(material, roles.MODEL)
    bound = nodegroups.inputs(node).get("Bound") if node else None
    limit = record.bound if bound is None else min(max(float(bound.default_value), BOUNDS[0]), BOUNDS[1])
    return Origin(preset, record.backend, record.estimator, limit)


def record_in(material: Material) -> Record:
    record = origin.read(material)
    if record is None:
        message = f"{material.name} was not made by vgroove, or by a later version of it; apply a preset"
        raise MaterialError(message)
    return record


def upgrade(material: Material) -> Record:
    """What a material was built from, kept in the present format from now on; MaterialError if it cannot be changed."""
    record = record_in(material)
    if reason := locked(material):
        raise MaterialError(reason)
    if roles.is_format_1(material):
        edited, guessed = is_edited(material), [(node, roles.guess(node)) for node in material.node_tree.nodes]
        for node, role in guessed:
            if role:
                node[roles.KEY] = role
        for name in (origin.STATE_1, origin.TIME_1):
            if name in material:
                del material[name]
        origin.write(material, record)
        record = replace(record, state="" if edited else state_of(material))
        origin.write(material, record)
    return record


def locked(material: Material) -> str:
    """Why a material cannot be changed in this file, and what to do; empty if it can."""
    if material.library is not None:
        what = f"is linked from {material.library.name}"
    elif material.override_library is not None:
        what = "is an override of a linked material, whose nodes cannot be changed"
    else:
        return ""
    return f"{material.name} {what}; choose Object > Relations > Make Local > Materials, or apply a preset"


def values_of(material: Material) -> dict[str, Any]:
    """The numbers of a material as its inputs have them, in the working space."""
    return {name: value_of(name, socket) for name, socket in parameter_sockets(material).items()}


def is_edited(material: Material) -> bool:
    """Whether a material was changed since ``build`` made it."""
    state = _state_1(material) if roles.is_format_1(material) else state_of(material)
    return record_in(material).state != state


def curves(material: Material) -> list[FCurve]:
    """The F-curves that play the course of a material."""
    return course.curves_of(material, parameter_sockets(material).values())


def plays(material: Material) -> bool:
    """Whether a material changes over time."""
    return bool(curves(material)) or course.trajectory_node(material) is not None


def preset_of(material: Material) -> Preset:
    """The preset that a material was built from, as it was then."""
    return record_in(material).preset


def to_preset(material: Material) -> Preset:
    """What a material is now, as a preset: its numbers and its course, with what an artist changed in them."""
    now, record = origin_of(material).preset, record_in(material)
    if not plays(material):
        return now
    if not is_edited(material):
        return replace(now, parameters=record.preset.parameters, time=record.preset.time)
    known = record.preset.time or Timeline("share", 0.0, 1.0, "authored", {})
    laws: dict[str, dict[str, Any]] = {}
    starts: dict[str, Any] = {}
    courses = _courses(material)
    for name, keys in colour_space.courses(courses, values_of(material), colour_space.of(material)).items():
        times = (known.start + keys.times * (known.end - known.start)).tolist()
        values = [tuple(of) if isinstance(of, list) else of for of in keys.values.tolist()]
        starts[name] = values[0]
        later = [(time, of) for time, of in zip(times, values, strict=True) if time > known.start]
        if later:
            laws[name] = {"law": "keys", "times": [time for time, _ in later], "values": [of for _, of in later]}
    time = replace(known, kind="authored", laws=laws) if laws else None  # one key alone: it stands still
    return replace(now, parameters=now.parameters | starts, time=time)


def _courses(material: Material) -> dict[str, Keyframes]:
    """The course of each parameter that changes, by age."""
    sockets = parameter_sockets(material)
    found = course.courses(material, sockets)
    for name, keys in found.items():
        scale = scale_of(name, sockets[name])
        if scale is not PLAIN:
            found[name] = converted_keys(name, keys, scale.of_input)
    return found


CURVE, TRAJECTORY = "F-curve", "trajectory"  # how the entries of a state begin that tell of its course


def state_of(material: Material) -> str:
    """The inputs that artists can change, and what is linked, as one comparable text.

    Our nodes are named by their roles, so that a material rebuilt in place compares with one built from nothing.
    """
    tree = material.node_tree
    names = {node.name: node.name for node in tree.nodes}
    for role in (*roles.GROUPS, roles.OUTPUT, roles.EEVEE):
        names |= {node.name: f"{role} {k}" for k, node in enumerate(roles.nodes(material, role))}
    inputs = {
        f"{socket.path_from_id()}.default_value": (names[node.name], name, socket)
        for node in tree.nodes
        for name, socket in _named_inputs(node)
    }
    values: list[Any] = [[names[node.name], node.mute] for node in tree.nodes if node.mute]
    found = curves(material)
    for curve in found:
        keys = [[round(float(part), 5) for part in point.co] for point in curve.keyframe_points]
        values.append([CURVE, *inputs[curve.data_path][:2], curve.array_index, keys])
    if (ramp := course.trajectory_node(material)) is not None:
        values.append([TRAJECTORY, str(trajectory.keys_of(ramp.node_tree))])
    moving, rec709 = {curve.data_path for curve in found}, _in_rec709(material)
    for path, (node, name, socket) in inputs.items():
        value = rec709.get(socket.path_from_id(), getattr(socket, "default_value", None))
        plain = [round(float(part), 7) for part in value] if isinstance(value, Iterable) else value
        driven = path in moving or node.startswith(roles.LIGHT)
        links = [[names[link.from_node.name], link.from_socket.name] for link in socket.links]
        values.append([node, name, None if driven else _comparable(plain), links])
    values += [
        [*inputs[curve.data_path][:2], curve.array_index, curve.driver.expression]
        for curve in (tree.animation_data.drivers if tree.animation_data else ())
        if curve.data_path in inputs and not inputs[curve.data_path][0].startswith(roles.LIGHT)
    ]
    return json.dumps(sorted(map(json.dumps, values)))


def _comparable(value: Any) -> Any:
    """A socket's value as JSON has it: what is neither a number nor a text by its name."""
    return value if value is None or isinstance(value, (bool, int, float, str, list)) else getattr(value, "name", "")


def _named_inputs(node: Node) -> list[tuple[str, NodeSocket]]:
    if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
        return list(nodegroups.inputs(node).items())
    return [(socket.name, socket) for socket in node.inputs]


def _state_1(material: Material) -> str:
    """What format 1 kept as a material's state: by the names of nodes."""
    values: list[Any] = []
    found = curves(material)
    moving = {curve.data_path for curve in found}
    rec709 = _in_rec709(material)
    for curve in found:
        keys = [[round(float(part), 5) for part in point.co] for point in curve.keyframe_points]
        values.append([curve.data_path, curve.array_index, keys])
    if (ramp := course.trajectory_node(material)) is not None:
        values.append(str(trajectory.keys_of(ramp.node_tree)))
    for node in sorted(material.node_tree.nodes, key=lambda node: node.name):
        for socket in node.inputs:
            driven = node.label.startswith("Lamp") or f"{socket.path_from_id()}.default_value" in moving
            value = rec709.get(socket.path_from_id(), getattr(socket, "default_value", None))
            plain = [round(float(part), 7) for part in value] if isinstance(value, Iterable) else value
            values.append(
                [node.name, socket.name, None if driven else plain, [link.from_node.name for link in socket.links]]
            )
    return json.dumps(values)


def _in_rec709(material: Material) -> dict[str, Any]:
    """By the path of each parameter's input, what its numbers are in Rec.709, as an input holds them.

    So a material is as edited, or not, in every working space. Empty where the numbers are in Rec.709 as they are.
    """
    if colour_space.KEY not in material:
        return {}
    built = {name: parameter(name).storable(of) for name, of in record_in(material).preset.parameters.items()}
    read = colour_space.read(values_of(material), built, colour_space.of(material))
    found = {}
    for name, socket in parameter_sockets(material).items():
        number = np.float32(scale_of(name, socket).to_input(read[name])).tolist()
        found[socket.path_from_id()] = [*number, 1.0] if socket.type == "RGBA" else number
    return found
