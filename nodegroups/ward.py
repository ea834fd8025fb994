# SPDX-License-Identifier: GPL-3.0-or-later
"""What all groups of Ward's model share: the artist's inputs, the formula, and a drawn facet.

Slopes and tangent are those of ``anisotropic``, and so are D and the facets. Sources: as ``addon/reference/ward.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from ..addon.models.anisotropic import ANISOTROPY, RADIAL, ROTATION
from ..addon.models.cook_torrance import SLOPE
from ..addon.models.ward import DIFFUSE, MODEL, SPECULAR
from . import anisotropic, osl_script, shading_normal, tangent
from ._tree import dot, maximum, normalize, scale, sqrt
from .parameters import add_input

if TYPE_CHECKING:
    from bpy.types import Node

    from ..addon.models import Form
    from ._tree import Number, Tree, Value


@dataclass(frozen=True)
class Inputs(anisotropic.Inputs):
    """Beside those of ``anisotropic``, without its Fresnel term: both colours. kind: which of Ward's forms."""

    albedo: Value
    specular: Value
    kind: str

    model: ClassVar[str] = MODEL.name

    def lobe(self, tree: Tree, N: Value, wi: Value, wo: Value) -> Value:
        """In 1/sr, without asking whether both are above: D / |wi + wo|^2, or of 1992 D (n.h)^4 / (4 sqrt(ni no))."""
        both = wi + wo
        h = normalize(both)
        D = self.density(tree, h, N)
        if self.kind == "bounded":
            return D / dot(both, both)
        return D * dot(N, h) ** 4 / (4.0 * sqrt(maximum(dot(N, wi) * dot(N, wo), 1e-14)))

    def draw(self, tree: Tree, N: Value, wo: Value) -> tuple[Value, Value]:
        """A facet as the view sees it, and what it weighs: 4 (lobe/D) (n.l)(n.v) / G1 (``Ward._draw``)."""
        h = self.facet(tree, N, wo)
        with tree.frame("Weight, (n.v)/G1 = max(n.v, (v.h)/(2 n.h))"):
            vh, no, nh = maximum(dot(wo, h), 1e-7), maximum(dot(N, wo), 1e-7), dot(N, h)
            ni = maximum(dot(N, scale(h, 2.0 * vh) - wo), 0.0)
            seen = maximum(no, vh / (2.0 * nh))
            if self.kind == "bounded":
                return h, ni * seen / (vh * vh)
            return h, nh**4 * sqrt(ni / no) * seen

    def for_script(self, tree: Tree) -> dict[str, Value]:
        return super().for_script(tree) | {"albedo": self.albedo, "specular": self.specular}


def interface(tree: Tree, kind: str, *, radial: bool, native: bool = False) -> Inputs:
    """Base Color; Specular Color; Roughness, as Cycles takes it if ``native``; those of ``anisotropic``; Normal."""
    albedo, specular, m = add_input(tree, DIFFUSE), add_input(tree, SPECULAR), add_input(tree, SLOPE, native=native)
    anisotropy, rotation, normal = (
        add_input(tree, ANISOTROPY),
        add_input(tree, ROTATION),
        shading_normal.interface(tree),
    )
    along = tangent.interface(tree, radial=radial)
    return Inputs({}, m, normal, anisotropy, rotation, along, radial, albedo, specular, kind)


def script(tree: Tree, estimator: str, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``ward_ESTIMATOR`` fed by these inputs."""
    given = inputs.for_script(tree) | more
    return osl_script.script(tree, f"ward_{estimator}", kind=list(MODEL.kinds).index(inputs.kind), **given)


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    radial = RADIAL in form.flags
    return (MODEL.kinds[form.kind] + " Radial" * radial).strip(), {"kind": form.kind, "radial": radial}
