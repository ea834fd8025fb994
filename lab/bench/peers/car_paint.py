# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show a lacquer of several lobes over a base."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from .nodes import COAT, LEVEL, LOBE, Peer, native_parts, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, ShaderNodeTree

    from ....addon.library.presets import Preset

LOCAL = True
UNIVERSAL = {"d": 1.0}
F0_OF_GLASS = 0.04  # what Principled's usual IOR of 1.5 reflects


def cycles(preset: Preset) -> Iterator[Peer]:
    of: dict[str, Any] = preset.parameters
    f0, m = max((of[f"s_{k}"] * sum(of[f"f0_{k}"]) / 3, of[f"m_{k}"]) for k in range(1, preset.lobes + 1))
    yield principled(
        f"{LOBE}; {COAT}, and of {preset.lobes} lobes the strongest, grey",
        Base_Color=of["albedo"],
        Specular_IOR_Level=LEVEL * f0 / F0_OF_GLASS,
        Roughness=m**0.5,
    )


def native(tree: ShaderNodeTree, preset: Preset) -> Node:
    of: dict[str, Any] = preset.parameters
    return native_parts(tree, preset, (1.0, *(of[f"s_{k}"] for k in range(1, preset.lobes + 1))))


def mitsuba(_preset: Preset) -> None:
    return None
