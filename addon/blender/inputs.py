# SPDX-License-Identifier: GPL-3.0-or-later
"""A parameter and the input that holds it: as Blender's own nodes would, by its ``Scale``; in older files as it is."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ... import nodegroups
from ..models import PLAIN, Scale, parameter, symbol
from ..reference.keyframes import Keyframes, place_keys
from ..reference.trajectory import Trajectory

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket
    from numpy.typing import ArrayLike, NDArray

    from ..reference.trajectory import Law

DIGITS = 6  # a float32 holds 7.2, of which a scale may cost one


def scale_of(name: str, socket: NodeSocket) -> Scale:
    """How an input holds its parameter ``name``."""
    of = parameter(name)
    return PLAIN if of.symbol and nodegroups.name_of(socket) == symbol(name) else of.scale


def value_of(name: str, socket: NodeSocket) -> float | tuple[float, ...]:
    """A parameter as its input has it, in the working space."""
    value: Any = socket.default_value
    if isinstance(value, Iterable):
        return tuple(value)[:3]
    scale = scale_of(name, socket)
    if scale is PLAIN:
        return float(value)
    of = parameter(name)
    return min(max(float(f"{scale.of_input(value):.{DIGITS}g}"), of.low), of.high)


def give(name: str, socket: NodeSocket, value: Any) -> None:
    """Write a parameter, in the working space, into its input."""
    held = scale_of(name, socket).to_input(parameter(name).storable(value))
    socket.default_value = (*held, 1.0) if socket.type == "RGBA" else held


def converted_keys(name: str, keys: Keyframes, convert: Callable[[Any], Any]) -> Keyframes:
    """Keys of parameter ``name`` whose straight lines are near those of ``keys``, each value converted."""
    if keys.times.size == 1:
        return Keyframes(keys.times, convert(keys.values))
    law = Converted(keys.law(), convert)
    return place_keys(Trajectory({name: law}, float(keys.times[0]), float(keys.times[-1])), name)


@dataclass(frozen=True)
class Converted:
    """A law whose values are converted."""

    law: Law
    convert: Callable[[Any], Any]

    def __call__(self, t: ArrayLike) -> NDArray[Any]:
        found: NDArray[Any] = self.convert(self.law(t))
        return found

    def events(self) -> NDArray[Any]:
        return self.law.events()
