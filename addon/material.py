# SPDX-License-Identifier: GPL-3.0-or-later
"""Preset + estimator + backend -> a Blender material that holds only the nodes which it needs."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import bpy

from .. import nodegroups
from ..nodegroups import (
    cook_torrance_closure,
    cook_torrance_corrected,
    cook_torrance_direct,
    cook_torrance_fit,
    cook_torrance_hybrid,
    cook_torrance_mirror,
    eevee,
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
)
from ..nodegroups import sum as sum_group
from . import lamps as lamp_binding
from .presets import M_RANGE
from .reference.hybrid import BOUNDS, DEFAULT_BOUND

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import Material, Node, Object, ShaderNodeTree

    from ..nodegroups._tree import Tree
    from .presets import Preset

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
}
UPRIGHT = {"closure", "direct"}  # estimators whose closures do not lean: others would be bent by Bump Map Correction
NATIVE = ("fit", "closure")  # of Cycles' own closures, which see every lamp
RANDOM = ("hybrid", "mirror")  # of facets that are drawn for each sample
EVERY_LAMP = ("corrected", "direct")  # what evaluates the formula at bound lamps of any size
KEY = "vgroove"  # custom property on a material: what it was built from
STATE = "vgroove_state"  # its inputs as built, to tell whether an artist changed them since


def binds(estimator: str, lamp_size: float, model: str = "cook_torrance") -> bool:
    """Whether a material by ``estimator`` evaluates the formula itself at a lamp of this size.

    ``mirror`` and ``hybrid`` do so where it is 0, as their random rays cannot hit such a lamp; glass never does.
    """
    if "direct" not in BUILDERS[model]:
        return False
    return estimator in EVERY_LAMP or (estimator not in NATIVE and lamp_size == 0.0)


class MaterialError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


@dataclass(frozen=True)
class Choice:
    """How a preset becomes a material.

    lamps: those that are evaluated by the formula: all of ``direct`` and ``corrected``, and beside ``mirror`` and
    ``hybrid`` those of zero size, which no ray can hit. shadows: whether these lamps cast any.
    bound: how much of the directional albedo ``hybrid`` may have wrong.
    """

    backend: str = "nodes"
    estimator: str = "fit"
    lamps: tuple[Object, ...] = ()
    shadows: bool = True
    bound: float = DEFAULT_BOUND

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


def build(preset: Preset, choice: Choice) -> Material:
    """The material of ``preset`` by ``choice``.

    Idempotent: if this .blend holds one that was built the same way and not edited since, that one is returned.
    An edited one is left alone and a new one is made beside it.
    """
    key = _key(preset, choice)
    for material in bpy.data.materials:
        if material.get(KEY) == key and material.get(STATE) == _state(material) and material.library is None:
            return material
    group = _group(preset, choice)  # may refuse: nothing is made before it
    material = bpy.data.materials.new(f"{preset.name} ({choice.estimator.title()})")
    if bpy.app.version < (5, 0, 0):  # 4.5 has no tree until use_nodes is set; 5.x warns when it is. Goes with 4.5 LTS.
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = _group_node(tree, group, preset.name)
    for name, value in preset.parameters.items():
        if SOCKETS[name] in node.inputs:  # smooth glass has no slope
            # m = 0, a smooth interface, is what float32 can hold of it
            _set(node, SOCKETS[name], max(preset.m, M_RANGE[0]) if name == "m" else value)
    if choice.estimator == "hybrid":
        _set(node, "Bound", choice.bound)
    for index, one in enumerate(choice.lamps, 1):
        _bind(tree, node, index, one, choice)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (300, 0)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    if eevee.OUTPUT in node.outputs:
        output.target = "CYCLES"
        shown = tree.nodes.new("ShaderNodeOutputMaterial")
        shown.target, shown.location = "EEVEE", (300, -160)
        tree.links.new(node.outputs[eevee.OUTPUT], shown.inputs["Surface"])
    _show_in_solid_view(material, preset)
    material.cycles.use_bump_map_correction = choice.estimator in UPRIGHT
    material.cycles.emission_sampling = "NONE" if choice.lamps else "AUTO"
    material[KEY] = key
    material[STATE] = _state(material)
    return material


# Reference name -> group input
SOCKETS = {"m": "Slope m", "f0": "F0", "eta": "IOR", "n": "n", "k": "k"}
SOCKETS |= {"albedo": "Base Color", "sigma": "Sigma", "tint": "Tint", "d": "Diffuse", "s": "Specular"}


def apply(material: Material, objects: Sequence[Object]) -> int:
    """Give ``material`` to the active slot of each object that can have one; returns how many took it."""
    count = 0
    for item in objects:
        if item.type not in {"MESH", "CURVE", "SURFACE", "META", "FONT", "POINTCLOUD", "CURVES", "VOLUME"}:
            continue
        if item.material_slots:
            item.active_material = material
        else:
            item.data.materials.append(material)
        count += 1
    return count


def _key(preset: Preset, choice: Choice) -> str:
    bound = [
        [one.name, lamp_binding.kind(one), lamp_binding.size(one) > 0, choice.shadows and one.data.use_shadow]
        for one in choice.lamps
    ]
    of_preset = [preset.id, preset.kind, preset.coupled, preset.parameters]
    more = [choice.bound] if choice.estimator == "hybrid" else []
    return json.dumps([*of_preset, choice.backend, choice.estimator, bound, *more])


def _state(material: Material) -> str:
    """The inputs that artists can turn, and what is linked, as one comparable text."""
    values = []
    for node in sorted(material.node_tree.nodes, key=lambda node: node.name):
        driven = node.label.startswith("Lamp")
        for socket in node.inputs:
            value = getattr(socket, "default_value", None)
            plain = [round(float(part), 7) for part in value] if isinstance(value, Iterable) else value
            values.append(
                [node.name, socket.name, None if driven else plain, [link.from_node.name for link in socket.links]]
            )
    return json.dumps(values)


def _group(preset: Preset, choice: Choice) -> ShaderNodeTree:
    """The node group of the preset's model by this choice."""
    known = BUILDERS[preset.model]
    if choice.estimator not in known:
        what = f'{preset.id} is {preset.model}, which has no estimator "{choice.estimator}"'
        message = f"{what}; use one of {', '.join(known)}"
        raise MaterialError(message)
    if choice.lamps and not binds("direct", 0.0, preset.model):
        message = f"{preset.id} is {preset.model}, which evaluates no lamps by itself; leave lamps empty"
        raise MaterialError(message)
    module = known[choice.estimator]
    name, arguments = _form(preset)
    label = f"{module.NAME} {name}".strip()
    if preset.model == "sum":
        label += f" {choice.estimator.title()}"
        build_group = module.build
        arguments = {part: _group(of, choice) for part, of in preset.parts().items()}
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
        build = partial(_with_eevee, build, _group(preset, Choice("nodes", "closure")))
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


def _bind(tree: ShaderNodeTree, node: Node, index: int, one: Object, choice: Choice) -> None:
    traced = choice.shadows and one.data.use_shadow and (choice.backend == "osl" or lamp.can_cast_shadows())
    variant: dict[str, Any] = {"kind": lamp_binding.kind(one), "shadows": traced, "sized": lamp_binding.size(one) > 0}
    make = lamp.build if choice.backend == "nodes" else lamp.build_osl
    group = nodegroups.ensure(lamp.name(**variant) + _suffix(choice), lamp.REVISION, partial(make, **variant))
    source = _group_node(tree, group, f"Lamp {index}: {one.name}")
    source.location = (-300, -540 * (index - 1))
    lamp_binding.bind(source, one, index - 1)
    tree.links.new(source.outputs["To Lamp"], node.inputs[f"To Lamp {index}"])
    tree.links.new(source.outputs["Irradiance"], node.inputs[f"Irradiance {index}"])


def _show_in_solid_view(material: Material, preset: Preset) -> None:
    """The colour head-on and the roughness, for viewports that do not run the shader."""
    values: dict[str, Any] = preset.parameters
    color = values.get("albedo") or values.get("tint")
    if color is None:
        color = tuple(float(channel) for channel in preset.reference_fresnel()(1.0))
    material.diffuse_color = (*color, 0.3 if preset.transparent else 1.0)
    material.roughness = 1.0 if preset.model == "oren_nayar" else min(1.0, preset.m**0.5)


def _suffix(choice: Choice) -> str:
    return " (OSL)" if choice.backend == "osl" else ""


def _group_node(tree: ShaderNodeTree, group: ShaderNodeTree, label: str) -> Node:
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree, node.label, node.width = group, label, 220
    return node


def _set(node: Node, name: str, value: Any) -> None:
    socket = node.inputs[name]
    socket.default_value = (*value, 1.0) if socket.type == "RGBA" else value
