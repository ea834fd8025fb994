# SPDX-License-Identifier: GPL-3.0-or-later
"""Numbers and names as people write them, checked where they enter: on the command line and in job files.

Digits are those of ASCII, and no number leaves the range that Blender has for it. Imports no bpy.
"""

from __future__ import annotations

import math
import os
import re
import tomllib
from typing import Any

from .errors import InputError

FRAMES = -1_048_574, 1_048_574  # Blender's own limits (MINAFRAME, MAXFRAME)
MOST_SAMPLES, MOST_SIDE, MOST_SEED = 2**24, 16384, 2**31 - 1  # of Cycles; pixels, ours; of an int32
MOST_WORKERS, MOST_MEGABYTES = 4096, 2**31 - 1
LONGEST_VALUE = 80  # characters of a value in a message
INTEGER = re.compile(r"[+-]?[0-9]{1,10}")
REAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,5})?")

# Python's parser takes time by the square of a key's parts: a.a.a. ... of 100 kB would take minutes.
MOST_PARTS = 16
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')"""
DEEP_KEY = re.compile(rf"(?<![\w.-])(?:{_PART}[ \t]*+\.[ \t]*+){{{MOST_PARTS}}}")


def shown(value: Any) -> str:
    """A value for a message, shortened. Python refuses to print integers of thousands of digits."""
    try:
        text = repr(value)
    except (ValueError, RecursionError):
        text = f"{type(value).__name__} too long to show"
    return text if len(text) <= LONGEST_VALUE else f"{text[: LONGEST_VALUE - 4]} ..."


def toml(text: str) -> dict[str, Any]:
    """The tables of a TOML text; InputError if it is none."""
    try:
        if found := DEEP_KEY.search(text):
            line = text.count("\n", 0, found.start()) + 1
            message = f"a key of more than {MOST_PARTS} parts (at line {line})"
            raise InputError(message)
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # numbers of thousands of digits; lists in lists in lists
        message = f"not valid TOML: {error}"
        raise InputError(message) from error


def whole(text: str, low: int, high: int) -> int:
    """A whole number from ``low`` to ``high``; InputError for any other text."""
    if INTEGER.fullmatch(text) and low <= int(text) <= high:
        return int(text)
    message = f"must be a whole number from {low} to {high}, got {shown(text)}"
    raise InputError(message)


def real(text: str, low: float = -math.inf, high: float = math.inf) -> float:
    """A finite number from ``low`` to ``high``; InputError for any other text."""
    if REAL.fullmatch(text) and low <= float(text) <= high and math.isfinite(float(text)):
        return float(text)
    span = ""
    if math.isfinite(high):
        span = f" from {low:g} to {high:g}"
    elif math.isfinite(low):
        span = f" of {low:g} or more"
    message = f"must be a number{span}, got {shown(text)}"
    raise InputError(message)


def frame_range(text: str) -> range:
    """The frames of FIRST-LAST, within Blender's own limits."""
    found = re.fullmatch(r"(-?[0-9]{1,7})-(-?[0-9]{1,7})", text)
    if not found or not FRAMES[0] <= int(found[1]) <= int(found[2]) <= FRAMES[1]:
        message = f"write FIRST-LAST, as in 1-48; Blender's frames are {FRAMES[0]} to {FRAMES[1]}"
        raise InputError(message)
    return range(int(found[1]), int(found[2]) + 1)


def size(text: str) -> tuple[int, int]:
    """Pixels of WIDTHxHEIGHT."""
    found = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", text)
    width, height = (int(found[1]), int(found[2])) if found else (0, 0)
    if not (1 <= width <= MOST_SIDE and 1 <= height <= MOST_SIDE):
        message = f"write WIDTHxHEIGHT in pixels up to {MOST_SIDE}, as in 640x480"
        raise InputError(message)
    return width, height


def name(text: str) -> str:
    """A name in a .blend, which Blender keeps as UTF-8.

    Python decodes the command line by the locale and keeps bytes that do not fit as lone surrogates.
    """
    try:
        read = text if text.isascii() else os.fsencode(text).decode("utf-8")
    except UnicodeDecodeError as error:
        message = "is not UTF-8, as names in Blender are"
        raise InputError(message) from error
    except UnicodeEncodeError:  # not of the command line
        read = text
    if not read or "\0" in read or any("\ud800" <= c <= "\udfff" for c in read):
        message = "is empty or holds characters that no name in Blender has"
        raise InputError(message)
    return read
