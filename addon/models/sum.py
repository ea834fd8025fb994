# SPDX-License-Identifier: GPL-3.0-or-later
"""A diffuse part under a specular one: f = d f_diffuse + s f_specular (Cook & Torrance 1982).

Coupled, the diffuse part gets what the specular one leaves.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..reference import Sum
from . import coat, cook_torrance, fresnel, oren_nayar, principled
from .spec import Form, Model, Parameter

if TYPE_CHECKING:
    from collections.abc import Iterator

COUPLED = "coupled"
AT_MOST_ONE = "; the shares add up to at most 1, or more light would leave than arrives"
D = Parameter(
    "d", "Diffuse", "Share of the diffuse part" + AT_MOST_ONE, 0.5, 0.0, 1.0, subtype="FACTOR", example="d = 0.6",
)  # fmt: skip
S = Parameter(
    "s", "Specular", "Share of the specular part" + AT_MOST_ONE, 0.5, 0.0, 1.0, subtype="FACTOR", example="s = 0.4",
)  # fmt: skip


def _reference(form: Form, parts: dict[str, Any]) -> Sum:
    return Sum(parts["diffuse"], parts["specular"], form.parameters["d"], form.parameters["s"], COUPLED in form.flags)


def _flaw(form: Form) -> str:
    if COUPLED in form.flags:
        return coat.flaw("a coupled sum", form)
    d, s = form.parameters["d"], form.parameters["s"]
    if d + s > 1.0 + 1e-9:
        return f"d + s must be at most 1, or more light would leave than arrives; got {d:g} + {s:g}"
    return ""


def account(form: Form, specular: str = cook_torrance.MODEL.name) -> Iterator[tuple[str, str]]:
    """Both parts, and their shares."""
    d, s = form.parameters["d"], form.parameters["s"]
    yield (
        "diffuse part: oren_nayar",
        f"{d:g} of what the specular part leaves" if COUPLED in form.flags else f"{d:g} of the light",
    )
    yield f"specular part: {specular}", f"{s:g} of the light"


def as_principled(form: Form) -> principled.Inputs:
    """Under a metal's term a mixture, whose colour is what both send back head-on."""
    d, s = form.parameters["d"], form.parameters["s"]
    below = principled.diffuse(form, d)
    if not principled.is_metallic(form):
        return below | principled.interface(form, s)
    head_on = d * np.asarray(form.parameters["albedo"]) + s * fresnel.reference(form)(1.0)
    mixed = {"Base Color": principled.rgb(head_on), "Metallic": s / (d + s) if d + s else 0.0}
    return below | principled.metal(form) | principled.NO_SPECULAR | mixed


MODEL = Model(
    name="sum",
    label="Sum",
    opening="",
    parameters=(D, S, *oren_nayar.MODEL.parameters, *cook_torrance.MODEL.parameters),
    has_fresnel=True,
    kinds=fresnel.LABELS,
    flags=(COUPLED,),
    parts=(("diffuse", "oren_nayar"), ("specular", "cook_torrance")),
    labels={"sigma": "Diffuse Roughness", "f0": "Specular Color"},
    reference=_reference,
    flaw=_flaw,
    account=account,
    solid=lambda form: form.parameters["albedo"],
    principled=as_principled,
    is_diffuse=True,
    most_lights_4_5={"corrected": 5},
)
