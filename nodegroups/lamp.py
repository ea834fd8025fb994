# SPDX-License-Identifier: GPL-3.0-or-later
"""What a sun, point or spot lamp of no size sends to the shaded point; the inputs are driven by the lamp.

Cycles' units: a sun's strength is its irradiance in W/m^2 across the beam; a point or spot of power P in W gives
P / (4 pi d^2) at distance d, as if it shone evenly in all directions (the spot's cone does not concentrate it).
"""

from __future__ import annotations

from math import pi

import bpy

from . import osl_script
from ._tree import Tree, Value, clamp, dot, length, less, normalize, scale

REVISION = 1
KINDS = ("SUN", "POINT", "SPOT")


def name(kind: str, *, shadows: bool) -> str:
    return f"VGroove {kind.title()} Lamp" + (", shadows" if shadows else "")


def can_cast_shadows() -> bool:
    """Whether this Blender's shader nodes can trace a ray (the Raycast node, 5.1 and later)."""
    return hasattr(bpy.types, "ShaderNodeRaycast")


def interface(tree: Tree, kind: str) -> dict[str, Value]:
    """Inputs by the parameter names of ``osl/lamp.osl``."""
    inputs = {
        "Colour": tree.input_color("Color", (1, 1, 1), tip="The lamp's colour with its temperature, linear RGB"),
        "Strength": tree.input_float(
            "Strength", 0.0, low=-1e30, high=1e30, tip="Sun: W/m^2; point and spot: W. With exposure; 0 when hidden"
        ),
    }
    if kind in {"SUN", "SPOT"}:
        inputs["Axis"] = tree.input_vector(
            "Axis", (0, 0, 1), tip="The lamp's own z axis in world space; it shines against it"
        )
    if kind in {"POINT", "SPOT"}:
        inputs["Position"] = tree.input_vector("Position", tip="Of the lamp in world space, metres")
    if kind == "SPOT":
        inputs["Size"] = tree.input_float(
            "Size", pi / 4, low=0.0, high=pi, subtype="ANGLE", tip="Full angle of the cone"
        )
        inputs["Blend"] = tree.input_float("Blend", 0.15, low=0.0, high=1.0, tip="Softness of the cone's edge")
    return inputs


def build(tree: Tree, kind: str, *, shadows: bool) -> None:
    inputs = interface(tree, kind)
    P = tree.geometry("Position")
    irradiance = inputs["Strength"]
    if kind == "SUN":
        wi, distance = normalize(inputs["Axis"]), None
    else:
        with tree.frame("Irradiance P / (4 pi d^2)"):
            offset = inputs["Position"] - P
            wi, distance = normalize(offset), length(offset)
            irradiance = irradiance / (4.0 * pi * distance * distance)
    if kind == "SPOT":
        irradiance = irradiance * _cone(tree, inputs, wi)
    if shadows:
        irradiance = irradiance * _unblocked(tree, wi, distance)
    tree.output_vector("To Lamp", wi, tip="Direction to the lamp")
    tree.output_color("Irradiance", scale(inputs["Colour"], irradiance), tip="W/m^2 across the beam")


def build_osl(tree: Tree, kind: str, *, shadows: bool) -> None:
    inputs = interface(tree, kind)
    node = osl_script.script(tree, "lamp", kind=KINDS.index(kind), shadows=int(shadows), **inputs)
    tree.output_vector("To Lamp", osl_script.output(tree, node, "ToLamp"), tip="Direction to the lamp")
    tree.output_color("Irradiance", osl_script.output(tree, node, "Irradiance"), tip="W/m^2 across the beam")


def _cone(tree: Tree, inputs: dict[str, Value], wi: Value) -> Value:
    with tree.frame("Spot cone: smooth step of the cosine over the blend"):
        edge = tree.math("COSINE", inputs["Size"] * 0.5)
        inside = dot(normalize(inputs["Axis"]), wi) - edge
        step = clamp(inside / tree.math("MAXIMUM", (1.0 - edge) * inputs["Blend"], 1e-9))
        return step * step * (3.0 - 2.0 * step)


def _unblocked(tree: Tree, wi: Value, distance: Value | None) -> Value:
    with tree.frame("Shadow"):
        ray = tree.node("ShaderNodeRaycast")  # Position unlinked: an offset would leak or freckle
        # Linked through Combine XYZ: Cycles takes a Direction that it thinks unlinked for the normal.
        through = tree.node("ShaderNodeCombineXYZ", *wi.xyz)
        tree.node_tree.links.new(through.outputs[0], ray.inputs["Direction"])
        tree.connect(1e9 if distance is None else distance, ray.inputs["Length"])
        # On a shared edge the ray may hit the next triangle where it starts, give or take what float32 rounds P.
        start = 1e-6 * (1.0 + length(tree.geometry("Position")))
        beyond = less(start, Value(tree, ray.outputs["Hit Distance"]))
        return 1.0 - Value(tree, ray.outputs["Is Hit"]) * beyond
