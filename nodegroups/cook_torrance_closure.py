# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``closure``: Cycles' own Beckmann closure, which has Smith's G in place of the V-groove's."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..addon.reference.fresnel import F82_COSINE
from . import cook_torrance, ensure, fresnel
from ._tree import Number, Tree, Value, output, sqrt
from .versions import EXACT_CONDUCTOR

if TYPE_CHECKING:
    from bpy.types import Node, NodeSocket

NAME = "VGroove Cook-Torrance Closure"
F82_NAME = ".VGroove F82 of Dielectric"
REVISION = 4


def build(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, native=True)  # Cycles clamps alpha to 1
    native = lobe(tree, kind, inputs.fresnel, sqrt(inputs.m), inputs.normal)
    tree.output_shader("BSDF", native, tip="To the material's Surface")


def lobe(
    tree: Tree, kind: str, parameters: dict[str, Value], roughness: Value, normal: Value,
    anisotropy: Value | None = None, tangent: Value | None = None,
) -> NodeSocket:  # fmt: skip
    """Cycles' Metallic BSDF with the Fresnel term of ``kind``."""
    metallic = tree.node("ShaderNodeBsdfMetallic", distribution="BECKMANN", Roughness=roughness, Normal=normal)
    if anisotropy is not None and tangent is not None:
        tree.wire(metallic, "Anisotropy", anisotropy)
        tree.wire(metallic, "Tangent", tangent)
    if kind == "schlick":
        _f82(tree, metallic, parameters["f0"], (1.0, 1.0, 1.0))  # with a white edge F82 is Schlick's formula
    elif kind == "f82":
        _f82(tree, metallic, parameters["f0"], parameters["f82_tint"])
    elif kind == "dielectric" and not EXACT_CONDUCTOR:
        _f82(tree, metallic, *_f82_of_dielectric(tree, parameters["eta"]))
    else:
        metallic.fresnel_type = "PHYSICAL_CONDUCTOR"
        tree.wire(metallic, "IOR", parameters["n"] if kind == "conductor" else parameters["eta"])
        tree.wire(metallic, "Extinction", parameters.get("k", (0.0, 0.0, 0.0)))
    return output(metallic, "BSDF")


def _f82(tree: Tree, metallic: Node, f0: Value, tint: Number) -> None:
    metallic.fresnel_type = "F82"
    tree.wire(metallic, "Base Color", f0)
    tree.wire(metallic, "Edge Tint", tint)


def _f82_of_dielectric(tree: Tree, eta: Value) -> tuple[Value, Value]:
    """Base colour and edge tint that make F82 exact head-on, at 82 degrees and grazing."""
    node = tree.group(ensure(F82_NAME, 1, _build_f82_of_dielectric), IOR=eta)
    f0, tint = (Value(tree, socket) for socket in node.outputs)
    return f0, tint


def _build_f82_of_dielectric(tree: Tree) -> None:
    eta = fresnel.held(tree, "dielectric")["eta"]
    with tree.frame("F82 fitted to the exact dielectric"):
        f0 = ((eta - 1.0) / (eta + 1.0)) ** 2
        grazing = (1.0 - F82_COSINE) ** 5
        tint = fresnel.reflectance(tree, "dielectric", {"eta": eta}, F82_COSINE) / (f0 + (1.0 - f0) * grazing)
    tree.output_float("F0", f0, tip="Head-on")
    tree.output_float("Edge Tint", tint, tip="At 82 degrees, over Schlick's")


def build_osl(tree: Tree, kind: str) -> None:
    inputs = cook_torrance.interface(tree, kind, native=True)
    node = cook_torrance.script(tree, "closure", kind, inputs)
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")
