# SPDX-License-Identifier: GPL-3.0-or-later
"""Cook-Torrance 1982: V-grooves of mirror facets, Beckmann-distributed. Reflection alone."""

from ..reference import CookTorrance, Smooth
from . import fresnel, principled
from .spec import Form, Model, Parameter, Scale

SLOPE = Parameter(
    "m", "Roughness", "Blender's own roughness: the square root of the facets' RMS slope m", 0.3, 1e-4, 10.0,
    unit="rms slope", subtype="FACTOR", native_high=1.0, is_roughness=True, zero_is_smooth=True, example="m = 0.3",
    symbol="Slope m", scale=Scale(lambda m: m**0.5, lambda roughness: roughness * roughness),
)  # fmt: skip


def _reference(form: Form, _parts: object) -> CookTorrance | Smooth:
    F, m = fresnel.reference(form), form.parameters["m"]
    return Smooth(F) if m == 0.0 else CookTorrance(m, F)


def as_principled(form: Form) -> principled.Inputs:
    """A dielectric without a body below it is black there."""
    if form.kind == "dielectric":
        return principled.interface(form) | {"Base Color": principled.BLACK}
    return principled.metal(form)


MODEL = Model(
    name="cook_torrance",
    label="Cook-Torrance",
    opening="Reflection of ",
    parameters=(SLOPE,),
    has_fresnel=True,
    kinds=fresnel.LABELS,
    reference=_reference,
    bounces=lambda form: form.kind != "dielectric",  # of a dielectric next to nothing is left after two
    principled=as_principled,
    most_lights_4_5={"corrected": 4, "direct": 6},
)
