# SPDX-License-Identifier: GPL-3.0-or-later
"""What both glass groups share: the artist's inputs, an interface's Fresnel term, and its pair of closures.

Cycles tells a shader which side it is on by Backfacing; Normal and Incoming are then already turned to that side.
Its Refraction and Glass BSDF invert their IOR there themselves; what is computed here has to.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..addon.models.glass import ABBE, MODEL, TINT
from . import fresnel, osl_script, shading_normal
from ._tree import Value, clamp, dot, output, select
from .parameters import add_input

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ..addon.models import Form
    from ._tree import Number, Tree


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs of a smooth interface, by reference name."""

    eta: Value
    tint: Value
    normal: Value


@dataclass(frozen=True)
class RoughInputs(Inputs):
    """And of a rough one."""

    m: Value


def smooth_inputs(tree: Tree) -> Inputs:
    """IOR, Tint and Normal. The same for every estimator and backend."""
    eta = fresnel.interface(tree, "dielectric")["eta"]
    return Inputs(eta, add_input(tree, TINT), shading_normal.interface(tree))


def rough_inputs(tree: Tree, *, native: bool = False, tint_tip: str = "") -> RoughInputs:
    """IOR, Slope m, Tint and Normal. The same for both backends."""
    eta = fresnel.interface(tree, "dielectric")["eta"]
    m = add_input(tree, MODEL.parameter("m"), native=native)
    tint = add_input(tree, TINT, tip=tint_tip)
    return RoughInputs(eta, tint, shading_normal.interface(tree), m)


def index_ahead(tree: Tree, eta: Value) -> Value:
    """Index of the far side over that of the viewer's: 1/eta from inside."""
    return select(tree.geometry("Backfacing"), 1.0 / eta, eta)


def reflectance(tree: Tree, cosine: Value | float, eta: Value, *, thin: bool) -> Value:
    """F of one facet at ``cosine``; of a thin pane with all reflections between its faces."""
    F = fresnel.reflectance(tree, "dielectric", {"eta": eta}, cosine)
    return 2.0 * F / (1.0 + F) if thin else F


def split(tree: Tree, h: Value, R: Value, T: Value, inputs: Inputs, *, thin: bool) -> NodeSocket:
    """A perfect mirror about ``h`` of weight R beside perfect refraction, or no bending if ``thin``, of weight T."""
    smooth = {"Roughness": 0.0, "Normal": h, "distribution": "BECKMANN"}
    mirror = tree.node("ShaderNodeBsdfAnisotropic", Color=R, **smooth)
    through = inputs.tint * T
    if thin:
        ahead = tree.node("ShaderNodeBsdfTransparent", Color=through)
    else:
        ahead = tree.node("ShaderNodeBsdfRefraction", Color=through, IOR=inputs.eta, **smooth)
    return tree.add_shaders([output(mirror, "BSDF"), output(ahead, "BSDF")])


def smooth_interface(tree: Tree, inputs: Inputs, *, thin: bool) -> NodeSocket:
    """m = 0: F(n.v) and 1 - F(n.v), exact and without random numbers."""
    N = shading_normal.specular_normal(tree, inputs.normal)
    eta = inputs.eta if thin else index_ahead(tree, inputs.eta)
    F = reflectance(tree, clamp(dot(N, tree.geometry("Incoming"))), eta, thin=thin)
    return split(tree, N, F, 1.0 - F, inputs, thin=thin)


def dispersive_interface(tree: Tree, inputs: Inputs, roughness: Value | float) -> NodeSocket:
    """Cycles' Principled, the one node that disperses: GGX where it is rough, and at m = 0 the same interface.

    It takes the root of its colour at each of a body's surfaces.
    """
    node = tree.node(
        "ShaderNodeBsdfPrincipled", distribution="GGX", Base_Color=inputs.tint * inputs.tint, Roughness=roughness,
        IOR=inputs.eta, Normal=inputs.normal, Transmission_Weight=1.0, Transmission_Dispersion_Scale=1.0,
        Transmission_Dispersion_Abbe_Number=add_input(tree, ABBE),
    )  # fmt: skip
    return output(node, "BSDF")


def script(tree: Tree, estimator: str, inputs: Inputs, *, thin: bool) -> NodeSocket:
    """The OSL shader ``glass_ESTIMATOR`` fed by these inputs; a smooth interface is ``mirror``'s without facets."""
    more: dict[str, Number] = {}
    if isinstance(inputs, RoughInputs):
        more["m"] = inputs.m
        if estimator == "mirror":
            more["smooth"] = 0
    else:
        estimator, more["smooth"], more["seed"] = "mirror", 1, 0.0  # it draws nothing
    node = osl_script.script(
        tree, f"glass_{estimator}", eta=inputs.eta, tint=inputs.tint, Normal=inputs.normal, thin=int(thin), **more
    )
    return node.outputs[0]


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    smooth = form.parameters["m"] == 0.0
    label = " ".join([*filter(None, [MODEL.kinds[form.kind]]), *["Smooth"] * smooth])
    return label, {"thin": form.kind == "thin", "smooth": smooth}
