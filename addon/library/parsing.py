# SPDX-License-Identifier: GPL-3.0-or-later
"""A preset's file, read: TOML text -> ``Preset``, every number checked against its model's spec. Imports no bpy.

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
    colour = "measured"             # or computed, quoted, by eye; in the same way roughness
    [verified]
    f0 = [0.95, 0.64, 0.54]         # reflectance head-on by the reference

Other models have the numbers of their spec (``addon/models``) at the top, and kind and flags where they have some; a
lobe of several is a table [[lobes]]; how facets are turned, a table [[distribution]] (``distribution``). Numbers that
change over time have their laws in a table [time]: see ``timeline``.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from ..models import DEFAULT, MODELS, PARAMETERS, MeasuredTable, fresnel
from . import distribution, timeline
from .checks import PresetError, as_in_range, as_number, as_typed, check_key
from .errors import InputError
from .inputs import shown, toml
from .preset import Preset, check_form

if TYPE_CHECKING:
    from ..models import Model, Number

LONGEST_NAME = 60  # characters (Blender keeps 63 bytes of a name)
TOP_KEYS = {"name": str, "model": str, "kind": str, "fresnel": dict, "source": dict, "tags": list, "notes": str}
TOP_KEYS |= {"m_range": list, "verified": dict, "time": dict, "table": dict}
SOURCE_KEYS = ("data", "licence", "trust", "colour", "roughness")
EVIDENCE = ("measured", "computed", "quoted", "by eye")  # how colour and roughness are known
EXAMPLES = {
    "name": 'name = "Copper"',
    "model": 'model = "cook_torrance"',
    "fresnel": "a table [fresnel] with f0, f0 and f82_tint, eta, or n and k",
    "lobes": "a table [[lobes]] for each lobe",
    "distribution": "a table [[distribution]] with beckmann, ggx, exponential, abc or points",
    "table": 'a table [table] with file = "chrome.binary" and the sha256 of its content',
    "source": 'a table [source] with data = "author, year, page"',
}


def parse(text: str, identity: str, where: str) -> Preset:
    """A preset from TOML ``text``; ``where`` (a file name) opens every PresetError."""
    try:
        data = toml(text)
    except InputError as error:
        message = f"{where}: {error}"
        raise PresetError(message) from error
    name = as_typed(where, "model", data.get("model", DEFAULT), str)
    if name not in MODELS:
        message = f'{where}: unknown model "{name}"; use one of {", ".join(MODELS)}'
        raise PresetError(message)
    model = MODELS[name]
    _check_keys(where, data, model)
    kind, parameters = _numbers(where, data, model)
    if not (data["name"].isprintable() and len(data["name"].strip()) > 0 and len(data["name"]) <= LONGEST_NAME):
        message = f"{where}: name must be 1 to {LONGEST_NAME} printable characters, got {shown(data['name'])}"
        raise PresetError(message)
    preset = Preset(
        identity,
        data["name"],
        name,
        kind,
        parameters,
        _source(where, data["source"]),
        tuple(as_typed(where, "tags", tag, str) for tag in data.get("tags", [])),
        data.get("notes", ""),
        m_range=_m_range(where, data["m_range"], parameters) if "m_range" in data else None,
        verified=_verified(where, data.get("verified", {})),
        time=timeline.parse(where, data["time"], parameters) if "time" in data else None,
        distribution=distribution.parse(where, data["distribution"]) if model.distribution else (),
        table=_table(where, data["table"]) if model.table else None,
        flags=tuple(flag for flag in model.flags if as_typed(where, flag, data.get(flag, False), bool)),
    )
    check_form(where, preset)
    return preset


def _check_keys(where: str, data: dict[str, Any], model: Model) -> None:
    """PresetError for a key that the model does not know, of another type, or missing."""
    lobes = ["lobes"] * bool(model.lobes) + ["distribution"] * bool(model.distribution)
    if "table" in data and model.table is None:
        message = f"{where}: model {model.name} takes no [table]; leave it out"
        raise PresetError(message)
    for key, value in data.items():
        check_key(where, key, [*TOP_KEYS, *(one.name for one in model.parameters), *model.flags, *lobes])
        if key in TOP_KEYS:
            as_typed(where, key, value, TOP_KEYS[key])
    needed = [one.name for one in model.parameters if not one.optional] + ["fresnel"] * model.has_fresnel + lobes
    needed += ["table"] * (model.table is not None)
    for key in ("name", "model", *needed, "source"):
        if key not in data:
            example = EXAMPLES[key] if key in EXAMPLES else PARAMETERS[key].example
            message = f'{where}: "{key}" is missing; add {example}'
            raise PresetError(message)


def _numbers(where: str, data: dict[str, Any], model: Model) -> tuple[str, dict[str, Number]]:
    """The form, and every parameter by its reference name: the model's own, its Fresnel term's, its lobes'."""
    numbers = {one.name: as_number(where, one.name, data.get(one.name, one.default)) for one in model.parameters}
    if not model.has_fresnel:
        kind = _kind(where, model, data)
        return kind, numbers | (_lobes(where, data["lobes"], model) if model.lobes else {})
    kind = _fresnel_kind(where, data["fresnel"])
    terms = fresnel.KINDS[kind].parameters
    return kind, numbers | {one.name: as_number(where, one.name, data["fresnel"][one.name]) for one in terms}


def _lobes(where: str, tables: Any, model: Model) -> dict[str, Number]:
    """The numbers of each lobe, s_1, m_1 and so on."""
    as_typed(where, "lobes", tables, list)
    if not 1 <= len(tables) <= model.most_lobes:
        message = f"{where}: [[lobes]] must be 1 to {model.most_lobes} tables, got {len(tables)}"
        raise PresetError(message)
    keys = [one.name for one in model.lobes]
    numbers: dict[str, Number] = {}
    for index, table in enumerate(tables, 1):
        of = f"{where}: lobe {index}"
        for key in as_typed(where, "lobes", table, dict):
            check_key(of, key, keys)
        for key in keys:
            if key not in table:
                message = f'{of}: "{key}" is missing; a lobe has {", ".join(keys)}'
                raise PresetError(message)
            numbers[f"{key}_{index}"] = as_number(of, key, table[key])
    return numbers


def _kind(where: str, model: Model, data: dict[str, Any]) -> str:
    """The kind of a model that has no Fresnel term to tell it."""
    if "fresnel" in data:
        message = f"{where}: model {model.name} takes no [fresnel]; leave it out"
        raise PresetError(message)
    kind = str(data.get("kind", next(iter(model.kinds))))
    if kind not in model.kinds:
        message = f'{where}: kind of {model.name} must be one of {", ".join(model.kinds)}, got "{kind}"'
        raise PresetError(message)
    return kind


def _fresnel_kind(where: str, table: dict[str, Any]) -> str:
    names = {kind: {one.name for one in of.parameters} for kind, of in fresnel.KINDS.items()}
    for key in table:
        check_key(where, key, sorted(set().union(*names.values())))
    for kind, keys in names.items():
        if set(table) == keys:
            return kind
    message = (
        f"{where}: [fresnel] must hold f0, or f0 and f82_tint, or eta, or n and k; got {', '.join(table) or 'nothing'}"
    )
    raise PresetError(message)


def _source(where: str, table: dict[str, Any]) -> dict[str, str]:
    for key, value in table.items():
        check_key(where, key, SOURCE_KEYS)
        as_typed(where, key, value, str)
        if key in {"colour", "roughness"} and value not in EVIDENCE:
            message = f'{where}: [source] {key} must be one of {", ".join(EVIDENCE)}, got "{value}"'
            raise PresetError(message)
    if not table.get("data", "").strip():
        message = f'{where}: [source] has no "data"; say where the numbers come from'
        raise PresetError(message)
    return dict(table)


def _table(where: str, table: dict[str, Any]) -> MeasuredTable:
    """The file of a measured table, as it is written there."""
    for key, value in table.items():
        check_key(f"{where}: [table]", key, ("file", "sha256"))
        as_typed(where, key, value, str)
    of = MeasuredTable(table.get("file", ""), table.get("sha256", "").lower())
    if of.file and not re.fullmatch("[0-9a-f]{64}", of.sha256):
        message = f"{where}: [table] must hold sha256 = the 64 digits of the file's SHA-256, got {shown(of.sha256)}"
        raise PresetError(message)
    return of


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


def _verified(where: str, table: dict[str, Any]) -> dict[str, Number]:
    checked = {}
    for key, value in table.items():
        check_key(f"{where}: [verified]", key, ("f0",))
        checked[key] = as_number(where, key, value)
    return checked
