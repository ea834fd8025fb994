# SPDX-License-Identifier: GPL-3.0-or-later
"""A model's parameters, from its spec, as inputs of a group and as the head of an OSL shader."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.models import MODELS, fresnel

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ..addon.models import Parameter
    from ._tree import Tree, Value


def add_input(tree: Tree, of: Parameter, *, native: bool = False, prefix: str = "", tip: str = "") -> Value:
    """The artist's input for a parameter, held within its range; ``native``: within what Cycles' closures take."""
    name, tip = prefix + of.label, tip or of.tip
    if isinstance(of.default, float):
        return tree.input_float(
            name, of.default, low=of.low, high=_high(of, native=native), subtype=of.subtype, tip=tip, held=True
        )
    if of.socket == "Color":
        return tree.input_color(name, of.default, tip=tip, high=max(of.high, 1.0), held=True)  # a texture may be white
    return tree.input_vector(name, of.default, low=of.low, high=of.high, tip=tip, held=True)


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
    about = [f'string label = "{of.label}"', f'string help = "{of.tip}"']
    if of.unit:
        about.append(f'string units = "{of.unit}"')
    if isinstance(of.default, float):
        about += [f"float min = {of.low!r}", f"float max = {_high(of, native=native)!r}"]
        return f"    float {of.name} = {of.default!r} [[ {', '.join(about)} ]],"
    return f"    color {of.name} = color{of.default} [[ {', '.join(about)} ]],"
