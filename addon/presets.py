# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: one TOML file a material, presets/FAMILY/MATERIAL.toml, read into frozen dataclasses and checked.

    name = "Copper"                 # what artists see
    model = "cook_torrance"         # opaque: reflection alone
    m = 0.3                         # RMS facet slope; 0 is a plain smooth interface
    [fresnel]                       # one of: f0 (RGB); eta; n and k (RGB)
    f0 = [0.95, 0.64, 0.54]
    [source]
    data = "author, year, table"    # where every number comes from
    trust = "what is measured and what is chosen"

Other models take their numbers at the top: "oren_nayar" albedo (RGB), sigma and kind "full" or "qualitative"; "glass",
which is transparent, m, eta, tint (RGB) and kind "interface" or "thin" (a sheet of it); "sum", a diffuse part under a
specular one, d, s, albedo, sigma, m and [fresnel], and coupled = true where the diffuse part gets what that leaves.

Imports no bpy.
"""

from __future__ import annotations

import difflib
import tomllib
from dataclasses import dataclass, replace
from functools import cache
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .reference import Conductor, CookTorrance, Dielectric, Fresnel, Glass, OrenNayar, Schlick, Smooth, Sum

if TYPE_CHECKING:
    from collections.abc import Callable

FOLDER = Path(__file__).parent.parent / "presets"
FIRST_FAMILY = "lecture"  # wins where a bare name is ambiguous
MODELS = {"cook_torrance": ("m",), "oren_nayar": ("albedo", "sigma"), "glass": ("m", "eta", "tint")}  # their numbers
MODELS["sum"] = ("d", "s", *MODELS["oren_nayar"], *MODELS["cook_torrance"])
FLAGS = {"sum": ("coupled",)}  # what is true or false of a model; false where it is not given
KINDS = {"oren_nayar": ("full", "qualitative"), "glass": ("interface", "thin")}  # the first where none is given
TRANSPARENT = {"glass"}
DEFAULTS = {"tint": (1.0, 1.0, 1.0)}
FRESNEL_KEYS = {"schlick": ("f0",), "dielectric": ("eta",), "conductor": ("n", "k")}
M_RANGE = (1e-4, 10.0)  # what float32 shaders keep finite; 0 stands for a smooth interface
RANGES = {"m": M_RANGE, "f0": (0.0, 1.0), "eta": (0.1, 10.0), "n": (0.0, 20.0), "k": (0.0, 20.0)}
# White Oren-Nayar as published sends back up to 1.051 of what arrives; below 0.95 no direction exceeds 1.
RANGES |= {"d": (0.0, 1.0), "s": (0.0, 1.0), "albedo": (0.0, 0.95), "sigma": (0.0, pi / 2), "tint": (0.0, 1.0)}
RGB = {"f0", "n", "k", "albedo", "tint"}
TOP_KEYS = {"name": str, "model": str, "kind": str, "fresnel": dict, "source": dict, "tags": list, "notes": str}
SOURCE_KEYS = ("data", "licence", "trust")


class PresetError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


@dataclass(frozen=True)
class Preset:
    """One material. ``parameters`` holds the model's numbers by their reference names.

    ``kind`` is the form of the model: of ``cook_torrance`` that of its Fresnel term, else one of ``KINDS``.
    """

    id: str
    name: str
    model: str
    kind: str
    parameters: dict[str, float | tuple[float, float, float]]
    source: dict[str, str]
    tags: tuple[str, ...] = ()
    notes: str = ""
    coupled: bool = False

    @property
    def family(self) -> str:
        return self.id.split("/")[0]

    @property
    def m(self) -> float:
        """RMS facet slope; 0 for a smooth interface, and for a model that has none."""
        value = self.parameters.get("m", 0.0)
        assert isinstance(value, float)  # noqa: S101 - one number by RANGES; only colours are tuples
        return value

    @property
    def transparent(self) -> bool:
        """Whether light goes through it."""
        return self.model in TRANSPARENT

    def reference_fresnel(self) -> Fresnel:
        """F of the reference, for models that have one."""
        kinds: dict[str, Callable[..., Fresnel]] = {
            "schlick": Schlick,
            "dielectric": Dielectric,
            "conductor": Conductor,
        }
        return kinds[self.kind](*(self.parameters[key] for key in FRESNEL_KEYS[self.kind]))

    def reference(self) -> CookTorrance | Smooth | OrenNayar | Glass | Sum:
        """The model of the reference that this preset stands for."""
        values: dict[str, Any] = self.parameters
        if self.model == "oren_nayar":
            return OrenNayar(values["albedo"], values["sigma"], qualitative=self.kind == "qualitative")
        if self.model == "glass":
            return Glass(self.m, values["eta"], values["tint"], thin=self.kind == "thin")
        if self.model == "sum":
            diffuse, specular = (part.reference() for part in self.parts().values())
            return Sum(diffuse, specular, values["d"], values["s"], self.coupled)
        F = self.reference_fresnel()
        return Smooth(F) if self.m == 0 else CookTorrance(self.m, F)

    def parts(self) -> dict[str, Preset]:
        """The diffuse and the specular part of a sum, each as a preset."""
        models = {"diffuse": ("oren_nayar", KINDS["oren_nayar"][0]), "specular": ("cook_torrance", self.kind)}
        return {
            part: replace(self, model=model, kind=kind, parameters={
                key: value for key, value in self.parameters.items()
                if key in MODELS[model] or (part == "specular" and key in FRESNEL_KEYS[kind])
            })
            for part, (model, kind) in models.items()
        }  # fmt: skip

    def with_parameters(self, **changes: Any) -> Preset:
        """A copy with some parameters changed; raises PresetError for an unknown name or a value out of range."""
        where = f"preset {self.id}"
        for key in changes:
            _known(where, key, self.parameters)
        checked = self.parameters | {key: _number(where, key, value) for key, value in changes.items()}
        _holds_together(where, checked, self.kind, coupled=self.coupled)
        return replace(self, parameters=checked)


def parse(text: str, identity: str, where: str) -> Preset:
    """A preset from TOML ``text``; ``where`` (a file name) opens every PresetError."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = f"{where}: not valid TOML: {error}"
        raise PresetError(message) from error
    model = _typed(where, "model", data.get("model", next(iter(MODELS))), str)
    if model not in MODELS:
        message = f'{where}: unknown model "{model}"; use one of {", ".join(MODELS)}'
        raise PresetError(message)
    numbers = MODELS[model]
    for key, value in data.items():
        _known(where, key, [*TOP_KEYS, *numbers, *FLAGS.get(model, ())])
        if key in TOP_KEYS:
            _typed(where, key, value, TOP_KEYS[key])
    needed = [key for key in numbers if key not in DEFAULTS] + ["fresnel"] * (model not in KINDS)
    for key in ("name", "model", *needed, "source"):
        if key not in data:
            message = f'{where}: "{key}" is missing; add {_example(key)}'
            raise PresetError(message)
    parameters = {key: _number(where, key, data.get(key, DEFAULTS.get(key))) for key in numbers}
    if model in KINDS:
        kind = _kind(where, model, data)
    else:
        kind = _fresnel_kind(where, data["fresnel"])
        parameters |= {key: _number(where, key, data["fresnel"][key]) for key in FRESNEL_KEYS[kind]}
    coupled = _typed(where, "coupled", data.get("coupled", False), bool)
    _holds_together(where, parameters, kind, coupled=coupled)
    source = _source(where, data["source"])
    tags = tuple(_typed(where, "tags", tag, str) for tag in data.get("tags", []))
    return Preset(identity, data["name"], model, kind, parameters, source, tags, data.get("notes", ""), coupled)


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
    if not isinstance(value, accepted) or isinstance(value, bool) != (kind is bool):
        wanted = {bool: "true or false", float: "a number", str: "a text", dict: "a table", list: "a list"}[kind]
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


def _holds_together(where: str, parameters: dict[str, Any], kind: str, *, coupled: bool) -> None:
    """The weights of a sum share what arrives; a coupled one lets light through to its diffuse part."""
    if coupled:
        _holds_coupled(where, parameters, kind)
        return
    d, s = parameters.get("d", 0.0), parameters.get("s", 0.0)
    if d + s > 1.0 + 1e-9:
        message = f"{where}: d + s must be at most 1, or more light would leave than arrives; got {d:g} + {s:g}"
        raise PresetError(message)


def _holds_coupled(where: str, parameters: dict[str, Any], kind: str) -> None:
    if kind == "conductor":
        message = f"{where}: a coupled sum needs eta or f0: no light passes a metal (n and k) to a diffuse part"
        raise PresetError(message)
    if kind == "schlick" and len(set(parameters["f0"])) > 1:
        message = f"{where}: a coupled sum needs an f0 without colour, got {list(parameters['f0'])}; give one number"
        raise PresetError(message)
    if parameters["m"] > 1.0:
        message = f"{where}: a coupled sum needs m of at most 1, got {parameters['m']:g}"
        raise PresetError(message)


def _kind(where: str, model: str, data: dict[str, Any]) -> str:
    """The kind of a model that is not told by its Fresnel term."""
    if "fresnel" in data:
        message = f"{where}: model {model} takes no [fresnel]; leave it out"
        raise PresetError(message)
    kind = str(data.get("kind", KINDS[model][0]))
    if kind not in KINDS[model]:
        message = f'{where}: kind of {model} must be one of {", ".join(KINDS[model])}, got "{kind}"'
        raise PresetError(message)
    return kind


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
        "eta": "eta = 1.5",
        "albedo": "albedo = [0.5, 0.5, 0.5]",
        "sigma": "sigma = 0.3",
        "d": "d = 0.6",
        "s": "s = 0.4",
        "fresnel": "a table [fresnel] with f0, eta, or n and k",
        "source": 'a table [source] with data = "author, year, page"',
    }[key]
