# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Beckmann closure, which has Smith's G in place of the V-groove's."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ..addon.reference.fresnel import F82_COSINE
from . import cook_torrance, fresnel
from ._tree import Number, Tree, Value, sqrt

if TYPE_CHECKING:
    from bpy.types import Node, NodeSocket

NAME = "VGroove Cook-Torrance Closure"
REVISION = 2
EXACT_CONDUCTOR = (5, 2, 0)  # earlier Physical Conductors approximate: up to 0.8 % of the peak, half of it at k = 0


def has_exact_conductor() -> bool:
    """Whether this Blender's Metallic BSDF evaluates the conductor's Fresnel term exactly."""
    return bpy.app.version >= EXACT_CONDUCTOR


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=1.0)  # Cycles clamps alpha to 1
    native = lobe(tree, kind, inputs.fresnel, sqrt(inputs.m), inputs.normal)
    tree.output_shader("BSDF", native, tip="To the material's Surface")


def lobe(
    tree: Tree, kind: str, parameters: dict[str, Value], roughness: Value, normal: Value,
    anisotropy: Value | None = None, tangent: Value | None = None,
) -> NodeSocket:  # fmt: skip
    """Cycles' Metallic BSDF with the Fresnel term of ``kind``."""
    metallic = tree.node("ShaderNodeBsdfMetallic", distribution="BECKMANN")
    tree.connect(roughness, metallic.inputs["Roughness"])
    tree.connect(normal, metallic.inputs["Normal"])
    if anisotropy is not None and tangent is not None:
        tree.connect(anisotropy, metallic.inputs["Anisotropy"])
        tree.connect(tangent, metallic.inputs["Tangent"])
    if kind == "schlick":
        _f82(tree, metallic, parameters["f0"], (1.0, 1.0, 1.0))  # with a white edge F82 is Schlick's formula
    elif kind == "f82":
        _f82(tree, metallic, parameters["f0"], parameters["f82_tint"])
    elif kind == "dielectric" and not has_exact_conductor():
        _f82(tree, metallic, *_f82_of_dielectric(tree, parameters["eta"]))
    else:
        metallic.fresnel_type = "PHYSICAL_CONDUCTOR"
        tree.connect(parameters["n"] if kind == "conductor" else parameters["eta"], metallic.inputs["IOR"])
        tree.connect(parameters.get("k", (0.0, 0.0, 0.0)), metallic.inputs["Extinction"])
    return metallic.outputs["BSDF"]


def _f82(tree: Tree, metallic: Node, f0: Value, tint: Number) -> None:
    metallic.fresnel_type = "F82"
    tree.connect(f0, metallic.inputs["Base Color"])
    tree.connect(tint, metallic.inputs["Edge Tint"])


def _f82_of_dielectric(tree: Tree, eta: Value) -> tuple[Value, Value]:
    """Base colour and edge tint that make F82 exact head-on, at 82 degrees and grazing."""
    with tree.frame("F82 fitted to the exact dielectric"):
        f0 = ((eta - 1.0) / (eta + 1.0)) ** 2
        grazing = (1.0 - F82_COSINE) ** 5
        tint = fresnel.reflectance(tree, "dielectric", {"eta": eta}, F82_COSINE) / (f0 + (1.0 - f0) * grazing)
    return f0, tint


def build_osl(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=1.0)
    node = cook_torrance.script(tree, "closure", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")
