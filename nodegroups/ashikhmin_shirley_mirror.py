# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: a facet is drawn by p(h) and reflects; a second mirror sends the diffuse part by the cosine.

Unbiased: what is left of the highlight once the density of wi is divided out is F min(1, (n.l)/(n.v)), and pi f of the
diffuse part. Source: the paper's section 4.1, with the exponent as ``facet`` of the reference has it.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import ashikhmin_shirley as model
from . import ashikhmin_shirley_direct as direct
from ._tree import (
    clamp,
    cos,
    cross,
    dot,
    exp,
    log,
    maximum,
    minimum,
    normalize,
    output,
    scale,
    sin,
    sqrt,
    tangents,
    vector,
)  # fmt: skip
from .lamp_beams import beam_interfaces
from .random_numbers import random_numbers, stream
from .shading_normal import shading_normal, smoothing, specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

    from ._tree import Tree, Value

NAME = "VGroove Ashikhmin-Shirley Mirror"
REVISION = 3


def build(tree: Tree, kind: str, lamps: int = 0, *, radial: bool) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = model.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    shaders = [facet(tree, inputs), scattered(tree, inputs)]
    shaders += [direct.emission(tree, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    shaders = [model.script(tree, "mirror", inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def facet(tree: Tree, inputs: model.Inputs) -> NodeSocket:
    """A mirror about a facet for each sample.

    tan^2 = e^x - 1 = 2 sinh(x/2) e^(x/2), x = -2 r^2 log(1 - u), which keeps its digits where x is small.
    """
    N, wo = specular_normal(tree, inputs.normal), tree.geometry("Incoming")
    T, (n_u, n_v) = inputs.turned_tangent(N), inputs.exponents
    u1, u2, _ = random_numbers(tree, stream("FACET"))
    with tree.frame("h by p(h)"):
        phi = 2.0 * pi * u2
        a, b = cos(phi) / sqrt(n_u + 1.0), sin(phi) / sqrt(n_v + 1.0)
        r2 = a * a + b * b
        half = -log(maximum(1.0 - u1, 1e-7)) * r2  # u may round to 1
        steep = sqrt(2.0 * tree.math("SINH", half) * exp(half) / r2)
        h = normalize(N + scale(T, steep * a) + scale(cross(N, T), steep * b))
    with tree.frame("Weight F min(1, (n.l)/(n.v))"):
        vh = clamp(dot(wo, h))
        wi = scale(h, 2.0 * vh) - wo
        share = minimum(maximum(dot(N, wi), 0.0) / maximum(dot(N, wo), 1e-7), 1.0)
        weight = inputs.amplitude * model.reflectance(tree, inputs.specular, vh) * vector(share, share, share)
    return _mirror(tree, weight, h)


def scattered(tree: Tree, inputs: model.Inputs) -> NodeSocket:
    """A mirror that reflects toward a wi drawn by the cosine."""
    N, wo = shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    u1, u2, _ = random_numbers(tree, stream("DIRECTION"))
    with tree.frame("wi by the cosine"):
        T, B = tangents(N)
        radius, phi = sqrt(u1), 2.0 * pi * u2
        cosine = sqrt(1.0 - u1)
        wi = scale(T, radius * cos(phi)) + scale(B, radius * sin(phi)) + scale(N, cosine)
    with tree.frame("Weight pi f"):
        f = model.scattered(inputs, model.entered(inputs, dot(N, wo)), cosine) * smoothing(tree, inputs.normal, wi)
        return _mirror(tree, inputs.deep * f, normalize(wi + wo))


def _mirror(tree: Tree, weight: Value, h: Value) -> NodeSocket:
    node = tree.node("ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=weight, Roughness=0.0, Normal=h)
    return output(node, "BSDF")
