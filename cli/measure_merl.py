# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove measure --merl``: a preset, or any material of a .blend, as a MERL table. What stopped is resumed."""

from __future__ import annotations

import json
import time
import zipfile
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..addon.library import presets
from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, replacing
from ..addon.measured.merl import write_merl
from .environment import start_blender, versions
from .options import AUTO, Estimator, apply_settings
from .terminal import progress, say

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Scene
    from numpy.typing import NDArray

    from ..addon.library.presets import Preset

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
        chosen = _chosen(preset, estimator)
        measured |= {"preset": asdict(preset), "estimator": chosen, "backend": backend, "bound": bound}
        start_blender()
        make, shading_osl = _of_preset(preset, backend, chosen, bound), backend == "osl"
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
    from .. import headless

    start = time.perf_counter()
    table = _table(make, output, json.dumps(measured, default=str), samples, seed, shading_osl=shading_osl)
    with headless.quiet():
        write_merl(output, table)
    _part(output).unlink(missing_ok=True)
    say(f"wrote {output}; {time.perf_counter() - start:.1f} s")


def _chosen(preset: Preset, estimator: Estimator) -> str:
    if preset.transparent:
        message = f"{preset.id} lets light through, which a MERL table cannot hold; choose an opaque preset"
        raise InputError(message)
    return "direct" if estimator == AUTO else str(estimator)


def _of_preset(preset: Preset, backend: str, estimator: str, bound: float) -> Callable[[Scene], Material]:
    from ..addon.blender.material import Choice, build, lamps_to_bind

    def make(scene: Scene) -> Material:
        suns = lamps_to_bind(scene, estimator, preset.model)
        return build(preset, Choice(backend, estimator, suns, shadows=False, bound=bound))

    return make


def _of_file(file: Path, name: str) -> tuple[Callable[[Scene], Material], bool]:
    """A material as it is; one of ours by its own estimator, bound to the instrument's sun. And whether it runs OSL."""
    import bpy

    from .. import headless
    from ..addon.blender import origin, reading
    from ..headless import scene as scenes

    with headless.quiet():
        shown = scenes.open_file(file)
    found = bpy.data.materials.get(name)
    if found is None:
        names = [f'"{one.name}"' for one in bpy.data.materials]
        known = ", ".join(names[:LONGEST_LIST]) + " ..." * (len(names) > LONGEST_LIST)
        message = f'{file}: has no material "{name}"; it has {known or "none"}'
        raise InputError(message)
    record = origin.read(found)
    if record is not None:
        preset = reading.to_preset(found)
        _chosen(preset, AUTO)
        return _of_preset(preset, record.backend, record.estimator, record.bound), record.backend == "osl"
    return (lambda _scene: found), bool(shown.cycles.shading_system)


def _table(
    make: Callable[[Scene], Material], output: Path, key: str, samples: int, seed: int, *, shading_osl: bool
) -> NDArray[np.float64]:
    """All entries (3, 90, 90, 180): those that a run before left beside the output, and the rest measured."""
    from .. import headless
    from ..addon.blender import gonio_merl

    done = _resumed(_part(output), key)
    if done:
        say(f"resuming at {len(done)}/{gonio_merl.BANDS}")
    rest = gonio_merl.bands(make, first=len(done), samples=samples, seed=seed, shading_osl=shading_osl)

    def measured() -> Any:
        while True:
            with headless.quiet():  # not around the progress bar
                band = next(rest, None)
            if band is None:
                return
            yield band

    for band in progress(measured(), "theta_h", gonio_merl.BANDS - len(done)):
        done.append(band)
        if len(done) < gonio_merl.BANDS:
            with replacing(_part(output)) as temporary, temporary.open("wb") as file:
                np.savez(file, key=key, table=np.stack(done))
    return np.concatenate(done, axis=1)


def _part(output: Path) -> Path:
    return output.with_name(f"{output.name}.part")


def _resumed(path: Path, key: str) -> list[NDArray[np.float64]]:
    """The bands of an interrupted measurement, if it was the same one; a damaged file is started over."""
    try:
        with np.load(path, allow_pickle=False) as held:
            if str(held["key"]) == key:
                table = held["table"]
                return list(table) if table.dtype == np.float64 and table.ndim == 5 else []
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        pass
    return []
