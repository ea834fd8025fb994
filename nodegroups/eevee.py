# SPDX-License-Identifier: GPL-3.0-or-later
"""What EEVEE shows where it cannot run a material's nodes, and from Blender 5.3 on the formula itself at every light.

EEVEE has no random facets, no shadow rays from shaders and no OSL: there it shows ``closure``, fed by the same inputs.

From 5.3 on it evaluates Material Lighting nodes once per light. The groups of Cycles' own closures then show the
formula (``add_formula``): a light's radiance is pi f cos(theta_i) times its Power, Color, Mask, shadow, and the Factor
of a diffuse surface that faces it, which is 1 / d^2 for a lamp of zero size. The world stays with EEVEE's own closures,
which lights must not reach once more (``world``). What they still show of a light is known, and taken off what Light
Accumulation adds; that must be positive, as EEVEE holds back the rest.

Raytraced reflections start at closures alone: with the scene's raytracing, and in light probes, EEVEE shows those of
the group. Cycles knows none of these nodes and drops the formula.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import pi
from typing import TYPE_CHECKING

from . import ensure
from ._native import output
from ._tree import Tree, Value, dot, maximum, normalize, scale, select, sqrt
from .versions import LIGHT_NODES

if TYPE_CHECKING:
    import bpy
    from bpy.types import Node, NodeSocket

OUTPUT = "EEVEE"
LIGHTS_NAME, SHARE_NAME = ".VGroove EEVEE Lights", ".VGroove EEVEE Share"
REVISION = 2
WORLD_NAME = ".VGroove EEVEE World"
FORMULA, SHARE = "BSDF", "Share of EEVEE"  # outputs of a formula's group
WIDEST = 0.5  # slope m from which EEVEE's map of the world is as blurred as it gets


def add_closure(tree: Tree, closure: bpy.types.ShaderNodeTree) -> None:
    """A second output: the group ``closure``, its inputs linked to those of the same name."""
    with tree.frame("What EEVEE shows"):
        node = tree.nested_with_inputs(closure)
    tree.output_shader(OUTPUT, node.outputs[0], tip="To a Material Output for EEVEE")


# The formula, in Blender 5.3


def add_formula(tree: Tree, formula: bpy.types.ShaderNodeTree) -> None:
    """Have EEVEE show ``formula``, a group with the outputs of ``output_formula``, in place of the first output."""
    with tree.frame("What EEVEE shows"):
        node = tree.nested_with_inputs(formula)
        share = Value(tree, node.outputs[SHARE])
        mix = partial(tree.node, "ShaderNodeMixShader", Fac=share, Shader_001=node.outputs[FORMULA])
        tree.replace_output(0, lambda native: output(mix(Shader=native), "Shader"))


def output_formula(tree: Tree, seen: Value, alpha: Value, **added: Value) -> None:
    """The outputs of a formula's group.

    seen: the world's light. added: what a light adds to what that holds of it, over its radiance, as ``Diffuse`` or
    ``Glossy``. alpha: 1 in EEVEE.
    """
    node = tree.group(ensure(LIGHTS_NAME, REVISION, build_lights), Seen=seen, **added)
    tree.output_shader(FORMULA, node.outputs[FORMULA], tip="The formula at lights, and the world")
    tree.output_float(SHARE, by_formula(tree, alpha), tip="1 where EEVEE shows the formula, else 0")


def build_lights(tree: Tree) -> None:
    black = (0.0, 0.0, 0.0)
    seen = tree.input_color("Seen", black, tip="The world's light")
    added = {
        name: tree.input_vector(name, black, tip="What a light adds, over its radiance")
        for name in ("Diffuse", "Glossy")
    }
    with tree.frame("Radiance of the light"):
        info, shadow = tree.node("ShaderNodeLightInfo"), tree.node("ShaderNodeShadowRaycast")
        power = Value(tree, output(info, "Power")) * Value(tree, output(_evaluation(tree), "Mask"))
        radiance = Value(tree, output(info, "Color")) * Value(tree, output(shadow, "Color")) * power
        lights = {f"{name}_Light": radiance * maximum(value, 0.0) for name, value in added.items()}
        at_lights = output(tree.node("ShaderNodeLightAccumulation", **lights), "Shader")
    # A colour that is linked to a shader is its emission; where there is an Emission node, glTF exports one.
    tree.output_shader(FORMULA, tree.add_shaders([at_lights, seen.socket]), tip="The formula at lights, and the world")


def is_formula(node: Node) -> bool:
    """Whether a node is a formula's group, which Cycles drops."""
    return node.bl_idname == "ShaderNodeGroup" and SHARE in node.outputs


def by_formula(tree: Tree, alpha: Value) -> Value:
    """1 in the camera's view in EEVEE without raytracing, else 0."""
    node = tree.group(ensure(SHARE_NAME, REVISION, build_share), Alpha=alpha)
    return Value(tree, node.outputs["Share"])


def build_share(tree: Tree) -> None:
    alpha = tree.input_float("Alpha", 0.0, low=0.0, high=1.0, tip="1 in EEVEE, 0 in Cycles", held=False)
    with tree.frame("The camera's view in EEVEE without raytracing"):
        traced = tree.node("ShaderNodeAttribute", attribute_type="VIEW_LAYER", attribute_name="eevee.use_raytracing")
        camera = Value(tree, output(tree.node("ShaderNodeLightPath"), "Is Camera Ray"))
        share = alpha * (camera * (1.0 - Value(tree, output(traced, "Fac"))))
        # Blender dissolves groups before Cycles sees them, which lacks Shader to RGB and reads this node's own value.
        share.socket.node.inputs[0].default_value = 0.0
    tree.output_float("Share", share, tip="1 where EEVEE shows the formula, else 0")


def by_closures(tree: Tree, share: Value) -> Value:
    """The ``share`` of light that Cycles' closures keep; 1 where EEVEE shows the formula, which has it itself."""
    if not LIGHT_NODES:
        return share
    alpha = Value(tree, output(tree.node("ShaderNodeShaderToRGB"), "Alpha"))
    return select(by_formula(tree, alpha), 1.0, share)


def to_light(tree: Tree) -> Value:
    """wi of the light."""
    return Value(tree, output(_evaluation(tree), "Direction"))


def received(tree: Tree, wi: Value) -> Value:
    """Irradiance over the light's radiance of a surface that faces the light: pi Factor."""
    return pi * factor(tree, wi)


def factor(tree: Tree, N: Value, roughness: Value | None = None) -> Value:
    """What EEVEE's own closure about N shows of the light, over its radiance: a white diffuse one, or a glossy one."""
    given = {"mode": "DIFFUSE"} if roughness is None else {"mode": "GLOSSY", "Roughness": roughness}
    return Value(tree, output(tree.one_node("ShaderNodeLightEvaluation", **given, Normal=N), "Factor"))


def _evaluation(tree: Tree) -> Node:
    return tree.one_node("ShaderNodeLightEvaluation", mode="DIFFUSE")


def radiance(tree: Tree, closure: NodeSocket) -> tuple[Value, Value]:
    """What EEVEE shows of a closure, the world's light and that of all lights; and 1, which in Cycles is 0."""
    node = tree.node("ShaderNodeShaderToRGB", Shader=closure)
    return Value(tree, output(node, "Color")), Value(tree, output(node, "Alpha"))


@dataclass(frozen=True)
class World:
    """The world's light from about a direction, what it holds of a light over its radiance, and 1, in Cycles 0."""

    radiance: Value
    factor: Value
    alpha: Value


def world(tree: Tree, direction: Value, slope: Value | float) -> World:
    """The world through a white lobe of this slope m in a unit direction."""
    node = tree.group(ensure(WORLD_NAME, REVISION, build_world), Direction=direction, m=slope)
    return World(*(Value(tree, node.outputs[name]) for name in ("Radiance", "Factor", "Alpha")))


def build_world(tree: Tree) -> None:
    """EEVEE's glossy closure about a normal -M below the surface, where no light falls on it that falls on the surface.

    EEVEE looks up the world toward the mirror image of the view, which is the same about M and -M, bent toward the
    normal: (1 - s)(-M) + s R. That is the wanted direction if, with d the angle from the view to it and M at d/2 + u,
    s sin(2u) = (s - 1) sin(d/2 - u); to first order sin(u) = -q sin(d/2).
    """
    direction = tree.input_vector("Direction", (0, 0, 1), hide_value=True, tip="Unit vector to where the world is seen")
    m = tree.input_float("m", 0.3, low=1e-4, high=WIDEST, tip="RMS slope of the lobe")
    V, s = tree.geometry("Incoming"), bend(m)
    with tree.frame("q, and half the angle"):
        cosine = dot(V, direction)
        half2, half = 0.5 - 0.5 * cosine, sqrt(0.5 + 0.5 * cosine)
        q = (1.0 - s) / (2.0 * s - (1.0 - s) * half)
        cos_u = sqrt(1.0 - q * q * half2)
    with tree.frame("M = V sin(d/2 - u) + D sin(d/2 + u)"):
        below = -normalize(V + scale(direction, (cos_u - half * q) / (cos_u + half * q)))
    lobe = tree.node(
        "ShaderNodeBsdfAnisotropic", distribution="MULTI_GGX", Color=(1.0, 1.0, 1.0), Roughness=sqrt(m), Normal=below
    )
    seen, alpha = radiance(tree, output(lobe, "BSDF"))
    tree.output_color("Radiance", seen, tip="Of the world")
    tree.output_float("Factor", factor(tree, below, sqrt(m)), tip="What it holds of a light, over its radiance")
    tree.output_float("Alpha", alpha, tip="1 in EEVEE, 0 in Cycles")


def bend(m: Value) -> Value:
    """How far EEVEE looks toward the mirror image of the view, 1, rather than along the normal, 0."""
    smooth = 1.0 - m
    return smooth * (sqrt(smooth) + m)


def mirrored(tree: Tree, N: Value, m: Value) -> Value:
    """The direction in which EEVEE's own glossy closure about N sees the world."""
    V, s = tree.geometry("Incoming"), bend(m)
    with tree.frame("(1 - s) N + s R"):
        R = scale(N, 2.0 * dot(N, V)) - V
        return normalize(scale(N, 1.0 - s) + scale(R, s))
