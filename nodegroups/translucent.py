# SPDX-License-Identifier: GPL-3.0-or-later
"""A translucent body under a coat of V-grooves: light that the coat lets in is scattered below the surface.

The body is Cycles' own subsurface closure, the same for every estimator; its weight is 1 - E, E the coat's directional
albedo, so that what is mirrored cannot be scattered as well. Cycles takes a mean free path of Radius / (4 pi) and finds
the scattering that gives a deep, evenly lit body the wanted diffuse reflectance.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import cook_torrance, cook_torrance_albedo
from ._tree import Tree, output
from .shading_normal import specular_normal, typical_smoothing

if TYPE_CHECKING:
    import bpy

NAME = "VGroove Translucent"
REVISION = 5


def build(tree: Tree, coat: bpy.types.ShaderNodeTree, kind: str, *, averaged: bool = False) -> None:
    """``coat``: the group of the coat by the estimator; ``kind``: of its Fresnel term.

    ``averaged``: with what Bump Map Correction does to the body, where it is off as the coat's lobes lean.
    """
    tip = "Diffuse reflectance: what a large, evenly lit body sends back of the light that enters it"
    color = tree.input_color("Reflectance", (0.8, 0.8, 0.8), tip=tip, held=True)
    tip = "Of red, green and blue light, in metres: how far it goes between two turns"
    path = tree.input_vector("Mean Free Path", (1e-3, 1e-3, 1e-3), low=0.0, high=10.0, tip=tip, held=True)
    tree.inputs_of(coat)
    inputs = cook_torrance.given(tree, kind)
    N = specular_normal(tree, inputs.normal)
    E = cook_torrance_albedo.directional_albedo(tree, kind, inputs, N)
    with tree.frame("Below the surface"):
        radius, normal = path * (4.0 * pi, 4.0 * pi, 4.0 * pi), N if averaged else inputs.normal
        given = {"Color": color, "Radius": radius, "Scale": 1.0, "Normal": normal}
        body = tree.node("ShaderNodeSubsurfaceScattering", falloff="RANDOM_WALK", **given)
        weight = (1.0 - E) * typical_smoothing(tree, inputs.normal) if averaged else 1.0 - E
        below = tree.weighted(output(body, "BSSRDF"), weight)
    with tree.frame(coat.name):
        node = tree.nested(coat)
        for socket in node.inputs:
            tree.connect(tree.given(socket.name), socket)
    tree.output_shader("BSDF", tree.add_shaders([below, node.outputs[0]]), tip="To the material's Surface")
