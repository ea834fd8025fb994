# SPDX-License-Identifier: GPL-3.0-or-later
"""A body that scatters light below its surface, under a coat of V-grooves."""

from __future__ import annotations

from math import pi
from typing import TYPE_CHECKING, Any

from ..reference import Lambert, Sum
from . import coat, cook_torrance, fresnel, principled
from .spec import Form, Model, Parameter

if TYPE_CHECKING:
    from collections.abc import Iterator

REFLECTANCE = Parameter(
    "reflectance", "Base Color",
    "Diffuse reflectance: the share of entering light that a large, evenly lit body returns",
    (0.8, 0.8, 0.8), 0.0, 1.0, socket="Color", example="reflectance = [0.8, 0.7, 0.6]", symbol="Reflectance",
)  # fmt: skip
MEAN_FREE_PATH = Parameter(
    "mean_free_path", "Subsurface Radius",
    "Mean free path: distance between scattering events in metres, for R, G and B",
    (1e-3, 1e-3, 1e-3), 0.0, 10.0, unit="m", socket="Vector",
    example="mean_free_path = [0.001, 0.001, 0.001] (metres)", symbol="Mean Free Path",
)  # fmt: skip


def _reference(form: Form, parts: dict[str, Any]) -> Sum:
    """As a large body looks under even light."""
    return Sum(Lambert(form.parameters["reflectance"]), parts["specular"], 1.0, 1.0, coupled=True)


def account(_form: Form, coat_of: str = cook_torrance.MODEL.name) -> Iterator[tuple[str, str]]:
    """The body and its coat."""
    yield "body: Cycles' subsurface scattering", "of the light that the coat lets in; the same for all estimators"
    yield f"coat: {coat_of}", "all of the reflected light"


def as_principled(form: Form) -> principled.Inputs:
    """Cycles takes a mean free path of Subsurface Radius * Scale / (4 pi)."""
    return principled.interface(form) | {
        "Base Color": principled.Feed("reflectance"),
        "Subsurface Weight": 1.0,
        "Subsurface Radius": principled.Feed("mean_free_path", 4.0 * pi),
        "Subsurface Scale": 1.0,
    }


MODEL = Model(
    name="translucent",
    label="Translucent",
    opening="",
    parameters=(REFLECTANCE, MEAN_FREE_PATH, *cook_torrance.MODEL.parameters),
    has_fresnel=True,
    kinds=fresnel.LABELS,
    parts=(("specular", "cook_torrance"),),
    labels={"f0": "Specular Color"},
    estimators=("fit", "closure", "corrected", "hybrid", "mirror"),
    reference=_reference,
    flaw=lambda form: coat.flaw("a translucent body", form),
    account=account,
    solid=lambda form: form.parameters["reflectance"],
    principled=as_principled,
    is_diffuse=True,
    mirrors=False,
    most_lights_4_5={"corrected": 4},
)
