# SPDX-License-Identifier: GPL-3.0-or-later
"""Keys against error: how many keys each changing preset takes for a tolerance, and what error they have.

python bench/keys.py            prints the table of docs/time.md
"""

from __future__ import annotations

import numpy as np

from vgroove.addon.presets import shipped
from vgroove.addon.reference import Exponential, Trajectory, place_keys
from vgroove.addon.reference.keyframes import TOLERANCE

TOLERANCES = (1e-2, 1e-3, 1e-4)


def error(course: Trajectory, name: str, tolerance: float, interpolation: str) -> tuple[int, float]:
    """Keys, and the largest miss as a share of the parameter's range, on a hundred points between any two keys."""
    keys = place_keys(course, name, tolerance, interpolation)  # type: ignore[arg-type]
    t = (keys.times[:-1, None] + np.linspace(0.0, 1.0, 101) * np.diff(keys.times)[:, None]).ravel()
    law = course.value(name, t)
    return keys.times.size, float(np.abs(keys(t) - law).max() / np.ptp(law, axis=0).max())


def even(course: Trajectory, name: str, tolerance: float) -> int:
    """How many keys at even distances would do, to a power of two."""
    count = 1
    while count < 2**22:
        count *= 2
        t = np.linspace(course.start, course.end, count + 1)
        middle = 0.5 * (t[:-1] + t[1:])
        law, found = course.value(name, t), course.value(name, middle)
        if np.abs(found - 0.5 * (law[:-1] + law[1:])).max() <= tolerance * np.ptp(law, axis=0).max():
            break
    return count + 1


def main() -> None:
    columns = [f"{kind}, {tolerance:g}" for kind in ("straight", "shape") for tolerance in TOLERANCES]
    print(f"| preset | parameter | {' | '.join(columns)} | evenly, {TOLERANCES[1]:g} |")
    print("| --- | --- |" + " ---: |" * (len(columns) + 1))
    worst = dict.fromkeys(TOLERANCES, 0.0)
    for preset in shipped().values():
        if preset.time is None:
            continue
        course = preset.trajectory()
        for name in course.laws:
            cells = []
            for interpolation in ("linear", "shape"):
                for tolerance in TOLERANCES:
                    count, off = error(course, name, tolerance, interpolation)
                    worst[tolerance] = max(worst[tolerance], off)
                    cells.append(str(count))
            print(f"| {preset.name} | {name} | {' | '.join(cells)} | {even(course, name, TOLERANCES[1])} |")
    pieces = place_keys(Trajectory({"p": Exponential(1.0, 0.0, (1.0,))}, 0.0, 40.0), "p").times.size - 1
    print(
        f"\nexp(-t) to {TOLERANCE:g}: {pieces} straight pieces; fewer than {(2.0 * TOLERANCE) ** -0.5:.1f} cannot do."
    )
    print("\nLargest error of all: " + ", ".join(f"{worst[one]:.2e} at {one:g}" for one in TOLERANCES))


if __name__ == "__main__":
    main()
