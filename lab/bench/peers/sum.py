# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show a diffuse part under a specular one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..mitsuba_scenes import rgb, roughness
from .nodes import COAT, LEVEL, LOBE, Peer, native_parts, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, ShaderNodeTree

    from ....addon.library.presets import Preset

LOCAL = True
UNIVERSAL: dict[str, float] = {}


def cycles(preset: Preset) -> Iterator[Peer]:
    """For a dielectric's Fresnel term."""
    of: dict[str, Any] = preset.parameters
    yield principled(
        f"{LOBE}; {COAT}",
        Base_Color=tuple(of["d"] * c for c in of["albedo"]),
        IOR=of["eta"],
        Specular_IOR_Level=LEVEL * of["s"],
        Roughness=of["m"] ** 0.5,
    )


def native(tree: ShaderNodeTree, preset: Preset) -> Node:
    of: dict[str, Any] = preset.parameters
    return native_parts(tree, preset, (of["d"], of["s"]))


def mitsuba(preset: Preset) -> dict[str, Any] | None:
    if preset.kind != "dielectric":
        return None
    of: dict[str, Any] = preset.parameters
    lobes = {
        "diffuse_reflectance": rgb(of["d"] * np.array(of["albedo"])),
        "specular_reflectance": rgb([of["s"]] * 3),
    }
    return roughness("plastic", preset.m) | {"int_ior": of["eta"], "ext_ior": 1.0} | lobes
