# SPDX-License-Identifier: GPL-3.0-or-later
"""Blinn-Phong (Blinn 1977), scaled exactly: a cosine lobe of the half vector about the normal, over Lambert."""

from dataclasses import replace
from functools import partial

from ..reference.phong import BlinnPhong
from . import phong
from .spec import Form, Parameter, Scale

# Blender's Roughness of the Beckmann lobe that is as wide near its peak, of slope (2/(n + 2))^(1/2)
SHININESS = Parameter(
    "shininess", "Roughness", "Width of the highlight, as of Blender's own Roughness: (2/(n + 2))^(1/4) for Blinn's n",
    200.0, 0.0, phong.HIGHEST, subtype="FACTOR", example="shininess = 200", symbol="Shininess n",
    scale=Scale(lambda n: ((2.0 / (n + 2.0)) ** 0.5) ** 0.5, lambda r: 2.0 / (r * r * r * r) - 2.0),
)  # fmt: skip


def _reference(form: Form, _parts: object) -> BlinnPhong:
    of = form.parameters
    return BlinnPhong(of["albedo"], of["specular"], of["shininess"])


MODEL = replace(
    phong.MODEL,
    name="blinn_phong",
    label="Blinn-Phong",
    parameters=(phong.DIFFUSE, phong.SPECULAR, SHININESS),
    reference=_reference,
    principled=partial(phong.as_principled, exponent=SHININESS),
)
