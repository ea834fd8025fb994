# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show glass."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...scenery import add_node
from ..mitsuba_scenes import roughness
from .nodes import BECKMANN, LOBE, Peer, colour, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, ShaderNodeTree

    from ....addon.library.presets import Preset

LOCAL = False
UNIVERSAL = {"glass": 1.0}


def cycles(preset: Preset) -> Iterator[Peer]:
    of: dict[str, Any] = preset.parameters
    numbers = {"IOR": of["eta"], "Roughness": of["m"] ** 0.5}
    yield Peer("Glass BSDF", "Smith's G", "BsdfGlass", BECKMANN | {"Color": of["tint"]} | numbers)
    yield principled(LOBE, Base_Color=of["tint"], Transmission_Weight=1.0, **numbers)


def native(tree: ShaderNodeTree, preset: Preset) -> Node:
    of: dict[str, Any] = preset.parameters
    numbers = BECKMANN | {"Color": colour(of["tint"]), "IOR": of["eta"], "Roughness": preset.m**0.5}
    return add_node(tree, "BsdfGlass", **numbers)


def mitsuba(preset: Preset) -> dict[str, Any] | None:
    if preset.kind != "interface":
        return None
    return roughness("dielectric", preset.m) | {"int_ior": preset.parameters["eta"], "ext_ior": 1.0}
