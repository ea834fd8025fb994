# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material was built from: one JSON object with named keys and a format number, in its property "vgroove".

``migrate`` lifts what earlier formats kept; files are upgraded when a material is changed, never when it is only read.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ..library import distribution
from ..library.presets import Preset, all_presets
from ..library.timeline import Timeline
from ..models import MODELS
from ..reference.hybrid import DEFAULT_BOUND
from . import roles
from .course import Play
from .roles import KEY

if TYPE_CHECKING:
    from bpy.types import Material

FORMAT = 3
FORMAT_2 = 2
STATE_1, TIME_1 = "vgroove_state", "vgroove_time"  # custom properties of format 1, beside KEY
UNKNOWN_SOURCE = {"data": "unknown"}


@dataclass(frozen=True)
class Record:
    """What a material was built from.

    preset: as it was then, with its course. lights: those that the material evaluates itself, as plain values.
    play: how the course is played; None for a material that stands still. state: the inputs that artists can change,
    as built (``material._state``), to tell whether they did.
    """

    preset: Preset
    backend: str
    estimator: str
    bound: float
    shadows: bool
    lights: tuple[Any, ...]
    play: Play | None
    state: str = ""
    disperses: bool = False
    bounces: bool = False

    def dumps(self) -> str:
        return json.dumps({"format": FORMAT} | asdict(self))

    def builds(self) -> str:
        """The same text for records that build the same material."""
        of = self.preset
        preset = [of.id, of.name, of.model, of.kind, of.flags, of.parameters, *map(asdict, of.distribution)]
        course = [asdict(self.play), of.time and asdict(of.time)] if self.play else None
        bound = self.bound if self.estimator == "hybrid" else None
        more = [self.disperses, self.bounces]
        return json.dumps([preset, self.backend, self.estimator, bound, self.shadows, self.lights, course, *more])


def read(material: Material) -> Record | None:
    """What a material was built from; None if it is not ours, or made by a later version, or its record is damaged."""
    if KEY not in material:
        return None
    model = roles.node(material, roles.MODEL) if roles.is_format_1(material) else None
    kept = (material.get(name) for name in (KEY, STATE_1, TIME_1))
    return _read(*(str(text or "") for text in kept), model.label if model else "")


def write(material: Material, record: Record) -> None:
    material[KEY] = record.dumps()


@lru_cache(maxsize=4096)  # the panel reads it with every redraw
def _read(text: str, state: str, course: str, label: str) -> Record | None:
    try:
        kept = migrate(json.loads(text), state, json.loads(course or "null"), label)
        preset = dict(kept["preset"])
        preset |= {"parameters": _values(preset["parameters"]), "verified": _values(preset["verified"])}
        preset |= {key: tuple(preset[key]) for key in ("tags", "flags")}
        preset |= {"distribution": distribution.of_record(preset.get("distribution", ()))}  # older ones had none
        preset |= {"m_range": preset["m_range"] and tuple(preset["m_range"])}
        preset["time"] = preset["time"] and Timeline(**preset["time"])
        play = kept["play"] and Play(**kept["play"])
        names = ("backend", "estimator", "bound", "shadows", "state")
        record = Record(
            Preset(**preset), **{name: kept[name] for name in names}, lights=tuple(kept["lights"]), play=play,
            disperses=bool(kept.get("disperses")), bounces=bool(kept.get("bounces")),
        )  # fmt: skip
    except (ValueError, KeyError, TypeError, AttributeError):
        return None
    return record if record.preset.model in MODELS else None


def _values(kept: dict[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in kept.items()}


def migrate(kept: Any, state: str, course: Any, label: str) -> dict[str, Any]:
    """What any format kept, in the present one; ValueError for a later format.

    state, course: what format 1 kept beside it. label: of its node, which was the preset's name.
    """
    if isinstance(kept, list):
        kept = _from_format_1(kept, state, course, label)
    if kept["format"] > FORMAT:
        message = f"format {kept['format']} was made by a later version"
        raise ValueError(message)
    return _from_format_2(kept) if kept["format"] == FORMAT_2 else dict(kept)


def _from_format_1(kept: list[Any], state: str, course: Any, label: str) -> dict[str, Any]:
    """From a list of texts and numbers: what it left out is taken from the preset of that id, if there still is one."""
    identity, model, kind, coupled, parameters, backend, estimator, lights, *bound = kept
    known = all_presets().get(identity)
    if known is not None and (known.model, known.kind) != (model, kind):
        known = None
    time = known.time if known and known.time and set(known.time.laws) <= set(parameters) else None
    preset = Preset(
        identity, label or (known.name if known else identity), model, kind, parameters,
        known.source if known else UNKNOWN_SOURCE, known.tags if known else (), flags=("coupled",) * coupled,
        time=Timeline(**course["time"]) if course else time,
    )  # fmt: skip
    return {
        "format": FORMAT, "preset": asdict(preset), "backend": backend, "estimator": estimator,
        "bound": bound[0] if bound else DEFAULT_BOUND, "shadows": all(one[3] for one in lights), "lights": lights,
        "play": course["play"] if course else None, "state": state,
    }  # fmt: skip


def _from_format_2(kept: dict[str, Any]) -> dict[str, Any]:
    """Which named the one flag that there was."""
    preset = dict(kept["preset"])
    preset["flags"] = ["coupled"] * preset.pop("coupled")
    return kept | {"format": FORMAT, "preset": preset}
