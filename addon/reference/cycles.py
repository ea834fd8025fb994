# SPDX-License-Identifier: GPL-3.0-or-later
"""The version of Cycles for which formulas of its own closures are computed.

Blender 5.3 changed the light that Cycles' Oren-Nayar sends back after several bounces. Where Blender runs,
``nodegroups/versions.py`` sets the version; elsewhere it is 5.2 LTS.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

UNTIL_5_2, SINCE_5_3 = VERSIONS = ("until_5_2", "since_5_3")
_version = [UNTIL_5_2]


def version() -> str:
    """One of ``VERSIONS``."""
    return _version[0]


def set_version(name: str) -> None:
    """Compute for another Cycles from now on. Raises ValueError for an unknown one."""
    if name not in VERSIONS:
        message = f"version must be one of {', '.join(VERSIONS)}, got {name!r}"
        raise ValueError(message)
    _version[0] = name


@contextmanager
def as_of(name: str) -> Iterator[None]:
    """Compute for another Cycles within the block."""
    before = version()
    set_version(name)
    try:
        yield
    finally:
        set_version(before)


def oren_nayar_power() -> int:
    """p: light that bounced more than once in Cycles' Oren-Nayar is coloured as color^p / (1 - color (1 - Ea))."""
    return {UNTIL_5_2: 3, SINCE_5_3: 2}[version()]
