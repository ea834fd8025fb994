# SPDX-License-Identifier: GPL-3.0-or-later
"""Oren-Nayar 1994: V-grooves of Lambertian facets. A rough diffuse surface."""

from math import pi

from ..reference import OrenNayar
from . import principled
from .estimators import BORROWING
from .spec import Form, Model, Parameter, Scale

# White as published sends back up to 1.051 of what arrives; below 0.95 no direction exceeds 1.
ALBEDO = Parameter(
    "albedo", "Base Color", "Albedo of a facet, linear RGB, 0 to 1", (0.8, 0.8, 0.8), 0.0, 0.95,
    socket="Color", example="albedo = [0.5, 0.5, 0.5]",
)  # fmt: skip
# Cycles' own Oren-Nayar of roughness r is nearest to the model where r = K s2/(s2 + C), s2 = sigma^2, for the C that
# ``closure_roughness`` was fitted with; K makes 90 degrees a roughness of 1.
C = 0.24
K = 1.0 + C / (pi / 2) ** 2
SIGMA = Parameter(
    "sigma", "Roughness", "By the standard deviation sigma of the facets' tilt: 0 is Lambert, 1 is 90 degrees",
    0.3, 0.0, pi / 2, unit="rad", subtype="FACTOR", example="sigma = 0.3", symbol="Sigma",
    scale=Scale(lambda sigma: K * sigma * sigma / (sigma * sigma + C), lambda r: (C * r / (K - r)) ** 0.5),
)  # fmt: skip


def _reference(form: Form, _parts: object) -> OrenNayar:
    return OrenNayar(form.parameters["albedo"], form.parameters["sigma"], qualitative=form.kind == "qualitative")


def _principled(form: Form) -> principled.Inputs:
    """Without a reflection; where an engine adds one nevertheless, it is as broad as can be."""
    qualitative = form.kind == "qualitative"
    return principled.diffuse(form, qualitative=qualitative) | principled.NO_SPECULAR | {"Roughness": 1.0}


MODEL = Model(
    name="oren_nayar",
    label="Oren-Nayar",
    opening="Rough ",
    parameters=(ALBEDO, SIGMA),
    kinds={"full": "Full", "qualitative": "Qualitative"},
    reference=_reference,
    solid=lambda form: form.parameters["albedo"],
    principled=_principled,
    is_diffuse=True,
    upright=frozenset({"fit"}),
    of_cycles=lambda estimator, _backend: estimator in BORROWING,  # 5.3's own Oren-Nayar is another
    most_lights_4_5={"corrected": 6},
)
