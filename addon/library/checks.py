# SPDX-License-Identifier: GPL-3.0-or-later
"""What a preset's numbers may be, and the one line that turns away what they may not. Imports no bpy."""

from __future__ import annotations

import difflib
from math import inf
from typing import TYPE_CHECKING, Any

from ..models import parameter
from ..models.cook_torrance import SLOPE
from .errors import InputError
from .inputs import shown

if TYPE_CHECKING:
    from ..models import Number

LONGEST_MESSAGE = 400  # characters
M_RANGE = SLOPE.low, SLOPE.high  # what float32 shaders keep finite; 0 stands for a smooth interface


class PresetError(InputError):
    """A preset that does not hold, or does not exist.

    Whatever a file holds, the text stays one line of at most ``LONGEST_MESSAGE`` printable characters.
    """

    def __init__(self, message: str) -> None:
        line = "".join(c if c.isprintable() else "?" for c in message)
        super().__init__(line if len(line) <= LONGEST_MESSAGE else f"{line[: LONGEST_MESSAGE - 4]} ...")


def check_key(where: str, key: str, known: Any) -> None:
    if key not in known:
        near = difflib.get_close_matches(key, list(known), n=1)
        hint = f'did you mean "{near[0]}"?' if near else f"known are {', '.join(known)}"
        message = f'{where}: unknown key "{key}"; {hint}'
        raise PresetError(message)


def as_typed(where: str, key: str, value: Any, kind: type) -> Any:
    accepted = (int, float) if kind is float else kind
    if not isinstance(value, accepted) or isinstance(value, bool) != (kind is bool):
        wanted = {bool: "true or false", float: "a number", str: "a text", dict: "a table", list: "a list"}[kind]
        message = f"{where}: {key} must be {wanted}, got {shown(value)}"
        raise PresetError(message)
    return value


def as_number(where: str, key: str, value: Any) -> Number:
    """A parameter within its range: one number, or three for RGB (one number then counts for all three)."""
    if not parameter(key).is_rgb:
        return as_in_range(where, key, value)
    channels = [value] * 3 if isinstance(value, (int, float)) else value
    if not isinstance(channels, (list, tuple)) or len(channels) != 3:
        message = f"{where}: {key} must be one number or three (R, G, B), got {shown(value)}"
        raise PresetError(message)
    red, green, blue = (as_in_range(where, key, channel) for channel in channels)
    return red, green, blue


def as_in_range(where: str, key: str, value: Any) -> float:
    try:
        number = float(as_typed(where, key, value, float))
    except OverflowError:  # an integer of hundreds of digits
        number = inf
    of = parameter(key)
    smooth = of.zero_is_smooth and key == of.name  # a lobe is never smooth
    if smooth and number == 0.0:
        return number
    if not of.low <= number <= of.high:
        hint = " (or 0, a smooth interface)" if smooth else ""
        message = f"{where}: {key} must be between {of.low:g} and {of.high:g}{hint}, got {number:g}"
        raise PresetError(message)
    return number
