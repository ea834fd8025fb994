# SPDX-License-Identifier: GPL-3.0-or-later
"""Preset + estimator + backend -> a Blender material that holds only the nodes which it needs."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ... import nodegroups
from ...nodegroups import (
    absorption,
    car_paint,
    cook_torrance_closure,
    cook_torrance_corrected,
    cook_torrance_direct,
    cook_torrance_fit,
    cook_torrance_hybrid,
    cook_torrance_mirror,
    eevee,
    fit_table,
    fresnel,
    glass_closure,
    glass_mirror,
    lamp,
    oren_nayar,
    oren_nayar_closure,
    oren_nayar_corrected,
    oren_nayar_direct,
    oren_nayar_fit,
    oren_nayar_hybrid,
    oren_nayar_mirror,
    random_numbers,
    trajectory,
    translucent,
    versions,
)
from ...nodegroups import sum as sum_group
from ..library.checks import M_RANGE, base_name
from ..library.presets import TRANSPARENT, Preset
from ..library.timeline import Timeline
from ..reference.hybrid import BOUNDS, DEFAULT_BOUND
from . import colour_space, origin, roles
from . import course as animation
from . import lamps as lamp_binding
from .origin import Record

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import FCurve, Material, Node, NodeSocket, Scene, ShaderNodeTree

    from ...nodegroups._tree import Tree
    from .course import Play
    from .lamps import Light

BACKENDS = ("nodes", "osl")
ESTIMATORS = ("fit", "closure", "corrected", "hybrid", "mirror", "direct")
BUILDERS: dict[str, dict[str, Any]] = {
    "cook_torrance": {
        "fit": cook_torrance_fit,
        "closure": cook_torrance_closure,
        "corrected": cook_torrance_corrected,
        "hybrid": cook_torrance_hybrid,
        "mirror": cook_torrance_mirror,
        "direct": cook_torrance_direct,
    },
    "oren_nayar": {
        "fit": oren_nayar_fit,
        "closure": oren_nayar_closure,
        "corrected": oren_nayar_corrected,
        "hybrid": oren_nayar_hybrid,
        "mirror": oren_nayar_mirror,
        "direct": oren_nayar_direct,
    },
    "glass": {"closure": glass_closure, "mirror": glass_mirror},
    "sum": dict.fromkeys(ESTIMATORS, sum_group),
    "car_paint": dict.fromkeys(ESTIMATORS, car_paint),
    "translucent": dict.fromkeys(("fit", "closure", "corrected", "hybrid", "mirror"), translucent),
}
UPRIGHT = {"closure", "direct"}  # estimators whose closures do not lean: others would be bent by Bump Map Correction
NATIVE = ("fit", "closure")  # of Cycles' own closures, which see every lamp
KEY = roles.KEY  # custom property on a material: what it was built from
RANDOM = ("hybrid", "mirror")  # of facets that are drawn for each sample
# How many lights may be bound where Cycles' stack of 255 floats has no room for eight: what outgrows it renders black.
# Measured with room to spare for an artist's own nodes, in 4.5, which keeps more on it, without: test_stack.py.
MOST_LIGHTS = {("car_paint", "corrected"): 4, ("car_paint", "hybrid"): 3}
if not versions.since(5, 0):
    MOST_LIGHTS = {
        ("car_paint", "corrected"): 3, ("car_paint", "hybrid"): 3, ("car_paint", "direct"): 6, ("sum", "corrected"): 5,
        ("translucent", "corrected"): 4, ("cook_torrance", "corrected"): 4, ("oren_nayar", "corrected"): 6,
    }  # fmt: skip
EVERY_LAMP = ("corrected", "direct")  # what evaluates the formula at bound lamps of any size


def binds(estimator: str, lamp_size: float, model: str = "cook_torrance") -> bool:
    """Whether a material by ``estimator`` evaluates the formula itself at a lamp of this size.

    ``mirror`` and ``hybrid`` do so where it is 0, as their random rays cannot hit such a lamp; glass never does.
    """
    if model in TRANSPARENT:
        return False
    return estimator in EVERY_LAMP or (estimator not in NATIVE and lamp_size == 0.0)


def lamps_to_bind(scene: Scene, estimator: str, model: str = "cook_torrance") -> tuple[Light, ...]:
    """The strongest lights that the material evaluates itself, as ``binds`` says for their size."""
    if estimator in NATIVE or model in TRANSPARENT:
        return ()
    return bindable(lamp_binding.followed(scene), estimator, model)


def bindable(lights: Sequence[Light], estimator: str, model: str) -> tuple[Light, ...]:
    """Those of a scene's followed lights that the material evaluates itself."""
    most = MOST_LIGHTS.get((model, estimator), lamp_binding.LIMIT)
    return tuple(one for one in lights if binds(estimator, lamp_binding.size(one.item), model))[:most]


class MaterialError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


@dataclass(frozen=True)
class Choice:
    """How a preset becomes a material.

    lamps: those that are evaluated by the formula: all of ``direct`` and ``corrected``, and beside ``mirror`` and
    ``hybrid`` those of zero size, which no ray can hit. shadows: whether these lamps cast any.
    bound: how much of the directional albedo ``hybrid`` may have wrong.
    play: how the course of a preset that changes is played; without it the material stands still, at the start.
    """

    backend: str = "nodes"
    estimator: str = "fit"
    lamps: tuple[Light, ...] = ()
    shadows: bool = True
    bound: float = DEFAULT_BOUND
    play: Play | None = None

    def __post_init__(self) -> None:
        for what, value, known in (("backend", self.backend, BACKENDS), ("estimator", self.estimator, ESTIMATORS)):
            if value not in known:
                message = f'unknown {what} "{value}"; use one of {", ".join(known)}'
                raise MaterialError(message)
        if self.lamps and self.estimator in NATIVE:
            message = f'"{self.estimator}" sees every lamp by itself; leave lamps empty'
            raise MaterialError(message)
        if len(self.lamps) > lamp_binding.LIMIT:
            most = f"at most {lamp_binding.LIMIT} lamps, got {len(self.lamps)}; bind the strongest"
            message = f'"{self.estimator}" binds {most}'
            raise MaterialError(message)
        low, high = BOUNDS
        if not low <= self.bound <= high:
            message = f"bound must be between {low:g} and {high:g} of the reflected light, got {self.bound:g}"
            raise MaterialError(message)
        for one in self.lamps:
            if refused := lamp_binding.refusal(one):
                raise MaterialError(refused)
            if not one.number:
                message = f"{one.name} has no place in the scene's rig; take lamps from lamps_to_bind"
                raise MaterialError(message)


def build(preset: Preset, choice: Choice, into: Material | None = None) -> Material:
    """The material of ``preset`` by ``choice``.

    Idempotent: if this .blend holds one that was built the same way and not edited since, that one is returned.
    An edited one is left alone and a new one is made beside it.

    into: a material that becomes this one; no other is looked for then. Cycles, which never forgets a material while it
    keeps a scene, sees one that changes.
    """
    if choice.play is not None and preset.time is None:
        message = f"{preset.id} does not change over time; leave play out"
        raise MaterialError(message)
    record, group = record_of(preset, choice), group_of(preset, choice)  # may refuse: nothing is made before it
    for known in bpy.data.materials if into is None else ():
        if _is_built_so(known, record, group):
            return known
    material = into or bpy.data.materials.new(preset.name)
    if origin.read(material) is not None:
        stop(material)
        material.node_tree.animation_data_clear()
        material.name = preset.name
    try:
        fill(material, preset, choice, group)
        origin.write(material, record)
        animate(material, record)
    except Exception:  # a material that cannot be built does not stay behind half made
        if into is None:
            bpy.data.materials.remove(material)
        raise
    origin.write(material, replace(record, state=state_of(material)))
    return material


def record_of(preset: Preset, choice: Choice) -> Record:
    """What a material of ``preset`` by ``choice`` remembers."""
    lights = tuple(str(one.slot) for one in choice.lamps)
    return Record(preset, choice.backend, choice.estimator, choice.bound, choice.shadows, lights, choice.play)


def _is_built_so(material: Material, record: Record, group: ShaderNodeTree) -> bool:
    """Whether a material was built from the same, of the same group, and nobody edited it since."""
    kept = origin.read(material)
    if kept is None or kept.preset.id != record.preset.id or material.library is not None:
        return False
    node = roles.node(material, roles.MODEL)
    same = node is not None and node.node_tree == group and kept.builds() == record.builds()
    return same and not colour_space.is_stale(material) and not is_edited(material)


def fill(material: Material, preset: Preset, choice: Choice, group: ShaderNodeTree) -> None:
    """The material as it is at the start of its course."""
    tree = versions.nodes_of(material)
    tree.nodes.clear()
    node = add_model(material, preset, choice, group)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location, output[roles.KEY] = (300, 0), roles.OUTPUT
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    if absorbs(preset):
        _absorb(tree, output, numbers_of(preset)["absorption"])
    show_in_eevee(tree, node, output)
    show_in_solid_view(material, preset)
    set_up(material, preset, choice)


def add_model(material: Material, preset: Preset, choice: Choice, group: ShaderNodeTree) -> Node:
    """A node of the model with the preset's numbers, and the lights that it evaluates."""
    node = _group_node(material.node_tree, group, preset.name, roles.MODEL)
    for name, value in numbers_of(preset).items():
        if socket_name(name) in node.inputs:  # smooth glass has no slope
            set_input(node.inputs[socket_name(name)], value)
    colour_space.mark(material)
    if choice.estimator == "hybrid":
        node.inputs["Bound"].default_value = choice.bound
    bind_lights(material, node, choice)
    return node


def held(parameter: str, value: Any) -> Any:
    """A parameter's value as its input has it: m = 0, a smooth interface, is what float32 can hold of it."""
    return max(value, M_RANGE[0]) if base_name(parameter) == "m" else value


def numbers_of(preset: Preset) -> dict[str, Any]:
    """A preset's parameters as inputs have them in the open file's working space."""
    numbers = colour_space.to_space(preset.parameters, colour_space.matrix())
    return {name: held(name, value) for name, value in numbers.items()}


def bind_lights(material: Material, node: Node, choice: Choice) -> None:
    """Link the lights of ``choice`` to a model's node, and have their scene tell of them."""
    for scene in {one.scene for one in choice.lamps}:
        lamp_binding.follow(scene)
    for index, one in enumerate(choice.lamps, 1):
        _bind(material.node_tree, node, index, one, choice)


def set_up(material: Material, preset: Preset, choice: Choice) -> None:
    """The material's own settings that the estimator needs."""
    upright = UPRIGHT | {"fit"} if preset.model == "oren_nayar" else UPRIGHT
    material.cycles.use_bump_map_correction = choice.estimator in upright
    material.cycles.emission_sampling = "NONE" if choice.lamps else "AUTO"


def show_in_eevee(tree: ShaderNodeTree, node: Node, output: Node) -> None:
    """Have EEVEE show the closure of the same inputs, where the group gives one, and leave ``output`` to Cycles."""
    if eevee.OUTPUT in node.outputs:
        output.target = "CYCLES"
        shown = tree.nodes.new("ShaderNodeOutputMaterial")
        shown.target, shown[roles.KEY] = "EEVEE", roles.EEVEE
        shown.location = (output.location.x, output.location.y - 160)
        tree.links.new(node.outputs[eevee.OUTPUT], shown.inputs["Surface"])


def animate(material: Material, record: Record) -> None:
    """Have the material play its preset's course, where it plays one."""
    if record.play is not None:
        preset, sockets = record.preset, parameter_sockets(material)
        course = colour_space.course(preset.trajectory(), preset.parameters, colour_space.matrix())
        animation.animate(material, sockets, course, record.play, preset.name, record.backend)


def absorbs(preset: Preset) -> bool:
    """Whether light loses something on its way through the material: a sheet has no inside, and white takes nothing."""
    taken = preset.parameters.get("absorption", 0.0)
    return preset.kind != "thin" and isinstance(taken, tuple) and any(taken)


def _absorb(tree: ShaderNodeTree, output: Node, taken: Any) -> None:
    group = nodegroups.ensure(absorption.NAME, absorption.REVISION, absorption.build)
    node = _group_node(tree, group, "Absorption", roles.ABSORPTION)
    node.location = (0, -320)
    set_input(node.inputs["Absorption"], taken)
    tree.links.new(node.outputs[0], output.inputs["Volume"])


# Reference name -> group input
SOCKETS = {"m": "Slope m", "f0": "F0", "f82_tint": "F82 Tint", "eta": "IOR", "n": "n", "k": "k"}
SOCKETS |= {"albedo": "Base Color", "sigma": "Sigma", "tint": "Tint", "d": "Diffuse", "s": "Specular"}
SOCKETS |= {"absorption": "Absorption", "reflectance": "Reflectance", "mean_free_path": "Mean Free Path"}


def socket_name(parameter: str) -> str:
    """The group input of a parameter: "Slope m" of m, "Lobe 2 Slope m" of m_2."""
    base = base_name(parameter)
    return SOCKETS[base] if base == parameter else f"Lobe {parameter.removeprefix(base)[1:]} {SOCKETS[base]}"


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
        socket = inputs.get(socket_name(name))
        smooth = base_name(name) == "m" and value == 0.0
        if socket is not None and not smooth and (socket.type == "VALUE") == isinstance(value, float):
            found[name] = socket
    return found


def bound_slots(material: Material) -> set[str]:
    """The lights of a scene that a material reads; of format 1 none, which is driven by lights itself."""
    record = origin.read(material)
    return {slot for slot in record.lights if isinstance(slot, str)} if record else set()


def origin_of(material: Material) -> Origin:
    """The preset and choice behind a material; the numbers are those of its inputs now, where it still has them."""
    record = _record(material)
    now = dict(record.preset.parameters)
    now |= colour_space.read(values_of(material), now, colour_space.of(material))
    # How the preset was verified, and what is noted of it, holds for its own numbers.
    preset = replace(record.preset, parameters=now, verified={}, m_range=None, notes="", time=None)
    node = roles.node(material, roles.MODEL)
    bound = nodegroups.inputs(node).get("Bound") if node else None
    limit = record.bound if bound is None else min(max(float(bound.default_value), BOUNDS[0]), BOUNDS[1])
    return Origin(preset, record.backend, record.estimator, limit)


def _record(material: Material) -> Record:
    record = origin.read(material)
    if record is None:
        message = f"{material.name} was not made by vgroove, or by a later version of it; apply a preset"
        raise MaterialError(message)
    return record


def upgrade(material: Material) -> Record:
    """What a material was built from, kept in the present format from now on; MaterialError if it cannot be changed."""
    record = _record(material)
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
    """The numbers of a material as its inputs hold them, in the working space."""
    found = {name: socket.default_value for name, socket in parameter_sockets(material).items()}
    return {name: tuple(of)[:3] if isinstance(of, Iterable) else float(of) for name, of in found.items()}


def is_edited(material: Material) -> bool:
    """Whether a material was changed since ``build`` made it."""
    state = _state_1(material) if roles.is_format_1(material) else state_of(material)
    return _record(material).state != state


def curves(material: Material) -> list[FCurve]:
    """The F-curves that play the course of a material."""
    return animation.curves_of(material, parameter_sockets(material).values())


def plays(material: Material) -> bool:
    """Whether a material changes over time."""
    return bool(curves(material)) or animation.trajectory_node(material) is not None


def preset_of(material: Material) -> Preset:
    """The preset that a material was built from, as it was then."""
    return _record(material).preset


def to_preset(material: Material) -> Preset:
    """What a material is now, as a preset: its numbers and its course, with what an artist changed in them."""
    now, record = origin_of(material).preset, _record(material)
    if not plays(material):
        return now
    if not is_edited(material):
        return replace(now, parameters=record.preset.parameters, time=record.preset.time)
    known = record.preset.time or Timeline("share", 0.0, 1.0, "authored", {})
    laws: dict[str, dict[str, Any]] = {}
    starts: dict[str, Any] = {}
    courses = animation.courses(material, parameter_sockets(material))
    for name, keys in colour_space.courses(courses, values_of(material), colour_space.of(material)).items():
        times = (known.start + keys.times * (known.end - known.start)).tolist()
        values = [tuple(of) if isinstance(of, list) else of for of in keys.values.tolist()]
        starts[name] = values[0]
        later = [(time, of) for time, of in zip(times, values, strict=True) if time > known.start]
        if later:
            laws[name] = {"law": "keys", "times": [time for time, _ in later], "values": [of for _, of in later]}
    time = replace(known, kind="authored", laws=laws) if laws else None  # one key alone: it stands still
    return replace(now, parameters=now.parameters | starts, time=time)


def play(material: Material, how: Play) -> None:
    """Have a material play its preset's course, in place of one that it plays already."""
    record = upgrade(material)
    if record.preset.time is None:
        message = f"{material.name}: {record.preset.id} does not change over time; choose a preset that does"
        raise MaterialError(message)
    if roles.node(material, roles.MODEL) is None:
        message = f"{material.name}: its node group was deleted; press Reset to Preset, which makes it again"
        raise MaterialError(message)
    edited = is_edited(material)
    animation.remove(material, parameter_sockets(material))
    record = replace(record, play=how)
    animate(material, record)
    origin.write(material, record if edited else replace(record, state=state_of(material)))


def stop(material: Material) -> None:
    """Take a material's course away; it stays as the current frame shows it."""
    record = upgrade(material)
    animation.remove(material, parameter_sockets(material))
    origin.write(material, replace(record, play=None))


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
    if (course := animation.trajectory_node(material)) is not None:
        values.append([TRAJECTORY, str(trajectory.keys_of(course.node_tree))])
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
    if (course := animation.trajectory_node(material)) is not None:
        values.append(str(trajectory.keys_of(course.node_tree)))
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
    built = {name: held(name, of) for name, of in _record(material).preset.parameters.items()}
    read = colour_space.read(values_of(material), built, colour_space.of(material))
    found = {}
    for name, socket in parameter_sockets(material).items():
        number = np.float32(read[name]).tolist()
        found[socket.path_from_id()] = [*number, 1.0] if socket.type == "RGBA" else number
    return found


def group_of(preset: Preset, choice: Choice) -> ShaderNodeTree:
    """The node group of the preset's model by this choice."""
    known = BUILDERS[preset.model]
    if choice.estimator not in known:
        what = f'{preset.id} is {preset.model}, which has no estimator "{choice.estimator}"'
        message = f"{what}; use one of {', '.join(known)}"
        raise MaterialError(message)
    if choice.lamps and not binds("direct", 0.0, preset.model):
        message = f"{preset.id} is {preset.model}, which evaluates no lamps by itself; leave lamps empty"
        raise MaterialError(message)
    fit_table.restore()  # groups that are there already may have lost it
    module = known[choice.estimator]
    name, arguments = _form(preset)
    label = f"{module.NAME} {name}".strip()
    if preset.model == "car_paint":
        label += f" {choice.estimator.title()}, {preset.lobes} lobe{'s' * (preset.lobes > 1)}"
        build_group = module.build
        base, lobe, *_ = (group_of(of, choice) for of in preset.parts().values())  # the lobes' groups are one
        arguments = {"base": base, "lobe": lobe, "lobes": preset.lobes, "averaged": choice.estimator == "fit"}
    elif preset.model == "translucent":
        label += f" {choice.estimator.title()}"
        build_group = module.build
        arguments = {"coat": group_of(preset.parts()["specular"], choice), "kind": preset.kind}
        arguments["averaged"] = choice.estimator not in UPRIGHT
    elif preset.model == "sum":
        label += f" {choice.estimator.title()}"
        build_group = module.build
        arguments = {part: group_of(of, choice) for part, of in preset.parts().items()}
        arguments["averaged"] = choice.estimator == "fit"
        if preset.coupled:
            label += " Coupled"
            arguments["coupled"] = preset.kind
    else:
        build_group = module.build if choice.backend == "nodes" else module.build_osl
        if choice.estimator not in NATIVE and preset.model != "glass":
            arguments["lamps"] = len(choice.lamps)
    if choice.lamps:
        label += f", {len(choice.lamps)} lamp{'s' * (len(choice.lamps) > 1)}"
    build = partial(build_group, **arguments)
    if choice.estimator != "closure":
        build = partial(_with_eevee, build, group_of(preset, Choice("nodes", "closure")))
    return nodegroups.ensure(label + _suffix(choice), module.REVISION, build)


def _with_eevee(build_group: Callable[[Tree], None], closure: ShaderNodeTree, tree: Tree) -> None:
    build_group(tree)
    eevee.add_closure(tree, closure)


def _form(preset: Preset) -> tuple[str, dict[str, Any]]:
    """What of the preset's kind its group's name says, and its builder has to know."""
    if preset.model == "glass":
        thin, smooth = preset.kind == "thin", preset.m == 0
        return " ".join(["Thin"] * thin + ["Smooth"] * smooth), {"thin": thin, "smooth": smooth}
    labels = oren_nayar.LABELS if preset.model == "oren_nayar" else fresnel.LABELS
    return labels[preset.kind], {"kind": preset.kind}


def _bind(tree: ShaderNodeTree, node: Node, index: int, one: Light, choice: Choice) -> None:
    slot, osl = one.slot, choice.backend == "osl"
    shadows = choice.shadows and slot.shadows and (osl or lamp.can_cast_shadows())
    make = partial(lamp.build_slot, slot=slot, shadows=shadows, osl=osl)
    name = f"VGroove Light {slot}" + ", no shadows" * (slot.shadows and not shadows) + _suffix(choice)
    source = _group_node(tree, nodegroups.ensure(name, lamp.REVISION, make), f"Light {index}: {slot}", roles.LIGHT)
    source.location = (-300, -160 * (index - 1))
    if "Stream" in source.inputs:
        source.inputs["Stream"].default_value = random_numbers.stream("LIGHT", index - 1)
    tree.links.new(source.outputs["To Lamp"], node.inputs[f"To Lamp {index}"])
    tree.links.new(source.outputs["Irradiance"], node.inputs[f"Irradiance {index}"])


def show_in_solid_view(material: Material, preset: Preset) -> None:
    """The colour head-on and the roughness, for viewports that do not run the shader."""
    values: dict[str, Any] = preset.parameters
    color = values.get("albedo") or values.get("tint") or values.get("reflectance")
    if color is None:
        color = tuple(float(channel) for channel in preset.reference_fresnel()(1.0))
    for k in range(1, preset.lobes + 1):
        color = tuple(c + values[f"s_{k}"] * f0 for c, f0 in zip(color, values[f"f0_{k}"], strict=True))
    color = colour_space.colour(color, colour_space.matrix()).tolist()
    material.diffuse_color = (*color, 0.3 if preset.transparent else 1.0)
    material.roughness = 1.0 if preset.model == "oren_nayar" else min(1.0, preset.m**0.5)


def _suffix(choice: Choice) -> str:
    return " (OSL)" if choice.backend == "osl" else ""


def _group_node(tree: ShaderNodeTree, group: ShaderNodeTree, label: str, role: str = "") -> Node:
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label, node.width = group, label, 220
    if role:
        node[roles.KEY] = role
    return node


def set_input(socket: NodeSocket, value: Any) -> None:
    socket.default_value = (*value, 1.0) if socket.type == "RGBA" else value
