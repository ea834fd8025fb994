# SPDX-License-Identifier: GPL-3.0-or-later
"""A material's MERL table as a file, measured band by band. What stopped is resumed from FILE.part."""

from __future__ import annotations

import hashlib
import json
import sys
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ..library.files import replacing, write_text
from ..measured.as_preset import check_opaque
from ..measured.merl import write_merl
from . import gonio_merl, origin, reading
from .material import Choice, build, lamps_to_bind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Material, Scene
    from numpy.typing import NDArray

    from ..library.presets import Preset

LAYOUT = {  # of a node in the editor
    "name", "label", "location", "location_absolute", "width", "height", "select", "hide", "parent", "color",
    "use_custom_color", "show_options", "show_preview", "show_texture", "warning_propagation",
}  # fmt: skip
SINGLE = {"node_tree", "image", "script", "color_ramp", "mapping"}
MANY = {"nodes", "inputs", "outputs", "elements", "curves", "points"}
SIMPLE = {"BOOLEAN", "INT", "FLOAT", "STRING", "ENUM"}
BANDS = gonio_merl.BANDS


def measured(
    make: Callable[[Scene], Material], output: Path, key: str, *,
    samples: int = 1, seed: int = 0, shading_osl: bool = False,
) -> Iterator[int]:  # fmt: skip
    """Measure what is missing, and write the table; yields how many of ``BANDS`` are done, at first those resumed.

    key: what is measured. An interrupted measurement of another is started over, as is a damaged one.
    """
    part = output.with_name(f"{output.name}.part")
    done = _resumed(part, key)
    yield len(done)
    for band in gonio_merl.bands(make, first=len(done), samples=samples, seed=seed, shading_osl=shading_osl):
        done.append(band)
        if len(done) < BANDS:
            with replacing(part) as temporary, temporary.open("wb") as file:
                np.savez(file, key=key, table=np.stack(done))
        else:
            write_merl(output, np.concatenate(done, axis=1))
            part.unlink(missing_ok=True)
        yield len(done)


def _resumed(path: Path, key: str) -> list[NDArray[np.float64]]:
    try:
        with np.load(path, allow_pickle=False) as held:
            if str(held["key"]) == key:
                table = held["table"]
                return list(table) if table.dtype == np.float64 and table.ndim == 5 else []
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile):
        pass
    return []


def of_preset(preset: Preset, backend: str, estimator: str, bound: float) -> Callable[[Scene], Material]:
    """A preset's material, bound to the instrument's sun."""

    def make(scene: Scene) -> Material:
        suns = lamps_to_bind(scene, estimator, preset.model)
        return build(preset, Choice(backend, estimator, suns, shadows=False, bound=bound))

    return make


def of_material(found: Material, *, runs_osl: bool) -> tuple[Callable[[Scene], Material], bool]:
    """A material as it is; one of ours by its own estimator, bound to the instrument's sun. And whether it runs OSL.

    runs_osl: whether its scene does. InputError for one of ours that lets light through.
    """
    record = origin.read(found)
    if record is None:
        return (lambda _scene: found), runs_osl
    preset = reading.to_preset(found)
    check_opaque(preset)
    return of_preset(preset, record.backend, record.estimator, record.bound), record.backend == "osl"


def digest(found: Material) -> str:
    """The same for materials whose nodes, values and links are the same."""
    return hashlib.sha256(json.dumps(_described(found.node_tree)).encode()).hexdigest()


def _described(of: Any) -> Any:
    """All of a node tree, a node or what a node holds that decides what it computes."""
    if of is None or isinstance(of, bpy.types.Text):
        return of and of.as_string()
    held: dict[str, Any] = {"type": of.bl_rna.identifier}
    if isinstance(of, bpy.types.ID) and not isinstance(of, bpy.types.NodeTree):
        held["id"] = [of.name_full, bpy.path.abspath(getattr(of, "filepath", ""))]
    if isinstance(of, bpy.types.Node):
        held["name"] = of.name  # links are between names
    for one in of.bl_rna.properties:
        if "name" not in held or one.identifier not in LAYOUT:
            held[one.identifier] = _value(of, one)
    return held


def _value(of: Any, one: Any) -> Any:
    key = one.identifier
    if key == "links":
        return [(a.from_node.name, a.from_socket.identifier, a.to_node.name, a.to_socket.identifier) for a in of.links]
    if key in SINGLE:
        return _described(getattr(of, key))
    if key in MANY:
        return [_described(each) for each in getattr(of, key)]
    if one.type not in SIMPLE or one.is_readonly:
        return None
    value = getattr(of, key)
    return list(map(str, value)) if getattr(one, "is_array", False) else str(value)


def main() -> None:
    """In a Blender of its own: the command line ends with JSON that says what to measure.

    file, material: a .blend and a name in it; output, key, samples, osl, frame; steps: a file for the number of bands.
    """
    job = json.loads(sys.argv[-1])
    bpy.context.scene.frame_set(job["frame"])
    with bpy.data.libraries.load(job["file"]) as (_, into):
        into.materials = [job["material"]]
    (found,) = into.materials
    make, osl = of_material(found, runs_osl=job["osl"])
    for done in measured(make, Path(job["output"]), job["key"], samples=job["samples"], shading_osl=osl):
        write_text(Path(job["steps"]), str(done))
