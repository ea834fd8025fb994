# SPDX-License-Identifier: GPL-3.0-or-later
"""What else could show Cook-Torrance facets."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import minimize_scalar

from ....addon.reference.fresnel import F82_COSINE, fresnel_conductor, schlick
from ....nodegroups import versions
from ...scenery import add_node
from ..mitsuba_scenes import rgb, roughness
from .nodes import BECKMANN, LOBE, Peer, colour, principled

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Node, ShaderNodeTree

    from ....addon.library.presets import Preset

LOCAL = True
UNIVERSAL = {"s": 1.0}
F82: dict[str, Any] = BECKMANN | {"fresnel_type": "F82"}


def cycles(preset: Preset) -> Iterator[Peer]:
    """For Schlick's Fresnel term."""
    of: dict[str, Any] = preset.parameters
    f0, rough = of["f0"], of["m"] ** 0.5
    metallic = {"Base Color": f0, "Edge Tint": (1.0, 1.0, 1.0), "Roughness": rough}
    yield Peer("Metallic BSDF", "Smith's G", "BsdfMetallic", F82 | metallic)
    glossy = BECKMANN | {"Color": f0, "Roughness": rough}
    yield Peer("Glossy BSDF", "Smith's G; reflects the same share at every angle", "BsdfGlossy", glossy)
    yield principled(LOBE, Base_Color=f0, Metallic=1.0, Roughness=rough)


def native(tree: ShaderNodeTree, preset: Preset) -> Node:
    """F82, exact head-on and at 82 degrees for any Fresnel term; a dielectric's own term where Cycles has it."""
    rough = preset.m**0.5
    if preset.kind == "dielectric" and versions.EXACT_CONDUCTOR:
        exact = BECKMANN | {"fresnel_type": "PHYSICAL_CONDUCTOR", "IOR": (preset.parameters["eta"],) * 3}
        return add_node(tree, "BsdfMetallic", **exact, Extinction=(0.0,) * 3, Roughness=rough)
    reflectance = preset.reference_fresnel()
    head_on, edge = (np.asarray(colour(reflectance(cos).tolist())) for cos in (1.0, F82_COSINE))
    tint = np.clip(edge / schlick(F82_COSINE, np.clip(head_on, 0.0, 1.0)), 0.0, 1.0)
    return add_node(tree, "BsdfMetallic", **F82, Roughness=rough, Base_Color=tuple(head_on), Edge_Tint=tuple(tint))


def mitsuba(preset: Preset) -> dict[str, Any] | None:
    if preset.kind not in {"schlick", "conductor"}:
        return None
    of: dict[str, Any] = preset.parameters
    n, k = (of["n"], of["k"]) if preset.kind == "conductor" else conductor_like(of["f0"])
    return roughness("conductor", preset.m) | {"eta": rgb(n), "k": rgb(k)}


@cache
def conductor_like(f0: tuple[float, ...]) -> tuple[list[float], list[float]]:
    """n and k, for each channel, of the conductor that reflects ``f0`` head-on and is nearest to Schlick elsewhere.

    f0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) leaves n free between (1 - r) / (1 + r), r = sqrt(f0), and its inverse;
    the n is chosen for which the largest distance of F from Schlick's, over all angles, is smallest. f0 in (0, 1).
    """
    cos = np.linspace(0.0, 1.0, 1001)
    indices, extinctions = [], []
    for f in f0:

        def k(n: float, f: float = f) -> float:
            return float(np.sqrt(max(f * (n + 1.0) ** 2 - (n - 1.0) ** 2, 0.0) / (1.0 - f)))

        def distance(n: float, f: float = f) -> float:
            return float(np.max(np.abs(fresnel_conductor(cos, n, k(n)) - schlick(cos, f))))

        least = (1.0 - f**0.5) / (1.0 + f**0.5)
        n = float(minimize_scalar(distance, bounds=(least, 1.0 / least), options={"xatol": 1e-8}).x)
        indices.append(n)
        extinctions.append(k(n))
    return indices, extinctions
