# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``mirror``: wi is drawn by the cosine, and a mirror about the half vector sends the ray there.

Unbiased: the weight f cos / pdf = pi f is what is left of the BRDF once the density cos / pi is divided out.
Source: Malley's method, a uniform disc projected up; ``OrenNayar.sample`` of the reference.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from . import oren_nayar
from . import oren_nayar_direct as direct
from ._tree import Tree, cos, cross, less, maximum, normalize, output, scale, select, sin, sqrt
from .lamp_beams import beam_interfaces
from .random_numbers import random_numbers, stream
from .shading_normal import shading_normal, smoothing

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Value

NAME = "VGroove Oren-Nayar Mirror"
REVISION = 6


def build(tree: Tree, kind: str, lamps: int = 0) -> None:
    """With ``lamps``: those of zero size, which no ray can hit, are added by ``direct``; no light counts twice."""
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    shaders = [ray(tree, kind, inputs)] + ([direct.emission(tree, kind, inputs, beams)] if beams else [])
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int = 0) -> None:
    inputs = oren_nayar.interface(tree)
    beams = beam_interfaces(tree, lamps)
    shaders = [oren_nayar.script(tree, "mirror", kind, inputs).outputs[0]]
    shaders += [direct.emission_osl(tree, kind, inputs, beams)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def ray(
    tree: Tree, kind: str, inputs: oren_nayar.Inputs, carried: Callable[[Value], Value] | None = None
) -> NodeSocket:
    """A mirror that reflects toward a wi drawn by the cosine, weighted by pi f.

    ``carried``: what other closures send of f from wi already; the mirror then sends the rest, where it is positive.
    """
    N, wo = shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    u1, u2, _ = random_numbers(tree, stream("DIRECTION"))
    with tree.frame("wi by the cosine"):
        axis = select(less(N.xyz[2] ** 2, 0.8), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))
        T = normalize(cross(N, axis))
        B = cross(N, T)
        radius, phi = sqrt(u1), 2.0 * pi * u2
        wi = scale(T, radius * cos(phi)) + scale(B, radius * sin(phi)) + scale(N, sqrt(1.0 - u1))
    with tree.frame("Weight pi f, a mirror about the half vector"):
        f = oren_nayar.brdf(tree, kind, inputs, N, wi, wo) * smoothing(tree, inputs.normal, wi)
        weight = (maximum(f - carried(wi), 0.0) if carried else f) * pi
        mirror = tree.node(
            "ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=weight, Roughness=0.0, Normal=normalize(wi + wo)
        )
    return output(mirror, "BSDF")
