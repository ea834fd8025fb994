# SPDX-License-Identifier: GPL-3.0-or-later
"""Preset + estimator + backend -> a Blender material that holds only the nodes which it needs."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import bpy

from .. import nodegroups
from ..nodegroups import (
    absorption,
    car_paint,
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
    trajectory,
    translucent,
)
from ..nodegroups import sum as sum_group
from . import animation
from . import lamps as lamp_binding
from .animation import Play
from .preset_checks import M_RANGE, base_name
from .presets import TRANSPARENT, Preset, all_presets
from .reference.hybrid import BOUNDS, DEFAULT_BOUND
from .timeline import Timeline

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from bpy.types import FCurve, Material, Node, NodeSocket, Object, Scene, ShaderNodeTree

    from ..nodegroups._tree import Tree

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
RANDOM = ("hybrid", "mirror")  # of facets that are drawn for each sample
EVERY_LAMP = ("corrected", "direct")  # what evaluates the formula at bound lamps of any size
KEY = "vgroove"  # custom property on a material: what it was built from
ABSORPTION = "Absorption"  # label of the node beside the model's
STATE = "vgroove_state"  # its inputs as built, to tell whether an artist changed them since
TIME = "vgroove_time"  # of a material that changes: how its course was played when it was built


def binds(estimator: str, lamp_size: float, model: str = "cook_torrance") -> bool:
    """Whether a material by ``estimator`` evaluates the formula itself at a lamp of this size.

    ``mirror`` and ``hybrid`` do so where it is 0, as their random rays cannot hit such a lamp; glass never does.
    """
    if model in TRANSPARENT:
        return False
    return estimator in EVERY_LAMP or (estimator not in NATIVE and lamp_size == 0.0)


def lamps_to_bind(scene: Scene, estimator: str, model: str = "cook_torrance") -> tuple[Object, ...]:
    """The strongest lamps that the material evaluates itself, as ``binds`` says for their size."""
    followed = [item for item in lamp_binding.of_scene(scene) if lamp_binding.refusal(item) is None]
    return tuple(item for item in followed if binds(estimator, lamp_binding.size(item), model))[: lamp_binding.LIMIT]


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
    lamps: tuple[Object, ...] = ()
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
    key, course = _key(preset, choice), _course_key(preset, choice.play)
    for material in bpy.data.materials if into is None else ():
        if (material.get(KEY), material.get(TIME)) != (key, course) or material.library is not None:
            continue
        if not is_edited(material):
            return material
    material = _build(preset, choice, into)
    material[KEY] = key
    if choice.play is not None:
        material[TIME] = course
        try:
            _animate(material, preset, choice.play)
        except Exception:  # a material whose course cannot be built does not stay behind half made
            bpy.data.materials.remove(material)
            raise
    material[STATE] = _state(material)
    return material


def _build(preset: Preset, choice: Choice, into: Material | None) -> Material:
    """The material as it is at the start of its course."""
    group = _group(preset, choice)  # may refuse: nothing is made before it
    name = f"{preset.name} ({choice.estimator.title()})"
    material = into or bpy.data.materials.new(name)
    if KEY in material:
        stop(material)
        material.node_tree.animation_data_clear()
        material.name = name
    if bpy.app.version < (5, 0, 0):  # 4.5 has no tree until use_nodes is set; 5.x warns when it is. Goes with 4.5 LTS.
        material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    node = _group_node(tree, group, preset.name)
    for name, value in preset.parameters.items():
        if socket_name(name) in node.inputs:  # smooth glass has no slope
            # m = 0, a smooth interface, is what float32 can hold of it
            _set(node, socket_name(name), max(value, M_RANGE[0]) if base_name(name) == "m" else value)
    if choice.estimator == "hybrid":
        _set(node, "Bound", choice.bound)
    for index, one in enumerate(choice.lamps, 1):
        _bind(tree, node, index, one, choice)
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    output.location = (300, 0)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    if absorbs(preset):
        _absorb(tree, output, preset.parameters["absorption"])
    if eevee.OUTPUT in node.outputs:
        output.target = "CYCLES"
        shown = tree.nodes.new("ShaderNodeOutputMaterial")
        shown.target, shown.location = "EEVEE", (300, -160)
        tree.links.new(node.outputs[eevee.OUTPUT], shown.inputs["Surface"])
    _show_in_solid_view(material, preset)
    upright = UPRIGHT | {"fit"} if preset.model == "oren_nayar" else UPRIGHT
    material.cycles.use_bump_map_correction = choice.estimator in upright
    material.cycles.emission_sampling = "NONE" if choice.lamps else "AUTO"
    return material


def _animate(material: Material, preset: Preset, play: Play) -> None:
    """Have the material play the preset's course."""
    sockets, course, backend = parameter_sockets(material), preset.trajectory(), json.loads(material[KEY])[5]
    animation.animate(material, {name: sockets[name] for name in course.laws}, course, play, preset.name, backend)


def _course_key(preset: Preset, play: Play | None) -> str | None:
    """What the material's course was built from."""
    if play is None or preset.time is None:
        return None
    return json.dumps({"play": asdict(play), "time": asdict(preset.time)})


def absorbs(preset: Preset) -> bool:
    """Whether light loses something on its way through the material: a sheet has no inside, and white takes nothing."""
    taken = preset.parameters.get("absorption", 0.0)
    return preset.kind != "thin" and isinstance(taken, tuple) and any(taken)


def _absorb(tree: ShaderNodeTree, output: Node, taken: Any) -> None:
    group = nodegroups.ensure(absorption.NAME, absorption.REVISION, absorption.build)
    node = _group_node(tree, group, ABSORPTION)
    node.location = (0, -320)
    _set(node, "Absorption", taken)
    tree.links.new(node.outputs[0], output.inputs["Volume"])


# Reference name -> group input
SOCKETS = {"m": "Slope m", "f0": "F0", "f82_tint": "F82 Tint", "eta": "IOR", "n": "n", "k": "k"}
SOCKETS |= {"albedo": "Base Color", "sigma": "Sigma", "tint": "Tint", "d": "Diffuse", "s": "Specular"}
SOCKETS |= {"absorption": "Absorption", "reflectance": "Reflectance", "mean_free_path": "Mean Free Path"}


def socket_name(parameter: str) -> str:
    """The group input of a parameter: "Slope m" of m, "Lobe 2 Slope m" of m_2."""
    base = base_name(parameter)
    return SOCKETS[base] if base == parameter else f"Lobe {parameter.removeprefix(base)[1:]} {SOCKETS[base]}"


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
    of_preset = [preset.id, preset.model, preset.kind, preset.coupled, preset.parameters]
    more = [choice.bound] if choice.estimator == "hybrid" else []
    return json.dumps([*of_preset, choice.backend, choice.estimator, bound, *more])


@dataclass(frozen=True)
class Origin:
    """What a material was built from, with the numbers that it has now.

    ``plain``: nothing was linked to it since, and its course, if it has one, is as it was built.
    """

    preset: Preset
    backend: str
    estimator: str
    bound: float
    plain: bool


def parameter_sockets(material: Material) -> dict[str, NodeSocket]:
    """The inputs that hold the parameters of a material that ``build`` made, by their reference names.

    Smooth glass and the like have no input for their slope.
    """
    parameters = json.loads(material[KEY])[4]
    groups = [node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeGroup"]
    inputs = {
        socket.name: socket for one in groups if _is_model(one) or one.label == ABSORPTION for socket in one.inputs
    }
    found = {name: inputs[socket_name(name)] for name in parameters if socket_name(name) in inputs}
    return {name: socket for name, socket in found.items() if base_name(name) != "m" or parameters[name] != 0.0}


def origin_of(material: Material) -> Origin:
    """The preset and choice behind a material that ``build`` made; the numbers are read from its group's inputs."""
    identity, model, kind, coupled, parameters, backend, estimator, _, *bound = json.loads(material[KEY])
    node = next(node for node in material.node_tree.nodes if node.bl_idname == "ShaderNodeGroup" and _is_model(node))
    now = {name: tuple(value) if isinstance(value, list) else value for name, value in parameters.items()}
    for name, socket in parameter_sockets(material).items():
        value = socket.default_value
        now[name] = tuple(value)[:3] if isinstance(value, Iterable) else float(value)
    known = all_presets().get(identity)
    source = known.source if known else {"data": "unknown"}
    preset = Preset(identity, node.label, model, kind, now, source, coupled=coupled)
    limit = node.inputs["Bound"].default_value if "Bound" in node.inputs else next(iter(bound), DEFAULT_BOUND)
    linked = {link.from_node for socket in node.inputs for link in socket.links}
    ours = all(one.label.startswith("Lamp ") or one.label == animation.LABEL for one in linked)
    plain = ours and not (TIME in material and is_edited(material))  # an edited course could not be made again
    return Origin(preset, backend, estimator, float(limit), plain=plain)


def is_edited(material: Material) -> bool:
    """Whether a material that ``build`` made was changed since."""
    return bool(material[STATE] != _state(material))


def reset(material: Material) -> None:
    """Give a material that ``build`` made the numbers again that it was built with, and its course."""
    parameters = _parameters_of(material)
    sockets = parameter_sockets(material)
    animation.remove(material, sockets)
    for name, socket in sockets.items():
        _set(socket.node, socket.name, parameters[name])
    if (played := course_of(material)) is not None:
        _animate(material, *played)
    _show_in_solid_view(material, origin_of(material).preset)


def curves(material: Material) -> list[FCurve]:
    """The F-curves that play the course of a material that ``build`` made."""
    return animation.curves_of(material, parameter_sockets(material).values())


def plays(material: Material) -> bool:
    """Whether a material that ``build`` made changes over time."""
    return bool(curves(material)) or animation.trajectory_node(material) is not None


def preset_of(material: Material) -> Preset:
    """The preset that a material came from, as it was then, with its course where the presets of today have one."""
    if (played := course_of(material)) is not None:
        return played[0]
    origin = origin_of(material).preset
    same = all_presets().get(origin.id)
    parameters = _parameters_of(material)
    fits = same is not None and same.time is not None and set(same.time.laws) <= set(parameters)
    return replace(origin, parameters=parameters, time=same.time if same and fits else None)


def kept(material: Material) -> Preset:
    """What a material is now, as a preset: its numbers and its course, with what an artist changed in them."""
    now, built = origin_of(material).preset, preset_of(material)
    if not plays(material):
        return now
    if not is_edited(material):
        return built
    known = built.time or Timeline("share", 0.0, 1.0, "authored", {})
    laws: dict[str, dict[str, Any]] = {}
    starts: dict[str, Any] = {}
    for name, keys in animation.courses(material, parameter_sockets(material)).items():
        times = (known.start + keys.times * (known.end - known.start)).tolist()
        values = [tuple(of) if isinstance(of, list) else of for of in keys.values.tolist()]
        starts[name] = values[0]
        later = [(time, of) for time, of in zip(times, values, strict=True) if time > known.start]
        if later:
            laws[name] = {"law": "keys", "times": [time for time, _ in later], "values": [of for _, of in later]}
    return replace(now, parameters=now.parameters | starts, time=replace(known, kind="authored", laws=laws))


def play(material: Material, how: Play) -> None:
    """Have a material that ``build`` made play its preset's course, in place of one that it plays already."""
    preset = preset_of(material)
    if preset.time is None:
        message = f"{material.name}: {preset.id} does not change over time; choose a preset that does"
        raise MaterialError(message)
    edited = is_edited(material)
    animation.remove(material, parameter_sockets(material))
    _animate(material, preset, how)
    material[TIME] = _course_key(preset, how)
    if not edited:
        material[STATE] = _state(material)


def stop(material: Material) -> None:
    """Take a material's course away; it stays as the current frame shows it."""
    animation.remove(material, parameter_sockets(material))
    if TIME in material:
        del material[TIME]


def _parameters_of(material: Material) -> dict[str, Any]:
    """The numbers that a material was built with."""
    kept = json.loads(material[KEY])[4]
    return {name: tuple(value) if isinstance(value, list) else value for name, value in kept.items()}


def course_of(material: Material) -> tuple[Preset, Play] | None:
    """The preset whose course a material was built to play, and how; None of a material that stands still."""
    if TIME not in material:
        return None
    kept = json.loads(material[TIME])
    preset = replace(origin_of(material).preset, parameters=_parameters_of(material), time=Timeline(**kept["time"]))
    return preset, Play(**kept["play"])


def _is_model(node: Node) -> bool:
    return not node.label.startswith("Lamp ") and node.label not in {ABSORPTION, animation.LABEL}


def _state(material: Material) -> str:
    """The inputs that artists can turn, and what is linked, as one comparable text."""
    values: list[Any] = []
    found = curves(material)
    moving = {curve.data_path for curve in found}
    for curve in found:
        keys = [[round(float(part), 5) for part in point.co] for point in curve.keyframe_points]
        values.append([curve.data_path, curve.array_index, keys])
    if (course := animation.trajectory_node(material)) is not None:
        values.append(str(trajectory.keys_of(course.node_tree)))
    for node in sorted(material.node_tree.nodes, key=lambda node: node.name):
        for socket in node.inputs:
            driven = node.label.startswith("Lamp") or f"{socket.path_from_id()}.default_value" in moving
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
    if preset.model == "car_paint":
        label += f" {choice.estimator.title()}, {preset.lobes} lobe{'s' * (preset.lobes > 1)}"
        build_group = module.build
        base, lobe, *_ = (_group(of, choice) for of in preset.parts().values())  # the lobes' groups are one
        arguments = {"base": base, "lobe": lobe, "lobes": preset.lobes, "averaged": choice.estimator == "fit"}
    elif preset.model == "translucent":
        label += f" {choice.estimator.title()}"
        build_group = module.build
        arguments = {"coat": _group(preset.parts()["specular"], choice), "kind": preset.kind}
        arguments["averaged"] = choice.estimator not in UPRIGHT
    elif preset.model == "sum":
        label += f" {choice.estimator.title()}"
        build_group = module.build
        arguments = {part: _group(of, choice) for part, of in preset.parts().items()}
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
    lamp_binding.bind(source, one, index - 1, only_pointlike=choice.estimator in RANDOM)
    tree.links.new(source.outputs["To Lamp"], node.inputs[f"To Lamp {index}"])
    tree.links.new(source.outputs["Irradiance"], node.inputs[f"Irradiance {index}"])


def _show_in_solid_view(material: Material, preset: Preset) -> None:
    """The colour head-on and the roughness, for viewports that do not run the shader."""
    values: dict[str, Any] = preset.parameters
    color = values.get("albedo") or values.get("tint") or values.get("reflectance")
    if color is None:
        color = tuple(float(channel) for channel in preset.reference_fresnel()(1.0))
    for k in range(1, preset.lobes + 1):
        color = tuple(c + values[f"s_{k}"] * f0 for c, f0 in zip(color, values[f"f0_{k}"], strict=True))
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
