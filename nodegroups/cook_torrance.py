# SPDX-License-Identifier: GPL-3.0-or-later
"""What all Cook-Torrance groups share: the artist's inputs, and the equations' dot products."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import fresnel, osl_script, shading_normal

if TYPE_CHECKING:
    from bpy.types import Node

    from ._tree import Number, Tree, Value


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: Fresnel parameters by reference name, RMS slope, and the normal as linked (or not)."""

    fresnel: dict[str, Value]
    m: Value
    normal: Value


def interface(tree: Tree, kind: str, *, m_high: float) -> Inputs:
    """The Fresnel term's own; Slope m; Normal. The same for every estimator and backend."""
    parameters = fresnel.interface(tree, kind)
    tip = "RMS slope of the facets; Blender's Roughness is its square root"
    m = tree.input_float("Slope m", 0.3, low=1e-4, high=m_high, tip=tip, held=True)
    return Inputs(parameters, m, shading_normal.interface(tree))


def given(tree: Tree, kind: str) -> Inputs:
    """The same inputs, where another group's have been taken over; of kinds that a coupled sum takes."""
    labels = {"schlick": {"f0": "F0"}, "dielectric": {"eta": "IOR"}}[kind]
    parameters = {name: tree.given(label) for name, label in labels.items()}
    return Inputs(parameters, tree.given("Slope m"), tree.given("Normal"))


def script(tree: Tree, estimator: str, kind: str, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``cook_torrance_ESTIMATOR`` fed by these inputs."""
    return osl_script.script(
        tree,
        f"cook_torrance_{estimator}",
        kind=list(fresnel.KINDS).index(kind),
        m=inputs.m,
        Normal=inputs.normal,
        **inputs.fresnel,
        **more,
    )
