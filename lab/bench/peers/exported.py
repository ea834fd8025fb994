# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show a model without a module of its own: Principled with the numbers that exports give it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ....addon.models.principled import Feed
from ...scenery import add_node
from .nodes import LOBE, Peer, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, ShaderNodeTree

    from ....addon.library.presets import Preset

LOCAL = False  # grooves follow the ball's tangents, which only Blender knows
UNIVERSAL: dict[str, float] = {}


def cycles(preset: Preset) -> Iterator[Peer]:
    yield principled(LOBE, **_given(preset))


def native(tree: ShaderNodeTree, preset: Preset) -> Node:
    return add_node(tree, "BsdfPrincipled", **_given(preset))


def mitsuba(_preset: Preset) -> None:
    """None of its BSDFs has such a lobe."""


def _given(preset: Preset) -> dict[str, Any]:
    inputs = preset.spec.principled(preset) if preset.spec.principled else {}
    return {name: what.value(preset) if isinstance(what, Feed) else what for name, what in inputs.items()}
