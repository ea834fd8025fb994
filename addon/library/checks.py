# SPDX-License-Identifier: GPL-3.0-or-later
"""What a preset's numbers may be, and the one line that turns away what they may not. Imports no bpy."""

from __future__ import annotations

import difflib
from math import inf, pi
from typing import Any

from .errors import InputError
from .inputs import shown

LONGEST_MESSAGE = 400  # characters
M_RANGE = (1e-4, 10.0)  # what float32 shaders keep finite; 0 stands for a smooth interface
RANGES = {
    "m": M_RANGE,
    "f0": (0.0, 1.0),
    "f82_tint": (0.0, 1.0),
    "eta": (0.1, 10.0),
    "n": (0.0, 20.0),
    "k": (0.0, 20.0),
}
# White Oren-Nayar as published sends back up to 1.051 of what arrives; below 0.95 no direction exceeds 1.
RANGES |= {"d": (0.0, 1.0), "s": (0.0, 1.0), "albedo": (0.0, 0.95), "sigma": (0.0, pi / 2), "tint": (0.0, 1.0)}
RANGES |= {"absorption": (0.0, 1e5), "reflectance": (0.0, 1.0), "mean_free_path": (0.0, 10.0)}
RGB = {"f0", "f82_tint", "n", "k", "albedo", "tint", "absorption", "reflectance", "mean_free_path"}


class PresetError(InputError):
    """A preset that does not hold, or does not exist.

    Whatever a file holds, the text stays one line of at most ``LONGEST_MESSAGE`` printable characters.
    """

    def __init__(self, message: str) -> None:
        line = "".join(c if c.isprintable() else "?" for c in message)
        super().__init__(line if len(line) <= LONGEST_MESSAGE else f"{line[: LONGEST_MESSAGE - 4]} ...")


def base_name(key: str) -> str:
    """The name of a number without that of its lobe: m of m_2."""
    name, _, lobe = key.rpartition("_")
    return name if lobe.isdigit() else key


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


def as_number(where: str, key: str, value: Any) -> float | tuple[float, float, float]:
    """A parameter within its range: one number, or three for RGB (one number then counts for all three)."""
    if base_name(key) not in RGB:
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
    low, high = RANGES[base_name(key)]
    if key == "m" and number == 0.0:
        return number
    if not low <= number <= high:
        hint = " (or 0, a smooth interface)" if key == "m" else ""
        message = f"{where}: {key} must be between {low:g} and {high:g}{hint}, got {number:g}"
        raise PresetError(message)
    return number
