# SPDX-License-Identifier: GPL-3.0-or-later
"""Which Cycles is meant where a formula is that of one of its own closures.

Blender 5.3 changed the light that Cycles' Oren-Nayar sends back after several bounces. Where Blender runs,
``nodegroups/versions.py`` says which one it is; elsewhere 5.2 LTS is meant.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

UNTIL_5_2, SINCE_5_3 = VERSIONS = ("until_5_2", "since_5_3")
_meant = [UNTIL_5_2]


def meant() -> str:
    """One of ``VERSIONS``."""
    return _meant[0]


def mean(version: str) -> None:
    """Mean another Cycles from now on. Raises ValueError for one that is not known."""
    if version not in VERSIONS:
        message = f"version must be one of {', '.join(VERSIONS)}, got {version!r}"
        raise ValueError(message)
    _meant[0] = version


@contextmanager
def as_of(version: str) -> Iterator[None]:
    """Mean another Cycles within the block."""
    before = meant()
    mean(version)
    try:
        yield
    finally:
        mean(before)


def oren_nayar_power() -> int:
    """p: light that bounced more than once in Cycles' Oren-Nayar is coloured as color^p / (1 - color (1 - Ea))."""
    return {UNTIL_5_2: 3, SINCE_5_3: 2}[meant()]
