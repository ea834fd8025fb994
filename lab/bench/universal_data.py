# SPDX-License-Identifier: GPL-3.0-or-later
"""The data of the universal material: properties of the object, which Attribute nodes read as a ray meets it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ...addon.blender import course
from ...addon.blender import lamps as lamp_binding
from ...addon.library.checks import M_RANGE
from ...addon.library.presets import Preset, shipped
from ...addon.models import MODELS, base_name, fresnel, parameter
from . import peers

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bpy.types import Object

    from ...addon.blender.course import Play
    from ...addon.reference.keyframes import Keyframes

NAME = "VGroove Universal"
REVISION = 1
LOBES = 3  # as many as any of our car paints has
WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
NEUTRAL: dict[str, Any] = {  # each parameter, as it is where a preset has none
    "f0": BLACK, "f82_tint": WHITE, "eta": 1.5, "n": WHITE, "k": WHITE, "m": 0.3, "albedo": BLACK, "sigma": 0.0,
    "d": 0.0, "s": 0.0, "tint": WHITE, "absorption": BLACK, "reflectance": WHITE, "mean_free_path": WHITE,
}  # fmt: skip
OF_LOBES = ("f0", "f82_tint", "m", "s")
# A preset's kind, by its number in these; and what else is on or off.
KINDS = {"fresnel": fresnel.KINDS, "diffuse": MODELS["oren_nayar"].kinds, "interface": MODELS["glass"].kinds}
SWITCHES = (*KINDS, "coupled", "body", "glass", "smooth", "age")


def data_of(preset: Preset | None, age: float = 0.0, play: Play | None = None) -> dict[str, Any]:
    """The properties that show ``preset``: at ``age`` of its course if it has one and it is played; of None nothing.

    Of a parameter that moves, properties end in Before and After, what its input holds at the keys around ``age``, and
    Span, their ages.
    """
    values = {name: NEUTRAL[base_name(name)] for name in names()}
    switches: dict[str, float] = dict.fromkeys(SWITCHES, 0.0)
    keys = {}
    if preset is not None:
        mine = {universal_name(name): value for name, value in preset.parameters.items()}
        values |= {name: value for name, value in mine.items() if name in values}  # without glass's Abbe number
        values["m"] = max(values["m"], M_RANGE[0])
        switches |= {name: float([*of].index(preset.kind)) for name, of in KINDS.items() if preset.kind in of}
        switches |= {"coupled": float("coupled" in preset.flags), "smooth": float(preset.m == 0.0)}
        for name, value in peers.of(preset).UNIVERSAL.items():
            (switches if name in switches else values)[name] = value
        if play is not None:
            switches["age"] = age
            keys = {universal_name(n): of for n, of in course.keyframes(preset.trajectory(), play).items()}
        if preset.kind in MODELS[preset.model].sheets:
            values["absorption"] = BLACK  # a sheet has no inside
    found: dict[str, Any] = {property_name(name): value for name, value in switches.items()}
    for name, value in values.items():
        if base_name(name) not in moving():
            found[property_name(name)] = value
            continue
        held = parameter(name).scale.to_input(value)
        before, after, span = _around(keys[name], age) if name in keys else (held, held, (0.0, 1.0, 0.0))
        found |= {
            property_name(name, "before"): before,
            property_name(name, "after"): after,
            property_name(name, "span"): span,
        }
    for index in range(1, lamp_binding.LIMIT + 1):
        found[property_name(f"lamp {index}", "axis")] = (0.3, 0.2, 0.9)
        found[property_name(f"lamp {index}", "strength")] = 0.0
    return found


def _around(keys: Keyframes, age: float) -> tuple[Any, Any, tuple[float, float, float]]:
    """The keys before and after ``age``, and their ages."""
    k = int(np.clip(np.searchsorted(keys.times, age, side="right"), 1, max(keys.times.size - 1, 1)))
    ends = (k - 1, min(k, keys.times.size - 1))
    before, after = (keys.values[end].tolist() for end in ends)
    start, end = (float(keys.times[end]) for end in ends)
    return before, after, (start, end, 0.0)


def names() -> list[str]:
    return [*NEUTRAL, *(f"{name}_{k}" for k in range(2, LOBES + 1) for name in OF_LOBES)]


def universal_name(parameter: str) -> str:
    """The first lobe of a car paint is the Cook-Torrance part."""
    return parameter.removesuffix("_1")


def property_name(*words: str) -> str:
    return " ".join(("vgroove", *words))


def moving() -> set[str]:
    """The parameters that some preset changes over time."""
    return {base_name(name) for preset in shipped().values() if preset.time for name in preset.time.laws}


def set_data(item: Object, data: Mapping[str, Any]) -> None:
    """Set the data of an object that has the universal material."""
    for name, value in data.items():
        item[name] = value
    item.update_tag()
