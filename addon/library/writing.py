# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets written: as text, and into a folder of the user's own. ``presets.parse`` reads them back. Imports no bpy."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..models import MeasuredTable, fresnel
from . import distribution, presets
from .checks import PresetError
from .files import check_writable, replacing, write_text
from .presets import USER_FAMILY, Preset

HEAD = "# SPDX-License-Identifier: GPL-3.0-or-later\n"


def value(of: Any) -> str:
    """A TOML value: text, true or false, a number, or a list of them."""
    if isinstance(of, bool):
        return str(of).lower()
    if isinstance(of, str):
        escaped = of.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(c if c.isprintable() else f"\\U{ord(c):08x}" for c in escaped) + '"'
    if isinstance(of, (int, float)):
        return repr(float(of))
    return "[" + ", ".join(value(part) for part in of) + "]"


def toml(values: dict[str, Any], **tables: dict[str, Any] | list[dict[str, Any]]) -> str:
    """Numbers and texts at the top, then tables, and lists of tables."""
    lines = [f"{key} = {value(of)}" for key, of in values.items()]
    for name, content in tables.items():
        for one in content if isinstance(content, list) else [content]:
            lines += ["", f"[[{name}]]" if isinstance(content, list) else f"[{name}]"]
            lines += [f"{key} = {value(of)}" for key, of in one.items()]
    return "\n".join(lines) + "\n"


def dumps(preset: Preset) -> str:
    """The text of ``preset``, which ``presets.parse`` reads back to the same."""
    values: dict[str, Any] = {"name": preset.name, "model": preset.model}
    tables: dict[str, dict[str, Any] | list[dict[str, Any]]] = {}
    numbers = dict(preset.parameters)
    spec = preset.spec
    if spec.has_fresnel:
        tables["fresnel"] = {one.name: numbers.pop(one.name) for one in fresnel.KINDS[preset.kind].parameters}
    else:
        values["kind"] = preset.kind
    if spec.lobes:
        keys, count = [one.name for one in spec.lobes], preset.lobes
        tables["lobes"] = [{key: numbers.pop(f"{key}_{k}") for key in keys} for k in range(1, count + 1)]
    if preset.distribution:
        tables["distribution"] = distribution.tables(preset.distribution)
    if preset.table is not None:
        tables["table"] = {"file": preset.table.file, "sha256": preset.table.sha256}
    values |= {flag: flag in preset.flags for flag in spec.flags}
    optional = {"tags": preset.tags, "notes": preset.notes, "m_range": preset.m_range}
    values |= {key: of for key, of in optional.items() if of} | numbers
    tables["source"] = dict(preset.source)
    if preset.verified:
        tables["verified"] = dict(preset.verified)
    if preset.time is not None:
        of = preset.time
        tables["time"] = {"unit": of.unit, "range": (of.start, of.end), "kind": of.kind}
        tables |= {f"time.{name}": dict(law) for name, law in of.laws.items()}
    return HEAD + toml(values, **tables)


def file_name(name: str) -> str:
    """A name as a file's, without ending: letters, digits and "_", whatever the name holds."""
    return re.sub(r"\W+", "_", name.casefold()).strip("_") or "preset"


def save(preset: Preset, folder: Path, *, overwrite: bool = False) -> Preset:
    """Write ``preset`` into the user's ``folder`` by its name; the preset as it is found from now on.

    PresetError where it would not read back, or a preset of that name is there already and is not to be overwritten.
    OSError where the folder cannot be written.
    """
    path = folder / f"{file_name(preset.name)}.toml"
    text = dumps(preset)
    held = presets.parse(text, f"{USER_FAMILY}/{path.stem}", path.name)
    if path.exists() and not overwrite:
        message = f'there is a preset "{path.stem}" in {folder} already; give this one another name'
        raise PresetError(message)
    folder.mkdir(parents=True, exist_ok=True)
    check_writable(path)
    write_text(path, text)
    presets.reread()
    return held


def free_name(name: str, folder: Path) -> str:
    """``name``, or with a number where the user's ``folder`` has a preset of that name already."""
    given, count = name, 1
    while (folder / f"{file_name(given)}.toml").exists():
        count += 1
        given = f"{name[:56]} {count}"
    return given


def copy_table(table: MeasuredTable, folder: Path) -> MeasuredTable:
    """A copy of a table's file in the user's ``folder``, named by its content too; OSError where that fails."""
    path = Path(table.file)
    copy = folder / f"{file_name(path.stem)}_{table.sha256[:8]}{path.suffix}"
    folder.mkdir(parents=True, exist_ok=True)
    if not copy.is_file():
        with replacing(copy) as temporary:
            shutil.copyfile(path, temporary)
    return MeasuredTable(copy.name, table.sha256)


def own_file(preset: Preset, folder: Path | None) -> Path | None:
    """The file of a preset in the user's ``folder``; None of one that ships with vgroove."""
    if folder is None or preset.id in presets.shipped():
        return None
    family, stem = preset.id.split("/")
    path = (folder if family == USER_FAMILY else folder / family) / f"{stem}.toml"
    return path if path.is_file() else None


def rename(preset: Preset, name: str, folder: Path) -> Preset:
    """Give one of the user's presets another name, and its file with it; raises as ``save`` does."""
    path = own_file(preset, folder)
    if path is None:
        message = f"{preset.id} ships with vgroove and keeps its name; save a copy as your own"
        raise PresetError(message)
    renamed = save(replace(preset, name=name), folder, overwrite=path == folder / f"{file_name(name)}.toml")
    if own_file(renamed, folder) != path:
        path.unlink()
        presets.reread()
    return renamed


def delete(preset: Preset, folder: Path) -> None:
    """Remove one of the user's presets; PresetError of one that ships with vgroove, OSError where that fails."""
    path = own_file(preset, folder)
    if path is None:
        message = f"{preset.id} ships with vgroove and cannot be deleted"
        raise PresetError(message)
    path.unlink()
    presets.reread()


def import_file(path: Path, folder: Path) -> Preset:
    """Copy the preset in the file ``path`` into the user's ``folder``; raises as ``save`` and ``presets.load`` do."""
    return save(presets.load(path), folder)
