# SPDX-License-Identifier: GPL-3.0-or-later
"""Every row of ``vgroove check``, of all models."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from ...addon.blender.material import ESTIMATORS
from . import glass as check_glass
from . import hybrid as check_hybrid
from . import oren_nayar as check_oren_nayar
from . import rows as check
from . import sum as check_sum
from . import time as check_time

if TYPE_CHECKING:
    from collections.abc import Callable

    from .rows import Row


def quick_plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """One row of each kind and estimator, but for those under a sun with an angle, which take long."""
    first: dict[tuple[str, ...], tuple[Callable[..., Row], tuple[Any, ...]]] = {}
    for measure, arguments in plan():
        function = getattr(measure, "func", measure)
        estimator = [part for part in arguments if part in ESTIMATORS]
        if arguments[-1] == 0.3 and "sun" not in function.__name__:
            first.setdefault((function.__module__, function.__name__, *estimator), (measure, arguments))
    return list(first.values())


def plan() -> list[tuple[Callable[..., Row], tuple[Any, ...]]]:
    """Every row, as the function that measures it and its arguments."""
    glass = [(partial(measure, **more), arguments) for measure, arguments, more in check_glass.plan()]
    return [
        *check.plan(),
        *check_hybrid.plan(),
        *check_oren_nayar.plan(),
        *check_sum.plan(),
        *check_time.plan(),
        *glass,
    ]
