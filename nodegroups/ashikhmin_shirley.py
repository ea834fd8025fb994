# SPDX-License-Identifier: GPL-3.0-or-later
"""What the groups of Ashikhmin & Shirley's model share: the artist's inputs, F, and what enters the surface.

Sources: as ``addon/reference/ashikhmin_shirley.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi
from typing import TYPE_CHECKING, Any

from ..addon.models.anisotropic import RADIAL
from ..addon.models.ashikhmin_shirley import LAMBERT, MODEL, SHARPNESS
from ..addon.reference import ashikhmin_shirley_fit as fit
from ..addon.reference.cook_torrance_fit import NARROWEST
from . import ashikhmin_lobe, ensure, fresnel, shading_normal, tangent
from ._tree import Value, clamp, maximum
from .osl_script import script as osl_script
from .parameters import add_input
from .polynomial import horner

if TYPE_CHECKING:
    from bpy.types import Node

    from ..addon.models import Form
    from ._tree import Number, Tree

HEADER = "ashikhmin_shirley_fit.h"


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: three colours, the exponent n, anisotropy, rotation in turns; tangent and normal as linked.

    kind: whose the diffuse part is. radial: a tangent that is not linked is around the Z axis, even where there is a UV
    map.
    """

    albedo: Value
    specular: Value
    amplitude: Value
    n: Value
    anisotropy: Value
    rotation: Value
    tangent: Value
    normal: Value
    kind: str
    radial: bool

    @property
    def over_lambert(self) -> bool:
        return self.kind == LAMBERT

    @cached_property
    def narrow(self) -> Value:
        """s^2: slopes are m / s along the tangent and m s across it."""
        return self.n.tree.fused(self.anisotropy, NARROWEST - 1.0, 1.0)

    @cached_property
    def exponents(self) -> tuple[Value, Value]:
        """n_u along the tangent, n_v across it."""
        n_u, n_v = (
            maximum(scaled - 2.0, 0.0) for scaled in ((self.n + 2.0) * self.narrow, (self.n + 2.0) / self.narrow)
        )
        return n_u, n_v

    @cached_property
    def roughness(self) -> Value:
        """Blender's, of slope m."""
        return SHARPNESS.scale.to_input(self.n)

    @cached_property
    def deep(self) -> Value:
        """Rd (1 - Rs), or over Lambert Rd."""
        return self.albedo if self.over_lambert else self.albedo * (1.0 - self.specular)

    def turned_tangent(self, N: Value) -> Value:
        """The unit tangent at right angles to a normal."""
        return tangent.tangent(self.n.tree, self.tangent, N, self.rotation, radial=self.radial)


def interface(tree: Tree, kind: str, *, radial: bool) -> Inputs:
    """Base Color; Specular Color and Tint; Roughness; Anisotropy; Rotation; Tangent; Normal. Of every estimator."""
    albedo, specular, amplitude, n, anisotropy, rotation = (add_input(tree, one) for one in MODEL.parameters)
    along, normal = tangent.interface(tree, radial=radial), shading_normal.interface(tree)
    return Inputs(albedo, specular, amplitude, n, anisotropy, rotation, along, normal, kind, radial)


def lobe(tree: Tree, inputs: Inputs, N: Value, T: Value, wi: Value) -> tuple[Value, Value]:
    """f cos of the highlight with F = 1 and v.h, through the nested group."""
    n_u, n_v = inputs.exponents
    group = ensure(ashikhmin_lobe.NAME, ashikhmin_lobe.REVISION, ashikhmin_lobe.build)
    node = tree.group(group, To_Light=wi, N=N, T=T, Along=n_u, Across=n_v)
    return Value(tree, node.outputs["f cos"]), Value(tree, node.outputs["v.h"])


def reflectance(tree: Tree, specular: Value, vh: Value) -> Value:
    """F = Rs + (1 - Rs)(1 - v.h)^5."""
    return fresnel.reflectance(tree, "schlick", {"f0": specular}, vh)


def scattered(inputs: Inputs, enters: Value | float, ni: Value) -> Value | float:
    """pi f of the diffuse part over ``deep``, with what enters toward the viewer: 28/23 a(n.l) a(n.v), or 1."""
    return 1.0 if inputs.over_lambert else 28.0 / 23.0 * enters * entering(ni)


def entered(inputs: Inputs, no: Value) -> Value | float:
    """a(n.v), or over Lambert 1."""
    return 1.0 if inputs.over_lambert else entering(no)


def entering(cosine: Value) -> Value:
    """a(c) = 1 - (1 - c/2)^5."""
    return horner((0.0, 5.0, -10.0, 10.0, -5.0, 1.0), 0.5 * clamp(cosine))


def script(tree: Tree, estimator: str, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``ashikhmin_shirley_ESTIMATOR``, fed by these inputs."""
    N = shading_normal.specular_normal(tree, inputs.normal)
    given = {one.name: getattr(inputs, "n" if one is SHARPNESS else one.name) for one in MODEL.parameters}
    unturned = tangent.tangent(tree, inputs.tangent, N, 0.0, radial=inputs.radial)
    name = f"ashikhmin_shirley_{estimator}"
    kind = list(MODEL.kinds).index(inputs.kind)
    return osl_script(
        tree, name, (name, {HEADER: header()}), kind=kind, **given, Tangent=unturned, Normal=inputs.normal, **more
    )


def header() -> str:
    """Numbers of ``fit``; of its diffuse part the colours of Lambert and of Toon, whose light falls until TOON_END."""
    even, smooth = fit.EDGES
    numbers = {
        "COLORED": fit.COLORED,
        "LAMBERT": fit.LAMBERT, "TOON": toon_color(), "TOON_SIZE": fit.TOON_SIZE, "TOON_SMOOTH": fit.TOON_SMOOTH,
        "TOON_END": even + smooth, "TOON_FALL": smooth, "TOON_ALBEDO": (1.0 - fit.LAMBERT) * pi / fit.TOON_AREA,
    }  # fmt: skip
    return "".join(f"#define {name} {float(number)!r}\n" for name, number in numbers.items())


def toon_color() -> float:
    """Of the Toon BSDF, which Cycles scales by the cone that it samples."""
    return float((1.0 - fit.LAMBERT) * 2.0 * pi * (1.0 - cos(sum(fit.EDGES))) / fit.TOON_AREA)


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    radial = RADIAL in form.flags
    return (MODEL.kinds[form.kind] + " Radial" * radial).strip(), {"kind": form.kind, "radial": radial}
