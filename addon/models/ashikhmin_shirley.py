# SPDX-License-Identifier: GPL-3.0-or-later
"""Ashikhmin & Shirley 2000: Blinn's highlight with two exponents, over a diffuse part that takes what is left.

For artists a Roughness and an Anisotropy: facets have slopes m / s along the tangent and m s across it, at most 1, with
s^2 = 1 - 0.9 Anisotropy as in Blender's Metallic BSDF. An exponent is n = 2/m^2 - 2 of its slope, as of Blinn-Phong, so
that n + 2 is the geometric mean of n_u + 2 and n_v + 2. Fits of measured materials have a highlight of any amplitude
over Lambert.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from ..reference.ashikhmin_shirley import AshikhminShirley
from ..reference.cook_torrance_fit import NARROWEST
from . import coat, phong, principled
from .anisotropic import ANISOTROPY, PRINCIPLED, RADIAL, ROTATION
from .oren_nayar import ALBEDO
from .spec import Form, Model, Parameter, Scale

DIFFUSE = replace(ALBEDO, default=(0.3, 0.3, 0.3), tip="Share that is scattered of the light that enters, linear RGB")
SPECULAR = replace(
    phong.SPECULAR, default=(0.04, 0.04, 0.04), tip="Reflectance head-on, linear RGB; toward grazing views it is white"
)
AMPLITUDE = Parameter(
    "amplitude", "Specular Tint", "Multiplies the highlight, linear RGB", (1.0, 1.0, 1.0), 0.0, 1.0, socket="Color",
    optional=True, example="amplitude = [1.0, 0.9, 0.8]", symbol="Amplitude",
)  # fmt: skip
LAMBERT = "lambert"
SHARPNESS = Parameter(
    "sharpness", "Roughness", "Width of the highlight, as of Blender's own Roughness: (2/(n + 2))^(1/4) for Blinn's n",
    200.0, 0.0, 1e5, subtype="FACTOR", example="sharpness = 200", symbol="Sharpness n",
    scale=Scale(lambda n: ((2.0 / (n + 2.0)) ** 0.5) ** 0.5, lambda r: 2.0 / (r * r * r * r) - 2.0),
)  # fmt: skip


def _reference(form: Form, _parts: object) -> AshikhminShirley:
    of = form.parameters
    narrow = 1.0 - (1.0 - NARROWEST) * of["anisotropy"]
    n_u, n_v = (max((of["sharpness"] + 2.0) * share - 2.0, 0.0) for share in (narrow, 1.0 / narrow))
    azimuth, lambert = 2.0 * pi * of["rotation"], form.kind == LAMBERT
    return AshikhminShirley(of["albedo"], of["specular"], n_u, n_v, azimuth, of["amplitude"], lambert)


def _flaw(form: Form) -> str:
    total = float(np.max(np.asarray(form.parameters["albedo"]) + form.parameters["amplitude"]))
    if form.kind == LAMBERT and total > 1.0 + 1e-9:
        return f"albedo + amplitude must be at most 1, or more light would leave than arrives; got {total:g}"
    return ""


def mirrored(form: Form) -> np.ndarray:
    """RGB of the light that a smooth surface mirrors head-on."""
    return np.asarray(form.parameters["specular"]) * np.asarray(form.parameters["amplitude"])


def head_on(form: Form) -> tuple[float, ...]:
    """RGB of the light that leaves head-on from a smooth surface."""
    under = 1.0 if form.kind == LAMBERT else 1.0 - np.asarray(form.parameters["specular"])
    return tuple((mirrored(form) + under * np.asarray(form.parameters["albedo"])).tolist())


def as_principled(form: Form) -> principled.Inputs:
    """A dielectric, or a mixture with a metal where it reflects more than one does; both rise to white as this does."""
    specular, total = mirrored(form), np.asarray(head_on(form))
    brightest, roughness = float(specular.max()), SHARPNESS.scale.to_input(form.parameters["sharpness"])
    if brightest <= coat.HIGHEST_F0:
        root, tint = brightest**0.5, principled.rgb(specular / max(brightest, 1e-9))
        below: principled.Inputs = {"Roughness": roughness, "Base Color": principled.Feed("albedo")}
        below = below | {"Specular IOR Level": 0.5, "IOR": (1.0 + root) / (1.0 - root), "Specular Tint": tint}
        return below | PRINCIPLED
    mixed: principled.Inputs = {"Roughness": roughness, "Base Color": principled.rgb(total)}
    return mixed | principled.NO_SPECULAR | {"Metallic": float(specular.mean() / total.mean())} | PRINCIPLED


MODEL = Model(
    name="ashikhmin_shirley",
    label="Ashikhmin-Shirley",
    opening="Satin ",
    parameters=(DIFFUSE, SPECULAR, AMPLITUDE, SHARPNESS, ANISOTROPY, ROTATION),
    kinds={"plain": "", LAMBERT: "Over Lambert"},
    flags=(RADIAL,),
    estimators=("fit", "closure", "corrected", "mirror", "direct"),
    reference=_reference,
    flaw=_flaw,
    solid=head_on,
    principled=as_principled,
    is_diffuse=True,
    mirrors=False,
    upright=frozenset({"fit", "corrected"}),
)
