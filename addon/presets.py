# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: one TOML file a material, presets/FAMILY/MATERIAL.toml, read into frozen dataclasses and checked.

    name = "Copper"                 # what artists see
    model = "cook_torrance"
    m = 0.3                         # RMS facet slope; 0 is a plain smooth interface
    [fresnel]                       # one of: f0 (RGB); eta; n and k (RGB)
    f0 = [0.95, 0.64, 0.54]
    [source]
    data = "author, year, table"    # where every number comes from
    trust = "what is measured and what is chosen"

Imports no bpy.
"""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .reference import Conductor, CookTorrance, Dielectric, Fresnel, Schlick, Smooth

if TYPE_CHECKING:
    from collections.abc import Callable

FOLDER = Path(__file__).parent.parent / "presets"
FIRST_FAMILY = "lecture"  # wins where a bare name is ambiguous
MODELS = ("cook_torrance",)
FRESNEL_KEYS = {"schlick": ("f0",), "dielectric": ("eta",), "conductor": ("n", "k")}
M_RANGE = (1e-4, 10.0)  # what float32 shaders keep finite; 0 stands for a smooth interface
RANGES = {"m": M_RANGE, "f0": (0.0, 1.0), "eta": (0.1, 10.0), "n": (0.0, 20.0), "k": (0.0, 20.0)}
RGB = {"f0", "n", "k"}
TOP_KEYS = {"name": str, "model": str, "m": float, "fresnel": dict, "source": dict, "tags": list, "notes": str}
SOURCE_KEYS = ("data", "licence", "trust")


class PresetError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


@dataclass(frozen=True)
class Preset:
    """One material. ``parameters`` holds m and the Fresnel numbers by their reference names."""

    id: str
    name: str
    model: str
    fresnel: str
    parameters: dict[str, float | tuple[float, float, float]]
    source: dict[str, str]
    tags: tuple[str, ...] = ()
    notes: str = ""

    @property
    def family(self) -> str:
        return self.id.split("/")[0]

    @property
    def m(self) -> float:
        """RMS facet slope; 0 for a smooth interface."""
        value = self.parameters["m"]
        assert isinstance(value, float)  # noqa: S101 - one number by RANGES; only colours are tuples
        return value

    def reference_fresnel(self) -> Fresnel:
        """F of the reference."""
        values = [self.parameters[key] for key in FRESNEL_KEYS[self.fresnel]]
        kinds: dict[str, Callable[..., Fresnel]] = {
            "schlick": Schlick,
            "dielectric": Dielectric,
            "conductor": Conductor,
        }
        return kinds[self.fresnel](*values)

    def reference(self) -> CookTorrance | Smooth:
        """The model of the reference that this preset stands for."""
        F = self.reference_fresnel()
        return Smooth(F) if self.m == 0 else CookTorrance(self.m, F)

    def with_parameters(self, **changes: Any) -> Preset:
        """A copy with some parameters changed; raises PresetError for an unknown name or a value out of range."""
        where = f"preset {self.id}"
        for key in changes:
            _known(where, key, self.parameters)
        checked = {key: _number(where, key, value) for key, value in changes.items()}
        return replace(self, parameters={**self.parameters, **checked})


def parse(text: str, identity: str, where: str) -> Preset:
    """A preset from TOML ``text``; ``where`` (a file name) opens every PresetError."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = f"{where}: not valid TOML: {error}"
        raise PresetError(message) from error
    for key, value in data.items():
        _known(where, key, TOP_KEYS)
        _typed(where, key, value, TOP_KEYS[key])
    for key in ("name", "model", "m", "fresnel", "source"):
        if key not in data:
            message = f'{where}: "{key}" is missing; add {_example(key)}'
            raise PresetError(message)
    if data["model"] not in MODELS:
        message = f'{where}: unknown model "{data["model"]}"; use one of {", ".join(MODELS)}'
        raise PresetError(message)
    fresnel = _fresnel_kind(where, data["fresnel"])
    parameters = {"m": _number(where, "m", data["m"])}
    parameters |= {key: _number(where, key, data["fresnel"][key]) for key in FRESNEL_KEYS[fresnel]}
    source = _source(where, data["source"])
    tags = tuple(_typed(where, "tags", tag, str) for tag in data.get("tags", []))
    return Preset(identity, data["name"], data["model"], fresnel, parameters, source, tags, data.get("notes", ""))


def load(path: Path) -> Preset:
    """The preset in ``path`` (FAMILY/MATERIAL.toml); PresetError if it cannot be read or does not hold."""
    where = f"{path.parent.name}/{path.name}"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        message = f"{where}: cannot be read: {error}"
        raise PresetError(message) from error
    return parse(text, f"{path.parent.name}/{path.stem}", where)


def load_folder(folder: Path) -> dict[str, Preset]:
    """All presets below ``folder`` by id; PresetError on the first that does not hold, or on two of one id."""
    presets: dict[str, Preset] = {}
    for path in sorted(folder.glob("*/*.toml")):
        preset = load(path)
        same = next((other for other in presets if other.casefold() == preset.id.casefold()), None)
        if same is not None:  # file systems that fold case would hold only one of the two
            message = f"{path.parent.name}/{path.name}: duplicate id, differs from {same} only in case; rename one"
            raise PresetError(message)
        presets[preset.id] = preset
    return presets


@cache
def all_presets() -> dict[str, Preset]:
    """The presets that ship with vgroove, by id."""
    return load_folder(FOLDER)


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
    names = [*presets, *(preset.id.split("/")[1] for preset in presets.values())]
    near = difflib.get_close_matches(name, names, n=1)
    message = f'unknown preset "{name}"; ' + (f'did you mean "{near[0]}"?' if near else '"vgroove presets" lists them')
    raise PresetError(message)


def search(query: str) -> list[Preset]:
    """Presets whose id, name or tags contain every word of ``query``, in order of id."""
    words = query.casefold().split()
    return [p for p in all_presets().values() if all(w in " ".join((p.id, p.name, *p.tags)).casefold() for w in words)]


def _known(where: str, key: str, known: Any) -> None:
    if key not in known:
        near = difflib.get_close_matches(key, list(known), n=1)
        hint = f'did you mean "{near[0]}"?' if near else f"known are {', '.join(known)}"
        message = f'{where}: unknown key "{key}"; {hint}'
        raise PresetError(message)


def _typed(where: str, key: str, value: Any, kind: type) -> Any:
    accepted = (int, float) if kind is float else kind
    if not isinstance(value, accepted) or isinstance(value, bool):
        wanted = {float: "a number", str: "a text", dict: "a table", list: "a list"}[kind]
        message = f"{where}: {key} must be {wanted}, got {value!r}"
        raise PresetError(message)
    return value


def _number(where: str, key: str, value: Any) -> float | tuple[float, float, float]:
    """A parameter within its range: one number, or three for RGB (one number then counts for all three)."""
    if key not in RGB:
        return _in_range(where, key, value)
    channels = [value] * 3 if isinstance(value, (int, float)) else value
    if not isinstance(channels, (list, tuple)) or len(channels) != 3:
        message = f"{where}: {key} must be one number or three (R, G, B), got {value!r}"
        raise PresetError(message)
    red, green, blue = (_in_range(where, key, channel) for channel in channels)
    return red, green, blue


def _in_range(where: str, key: str, value: Any) -> float:
    number = float(_typed(where, key, value, float))
    low, high = RANGES[key]
    if key == "m" and number == 0.0:
        return number
    if not low <= number <= high:
        hint = " (or 0, a smooth interface)" if key == "m" else ""
        message = f"{where}: {key} must be between {low:g} and {high:g}{hint}, got {number:g}"
        raise PresetError(message)
    return number


def _fresnel_kind(where: str, table: dict[str, Any]) -> str:
    for key in table:
        _known(where, key, ("f0", "eta", "n", "k"))
    for kind, keys in FRESNEL_KEYS.items():
        if set(table) == set(keys):
            return kind
    message = f"{where}: [fresnel] must hold f0, or eta, or n and k; got {', '.join(table) or 'nothing'}"
    raise PresetError(message)


def _source(where: str, table: dict[str, Any]) -> dict[str, str]:
    for key, value in table.items():
        _known(where, key, SOURCE_KEYS)
        _typed(where, key, value, str)
    if not table.get("data", "").strip():
        message = f'{where}: [source] has no "data"; say where the numbers come from'
        raise PresetError(message)
    return dict(table)


def _example(key: str) -> str:
    return {
        "name": 'name = "Copper"',
        "model": 'model = "cook_torrance"',
        "m": "m = 0.3",
        "fresnel": "a table [fresnel] with f0, eta, or n and k",
        "source": 'a table [source] with data = "author, year, page"',
    }[key]
