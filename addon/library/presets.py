# SPDX-License-Identifier: GPL-3.0-or-later
"""The library of presets: presets/FAMILY/MATERIAL.toml and the user's own, by id. Imports no bpy."""

from __future__ import annotations

import difflib
import os
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

from .checks import PresetError
from .files import FileError, read_text
from .parsing import parse
from .preset import Preset
from .search import search as search_among

__all__ = [
    "Preset",
    "PresetError",
    "all_presets",
    "find",
    "load",
    "load_errors",
    "load_folder",
    "parse",
    "reread",
    "search",
    "set_user_folder",
    "shipped",
    "user_folder",
]  # fmt: skip

FOLDER = Path(__file__).parents[2] / "presets"
USER_FOLDER = "VGROOVE_PRESETS"  # the environment variable that names a folder of more presets
USER_FAMILY = "mine"  # of a file that lies right in that folder
LONGEST_FILE = 100_000  # bytes
FIRST_FAMILY = "lecture"  # wins where a bare name is ambiguous


def load(path: Path) -> Preset:
    """The preset in ``path`` (FAMILY/MATERIAL.toml); PresetError if it cannot be read or does not hold."""
    return _read(path, path.parent.name)


def _read(path: Path, family: str) -> Preset:
    where, identity = f"{path.parent.name}/{path.name}", f"{family}/{path.stem}"
    if not re.fullmatch(r"[\w.-]+/[\w.-]+", identity):
        message = f'{where}: cannot be "{identity}"; name file and folder with letters, digits, "_", "-" and "." alone'
        raise PresetError(message)
    try:
        text = read_text(path, LONGEST_FILE)
    except FileError as error:
        message = f"{where}: cannot be read: {error}"
        raise PresetError(message) from error
    preset = parse(text, identity, where)
    if preset.table is None or not preset.table.file or Path(preset.table.file).is_absolute():
        return preset
    return replace(preset, table=replace(preset.table, file=str(path.absolute().parent / preset.table.file)))


def load_folder(folder: Path) -> dict[str, Preset]:
    """All presets below ``folder`` by id; PresetError on the first that does not hold, or on two of one id."""
    presets: dict[str, Preset] = {}  # by id without case: file systems that fold case would hold only one of two
    for path in sorted(folder.glob("*/*.toml")):
        preset = load(path)
        same = presets.setdefault(preset.id.casefold(), preset)
        if same is not preset:
            message = f"{path.parent.name}/{path.name}: duplicate id, differs from {same.id} only in case; rename one"
            raise PresetError(message)
    return {preset.id: preset for preset in presets.values()}


@cache
def shipped() -> dict[str, Preset]:
    """The presets that ship with vgroove, by id."""
    return load_folder(FOLDER)


_user_folders: list[Path] = []  # of the extension; in use where the environment names none


def user_folder() -> Path | None:
    """Where the user's own presets are: the folder that ``VGROOVE_PRESETS`` names, else the extension's."""
    named = os.environ.get(USER_FOLDER)
    if not named:
        return next(iter(_user_folders), None)
    try:
        return Path(named).expanduser()
    except RuntimeError:  # ~somebody whom the system does not know
        return Path(named)


def set_user_folder(folder: Path | None) -> None:
    """The folder for presets of those who have not set ``VGROOVE_PRESETS``."""
    _user_folders[:] = [folder] if folder else []


@cache
def _of_user(folder: Path | None) -> tuple[dict[str, Preset], dict[str, PresetError]]:
    """What holds in the user's folder, MATERIAL.toml or FAMILY/MATERIAL.toml, and what does not, by id."""
    held: dict[str, Preset] = {}
    refused: dict[str, PresetError] = {}
    if folder is None or not folder.is_dir():
        return held, refused
    taken = {identity.casefold(): identity for identity in shipped()}
    for path in sorted([*folder.glob("*.toml"), *folder.glob("*/*.toml")]):
        family = USER_FAMILY if path.parent == folder else path.parent.name
        try:
            preset = _read(path, family)
        except PresetError as error:
            refused[f"{family}/{path.stem}"] = error
            continue
        same = taken.setdefault(preset.id.casefold(), preset.id)
        if preset.id in shipped() or preset.id in held or same != preset.id:
            message = f"{path.parent.name}/{path.name}: there is a preset {same} already; rename the file"
            refused[preset.id] = PresetError(message)
        else:
            held[preset.id] = preset
    return held, refused


def all_presets() -> dict[str, Preset]:
    """The presets that ship with vgroove and those of the user that hold, by id."""
    return shipped() | _of_user(user_folder())[0]


def load_errors() -> list[PresetError]:
    """Why files of the user's folder cannot be loaded, one error each; or that the folder is missing."""
    folder = user_folder()
    if os.environ.get(USER_FOLDER) and folder is not None and not folder.is_dir():
        return [PresetError(f"{USER_FOLDER}: {folder} is no folder; make it, or unset the variable")]
    return list(_of_user(folder)[1].values())


def reread() -> None:
    """Read the user's folder again at the next request."""
    _of_user.cache_clear()


def find(name: str) -> Preset:
    """The preset of id FAMILY/MATERIAL or of bare name MATERIAL; PresetError suggests what is near."""
    presets = all_presets()
    if name in presets:
        return presets[name]
    hits = [preset for preset in presets.values() if preset.id.split("/")[1] == name]
    first = [preset for preset in hits if preset.family == FIRST_FAMILY]
    if len(hits) == 1 or first:
        return (first or hits)[0]
    if hits:
        message = f'preset "{name}" is in several families; write one of {", ".join(p.id for p in hits)}'
        raise PresetError(message)
    for identity, error in _of_user(user_folder())[1].items():
        if name in {identity, identity.split("/")[1]}:
            raise error
    names = [*presets, *(preset.id.split("/")[1] for preset in presets.values())]
    near = difflib.get_close_matches(name, names, n=1)
    message = f'unknown preset "{name}"; ' + (f'did you mean "{near[0]}"?' if near else '"vgroove presets" lists them')
    raise PresetError(message)


def search(query: str) -> list[Preset]:
    """Presets that have every word of ``query``, the best first (``search.search``); all, by id, if it has none."""
    return search_among(query, all_presets().values())
