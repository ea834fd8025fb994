# SPDX-License-Identifier: GPL-3.0-or-later
"""The universal material: one node tree that shows any preset of ours, whose switches are set by data alone.

It is what a material would be if nothing were left out of it: Cook-Torrance with every Fresnel term, both forms of
Oren-Nayar, the weights of a sum, further lobes, transmission, a translucent body, the terms of eight lamps and a course
over time, all made of the groups and shaders that ``material.build`` takes. For a preset and an estimator
it shows the same picture as the material that was built for them alone.

Absorption is beside it, not in it: with a density by data Cycles takes a volume for uneven, and the pictures of every
material would take several times as long for it alone. Of ``corrected`` as nodes it has four lamps' terms: with six the
values that its parts share no longer fit in SVM's stack, and the material is black. An estimator is not data either.
A parameter that some preset changes over time goes through one ramp, between the two keys around the object's age.

All numbers are properties of the object, which Attribute nodes read as a ray meets it: Cycles folds constants, and
would fold this material into the other. It is as quick as it can be made: what several kinds share is there once, and
what a Mix Shader weighs with 0, SVM jumps over. OSL has one script a model and takes its kind from the data, too.
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from math import pi
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ... import nodegroups
from ...addon.blender import course as animation
from ...addon.blender import lamps as lamp_binding
from ...addon.blender.material import BUILDERS, NATIVE, RANDOM, UPRIGHT, Choice, _bind, _group_node, parameter_sockets
from ...addon.library.checks import M_RANGE, base_name
from ...addon.library.presets import Preset, shipped
from ...nodegroups import (
    absorption,
    cook_torrance,
    cook_torrance_albedo,
    fresnel,
    lamp,
    osl_script,
    ramp,
    shading_normal,
    versions,
)
from ...nodegroups import cook_torrance_closure as closure
from ...nodegroups._tree import Value, output, select
from ...nodegroups.lamp_beams import beam_interfaces

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from bpy.types import Material, Node, NodeSocket, Object, ShaderNodeTree

    from ...addon.blender.course import Play
    from ...addon.reference.keyframes import Keyframes
    from ...nodegroups._tree import Tree

NAME = "VGroove Universal"
REVISION = 1
LOBES = 3  # as many as any of our car paints has
ANY = "any"  # the kind of Fresnel term that data choose
TERMS = {"corrected": 1, "hybrid": 1, "mirror": 3, "direct": 4}  # lights, for nodes: as many as SVM's stack holds
PARTS = ("diffuse", "body", "specular", "lobes", "transmission")
WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
NEUTRAL: dict[str, Any] = {  # each parameter, as it is where a preset has none
    "f0": BLACK, "f82_tint": WHITE, "eta": 1.5, "n": WHITE, "k": WHITE, "m": 0.3, "albedo": BLACK, "sigma": 0.0,
    "d": 0.0, "s": 0.0, "tint": WHITE, "absorption": BLACK, "reflectance": WHITE, "mean_free_path": WHITE,
}  # fmt: skip
OF_LOBES = ("f0", "f82_tint", "m", "s")
SWITCHES = ("fresnel", "qualitative", "coupled", "body", "glass", "thin", "smooth", "age")


@dataclass(frozen=True)
class Form:
    """How the universal material is evaluated; ``lamps``: how many it has terms for."""

    backend: str
    estimator: str

    @property
    def lamps(self) -> int:
        if self.estimator in NATIVE:
            return 0
        return lamp_binding.LIMIT if self.backend == "osl" else TERMS.get(self.estimator, lamp_binding.LIMIT)

    @property
    def glass(self) -> str:
        return "mirror" if self.estimator in RANDOM else "closure"


def fits() -> bool:
    """Whether it can be had of plain nodes: SVM of Blender 4.5 has no room on its stack but for ``closure``'s."""
    return versions.since(5, 0)


def form_of(choice: Choice) -> Form:
    """What ``fit`` shows, ``corrected`` does where no lamp is lit, and it can do lamps as well."""
    return Form(choice.backend, "corrected" if choice.estimator == "fit" else choice.estimator)


# The data


def data_of(preset: Preset | None, age: float = 0.0, play: Play | None = None) -> dict[str, Any]:
    """The properties that show ``preset``: at ``age`` of its course if it has one and it is played; of None nothing.

    A parameter's property ends in Before and After: its keys around ``age``, and Span, their ages.
    """
    values = {name: NEUTRAL[base_name(name)] for name in _names()}
    switches: dict[str, float] = dict.fromkeys(SWITCHES, 0.0)
    keys = {}
    if preset is not None:
        values |= {_universal_name(name): value for name, value in preset.parameters.items()}
        values["m"] = max(values["m"], M_RANGE[0])
        alone = {"cook_torrance": ("s",), "translucent": ("s",), "oren_nayar": ("d",), "car_paint": ("d",)}
        values |= dict.fromkeys(alone.get(preset.model, ()), 1.0)
        kinds = list(fresnel.KINDS)
        switches["fresnel"] = float(kinds.index(preset.kind)) if preset.kind in kinds else 0.0
        switches["qualitative"] = float(preset.kind == "qualitative")
        switches["coupled"] = float(preset.coupled or preset.model == "translucent")
        switches["body"] = float(preset.model == "translucent")
        switches["glass"], switches["thin"] = float(preset.model == "glass"), float(preset.kind == "thin")
        switches["smooth"] = float(preset.m == 0.0)
        if play is not None:
            switches["age"] = age
            keys = {_universal_name(n): of for n, of in animation.keyframes(preset.trajectory(), play).items()}
    if preset is not None and preset.kind == "thin":
        values["absorption"] = BLACK  # a sheet has no inside
    found: dict[str, Any] = {_property(name): value for name, value in switches.items()}
    for name, value in values.items():
        before, after, span = _around(keys[name], age) if name in keys else (value, value, (0.0, 1.0, 0.0))
        if base_name(name) not in _moving():
            found[_property(name)] = value
            continue
        found |= {_property(name, "before"): before, _property(name, "after"): after, _property(name, "span"): span}
    for index in range(1, lamp_binding.LIMIT + 1):
        found[_property(f"lamp {index}", "axis")] = (0.3, 0.2, 0.9)
        found[_property(f"lamp {index}", "strength")] = 0.0
    return found


def _around(keys: Keyframes, age: float) -> tuple[Any, Any, tuple[float, float, float]]:
    """The keys before and after ``age``, and their ages."""
    k = int(np.clip(np.searchsorted(keys.times, age, side="right"), 1, max(keys.times.size - 1, 1)))
    ends = (k - 1, min(k, keys.times.size - 1))
    before, after = (keys.values[end].tolist() for end in ends)
    start, end = (float(keys.times[end]) for end in ends)
    return before, after, (start, end, 0.0)


def _names() -> list[str]:
    return [*NEUTRAL, *(f"{name}_{k}" for k in range(2, LOBES + 1) for name in OF_LOBES)]


def _universal_name(parameter: str) -> str:
    """The first lobe of a car paint is the Cook-Torrance part."""
    return parameter.removesuffix("_1")


def _property(*words: str) -> str:
    return " ".join(("vgroove", *words))


def _moving() -> set[str]:
    """The parameters that some preset changes over time."""
    return {base_name(name) for preset in shipped().values() if preset.time for name in preset.time.laws}


def set_data(item: Object, data: Mapping[str, Any]) -> None:
    """Set the data of an object that has the universal material."""
    for name, value in data.items():
        item[name] = value
    item.update_tag()


# The tree


def build(choice: Choice, parts: Sequence[str] = PARTS) -> Material:
    """The universal material for the estimator, the backend and the lamps of ``choice``; ``parts``: only these.

    The lamps that ``choice`` lacks of eight are suns of no strength.
    """
    form = form_of(choice)
    made = bpy.data.materials.new(f"Universal ({form.estimator.title()})")
    versions.nodes_of(made).nodes.clear()
    output = made.node_tree.nodes.new("ShaderNodeOutputMaterial")
    _add(made, output, choice, parts)
    made.cycles.use_bump_map_correction = form.estimator in UPRIGHT
    made.cycles.emission_sampling = "NONE"
    return made


def _add(made: Material, output: Node, choice: Choice, parts: Sequence[str]) -> None:
    """Add ``parts`` to what a material shows already."""
    tree, form = made.node_tree, form_of(choice)
    title = "" if tuple(parts) == PARTS else f" {', '.join(parts).title()}"
    name = f"{NAME}{title} {form.estimator.title()}{_suffix(form)}"
    node = _group_node(tree, nodegroups.ensure(name, REVISION, partial(_build, form=form, parts=parts)), NAME)
    for socket in node.outputs:
        place = output.inputs["Volume" if socket.name == "Volume" else "Surface"]
        shown = socket
        if place.is_linked:
            both = tree.nodes.new("ShaderNodeAddShader")
            tree.links.new(place.links[0].from_socket, both.inputs[0])
            tree.links.new(socket, both.inputs[1])
            shown = both.outputs[0]
        tree.links.new(shown, place)
    if "To Lamp 1" in node.inputs:
        for index in range(1, form.lamps + 1):
            if index <= len(choice.lamps):
                _bind(tree, node, index, choice.lamps[index - 1], choice)
            else:
                _spare(tree, node, index, choice)


def _spare(tree: ShaderNodeTree, node: Node, index: int, choice: Choice) -> None:
    """A lamp that is not there: a sun, the quickest kind, whose strength is data."""
    osl = choice.backend == "osl"
    variant: dict[str, Any] = {"kind": "SUN", "shadows": choice.shadows and (osl or lamp.can_cast_shadows())}
    name = lamp.name(**variant) + " (OSL)" * osl
    group = nodegroups.ensure(name, lamp.REVISION, partial(lamp.build_osl if osl else lamp.build, **variant))
    source = _group_node(tree, group, f"Lamp {index}")
    for of, kept in (("axis", "Vector"), ("strength", "Fac")):
        datum = tree.nodes.new("ShaderNodeAttribute")
        datum.attribute_type, datum.attribute_name = "OBJECT", _property(f"lamp {index}", of)
        tree.links.new(output(datum, kept), source.inputs[of.title()])
    tree.links.new(source.outputs["To Lamp"], node.inputs[f"To Lamp {index}"])
    tree.links.new(source.outputs["Irradiance"], node.inputs[f"Irradiance {index}"])


def _build(tree: Tree, form: Form, parts: Sequence[str]) -> None:
    if form.lamps and set(parts) & {"diffuse", "specular", "lobes"}:
        beam_interfaces(tree, form.lamps)
    _Universal(tree, form).fill(parts)


class _Universal:
    """The group while it is filled: its data, each read once, and the shaders of its parts."""

    def __init__(self, tree: Tree, form: Form) -> None:
        self.tree, self.form = tree, form
        self.normal = shading_normal.interface(tree)
        self._read: dict[str, Value] = {}

    def fill(self, parts: Sequence[str]) -> None:
        tree = self.tree
        shaders: list[NodeSocket] = []
        for part in parts:
            if part != "absorption":
                with tree.frame(part):
                    shaders += getattr(self, f"_{part}")()
        if shaders:
            tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")
        if "absorption" in parts:
            group = nodegroups.ensure(absorption.NAME, absorption.REVISION, absorption.build)
            node = tree.group(group, Absorption=self.parameter("absorption"))
            tree.output_shader("Volume", node.outputs[0], tip="To the material's Volume")

    # Data

    def switch(self, name: str) -> Value:
        if name not in self._read:
            self._read[name] = _read(self.tree, _property(name), color=False)
        return self._read[name]

    def parameter(self, name: str) -> Value:
        """A parameter as it is at the object's age."""
        if name not in self._read:
            self._read[name] = _parameter(self.tree, name)
        return self._read[name]

    # Parts

    def _diffuse(self) -> list[NodeSocket]:
        d = self.parameter("d") * self._left()
        inputs = {"Base Color": self.parameter("albedo"), "Sigma": self.parameter("sigma")}
        module, qualitative = BUILDERS["oren_nayar"][self.form.estimator], self.switch("qualitative")
        if self.form.backend == "osl":
            group = self._ensure(module, "Oren-Nayar", _by_data(partial(module.build_osl, kind="full"), "kind"))
            return [self._use(group, d, inputs | {"kind": qualitative})]
        groups = [
            self._ensure(module, kind.title(), partial(module.build, kind=kind)) for kind in ("full", "qualitative")
        ]
        weights = (d * (1.0 - qualitative), d * qualitative)
        return [self._use(group, weight, inputs) for group, weight in zip(groups, weights, strict=True)]

    def _body(self) -> list[NodeSocket]:
        tree = self.tree
        radius = self.parameter("mean_free_path") * (4.0 * pi, 4.0 * pi, 4.0 * pi)
        given = {"Color": self.parameter("reflectance"), "Radius": radius, "Scale": 1.0, "Normal": self.normal}
        node = tree.node("ShaderNodeSubsurfaceScattering", falloff="RANDOM_WALK", **given)
        return [tree.weighted(output(node, "BSSRDF"), self.switch("body") * self._left())]

    def _specular(self) -> list[NodeSocket]:
        module = BUILDERS["cook_torrance"][self.form.estimator]
        inputs = {"F0": "f0", "F82 Tint": "f82_tint", "IOR": "eta", "n": "n", "k": "k", "Slope m": "m"}
        values = {label: self.parameter(name) for label, name in inputs.items()}
        osl = self.form.backend == "osl"
        with _any_kind(osl=osl):
            make = _by_data(partial(module.build_osl, kind=ANY), "kind") if osl else partial(module.build, kind=ANY)
            group = self._ensure(module, "Cook-Torrance", make)
        return [self._use(group, self.parameter("s"), values | {"kind": self.switch("fresnel")})]

    def _lobes(self) -> list[NodeSocket]:
        module = BUILDERS["cook_torrance"][self.form.estimator]
        make = module.build_osl if self.form.backend == "osl" else module.build
        group = self._ensure(module, "F82", partial(make, kind="f82"))
        labels = {"F0": "f0", "F82 Tint": "f82_tint", "Slope m": "m"}
        return [
            self._use(group, self.parameter(f"s_{k}"), {of: self.parameter(f"{n}_{k}") for of, n in labels.items()})
            for k in range(2, LOBES + 1)
        ]

    def _transmission(self) -> list[NodeSocket]:
        module, glass = BUILDERS["glass"][self.form.glass], self.switch("glass")
        inputs = {"IOR": self.parameter("eta"), "Slope m": self.parameter("m"), "Tint": self.parameter("tint")}
        thin, smooth = self.switch("thin"), self.switch("smooth")
        found = []
        if self.form.backend == "osl" and self.form.glass == "mirror":
            group = self._ensure(module, "Glass", _by_data(module.build_osl, "thin", "smooth"))
            return [self._use(group, glass, inputs | {"thin": thin, "smooth": smooth})]
        for is_smooth, weight in ((False, glass * (1.0 - smooth)), (True, glass * smooth)):
            title = f"Glass{' Smooth' * is_smooth}"
            if self.form.backend == "osl":
                group = self._ensure(module, title, _by_data(partial(module.build_osl, smooth=is_smooth), "thin"))
                found.append(self._use(group, weight, inputs | {"thin": thin}))
                continue
            for is_thin, share in ((False, 1.0 - thin), (True, thin)):
                make = partial(module.build, thin=is_thin, smooth=is_smooth)
                group = self._ensure(module, title + " Thin" * is_thin, make)
                found.append(self._use(group, weight * share, inputs))
        return found

    def _left(self) -> Value:
        """1 - s E where the parts are coupled, E the specular part's directional albedo; else 1."""
        if "left" not in self._read:
            names = ("f0", "f82_tint", "eta", "n", "k")
            values = {name: self.parameter(name) for name in names} | {"kind": self.switch("fresnel")}
            inputs = cook_torrance.Inputs(values, self.parameter("m"), self.normal)
            N = shading_normal.specular_normal(self.tree, self.normal)
            with _any_kind(osl=False):
                E = cook_torrance_albedo.directional_albedo(self.tree, ANY, inputs, N)
            self._read["left"] = 1.0 - self.switch("coupled") * (self.parameter("s") * E)
        return self._read["left"]

    def _ensure(self, module: Any, title: str, make: Callable[..., None]) -> ShaderNodeTree:
        """The group of a part, with all lamps where its estimator takes them."""
        if self.form.lamps and "Glass" not in title:
            make = partial(make, lamps=self.form.lamps)
        name = f"{NAME} {title}, {module.NAME.removeprefix('VGroove ')}{_suffix(self.form)}"
        return nodegroups.ensure(name, REVISION, make)

    def _use(self, group: ShaderNodeTree, weight: Value, inputs: Mapping[str, Value]) -> NodeSocket:
        node = self.tree.nested(group)
        for socket in node.inputs:
            lamps = socket.name.startswith(("To Lamp", "Irradiance"))
            value = self.normal if socket.name == "Normal" else inputs.get(socket.name)
            if lamps:
                value = self.tree.given(socket.name)
            if value is not None:  # Bound of hybrid stays as it is
                self.tree.connect(value, socket)
        return self.tree.weighted(node.outputs[0], weight)


def _suffix(form: Form) -> str:
    return " (OSL)" if form.backend == "osl" else ""


def _read(tree: Tree, name: str, *, color: bool) -> Value:
    node = tree.node("ShaderNodeAttribute", attribute_type="OBJECT", attribute_name=name)
    return Value(tree, output(node, "Color" if color else "Fac"))


def _parameter(tree: Tree, name: str) -> Value:
    """A parameter by the object's properties, through a ramp if some preset changes it over time."""
    color = isinstance(NEUTRAL[base_name(name)], tuple)
    if base_name(name) not in _moving():
        return _read(tree, _property(name), color=color)
    before, after = (_read(tree, _property(name, end), color=color) for end in ("before", "after"))
    start, end, _ = _read(tree, _property(name, "span"), color=True).xyz
    age = _read(tree, _property("age"), color=False)
    node = tree.group(ramp.group(color=color), Before=before, After=after, Age=age, Start=start, End=end)
    return Value(tree, node.outputs["Value"])


# The Fresnel term and the kinds that data choose


class _AnyFresnel:
    """As a module of ``fresnel.KINDS``: every term at once, of which an input chooses one."""

    NAME = f"{NAME} Fresnel"
    REVISION = REVISION
    KINDS = dict(fresnel.KINDS)

    def __init__(self, *, osl: bool) -> None:
        self._osl = osl  # there the scripts have the switch

    def interface(self, tree: Tree) -> dict[str, Value]:
        f82, dielectric, conductor = (self.KINDS[kind].interface(tree) for kind in ("f82", "dielectric", "conductor"))
        kind = {} if self._osl else {"kind": _kind_input(tree)}
        return f82 | dielectric | conductor | kind

    def build(self, tree: Tree) -> None:
        parameters = self.interface(tree)
        cosine = tree.input_float("Cosine", 1.0, low=0.0, high=1.0, tip="wo . h, view against half vector")
        F: Value | None = None
        for index, kind in enumerate(self.KINDS):
            of = fresnel.reflectance(tree, kind, _of_kind(kind, parameters), cosine)
            F = of if F is None else select(_is(parameters["kind"], index), of, F)
        assert F is not None  # noqa: S101 - there are kinds
        tree.output_color("F", F, tip="Fresnel reflectance")


def _kind_input(tree: Tree, name: str = "kind") -> Value:
    tree.input_float(name, 0.0, low=0.0, high=10.0, tip="Which of several, by number")
    return tree.given(name)  # after a panel it is not the last


def _is(value: Value, index: int) -> Value:
    return value.tree.math("COMPARE", value, float(index), 0.5)


def _of_kind(kind: str, parameters: Mapping[str, Value]) -> dict[str, Value]:
    names = {"schlick": ("f0",), "dielectric": ("eta",), "conductor": ("n", "k"), "f82": ("f0", "f82_tint")}[kind]
    return {name: parameters[name] for name in names}


@contextmanager
def _any_kind(*, osl: bool) -> Iterator[None]:
    """While groups are built here, there is a further kind of Fresnel term: ``ANY``."""
    native = closure.lobe

    def lobe(tree: Tree, kind: str, parameters: dict[str, Value], *shape: Value) -> NodeSocket:
        """Cycles' own lobe of each kind, all but one weighted with 0."""
        if kind != ANY:
            return native(tree, kind, parameters, *shape)
        return tree.add_shaders([
            tree.weighted(native(tree, of, _of_kind(of, parameters), *shape), _is(parameters["kind"], index))
            for index, of in enumerate(_AnyFresnel.KINDS)
        ])  # fmt: skip

    fresnel.KINDS[ANY] = _AnyFresnel(osl=osl)  # type: ignore[assignment]
    closure.lobe = lobe  # type: ignore[assignment]
    try:
        yield
    finally:
        closure.lobe = native
        del fresnel.KINDS[ANY]


def _by_data(make: Callable[..., None], *parameters: str) -> Callable[..., None]:
    """A group of OSL shaders that takes these of their parameters, which else are constants, by inputs."""

    def build_open(tree: Tree, **arguments: Any) -> None:
        make(tree, **arguments)
        for name in parameters:
            value = _kind_input(tree, name)
            for node in tree.node_tree.nodes:
                if node.bl_idname == "ShaderNodeScript":
                    tree.connect(value, osl_script.socket(node, name))

    return build_open


# One thing that was left out, put back


def with_part(made: Material, choice: Choice, part: str) -> Material:
    """A copy of a material of ours with one of ``PARTS`` beside it, or "lamps", weighted with 0 by data."""
    copy = made.copy()
    output = next(n for n in copy.node_tree.nodes if n.bl_idname == "ShaderNodeOutputMaterial" and n.target != "EEVEE")
    how = choice
    if part == "lamps":
        part, how = "specular", Choice(choice.backend, "direct")
    elif part == "random":
        part, how = "specular", Choice(choice.backend, "mirror")
    _add(copy, output, Choice(how.backend, how.estimator), (part,))
    copy.cycles.emission_sampling = "NONE"
    return copy


def with_time(made: Material) -> Material:
    """A copy of a material of ours whose parameters come from data, by way of ramps over the object's age."""
    copy = made.copy()
    sockets = parameter_sockets(copy)

    def outputs(tree: Tree) -> None:
        for name in sockets:
            known = _universal_name(name)
            make = tree.output_color if isinstance(NEUTRAL[base_name(known)], tuple) else tree.output_float
            make(name, _parameter(tree, known), tip="At the object's age")

    node = _group_node(copy.node_tree, nodegroups.make(f"{NAME} Time", REVISION, outputs), NAME)
    for name, socket in sockets.items():
        copy.node_tree.links.new(node.outputs[name], socket)
    return copy


def without_eevee(made: Material) -> Material:
    """A copy of a material of ours without what EEVEE shows."""
    copy = made.copy()
    for node in list(copy.node_tree.nodes):
        if node.bl_idname == "ShaderNodeOutputMaterial" and node.target == "EEVEE":
            copy.node_tree.nodes.remove(node)
    return copy
