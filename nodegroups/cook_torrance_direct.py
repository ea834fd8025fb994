# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``direct``: the formula itself at lamps bound to the material, sent out as emission.

Radiance of one lamp: f cos(theta_i) E = F D G / (4 (n.v)) E, E the irradiance across the beam; n.l cancels.
"""

from . import beckmann_d, cook_torrance, ensure, fresnel, vgroove_g
from ._tree import Tree, Value, dot, length, less, maximum, normalize
from .shading_normal import shading_normal

NAME = "VGroove Cook-Torrance Direct"
REVISION = 1


def build(tree: Tree, kind: str, lamps: int) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=10.0)
    beams = [beam_interface(tree, index) for index in range(1, lamps + 1)]
    N = shading_normal(tree, inputs.normal)
    radiance = None
    for wi, irradiance in beams:
        one = _radiance(tree, kind, inputs, N, wi, irradiance)
        radiance = one if radiance is None else radiance + one
    emission = tree.node("ShaderNodeEmission")
    tree.connect((0.0, 0.0, 0.0) if radiance is None else radiance, emission.inputs["Color"])
    tree.output_shader("Emission", emission.outputs["Emission"], tip="To the material's Surface")


def beam_interface(tree: Tree, index: int) -> tuple[Value, Value]:
    """Sockets that take what a lamp group (``lamp.py``) gives: direction to the lamp and its irradiance."""
    with tree.panel(f"Lamp {index}"):
        wi = tree.input_vector(f"To Lamp {index}", (0, 0, 1), hide_value=True, tip="From the lamp's group")
        irradiance = tree.input_color(f"Irradiance {index}", (0, 0, 0), tip="From the lamp's group, in W/m^2 across the beam")
    return wi, irradiance


def _radiance(
    tree: Tree, kind: str, inputs: cook_torrance.Inputs, N: Value, wi: Value, irradiance: Value
) -> Value:
    wo = tree.geometry("Incoming")
    with tree.frame("Half vector and cosines"):
        both = wi + wo
        h = normalize(both)
        nh, vh = dot(N, h), 0.5 * length(both)  # dot(wo, h) would lose a hundredfold in float32 at grazing angles
        no, ni = dot(N, wo), dot(N, wi)
        lit = less(0.0 * ni, ni) * less(0.0 * no, no)
    with tree.frame("F D G / (4 n.v)"):
        D = tree.group(ensure(beckmann_d.NAME, beckmann_d.REVISION, beckmann_d.build), h=h, N=N, Slope_m=inputs.m)
        G = tree.group(
            ensure(vgroove_g.NAME, vgroove_g.REVISION, vgroove_g.build), **{"n.h": nh, "n.v": no, "n.l": ni, "v.h": vh}
        )
        F = fresnel.reflectance(tree, kind, inputs.fresnel, vh)
        dg = Value(tree, D.outputs["D"]) * Value(tree, G.outputs["G"]) / (4.0 * maximum(no, 1e-7)) * lit
    return irradiance * F * dg


def build_osl(tree: Tree, kind: str, lamps: int) -> None:
    inputs = cook_torrance.interface(tree, kind, m_high=10.0)
    beams = [beam_interface(tree, index) for index in range(1, lamps + 1)]
    total = tree.node("ShaderNodeEmission", (0.0, 0.0, 0.0)).outputs[0]
    for wi, irradiance in beams:
        node = cook_torrance.script(tree, "direct", kind, inputs, ToLamp=wi, Irradiance=irradiance)
        both = tree.node("ShaderNodeAddShader")
        tree.node_tree.links.new(total, both.inputs[0])
        tree.node_tree.links.new(node.outputs[0], both.inputs[1])
        total = both.outputs[0]
    tree.output_shader("Emission", total, tip="To the material's Surface")
