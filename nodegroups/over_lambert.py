# SPDX-License-Identifier: GPL-3.0-or-later
"""A lobe over Lambert, f = albedo/pi + specular lobe: what the groups of models of this form share."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Protocol

from . import eevee
from ._native import output
from ._tree import Value, dot, greater, maximum, minimum, sqrt
from .shading_normal import lit, shading_normal, smoothing, specular_normal, typical_smoothing

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import NodeSocket

    from ._tree import Tree
    from .lamp_beams import Beams


class Inputs(Protocol):
    """Both colours, and the normal as linked (or not)."""

    @property
    def albedo(self) -> Value: ...
    @property
    def specular(self) -> Value: ...
    @property
    def normal(self) -> Value: ...


def emission(
    tree: Tree, inputs: Inputs, beams: Beams, lobe: Callable[[Value, Value, Value], Value], *, diffuse: bool = True,
    diffused: Value | None = None, carried: Callable[[Value], tuple[Value, Value | float]] | None = None,
) -> NodeSocket:  # fmt: skip
    """The radiance of all lamps, f cos(theta_i) E each, as an emission closure of plain nodes.

    lobe: (N, wi, wo) -> the lobe in 1/sr, without asking whether both are above. diffuse: whether Lambert is sent, too;
    diffused: the share of it that another closure sends already. carried: (f cos, f of Lambert) that other closures
    send from wi already for a white Specular Color; the emission is then what they lack, negative where they send too
    much.
    """
    N, facing, wo = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    radiance: Value | int = 0
    for wi, irradiance in beams:
        ni, no = dot(N, wi), dot(N, wo)
        seen = greater(ni, 0.0) * greater(no, 0.0) * lit(tree, inputs.normal, wi)
        f_cos, lambert = lobe(N, wi, wo) * ni, inputs.albedo * (1.0 / pi) if diffuse else None
        if carried is not None:
            sent, under = carried(wi)
            f_cos = f_cos - sent
            lambert = inputs.specular * -under if isinstance(under, Value) else lambert
        sends = inputs.specular * (f_cos * seen)
        if lambert is not None:
            kept = smoothing(tree, inputs.normal, wi)
            kept = kept if diffused is None else kept - diffused
            sends = sends + lambert * (maximum(dot(facing, wi), 0.0) * kept)
        radiance = radiance + irradiance * sends
    emitted = tree.node("ShaderNodeEmission", Color=radiance if beams else (0.0, 0.0, 0.0))
    return output(emitted, "Emission")


def output_formula(
    tree: Tree, inputs: Inputs, lobe: Callable[[Value, Value, Value], Value], m: Value, E: Value | float
) -> None:
    """The outputs of a formula's group for EEVEE (``eevee``): Lambert by its own closure, the lobe at every light.

    lobe: as of ``emission``. m: the slope of a Beckmann lobe that is as wide, for the world, of whose light the share E
    is sent back for a white Specular Color.
    """
    N, wo, wi = specular_normal(tree, inputs.normal), tree.geometry("Incoming"), eevee.to_light(tree)
    facing = shading_normal(tree, inputs.normal)
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=inputs.albedo, Roughness=0.0, Normal=facing)
    lambert, _ = eevee.radiance(tree, output(diffuse, "BSDF"))
    slope = minimum(m, eevee.WIDEST)
    world = eevee.world(tree, eevee.mirrored(tree, N, slope), slope)
    ni, share = dot(N, wi), inputs.specular * E
    f_cos = lobe(N, wi, wo) * (ni * (greater(ni, 0.0) * greater(dot(N, wo), 0.0)))
    shown = inputs.specular * (f_cos * eevee.received(tree, wi))
    eevee.output_formula(tree, lambert + share * world.radiance, world.alpha, Glossy=shown - share * world.factor)


def mirror(tree: Tree, inputs: Inputs, draw: Callable[[], tuple[Value, Value]]) -> list[NodeSocket]:
    """Lambert, and a mirror about a drawn facet. draw: -> the facet, and what it weighs."""
    color = inputs.albedo * typical_smoothing(tree, inputs.normal)  # Cycles' own is off, as facets lean
    diffuse = tree.node("ShaderNodeBsdfDiffuse", Color=color, Roughness=0.0, Normal=inputs.normal)
    h, weight = draw()
    color = inputs.specular * weight
    facet = tree.node("ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=color, Roughness=0.0, Normal=h)
    return [output(diffuse, "BSDF"), output(facet, "BSDF")]


def glossy(tree: Tree, color: Value, slopes: tuple[Value, Value], normal: Value, tangent: Value) -> NodeSocket:
    """Cycles' Beckmann lobe with the larger slope along the tangent, as Glossy BSDF takes it.

    That makes slopes of r^2 / (1 + a) along the tangent and r^2 (1 + a) across it, for a below 0.
    """
    along, across = slopes
    lobe = tree.node(
        "ShaderNodeBsdfAnisotropic", distribution="BECKMANN", Color=color, Roughness=sqrt(sqrt(along * across)),
        Anisotropy=sqrt(across / along) - 1.0, Normal=normal, Tangent=tangent,
    )  # fmt: skip
    return output(lobe, "BSDF")
