# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's numbers in other words than its inputs have: the colour of a metal, and parameters as papers give them.

Each property reads the material's inputs and writes them. Only the edge of a metal is stored, which n and k do not tell
where they are held to their range.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import bpy

from ..blender import beside, colour_space, material
from ..blender.inputs import give, value_of
from ..models import parameter
from ..reference.fresnel import conductor_of, head_on_and_edge

if TYPE_CHECKING:
    from bpy.types import Material, NodeSocket

DARKEST = 1e-3  # reflectance head-on, below which n and k tell nothing of the edge any more
ALIKE = 1e-6  # numbers that differ by less in proportion are the same ones, rounded to float32


def sockets(made: Material) -> dict[str, NodeSocket]:
    """The inputs of a material that are not linked, by their parameters' names."""
    return {name: one for name, one in material.parameter_sockets(made).items() if not one.is_linked}


def has_index(made: Material) -> bool:
    """Whether a material is a metal by n and k, which nothing else drives."""
    return {"n", "k"} <= sockets(made).keys()


def _get_color(numbers: VGrooveNumbers) -> tuple[float, ...]:
    held = sockets(numbers.id_data)
    r, _ = head_on_and_edge(*(value_of(name, held[name]) for name in "nk")) if {"n", "k"} <= held.keys() else (0.0, 0.0)
    return tuple([float(one) for one in r] if hasattr(r, "__iter__") else [0.0] * 3)


def _set_color(numbers: VGrooveNumbers, color: Any) -> None:
    held = sockets(numbers.id_data)
    if not has_index(numbers.id_data):
        return
    index = _index(held)
    g = numbers.edge if tuple(numbers.edge_of) == index else head_on_and_edge(index[:3], index[3:])[1]
    r = [max(channel, DARKEST) for channel in color]
    for name, value in zip("nk", conductor_of(r, g, parameter("n").high), strict=True):
        give(name, held[name], tuple(value.tolist()))
    numbers.edge, numbers.edge_of = g, _index(held)


def _index(held: dict[str, NodeSocket]) -> tuple[float, ...]:
    """n and k as the inputs hold them."""
    return tuple(value for name in "nk" for value in held[name].default_value)


def _measured(made: Material) -> dict[str, tuple[float, ...]]:
    """n and k of the preset, in the file's working space."""
    numbers = colour_space.to_space(material.preset_of(made).parameters, colour_space.of(made))
    return {name: numbers[name] for name in "nk"}


def _get_measured(numbers: VGrooveNumbers) -> bool:
    held, made = sockets(numbers.id_data), numbers.id_data
    return has_index(made) and all(
        abs(now - then) <= ALIKE * then + ALIKE
        for name, of in _measured(made).items()
        for now, then in zip(value_of(name, held[name]), of, strict=True)  # type: ignore[arg-type]
    )


def _set_measured(numbers: VGrooveNumbers, wanted: bool) -> None:  # noqa: FBT001 - Blender's setter
    if wanted and has_index(numbers.id_data):
        for name, value in _measured(numbers.id_data).items():
            give(name, sockets(numbers.id_data)[name], value)


def takes_alpha(made: Material) -> bool:
    """Whether an alpha would count: every output shows something, and no texture feeds the alpha."""
    shown, passing = list(beside.outputs(made)), beside.alpha(made)
    fed = passing is not None and passing[0].is_linked
    return bool(shown) and not fed and all(output.inputs["Surface"].is_linked for output in shown)


def _get_alpha(numbers: VGrooveNumbers) -> float:
    passing = beside.alpha(numbers.id_data) if material.is_ours(numbers.id_data) else None
    if passing is None:
        return 1.0
    socket, inverse = passing
    return 1.0 - socket.default_value if inverse else float(socket.default_value)


def _set_alpha(numbers: VGrooveNumbers, alpha: float) -> None:
    if material.is_ours(numbers.id_data) and takes_alpha(numbers.id_data):
        beside.set_alpha(numbers.id_data, alpha)


def _as_published(name: str, tip: str) -> Any:
    """A property that shows parameter ``name`` itself, whatever its input holds in its place."""
    of = parameter(name)

    def read(numbers: VGrooveNumbers) -> float:
        socket = sockets(numbers.id_data).get(name)
        return float(value_of(name, socket)) if socket else 0.0  # type: ignore[arg-type]

    def write(numbers: VGrooveNumbers, value: float) -> None:
        if (socket := sockets(numbers.id_data).get(name)) is not None:
            give(name, socket, min(max(value, of.low), of.high))

    unit = "ROTATION" if of.unit == "rad" else "NONE"
    return bpy.props.FloatProperty(
        name=of.symbol, description=tip, min=of.low, max=of.high, soft_max=of.native_high or of.high, precision=4,
        unit=unit, options=set(), get=read, set=write,
    )  # fmt: skip


class VGrooveNumbers(bpy.types.PropertyGroup):
    """Of a material of ours."""

    color: bpy.props.FloatVectorProperty(
        name="Color", description="Color that the metal reflects head-on. Editing it changes IOR and Extinction",
        subtype="COLOR", size=3, min=0.0, max=1.0, options=set(), get=_get_color, set=_set_color,
    )  # fmt: skip
    measured: bpy.props.BoolProperty(
        name="Measured", description="IOR and Extinction are those of the preset. Turn on to restore them",
        options=set(), get=_get_measured, set=_set_measured,
    )  # fmt: skip
    alpha: bpy.props.FloatProperty(
        name="Alpha", description="Share of the surface that is there; the rest lets light straight through",
        subtype="FACTOR", min=0.0, max=1.0, options=set(), get=_get_alpha, set=_set_alpha,
    )  # fmt: skip
    edge: bpy.props.FloatVectorProperty(options={"HIDDEN"})  # g of ``head_on_and_edge`` by which Color was set last
    edge_of: bpy.props.FloatVectorProperty(size=6, options={"HIDDEN"})  # n and k that it gave
    m: _as_published("m", "RMS slope of the facets, as in Cook and Torrance: the square of Roughness")
    sigma: _as_published("sigma", "Standard deviation of the facets' tilt, as in Oren and Nayar")


def draw(layout: bpy.types.UILayout, made: Material) -> None:
    """The inputs of a material by Blender's names; of a metal its colour in place of six numbers."""
    held = sockets(made)
    if has_index(made):
        layout.prop(made.vgroove_numbers, "color")
        known = material.preset_of(made).source.get("colour", "")
        layout.prop(made.vgroove_numbers, "measured", text=known.capitalize() or "As Preset")
    for name, socket in held.items():
        if name not in {"n", "k"} or not has_index(made):
            layout.prop(socket, "default_value", text=socket.name)
    if takes_alpha(made):
        layout.prop(made.vgroove_numbers, "alpha")


def is_published(made: Material) -> bool:
    """Whether papers give a material by other numbers than its inputs show."""
    return not {"m", "sigma", "n"}.isdisjoint(sockets(made))


def draw_published(layout: bpy.types.UILayout, made: Material) -> None:
    """The same as papers have them."""
    held = sockets(made)
    for name in ("m", "sigma"):
        if name in held:
            layout.prop(made.vgroove_numbers, name)
    for name in ("n", "k"):
        if name in held:
            layout.prop(held[name], "default_value", text=parameter(name).symbol)


CLASSES = (VGrooveNumbers,)
