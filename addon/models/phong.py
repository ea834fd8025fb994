# SPDX-License-Identifier: GPL-3.0-or-later
"""Modified Phong (Lafortune & Willems 1994): a cosine lobe about the mirror direction, over Lambert."""

from dataclasses import replace

import numpy as np

from ..reference.phong import Phong
from . import coat, principled
from .oren_nayar import ALBEDO
from .spec import Form, Model, Parameter, Scale

HIGHEST = 1e4  # exponent; beyond, float32 no longer tells such lobes from one another
AT_MOST_ONE = "; in each channel Base Color and Specular Color add up to at most 1"
DIFFUSE = replace(ALBEDO, tip="Share of the light that is scattered evenly, linear RGB" + AT_MOST_ONE)
SPECULAR = Parameter(
    "specular", "Specular Color", "Share of the light that the highlight reflects head-on, linear RGB" + AT_MOST_ONE,
    (0.2, 0.2, 0.2), 0.0, 1.0, socket="Color", example="specular = [0.2, 0.2, 0.2]", symbol="Specular",
)  # fmt: skip
# Blender's Roughness of the Beckmann lobe that is as wide near its peak head-on, of slope (2n + 1)^(-1/2)
EXPONENT = Parameter(
    "exponent", "Roughness", "Width of the highlight, as of Blender's own Roughness: (2n + 1)^(-1/4) for Phong's n",
    50.0, 0.0, HIGHEST, subtype="FACTOR", example="exponent = 50", symbol="Exponent n",
    scale=Scale(lambda n: 1.0 / ((2.0 * n + 1.0) ** 0.5) ** 0.5, lambda r: 0.5 / (r * r * r * r) - 0.5),
)  # fmt: skip


def _reference(form: Form, _parts: object) -> Phong:
    of = form.parameters
    return Phong(of["albedo"], of["specular"], of["exponent"])


def flaw(form: Form) -> str:
    """Why Base Color and Specular Color cannot go together; "" if they can."""
    total = max(head_on(form))
    if total > 1.0 + 1e-9:
        return f"albedo + specular must be at most 1, or more light would leave than arrives; got {total:g}"
    return ""


def head_on(form: Form) -> tuple[float, ...]:
    """RGB of the light that leaves head-on."""
    return tuple(np.add(form.parameters["albedo"], form.parameters["specular"]).tolist())


def as_principled(form: Form, exponent: Parameter = EXPONENT) -> principled.Inputs:
    """A dielectric, or a mixture with a metal where it reflects more than one does; both brighten toward the edge."""
    specular, total = np.asarray(form.parameters["specular"]), np.asarray(head_on(form))
    brightest, roughness = float(specular.max()), exponent.scale.to_input(form.parameters[exponent.name])
    if brightest <= coat.HIGHEST_F0:
        root, tint = brightest**0.5, principled.rgb(specular / max(brightest, 1e-9))
        below: principled.Inputs = {"Roughness": roughness, "Base Color": principled.Feed("albedo")}
        return below | {"Specular IOR Level": 0.5, "IOR": (1.0 + root) / (1.0 - root), "Specular Tint": tint}
    mixed: principled.Inputs = {"Roughness": roughness, "Base Color": principled.rgb(total)}
    return mixed | principled.NO_SPECULAR | {"Metallic": float(np.mean(specular) / np.mean(total))}


MODEL = Model(
    name="phong",
    label="Phong",
    opening="",
    parameters=(DIFFUSE, SPECULAR, EXPONENT),
    kinds={"plain": ""},
    estimators=("closure", "corrected", "mirror", "direct"),
    reference=_reference,
    flaw=flaw,
    solid=head_on,
    principled=as_principled,
    is_diffuse=True,
    mirrors=False,
    upright=frozenset({"corrected"}),
)
