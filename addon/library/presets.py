# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets: one TOML file a material, presets/FAMILY/MATERIAL.toml, read into frozen dataclasses and checked.

    name = "Copper"                 # what artists see
    model = "cook_torrance"         # opaque: reflection alone
    m = 0.3                         # RMS facet slope; 0 is a plain smooth interface
    m_range = [0.02, 0.5]           # slopes that suit it; may be left out, as may tags, notes, trust and [verified]
    tags = ["metal"]
    [fresnel]                       # one of: f0 (RGB); f0 and f82_tint (RGB); eta; n and k (RGB)
    f0 = [0.95, 0.64, 0.54]
    [source]
    data = "author, year, table"    # where every number comes from
    trust = "what is measured and what is chosen"
    [verified]
    f0 = [0.95, 0.64, 0.54]         # reflectance head-on by the reference

Other models take their numbers at the top:

- "oren_nayar": albedo (RGB), sigma; kind "full" or "qualitative".
- "glass", which is transparent: m, eta, tint (RGB), absorption (RGB, 1/m); kind "interface" or "thin" (a sheet of it).
- "sum", a diffuse part under a specular one: d, s, albedo, sigma, m and [fresnel]; coupled = true where the diffuse
  part gets what the specular one leaves.
- "car_paint": albedo and sigma of its base and, for each of up to four lobes, a table [[lobes]] with s, m, f0,
  f82_tint, which are its parameters s_1, m_1, ... s_2 and so on.
- "translucent": reflectance and mean_free_path (RGB, metres) of the body, m and [fresnel] of the coat.

Numbers that change over time have their laws in a table [time]: see ``timeline``.

Imports no bpy.
"""

from __future__ import annotations

import difflib
import os
import re
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..reference import (
    F82,
    CarPaint,
    Conductor,
    CookTorrance,
    Dielectric,
    Fresnel,
    Glass,
    Lambert,
    OrenNayar,
    Schlick,
    Smooth,
    Sum,
)
from . import timeline
from .checks import PresetError, as_in_range, as_number, as_typed, base_name, check_key
from .errors import InputError
from .files import FileError, read_text
from .inputs import shown, toml

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..reference.trajectory import Trajectory

FOLDER = Path(__file__).parents[2] / "presets"
USER_FOLDER = "VGROOVE_PRESETS"  # the environment variable that names a folder of more presets
USER_FAMILY = "mine"  # of a file that lies right in that folder
LONGEST_FILE, LONGEST_NAME = 100_000, 60  # bytes; characters (Blender keeps 63 bytes of a name)
FIRST_FAMILY = "lecture"  # wins where a bare name is ambiguous
MODELS = {
    "cook_torrance": ("m",),
    "oren_nayar": ("albedo", "sigma"),
    "glass": ("m", "eta", "tint", "absorption"),
}  # their numbers
MODELS["sum"] = ("d", "s", *MODELS["oren_nayar"], *MODELS["cook_torrance"])
MODELS["car_paint"] = ("albedo", "sigma")
MODELS["translucent"] = ("reflectance", "mean_free_path", *MODELS["cook_torrance"])
LOBE, MOST_LOBES = ("s", "m", "f0", "f82_tint"), 4  # of car paint
FLAGS = {"sum": ("coupled",)}  # what is true or false of a model; false where it is not given
# The first where none is given
KINDS = {"oren_nayar": ("full", "qualitative"), "glass": ("interface", "thin"), "car_paint": ("f82",)}
TRANSPARENT = {"glass"}
DEFAULTS = {"tint": (1.0, 1.0, 1.0), "absorption": (0.0, 0.0, 0.0)}
FRESNEL_KEYS = {"schlick": ("f0",), "dielectric": ("eta",), "conductor": ("n", "k"), "f82": ("f0", "f82_tint")}
COUPLED_F0, COUPLED_ETA = 0.25, 3.0  # up to which the shaders' albedo of the specular part was fitted and is tested
LISTS = {"car_paint": ("lobes",)}  # tables of numbers beside a model's own
TOP_KEYS = {"name": str, "model": str, "kind": str, "fresnel": dict, "source": dict, "tags": list, "notes": str}
TOP_KEYS |= {"m_range": list, "verified": dict, "time": dict}
SOURCE_KEYS = ("data", "licence", "trust")


@dataclass(frozen=True)
class Preset:
    """One material. ``parameters`` holds the model's numbers by their reference names.

    ``kind`` is the form of the model: of ``cook_torrance`` that of its Fresnel term, else one of ``KINDS``.
    ``m_range``: slopes that suit the material. ``verified``: its reflectance head-on, "f0", by the reference.
    ``time``: how its numbers change, where they do; ``parameters`` are those at the start.
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
    m_range: tuple[float, float] | None = None
    verified: dict[str, float | tuple[float, float, float]] = field(default_factory=dict)
    time: timeline.Timeline | None = None

    @property
    def family(self) -> str:
        return self.id.split("/")[0]

    @property
    def m(self) -> float:
        """RMS facet slope, of several lobes the largest; 0 for a smooth interface, and for a model that has none."""
        return max(
            (v for key, v in self.parameters.items() if base_name(key) == "m" and isinstance(v, float)), default=0.0
        )

    @property
    def transparent(self) -> bool:
        """Whether light goes through it."""
        return self.model in TRANSPARENT

    def trajectory(self) -> Trajectory:
        """How its numbers change; PresetError where they do not."""
        if self.time is None:
            message = f"preset {self.id} does not change over time"
            raise PresetError(message)
        return self.time.trajectory(self.parameters)

    def at(self, time: float) -> Preset:
        """The material as it is at a time, in the preset's own unit; times beyond its range show its ends."""
        now = {name: timeline.plain(value) for name, value in self.trajectory().at(time).items()}
        return replace(self, parameters=self.parameters | now, verified={}, m_range=None, time=None)

    def reference_fresnel(self) -> Fresnel:
        """F of the reference, for models that have one."""
        kinds: dict[str, Callable[..., Fresnel]] = {
            "schlick": Schlick,
            "dielectric": Dielectric,
            "conductor": Conductor,
            "f82": F82,
        }
        return kinds[self.kind](*(self.parameters[key] for key in FRESNEL_KEYS[self.kind]))

    def reference(self) -> CookTorrance | Smooth | OrenNayar | Glass | Sum | CarPaint:
        """The model of the reference that this preset stands for."""
        values: dict[str, Any] = self.parameters
        if self.model == "oren_nayar":
            return OrenNayar(values["albedo"], values["sigma"], qualitative=self.kind == "qualitative")
        if self.model == "glass":
            return Glass(self.m, values["eta"], values["tint"], thin=self.kind == "thin")
        if self.model == "car_paint":
            base, *lobes = (part.reference() for part in self.parts().values())
            return CarPaint(base, tuple(lobes), tuple(values[f"s_{k}"] for k in range(1, len(lobes) + 1)))
        if self.model == "translucent":  # as a large body is under even light
            return Sum(Lambert(values["reflectance"]), self.parts()["specular"].reference(), 1.0, 1.0, coupled=True)
        if self.model == "sum":
            diffuse, specular = (part.reference() for part in self.parts().values())
            return Sum(diffuse, specular, values["d"], values["s"], self.coupled)
        F = self.reference_fresnel()
        return Smooth(F) if self.m == 0 else CookTorrance(self.m, F)

    def parts(self) -> dict[str, Preset]:
        """The diffuse part of a sum or a car paint and what lies over it, or a body's coat, each as a preset."""
        parts = {}
        if self.model in {"sum", "car_paint"}:
            parts["diffuse"] = self._part("oren_nayar", KINDS["oren_nayar"][0], "")
        if self.model in {"sum", "translucent"}:
            parts["specular"] = self._part("cook_torrance", self.kind, "")
        for k in range(1, self.lobes + 1):
            parts[f"lobe {k}"] = self._part("cook_torrance", self.kind, f"_{k}")
        return parts

    @property
    def lobes(self) -> int:
        """How many lobes a car paint has; 0 for other models."""
        return sum(base_name(key) == "s" and key != "s" for key in self.parameters)

    def _part(self, model: str, kind: str, suffix: str) -> Preset:
        wanted = (*MODELS[model], *FRESNEL_KEYS.get(kind, ()))
        numbers = {key: self.parameters[key + suffix] for key in wanted}
        return replace(self, model=model, kind=kind, parameters=numbers, time=None)

    def with_parameters(self, /, **changes: Any) -> Preset:
        """A copy with some parameters changed; raises PresetError for an unknown name or a value out of range.

        What is given a value keeps it: it no longer changes over time.
        """
        where = f"preset {self.id}"
        for key in changes:
            check_key(where, key, self.parameters)
        checked = self.parameters | {key: as_number(where, key, value) for key, value in changes.items()}
        _holds_together(where, checked, self.kind, coupled=self.coupled)
        left = self.time and self.time.without(changes)
        if checked == self.parameters and left == self.time:
            return self
        changed = replace(self, parameters=checked, verified={}, time=left)
        _holds_throughout(where, changed)
        suits = self.m_range is not None and self.m_range[0] <= changed.m <= self.m_range[1]
        return changed if suits else replace(changed, m_range=None)


def parse(text: str, identity: str, where: str) -> Preset:
    """A preset from TOML ``text``; ``where`` (a file name) opens every PresetError."""
    try:
        data = toml(text)
    except InputError as error:
        message = f"{where}: {error}"
        raise PresetError(message) from error
    model = as_typed(where, "model", data.get("model", next(iter(MODELS))), str)
    if model not in MODELS:
        message = f'{where}: unknown model "{model}"; use one of {", ".join(MODELS)}'
        raise PresetError(message)
    numbers = MODELS[model]
    for key, value in data.items():
        check_key(where, key, [*TOP_KEYS, *numbers, *FLAGS.get(model, ()), *LISTS.get(model, ())])
        if key in TOP_KEYS:
            as_typed(where, key, value, TOP_KEYS[key])
    needed = [key for key in numbers if key not in DEFAULTS] + ["fresnel"] * (model not in KINDS)
    needed += LISTS.get(model, ())
    for key in ("name", "model", *needed, "source"):
        if key not in data:
            message = f'{where}: "{key}" is missing; add {_example(key)}'
            raise PresetError(message)
    parameters = {key: as_number(where, key, data.get(key, DEFAULTS.get(key))) for key in numbers}
    if model in KINDS:
        kind = _kind(where, model, data)
        if model == "car_paint":
            parameters |= _lobes(where, data["lobes"])
    else:
        kind = _fresnel_kind(where, data["fresnel"])
        parameters |= {key: as_number(where, key, data["fresnel"][key]) for key in FRESNEL_KEYS[kind]}
    if not (data["name"].isprintable() and len(data["name"].strip()) > 0 and len(data["name"]) <= LONGEST_NAME):
        message = f"{where}: name must be 1 to {LONGEST_NAME} printable characters, got {shown(data['name'])}"
        raise PresetError(message)
    coupled = as_typed(where, "coupled", data.get("coupled", False), bool)
    _holds_together(where, parameters, kind, coupled=coupled)
    source = _source(where, data["source"])
    tags = tuple(as_typed(where, "tags", tag, str) for tag in data.get("tags", []))
    m_range = _m_range(where, data["m_range"], parameters) if "m_range" in data else None
    verified = _verified(where, data.get("verified", {}))
    changes = timeline.parse(where, data["time"], parameters) if "time" in data else None
    preset = Preset(
        identity, data["name"], model, kind, parameters, source, tags, data.get("notes", ""), coupled, m_range,
        verified, changes,
    )  # fmt: skip
    _holds_throughout(where, preset)
    return preset


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
    return parse(text, identity, where)


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


def refused() -> list[PresetError]:
    """Of each of the user's files that does not hold, why; and of a folder that is not there."""
    folder = user_folder()
    if os.environ.get(USER_FOLDER) and folder is not None and not folder.is_dir():
        return [PresetError(f"{USER_FOLDER}: {folder} is no folder; make it, or unset the variable")]
    return list(_of_user(folder)[1].values())


def reread() -> None:
    """Look again into the user's folder when next asked."""
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
    """Presets whose id, name or tags contain every word of ``query``, in order of id."""
    words = query.casefold().split()
    return [p for p in all_presets().values() if all(w in " ".join((p.id, p.name, *p.tags)).casefold() for w in words)]


def _lobes(where: str, tables: Any) -> dict[str, float | tuple[float, float, float]]:
    """The numbers of each lobe of a car paint, s_1, m_1 and so on."""
    as_typed(where, "lobes", tables, list)
    if not 1 <= len(tables) <= MOST_LOBES:
        message = f"{where}: [[lobes]] must be 1 to {MOST_LOBES} tables, got {len(tables)}"
        raise PresetError(message)
    numbers: dict[str, float | tuple[float, float, float]] = {}
    for index, table in enumerate(tables, 1):
        of = f"{where}: lobe {index}"
        for key in as_typed(where, "lobes", table, dict):
            check_key(of, key, LOBE)
        for key in LOBE:
            if key not in table:
                message = f'{of}: "{key}" is missing; a lobe has {", ".join(LOBE)}'
                raise PresetError(message)
            numbers[f"{key}_{index}"] = as_number(of, key, table[key])
    return numbers


def _holds_together(where: str, parameters: dict[str, Any], kind: str, *, coupled: bool) -> None:
    """The weights of a sum share what arrives; a coupled one lets light through to its diffuse part."""
    if coupled or "mean_free_path" in parameters:
        _holds_coupled(where, parameters, kind)
        return
    lobes = [value for key, value in parameters.items() if base_name(key) == "s" and key != "s"]
    if lobes and sum(lobes) + max(parameters["albedo"]) > 1.0 + 1e-9:
        got = f"{max(parameters['albedo']):g} + {sum(lobes):g}"
        message = (
            f"{where}: albedo and all s must together be at most 1, or more light would leave than arrives; got {got}"
        )
        raise PresetError(message)
    d, s = parameters.get("d", 0.0), parameters.get("s", 0.0)
    if d + s > 1.0 + 1e-9:
        message = f"{where}: d + s must be at most 1, or more light would leave than arrives; got {d:g} + {s:g}"
        raise PresetError(message)


def _holds_throughout(where: str, preset: Preset) -> None:
    """The same at every time of a preset that changes."""
    if preset.time is None:
        return
    moments = preset.time.moments
    values = preset.trajectory().at(moments)
    for index, time in enumerate(moments):
        now = {name: timeline.plain(of[index]) for name, of in values.items()}
        at = f"{where}: at time {time:g}"
        _holds_together(at, preset.parameters | now, preset.kind, coupled=preset.coupled)


def _holds_coupled(where: str, parameters: dict[str, Any], kind: str) -> None:
    coated = "a translucent body" if "mean_free_path" in parameters else "a coupled sum"
    if kind in {"conductor", "f82"}:
        message = f"{where}: {coated} needs eta or f0: no light passes a metal to what lies below"
        raise PresetError(message)
    if kind == "schlick" and len(set(parameters["f0"])) > 1:
        message = f"{where}: {coated} needs an f0 without colour, got {list(parameters['f0'])}; give one number"
        raise PresetError(message)
    if kind == "schlick" and max(parameters["f0"]) > COUPLED_F0:
        got = f"{max(parameters['f0']):g}"
        message = f"{where}: {coated} needs f0 of at most {COUPLED_F0:g} (an index of 3), got {got}"
        raise PresetError(message)
    if kind == "dielectric" and not 1.0 <= parameters["eta"] <= COUPLED_ETA:
        message = f"{where}: {coated} needs eta from 1 to {COUPLED_ETA:g}, got {parameters['eta']:g}"
        raise PresetError(message)
    if parameters["m"] > 1.0:
        message = f"{where}: {coated} needs m of at most 1, got {parameters['m']:g}"
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
        check_key(where, key, [key for keys in FRESNEL_KEYS.values() for key in keys])
    for kind, keys in FRESNEL_KEYS.items():
        if set(table) == set(keys):
            return kind
    message = (
        f"{where}: [fresnel] must hold f0, or f0 and f82_tint, or eta, or n and k; got {', '.join(table) or 'nothing'}"
    )
    raise PresetError(message)


def _source(where: str, table: dict[str, Any]) -> dict[str, str]:
    for key, value in table.items():
        check_key(where, key, SOURCE_KEYS)
        as_typed(where, key, value, str)
    if not table.get("data", "").strip():
        message = f'{where}: [source] has no "data"; say where the numbers come from'
        raise PresetError(message)
    return dict(table)


def _m_range(where: str, values: list[Any], parameters: dict[str, Any]) -> tuple[float, float]:
    """Two ascending slopes around the preset's own."""
    bounds = [as_in_range(where, "m", value) for value in values]
    if "m" not in parameters:
        message = f"{where}: m_range goes with a model that has an m; leave it out"
        raise PresetError(message)
    if len(bounds) != 2 or not bounds[0] <= parameters["m"] <= bounds[1]:
        message = f"{where}: m_range must be two slopes with m = {parameters['m']:g} between them, got {values}"
        raise PresetError(message)
    return bounds[0], bounds[1]


def _verified(where: str, table: dict[str, Any]) -> dict[str, float | tuple[float, float, float]]:
    checked = {}
    for key, value in table.items():
        check_key(f"{where}: [verified]", key, ("f0",))
        checked[key] = as_number(where, key, value)
    return checked


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
        "reflectance": "reflectance = [0.8, 0.7, 0.6]",
        "mean_free_path": "mean_free_path = [0.001, 0.001, 0.001] (metres)",
        "lobes": "a table [[lobes]] with s, m, f0 and f82_tint for each lobe",
        "fresnel": "a table [fresnel] with f0, f0 and f82_tint, eta, or n and k",
        "source": 'a table [source] with data = "author, year, page"',
    }[key]
