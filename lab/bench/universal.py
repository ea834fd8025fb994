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

from dataclasses import dataclass
from functools import partial
from math import pi
from typing import TYPE_CHECKING, Any

from ... import nodegroups
from ...addon.blender import lamps as lamp_binding
from ...addon.blender.material import BUILDERS, NATIVE, RANDOM, UPRIGHT, Choice, _bind, _group_node, parameter_sockets
from ...addon.models import MODELS, base_name, label, parameter, symbol
from ...nodegroups import absorption, cook_torrance, cook_torrance_albedo, lamp, ramp, shading_normal, versions
from ...nodegroups._native import output
from ...nodegroups._tree import Value
from ...nodegroups.lamp_beams import beam_interfaces
from ..scenery import add_node, wire
from .any_fresnel import ANY, any_kind, by_data
from .universal_data import LOBES, NAME, NEUTRAL, REVISION, moving, property_name, universal_name

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from bpy.types import Material, Node, NodeSocket, ShaderNodeTree

    from ...nodegroups._tree import Tree

TERMS = {"corrected": 1, "hybrid": 1, "mirror": 3, "direct": 4}  # lights, for nodes: as many as SVM's stack holds
PARTS = ("diffuse", "body", "specular", "lobes", "transmission")


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
    return versions.LEAN_STACK


def form_of(choice: Choice) -> Form:
    """What ``fit`` shows, ``corrected`` does where no lamp is lit, and it can do lamps as well."""
    return Form(choice.backend, "corrected" if choice.estimator == "fit" else choice.estimator)


# The tree


def build(choice: Choice, parts: Sequence[str] = PARTS) -> Material:
    """The universal material for the estimator, the backend and the lamps of ``choice``; ``parts``: only these.

    The lamps that ``choice`` lacks of eight are suns of no strength.
    """
    form = form_of(choice)
    made = versions.empty_material(f"Universal ({form.estimator.title()})")
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
        before = place.links[0].from_socket if place.is_linked else None
        wire(tree, add_node(tree, "AddShader", Shader=before, Shader_001=socket) if before else socket, place)
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
        name = property_name(f"lamp {index}", of)
        datum = add_node(tree, "Attribute", attribute_type="OBJECT", attribute_name=name)
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
            self._read[name] = _read(self.tree, property_name(name), color=False)
        return self._read[name]

    def parameter(self, name: str) -> Value:
        """A parameter as it is at the object's age."""
        if name not in self._read:
            self._read[name] = _parameter(self.tree, name)
        return self._read[name]

    def _inputs(self, model: str, *names: str, of: str = "") -> dict[str, Value]:
        """Parameters, of the lobe that ``of`` names, for the inputs of a model's group."""
        return {label(model, name): parameter(name).scale.to_input(self.parameter(name + of)) for name in names}

    # Parts

    def _diffuse(self) -> list[NodeSocket]:
        d = self.parameter("d") * self._left()
        inputs = self._inputs("oren_nayar", "albedo", "sigma")
        module, number = BUILDERS["oren_nayar"][self.form.estimator], self.switch("diffuse")
        kinds = list(MODELS["oren_nayar"].kinds)
        if self.form.backend == "osl":
            group = self._ensure(module, "Oren-Nayar", by_data(partial(module.build_osl, kind=kinds[0]), "kind"))
            return [self._use(group, d, inputs | {"kind": number})]
        groups = [self._ensure(module, kind.title(), partial(module.build, kind=kind)) for kind in kinds]
        weights = (d * (1.0 - number), d * number)
        return [self._use(group, weight, inputs) for group, weight in zip(groups, weights, strict=True)]

    def _body(self) -> list[NodeSocket]:
        tree = self.tree
        radius = self.parameter("mean_free_path") * (4.0 * pi, 4.0 * pi, 4.0 * pi)
        given = {"Color": self.parameter("reflectance"), "Radius": radius, "Scale": 1.0, "Normal": self.normal}
        node = tree.node("ShaderNodeSubsurfaceScattering", falloff="RANDOM_WALK", **given)
        return [tree.weighted(output(node, "BSSRDF"), self.switch("body") * self._left())]

    def _specular(self) -> list[NodeSocket]:
        module = BUILDERS["cook_torrance"][self.form.estimator]
        values = self._inputs("cook_torrance", "f0", "f82_tint", "eta", "m")
        values |= {symbol(name): self.parameter(name) for name in "nk"}
        osl = self.form.backend == "osl"
        with any_kind(osl=osl):
            make = by_data(partial(module.build_osl, kind=ANY), "kind") if osl else partial(module.build, kind=ANY)
            group = self._ensure(module, "Cook-Torrance", make)
        return [self._use(group, self.parameter("s"), values | {"kind": self.switch("fresnel")})]

    def _lobes(self) -> list[NodeSocket]:
        module = BUILDERS["cook_torrance"][self.form.estimator]
        make = module.build_osl if self.form.backend == "osl" else module.build
        group = self._ensure(module, "F82", partial(make, kind="f82"))
        return [
            self._use(group, self.parameter(f"s_{k}"), self._inputs("cook_torrance", "f0", "f82_tint", "m", of=f"_{k}"))
            for k in range(2, LOBES + 1)
        ]

    def _transmission(self) -> list[NodeSocket]:
        module, glass = BUILDERS["glass"][self.form.glass], self.switch("glass")
        inputs = self._inputs("glass", "eta", "m", "tint")
        thin, smooth = self.switch("interface"), self.switch("smooth")
        found = []
        if self.form.backend == "osl" and self.form.glass == "mirror":
            group = self._ensure(module, "Glass", by_data(module.build_osl, "thin", "smooth"))
            return [self._use(group, glass, inputs | {"thin": thin, "smooth": smooth})]
        for is_smooth, weight in ((False, glass * (1.0 - smooth)), (True, glass * smooth)):
            title = f"Glass{' Smooth' * is_smooth}"
            if self.form.backend == "osl":
                group = self._ensure(module, title, by_data(partial(module.build_osl, smooth=is_smooth), "thin"))
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
            with any_kind(osl=False):
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
                value = self.tree.input_named(socket.name)
            if value is not None:  # Bound of hybrid stays as it is
                self.tree.connect(value, socket)
        return self.tree.weighted(node.outputs[0], weight)


def _suffix(form: Form) -> str:
    return " (OSL)" if form.backend == "osl" else ""


def _read(tree: Tree, name: str, *, color: bool) -> Value:
    node = tree.node("ShaderNodeAttribute", attribute_type="OBJECT", attribute_name=name)
    return Value(tree, output(node, "Color" if color else "Fac"))


def _parameter(tree: Tree, name: str) -> Value:
    """A parameter by the object's properties; one that moves in some preset by a ramp of what its input holds."""
    color = isinstance(NEUTRAL[base_name(name)], tuple)
    if base_name(name) not in moving():
        return _read(tree, property_name(name), color=color)
    before, after = (_read(tree, property_name(name, end), color=color) for end in ("before", "after"))
    start, end, _ = _read(tree, property_name(name, "span"), color=True).xyz
    age = _read(tree, property_name("age"), color=False)
    node = tree.group(ramp.group(color=color), Before=before, After=after, Age=age, Start=start, End=end)
    return parameter(name).scale.of_input(Value(tree, node.outputs["Value"]))


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
            known = universal_name(name)
            make = tree.output_color if isinstance(NEUTRAL[base_name(known)], tuple) else tree.output_float
            make(name, parameter(name).scale.to_input(_parameter(tree, known)), tip="At the object's age")

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
