# SPDX-License-Identifier: GPL-3.0-or-later
"""Preset + estimator + backend -> a Blender material that holds only the nodes which it needs."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import bpy

from ... import nodegroups
from ...nodegroups import eevee, lamp, random_numbers, versions
from ..models import label
from ..models.estimators import ALL as ESTIMATORS
from ..models.estimators import EVERY_LIGHT, NATIVE, RANDOM, UPRIGHT
from . import colour_space, course, origin, roles
from . import lamps as lamp_binding
from .choice import BACKENDS, Choice, MaterialError, bindable, binds, lamps_to_bind
from .groups import BUILDERS, absorption_group, group_of, suffix
from .inputs import give
from .origin import Record
from .reading import (
    CURVE,
    TRAJECTORY,
    Origin,
    bound_slots,
    curves,
    is_edited,
    is_ours,
    locked,
    origin_of,
    parameter_sockets,
    plays,
    preset_of,
    state_of,
    to_preset,
    upgrade,
    values_of,
)

if TYPE_CHECKING:
    from bpy.types import Material, Node, ShaderNodeTree

    from ..library.presets import Preset
    from .course import Play
    from .lamps import Light

__all__ = [  # the front of this room: what others need of a material, they take from here
    "BACKENDS", "BUILDERS", "CURVE", "ESTIMATORS", "EVERY_LIGHT", "NATIVE", "RANDOM", "TRAJECTORY", "UPRIGHT",
    "Choice", "MaterialError", "Origin", "absorbs", "absorption_group", "add_model", "animate", "bind_lights",
    "bindable", "binds", "bound_slots", "build", "curves", "fill", "group_of", "is_edited", "is_ours", "lamps_to_bind",
    "locked", "numbers_of", "origin_of", "parameter_sockets", "play", "plays", "preset_of", "record_of", "set_up",
    "show_in_eevee", "show_in_solid_view", "state_of", "stop", "to_preset", "upgrade", "values_of",
    "write_numbers",
]  # fmt: skip


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
    disperses = choice.disperses and preset.can_disperse  # also in a Blender that cannot, for one that can
    return Record(
        preset, choice.backend, choice.estimator, choice.bound, choice.shadows, lights, choice.play,
        disperses=disperses, bounces=choice.bounces and preset.can_bounce,
    )  # fmt: skip


def _is_built_so(material: Material, record: Record, group: ShaderNodeTree) -> bool:
    """Whether a material was built from the same, of the same group, and nobody edited it since."""
    kept = origin.read(material)
    if kept is None or kept.preset.id != record.preset.id or material.library is not None:
        return False
    node = roles.node(material, roles.MODEL)
    same = node is not None and node.node_tree == group and kept.builds() == record.builds()
    return same and not colour_space.is_stale(material) and not is_edited(material)


def fill(
    material: Material, preset: Preset, choice: Choice, group: ShaderNodeTree, *, keep_nodes: bool = False
) -> None:
    """The material as it is at the start of its course."""
    tree = versions.nodes_of(material)
    if not keep_nodes:
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
    write_numbers(node, preset)
    colour_space.mark(material)
    if choice.estimator == "hybrid":
        node.inputs["Bound"].default_value = choice.bound
    bind_lights(material, node, choice)
    return node


def write_numbers(node: Node, preset: Preset) -> None:
    """Give a model's node a preset's parameters."""
    for name, value in numbers_of(preset).items():
        if (text := label(preset.model, name)) in node.inputs:  # smooth glass has no roughness
            give(name, node.inputs[text], value)


def numbers_of(preset: Preset) -> dict[str, Any]:
    """A preset's parameters in the open file's working space."""
    return colour_space.to_space(preset.parameters, colour_space.matrix())


def bind_lights(material: Material, node: Node, choice: Choice) -> None:
    """Link the lights of ``choice`` to a model's node, and have their scene tell of them."""
    for scene in {one.scene for one in choice.lamps}:
        lamp_binding.follow(scene)
    for index, one in enumerate(choice.lamps, 1):
        _bind(material.node_tree, node, index, one, choice)


def set_up(material: Material, preset: Preset, choice: Choice) -> None:
    """The material's own settings that the estimator needs, and EEVEE to look through what bends light."""
    material.cycles.use_bump_map_correction = choice.estimator in UPRIGHT | preset.spec.upright
    material.cycles.emission_sampling = "NONE" if choice.lamps else "AUTO"
    material.use_raytrace_refraction = preset.refracts


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
        laws = colour_space.course(preset.trajectory(), preset.parameters, colour_space.matrix())
        course.animate(material, sockets, laws, record.play, preset.name, record.backend)


def absorbs(preset: Preset) -> bool:
    """Whether light loses something on its way through the material: a sheet has no inside, and white takes nothing."""
    taken = preset.parameters.get("absorption", 0.0)
    return not preset.is_sheet and isinstance(taken, tuple) and any(taken)


def _absorb(tree: ShaderNodeTree, output: Node, taken: Any) -> None:
    node = _group_node(tree, absorption_group(), "Absorption", roles.ABSORPTION)
    node.location = (0, -320)
    give("absorption", node.inputs["Absorption"], taken)
    tree.links.new(node.outputs[0], output.inputs["Volume"])


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
    course.remove(material, parameter_sockets(material))
    record = replace(record, play=how)
    animate(material, record)
    origin.write(material, record if edited else replace(record, state=state_of(material)))


def stop(material: Material) -> None:
    """Take a material's course away; it stays as the current frame shows it."""
    record = upgrade(material)
    course.remove(material, parameter_sockets(material))
    origin.write(material, replace(record, play=None))


def _bind(tree: ShaderNodeTree, node: Node, index: int, one: Light, choice: Choice) -> None:
    slot, osl = one.slot, choice.backend == "osl"
    shadows = choice.shadows and slot.shadows and (osl or lamp.can_cast_shadows())
    make = partial(lamp.build_slot, slot=slot, shadows=shadows, osl=osl)
    name = f".VGroove Light {slot}" + ", no shadows" * (slot.shadows and not shadows) + suffix(choice)
    source = _group_node(tree, nodegroups.ensure(name, lamp.REVISION, make), f"Light {index}: {slot}", roles.LIGHT)
    source.location = (-300, -160 * (index - 1))
    if "Stream" in source.inputs:
        source.inputs["Stream"].default_value = random_numbers.stream("LIGHT", index - 1)
    tree.links.new(source.outputs["To Lamp"], node.inputs[f"To Lamp {index}"])
    tree.links.new(source.outputs["Irradiance"], node.inputs[f"Irradiance {index}"])


def show_in_solid_view(material: Material, preset: Preset) -> None:
    """The colour head-on and the roughness, for viewports that do not run the shader."""
    color = colour_space.colour(preset.solid, colour_space.matrix()).tolist()
    material.diffuse_color = (*color, 0.3 if preset.transparent else 1.0)
    material.roughness = preset.roughness


def _group_node(tree: ShaderNodeTree, group: ShaderNodeTree, label: str, role: str = "") -> Node:
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label, node.width = group, label, 220
    node.show_options = False  # the menu of all node groups, in which this one has an internal name
    if role:
        node[roles.KEY] = role
    return node
