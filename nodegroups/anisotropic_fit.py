# SPDX-License-Identifier: GPL-3.0-or-later
"""Estimator ``fit``: the mixture of Cook-Torrance, stretched with the slopes. Nothing is random.

As ``anisotropic_fit`` of the reference has it: the table is looked up where a round surface looks like this one from
the viewer, and each lobe's slopes and lean are stretched. In units of m, so that float32 keeps the narrowest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..addon.reference.anisotropic_fit import EXCESS, ROUGH
from ..addon.reference.cook_torrance_fit import NARROWEST
from . import anisotropic, cook_torrance, ensure
from . import cook_torrance_closure as closure
from . import cook_torrance_fit as fit
from ._tree import Tree, Value, cos, cross, dot, maximum, minimum, scale, sin, sqrt
from .shading_normal import raised, specular_normal

if TYPE_CHECKING:
    from bpy.types import NodeSocket

NAME = "VGroove Anisotropic Fit"
REVISION = 1
LOOK_UP_NAME = ".VGroove Anisotropic Fit Lobes"


def build(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial, native=True)  # Cycles clamps alpha to 1
    tree.output_shader("BSDF", shader(tree, kind, inputs), tip="To the material's Surface")


def build_osl(tree: Tree, kind: str, *, radial: bool) -> None:
    inputs = anisotropic.interface(tree, kind, radial=radial, native=True)
    node = cook_torrance.script(tree, "fit", kind, inputs, **for_script(tree, inputs))
    tree.output_shader("BSDF", node.outputs[0], tip="To the material's Surface")


def shader(tree: Tree, kind: str, inputs: anisotropic.Inputs) -> NodeSocket:
    """The mixture about the normal, raised where it has to be."""
    return raised(tree, inputs.normal, lambda N: mixture(tree, kind, inputs, N))


def mixture(tree: Tree, kind: str, inputs: anisotropic.Inputs, N: Value) -> NodeSocket:
    """One Metallic BSDF a lobe. Cycles skips a lobe of weight 0 with all nodes that serve it alone."""
    shaders = []
    for lobe in lobes(tree, inputs.m, inputs.anisotropy, N, inputs.tangent_to(N)):
        with tree.frame("Lobe"):
            leaning = lobe.anisotropy, lobe.tangent
            native = closure.lobe(tree, kind, inputs.fresnel, lobe.roughness, lobe.normal, *leaning)
            shaders.append(tree.weighted(native, lobe.weight))
    return tree.add_shaders(shaders)


@dataclass(frozen=True)
class Lobe(fit.Lobe):
    """A lobe that need not lie along or across the plane of view."""

    anisotropy: Value
    tangent: Value


def lobes(tree: Tree, m: Value, anisotropy: Value, N: Value, T: Value) -> list[Lobe]:
    """The mixture as seen from the viewer; normals not yet of length 1."""
    node = looked_up(tree, m, anisotropy, N, T)
    weight = Value(tree, node["Weight"])
    found = []
    for index, share in enumerate(weight.rgb, 1):
        of = (Value(tree, node[f"{name} {index}"]) for name in ("Roughness", "Normal", "Anisotropy", "Tangent"))
        found.append(Lobe(share, *of))
    return found


def looked_up(tree: Tree, m: Value, anisotropy: Value, N: Value, T: Value) -> dict[str, NodeSocket]:
    """The outputs of the nested group by name."""
    node = tree.group(ensure(LOOK_UP_NAME, REVISION, build_look_up), m=m, Anisotropy=anisotropy, N=N, T=T)
    return {socket.name: socket for socket in node.outputs}


def for_script(tree: Tree, inputs: anisotropic.Inputs) -> dict[str, Value]:
    """The same as parameters of the OSL shaders, which cannot read an image of a .blend themselves."""
    found = looked_up(tree, inputs.m, inputs.anisotropy, specular_normal(tree, inputs.normal), inputs.T)
    return {name.lower().replace(" ", "_"): Value(tree, socket) for name, socket in found.items()}


def build_look_up(tree: Tree) -> None:
    """``lobes`` of the reference."""
    slope = tree.input_float("m", 0.3, low=1e-4, high=10.0, tip="RMS slope of the facets")
    anisotropy = tree.input_float("Anisotropy", 0.5, low=0.0, high=1.0, tip="As of Metallic BSDF")
    N, T = (tree.input_vector(name, (0, 0, 1), hide_value=True, tip="Unit vector") for name in ("N", "T"))
    wo, m, B = tree.geometry("Incoming"), minimum(slope, 1.0), cross(N, T)
    with tree.frame("Slopes over m: 1/s along T, s along B"):
        narrow = 1.0 - (1.0 - NARROWEST) * anisotropy  # s^2, one slope over the other
        s = sqrt(narrow)
    with tree.frame("The round slope that looks like this one"):
        x, y, z = dot(T, wo), dot(B, wo), dot(N, wo)
        across2 = x * x / narrow + y * y * narrow
        round_slope = minimum(m * sqrt(across2 + z * z), 1.0)
    look_up = tree.group(ensure(fit.LOOK_UP_NAME, fit.REVISION, fit.build_look_up), m=round_slope, N=N)
    weight, first, *others = (Value(tree, socket) for socket in look_up.outputs)
    with tree.frame("No more light than arrives"):
        excess = EXCESS * maximum(minimum(m / s, 1.0) - ROUGH, 0.0) * (1.0 - narrow)
        tree.output_color("Weight", scale(weight, 1.0 - excess * (1.0 - z * z)), tip="Of each lobe")
    with tree.frame("Upright lobe"):
        k = minimum(first * first, 1.0) / round_slope
        _lobe(tree, 1, sqrt(m * k), N, anisotropy, T)
    with tree.frame("g over m, and the view's side"):
        over = 1.0 / maximum(sqrt(across2), 1e-7)
        gx, gy = x / narrow * over, y * narrow * over
        g, side = scale(T, gx) + scale(B, gy), sqrt(x * x + y * y)
    for index, of in enumerate(others, 2):
        with tree.frame("Lobe, stretched"):
            roughness, aniso, tilt = of.rgb
            square, aspect = roughness * roughness, sqrt(1.0 - (1.0 - NARROWEST) * aniso)
            within, across = (minimum(slopes, 1.0) / round_slope for slopes in (square * aspect, square / aspect))
            more = within * within - across * across
            xx = across * across / narrow + more * gx * gx
            yy = across * across * narrow + more * gy * gy
            xy, half = more * gx * gy, 0.5 * (xx - yy)
            wide2 = 0.5 * (xx + yy) + sqrt(half * half + xy * xy)
            both = within * across  # the product of its two slopes
        with tree.frame("As Metallic BSDF takes it"):
            turn = 0.5 * tree.math("ARCTAN2", xy, half)
            axis = scale(T, cos(turn)) + scale(B, sin(turn))
            lean = tilt * side * m / round_slope
            normal = scale(N, 1.0 - tilt * z) - scale(g, lean)
            narrower = minimum((1.0 - both / wide2) / (1.0 - NARROWEST), 1.0)
            _lobe(tree, index, sqrt(m * sqrt(both)), normal, maximum(narrower, 0.0), axis)


def _lobe(tree: Tree, index: int, roughness: Value, normal: Value, anisotropy: Value, tangent: Value) -> None:
    tree.output_float(f"Roughness {index}", roughness, tip="As of Metallic BSDF")
    tree.output_vector(f"Normal {index}", normal, tip="Not of length 1")
    tree.output_float(f"Anisotropy {index}", anisotropy, tip="As of Metallic BSDF")
    tree.output_vector(f"Tangent {index}", tangent, tip="Of the wider slope")
