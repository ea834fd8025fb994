# SPDX-License-Identifier: GPL-3.0-or-later
"""Every row of ``vgroove check``, of all models."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from . import check, check_glass, check_hybrid, check_oren_nayar, check_sum

if TYPE_CHECKING:
    from collections.abc import Callable

    from .check import Row


def plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """Every row, as the function that measures it and its arguments."""
    glass = [(partial(measure, **more), arguments) for measure, arguments, more in check_glass.plan()]
    return [*check.plan(), *check_hybrid.plan(), *check_oren_nayar.plan(), *check_sum.plan(), *glass]
