# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show Oren-Nayar's diffuse facets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ....addon.reference.oren_nayar_fit import closure_roughness
from ...scenery import add_node
from ..mitsuba_scenes import rgb
from .nodes import Peer, colour, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, ShaderNodeTree

    from ....addon.library.presets import Preset

LOCAL = True
UNIVERSAL = {"d": 1.0}


def cycles(preset: Preset) -> Iterator[Peer]:
    of: dict[str, Any] = preset.parameters
    albedo, sigma = of["albedo"], of["sigma"]
    yield Peer(
        "Diffuse BSDF", "Fujii's fit of Oren and Nayar's model", "BsdfDiffuse", {"Color": albedo, "Roughness": sigma}
    )
    yield principled("Fujii's fit, under no coat", Base_Color=albedo, Diffuse_Roughness=sigma, Specular_IOR_Level=0.0)


def native(tree: ShaderNodeTree, preset: Preset) -> Node:
    of: dict[str, Any] = preset.parameters
    return add_node(tree, "BsdfDiffuse", Color=colour(of["albedo"]), Roughness=float(closure_roughness(of["sigma"])))


def mitsuba(preset: Preset) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": rgb(preset.parameters["albedo"])}
