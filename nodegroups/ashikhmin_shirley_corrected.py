# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``corrected``: ``fit``, and at bound lamps the signed difference from the formula, as emission.

As ``cook_torrance_corrected``: bound lamps are exact, world and bounces are as ``fit`` has them.
"""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING

from ..addon.reference import ashikhmin_shirley_fit as of_reference
from . import ashikhmin_shape, ensure, fresnel, smith_lobe
from . import ashikhmin_shirley as model
from . import ashikhmin_shirley_direct as direct
from . import ashikhmin_shirley_fit as fit
from ._tree import Value, clamp, dot, normalize
from .lamp_beams import beam_interfaces
from .shading_normal import shading_normal, specular_normal

if TYPE_CHECKING:
    from ._tree import Tree

NAME = "VGroove Ashikhmin-Shirley Corrected"
REVISION = 3


def build(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    of = ashikhmin_shape.shape(tree, inputs)
    shaders = [fit.shader(tree, inputs, of)]
    if beams:
        shaders.append(direct.emission(tree, inputs, beams, carried(tree, inputs, of)))
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, lamps: int, *, radial: bool) -> None:
    inputs = model.interface(tree, kind, radial=radial)
    beams = beam_interfaces(tree, lamps)
    shape = ashikhmin_shape.shape(tree, inputs).parameters
    shaders = [model.script(tree, "fit", inputs, **shape).outputs[0]]
    shaders += [direct.emission_osl(tree, inputs, beams, "correction", **shape)] if beams else []
    tree.output_shader("BSDF", tree.add_shaders(shaders), tip="To the material's Surface")


def carried(tree: Tree, inputs: model.Inputs, of: ashikhmin_shape.Shape) -> direct.Carried:
    """What the closures of ``fit`` send from wi."""
    N, facing, wo = specular_normal(tree, inputs.normal), shading_normal(tree, inputs.normal), tree.geometry("Incoming")
    color, f0, weight = fit.split(inputs, of)
    along = normalize(of.tangent)
    wide, narrow = of.slopes
    enters = model.entered(inputs, dot(facing, wo))
    group = ensure(smith_lobe.NAME, smith_lobe.REVISION, smith_lobe.build)

    def sent(wi: Value, f_cos: Value, vh: Value) -> tuple[Value, Value | float]:
        given = {"Normal": N, "Tangent": along, "Across": wide, "Within": narrow}
        node = tree.group(group, To_Light=wi, To_Viewer=wo, h=normalize(wi + wo), **given)
        lobe = weight * Value(tree, node.outputs["f cos"])
        mirrored = color * f_cos + fresnel.reflectance(tree, "schlick", {"f0": f0}, vh) * lobe
        if inputs.over_lambert:
            return mirrored, 1.0
        with tree.frame("Lambert and Toon, pi f"):
            ni = clamp(dot(facing, wi))
            even, smooth = of_reference.EDGES
            fall = clamp(1.0 + even / smooth - tree.math("ARCCOSINE", ni) * (1.0 / smooth))
            scale_toon = pi * (1.0 - of_reference.LAMBERT) / of_reference.TOON_AREA
            below = of_reference.LAMBERT + scale_toon * fall / (ni + 1e-7)
        return mirrored, enters * below

    return sent
