# SPDX-License-Identifier: GPL-3.0-or-later
"""A model's parameters, from its spec, as inputs of a group and as the head of an OSL shader."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.models import MODELS, fresnel, parameter
from . import ensure
from ._tree import hold

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import bpy

    from ..addon.models import Parameter
    from ._tree import Tree, Value

TO_INPUT = "vgroove_to_input"  # custom property of a group that turns a parameter into what its input takes


def add_input(
    tree: Tree, of: Parameter, *, native: bool = False, prefix: str = "", tip: str = "", held: bool = True
) -> Value:
    """A parameter, of the artist's input for it, held to its range; ``native``: to what Cycles' closures take."""
    name, tip = prefix + of.label, tip or of.tip
    if isinstance(of.default, float):
        default, (low, high) = of.scale.to_input(of.default), _ends(of, native=native)
        return of.scale.of_input(
            tree.input_float(name, default, low=low, high=high, subtype=of.subtype, tip=tip, held=held)
        )
    if of.socket == "Color":
        return tree.input_color(name, of.default, tip=tip, high=max(of.high, 1.0), held=held)  # a texture may be white
    return tree.input_vector(name, of.default, low=of.low, high=of.high, tip=tip, held=held)


def existing_input(tree: Tree, of: Parameter, names: Mapping[str, str]) -> Value:
    """A parameter, of the input made before for it under its label, or what ``names`` calls that; held to its range."""
    value = tree.input_named(names.get(of.label, of.label))
    return value if of.is_rgb else of.scale.of_input(hold(value, *_ends(of, native=False)))


def to_input(name: str) -> bpy.types.ShaderNodeTree:
    """A group that turns parameter ``name``, as textures of older files give it, into what its input takes."""
    of = parameter(name)

    def build(tree: Tree) -> None:
        value = tree.input_float(of.symbol, 0.3, low=of.low, high=of.high, tip=of.tip, held=True)
        tree.output_float(of.label, of.scale.to_input(value), tip=of.tip)

    group = ensure(f".VGroove {of.symbol} to {of.label}", 1, build)
    group[TO_INPUT] = name
    return group


def renamed(model: str, part: str) -> dict[str, str]:
    """What groups of ``model`` call inputs of the groups of its ``part``, where not as these do."""
    spec = MODELS[part]
    terms = [one for kind in fresnel.KINDS.values() for one in kind.parameters] if spec.has_fresnel else []
    own = {one.name: one.label for one in (*spec.parameters, *terms)}
    return {own[name]: label for name, label in MODELS[model].labels.items() if name in own}


def _ends(of: Parameter, *, native: bool) -> list[float]:
    """The range of the input: where a scale falls, the highest parameter is the lowest input."""
    return sorted(map(of.scale.to_input, (of.low, _high(of, native=native))))


def _high(of: Parameter, *, native: bool) -> float:
    return of.native_high if native and of.native_high is not None else of.high


def headers() -> dict[str, str]:
    """Of each model the head of its shaders, MODEL_parameters.h, and with the range of native closures."""
    return {
        f"{name}{'_native' * native}_parameters.h": "\n".join(_declarations(name, native=native))
        for name in MODELS
        for native in (False, True)
    }


def _declarations(name: str, *, native: bool) -> Iterator[str]:
    model = MODELS[name]
    if any(model.kinds.values()):
        numbered = ", ".join(f"{index} {label}" for index, label in enumerate(model.kinds.values()))
        label = "Fresnel" if model.has_fresnel else "Kind"
        yield f'    int kind = 0 [[ string label = "{label}", string help = "{numbered}" ]],'
    terms = [one for kind in fresnel.KINDS.values() for one in kind.parameters] if model.has_fresnel else []
    for one in dict.fromkeys([*terms, *model.parameters]):
        if not one.in_volume:
            yield _declaration(one, native=native)


def _declaration(of: Parameter, *, native: bool) -> str:
    about = [f'string label = "{of.symbol or of.label}"', f'string help = "{of.tip}"']
    if of.unit:
        about.append(f'string units = "{of.unit}"')
    if isinstance(of.default, float):
        about += [f"float min = {of.low!r}", f"float max = {_high(of, native=native)!r}"]
        return f"    float {of.name} = {of.default!r} [[ {', '.join(about)} ]],"
    return f"    color {of.name} = color{of.default} [[ {', '.join(about)} ]],"
