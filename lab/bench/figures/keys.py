# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys against error, for docs/time.md: how many each changing preset takes for a tolerance, and what they miss by."""

from __future__ import annotations

import numpy as np

from ....addon.library.presets import shipped
from ....addon.reference import Exponential, Trajectory, place_keys
from ....addon.reference.keyframes import TOLERANCE
from ..cells import Table

TOLERANCES = (1e-2, 1e-3, 1e-4)
INTERPOLATIONS = {"linear": "straight", "shape": "shape"}


def tables() -> dict[str, Table]:
    """Keys of every parameter that changes; the worst miss at each tolerance; pieces of exp(-t) and the fewest."""
    worst, rows = dict.fromkeys(TOLERANCES, 0.0), []
    for preset in shipped().values():
        if preset.time is None:
            continue
        course = preset.trajectory()
        for name in course.laws:
            counts = []
            for interpolation in INTERPOLATIONS:
                for tolerance in TOLERANCES:
                    count, off = missed(course, name, tolerance, interpolation)
                    worst[tolerance] = max(worst[tolerance], off)
                    counts.append(count)
            rows.append([preset.name, name, *counts, even(course, name, TOLERANCE)])
    kinds = [f"{kind}, {tolerance:g}" for kind in INTERPOLATIONS.values() for tolerance in TOLERANCES]
    pieces = place_keys(Trajectory({"p": Exponential(1.0, 0.0, (1.0,))}, 0.0, 40.0), "p").times.size - 1
    return {
        "keys": Table(["preset", "parameter", *kinds, f"evenly, {TOLERANCE:g}"], rows),
        "worst": Table(["tolerance", "largest error"], [list(pair) for pair in worst.items()]),
        "exponential": Table(
            ["tolerance", "straight pieces", "fewest"], [[TOLERANCE, pieces, (2.0 * TOLERANCE) ** -0.5]]
        ),
    }


def missed(course: Trajectory, name: str, tolerance: float, interpolation: str) -> tuple[int, float]:
    """Keys, and the largest miss as a share of the parameter's range, on a hundred points between any two keys."""
    keys = place_keys(course, name, tolerance, interpolation)  # type: ignore[arg-type]
    t = (keys.times[:-1, None] + np.linspace(0.0, 1.0, 101) * np.diff(keys.times)[:, None]).ravel()
    law = course.value(name, t)
    return keys.times.size, float(np.max(np.abs(keys(t) - law)) / np.max(np.ptp(law, axis=0)))


def even(course: Trajectory, name: str, tolerance: float) -> int:
    """How many keys at even distances would do, to a power of two."""
    count = 1
    while count < 2**22:
        count *= 2
        t = np.linspace(course.start, course.end, count + 1)
        middle = 0.5 * (t[:-1] + t[1:])
        law, found = course.value(name, t), course.value(name, middle)
        if np.max(np.abs(found - 0.5 * (law[:-1] + law[1:]))) <= tolerance * np.max(np.ptp(law, axis=0)):
            break
    return count + 1
