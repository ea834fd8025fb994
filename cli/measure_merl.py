# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove measure --merl``: a preset, or any material of a .blend, as a MERL table. What stopped is resumed."""

from __future__ import annotations

import json
import time
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..addon.library import presets
from ..addon.library.errors import InputError
from ..addon.library.files import check_writable
from ..addon.measured.as_preset import check_opaque
from .environment import start_blender, versions
from .options import AUTO, Estimator, apply_settings
from .terminal import progress, say

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Scene

LONGEST_LIST = 10  # names in a message


def measure_merl(
    name: str, output: Path, *, material: str | None, settings: list[str] | None, at_time: float | None,
    estimator: Estimator, backend: str, samples: int, seed: int, bound: float,
) -> None:  # fmt: skip
    """Measure all entries, band by band, and write them. InputError for what cannot be measured so."""
    if output.suffix.lower() != ".binary":
        message = f"{output}: MERL tables are .binary files; name one that ends in .binary"
        raise InputError(message)
    check_writable(output)
    measured: dict[str, Any] = {"samples": samples, "seed": seed, "versions": versions()}
    if material is None:
        preset = apply_settings(presets.find(name), settings, at_time)
        check_opaque(preset)
        chosen = "direct" if estimator == AUTO else str(estimator)
        measured |= {"preset": asdict(preset), "estimator": chosen, "backend": backend, "bound": bound}
        start_blender()
        from ..addon.blender.merl_file import of_preset

        make, shading_osl = of_preset(preset, backend, chosen, bound), backend == "osl"
    else:
        if settings or at_time is not None or estimator != AUTO:
            message = "--material is measured as it stands in the file; leave --set, --time and --estimator out"
            raise InputError(message)
        file = Path(name)
        if file.suffix.lower() != ".blend" or not file.is_file():
            message = f"{name}: --material needs the .blend that holds it"
            raise InputError(message)
        state = file.stat()
        measured |= {"file": str(file.absolute()), "changed": [state.st_mtime_ns, state.st_size], "material": material}
        start_blender()
        make, shading_osl = _of_file(file, material)
    start = time.perf_counter()
    _measure(make, output, json.dumps(measured, default=str), samples, seed, shading_osl=shading_osl)
    say(f"wrote {output}; {time.perf_counter() - start:.1f} s")


def _of_file(file: Path, name: str) -> tuple[Callable[[Scene], Material], bool]:
    """A material as it is; one of ours by its own estimator, bound to the instrument's sun. And whether it runs OSL."""
    import bpy

    from .. import headless
    from ..addon.blender import merl_file
    from ..headless import scene as scenes

    with headless.quiet():
        shown = scenes.open_file(file)
    found = bpy.data.materials.get(name)
    if found is None:
        names = [f'"{one.name}"' for one in bpy.data.materials]
        known = ", ".join(names[:LONGEST_LIST]) + " ..." * (len(names) > LONGEST_LIST)
        message = f'{file}: has no material "{name}"; it has {known or "none"}'
        raise InputError(message)
    return merl_file.of_material(found, runs_osl=bool(shown.cycles.shading_system))


def _measure(
    make: Callable[[Scene], Material], output: Path, key: str, samples: int, seed: int, *, shading_osl: bool
) -> None:
    """All entries: those that a run before left beside the output, and the rest measured."""
    from .. import headless
    from ..addon.blender import merl_file

    steps = merl_file.measured(make, output, key, samples=samples, seed=seed, shading_osl=shading_osl)
    done = next(steps)
    if done:
        say(f"resuming at {done}/{merl_file.BANDS}")

    def rest() -> Any:
        while True:
            with headless.quiet():  # not around the progress bar
                step = next(steps, None)
            if step is None:
                return
            yield step

    for _ in progress(rest(), "theta_h", merl_file.BANDS - done):
        pass
