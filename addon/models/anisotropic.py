# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance with an elliptical distribution of facets: brushed, ground, rolled and turned surfaces.

Slopes along the tangent and across it are m / s and m s, s^2 = 1 - 0.9 Anisotropy, as Blender's Metallic BSDF has them.
"""

from __future__ import annotations

from math import pi

from ..reference import Anisotropic, Smooth
from ..reference.cook_torrance_fit import NARROWEST
from . import cook_torrance, fresnel, principled
from .cook_torrance import SLOPE
from .spec import Form, Model, Parameter

ANISOTROPY = Parameter(
    "anisotropy", "Anisotropy", "How much rougher along the tangent than across it: 1 is ten times", 0.5, 0.0, 1.0,
    subtype="FACTOR", example="anisotropy = 0.8",
)  # fmt: skip
ROTATION = Parameter(
    "rotation", "Rotation", "Turns the tangent about the normal; 1 is a full turn", 0.0, 0.0, 1.0, unit="turns",
    subtype="FACTOR", optional=True,
)  # fmt: skip
RADIAL = "radial"  # grooves around the object's Z axis, whatever UV map there is


def _reference(form: Form, _parts: object) -> Anisotropic | Smooth:
    of, F = form.parameters, fresnel.reference(form)
    if of["m"] == 0.0:
        return Smooth(F)
    aspect = (1.0 - (1.0 - NARROWEST) * of["anisotropy"]) ** 0.5
    return Anisotropic(of["m"] / aspect, of["m"] * aspect, F, 2.0 * pi * of["rotation"])


# Principled has the same two numbers, and a Tangent.
PRINCIPLED: principled.Inputs = {
    "Anisotropic": principled.Feed("anisotropy"),
    "Anisotropic Rotation": principled.Feed("rotation"),
}


MODEL = Model(
    name="anisotropic",
    label="Anisotropic",
    opening="Brushed reflection of ",
    parameters=(SLOPE, ANISOTROPY, ROTATION),
    has_fresnel=True,
    kinds=fresnel.LABELS,
    flags=(RADIAL,),
    estimators=("fit", "closure", "corrected", "mirror", "direct"),
    reference=_reference,
    most_lights_4_5={"corrected": 3, "direct": 5},
    principled=lambda form: {**cook_torrance.as_principled(form), **PRINCIPLED},
)
