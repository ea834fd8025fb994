# SPDX-License-Identifier: GPL-3.0-or-later
"""To come."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .record import Cell


def cells(*, quick: bool) -> list[Cell]:
    del quick
    return []
