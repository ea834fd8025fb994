# SPDX-License-Identifier: GPL-3.0-or-later
"""A model as Blender's Principled BSDF, which exporters read: what its inputs get, by the names of its sockets.

Each model's own file says what it is, by what is common to several of them here. Principled has another distribution
(GGX) and another G: colours and widths are carried, the shape of the lobe is not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reference import oren_nayar_fit, schlick
from ..reference.fresnel import F82_COSINE
from . import coat, fresnel
from .spec import Number

if TYPE_CHECKING:
    from .spec import Form

BLACK = (0.0, 0.0, 0.0)
WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Feed:
    """What a parameter gives to an input: factor * value ** exponent. A texture on the one belongs on the other."""

    parameter: str
    factor: float = 1.0
    exponent: float = 1.0

    def value(self, form: Form) -> Number:
        found = self.factor * np.asarray(form.parameters[self.parameter], dtype=np.float64) ** self.exponent
        return found.item() if found.ndim == 0 else tuple(found.tolist())


Inputs = dict[str, Number | Feed]
NO_SPECULAR: Inputs = {"Specular IOR Level": 0.0}
ROUGHNESS: Inputs = {
    "Roughness": Feed("m", exponent=0.5)
}  # Cycles' alpha is m, and the square of Principled's Roughness


def metal(form: Form) -> Inputs:
    """What only reflects: exact for Schlick's term and F82; of n and k the reflectance head-on and at 82 degrees."""
    if form.kind in {"schlick", "f82"}:
        tint: Number | Feed = Feed("f82_tint") if form.kind == "f82" else WHITE
        return {**ROUGHNESS, "Metallic": 1.0, "Base Color": Feed("f0"), "Specular Tint": tint}
    F = fresnel.reference(form)
    f0, edge = F(1.0), F(F82_COSINE)
    tint = rgb(edge / schlick(F82_COSINE, f0))
    return {**ROUGHNESS, "Metallic": 1.0, "Base Color": rgb(f0), "Specular Tint": tint}


def interface(form: Form, share: float = 1.0) -> Inputs:
    """The reflection of a dielectric, above what light reaches through it. share: of that reflection, in 0..1."""
    level: Inputs = {"Specular IOR Level": 0.5 * share}  # 0.5: all that the IOR reflects
    if form.kind == "dielectric":
        return {**ROUGHNESS, **level, "IOR": Feed("eta")}
    f0 = np.asarray(form.parameters["f0"])
    brightest = float(f0.max())
    eta = (1.0 + brightest**0.5) / (1.0 - brightest**0.5)
    return {**ROUGHNESS, **level, "IOR": eta, "Specular Tint": rgb(f0 / max(brightest, 1e-9))}


def is_metallic(form: Form) -> bool:
    """Whether the Fresnel term is a metal's, or reflects more than a dielectric does."""
    f0 = form.parameters.get("f0", BLACK)
    return fresnel.KINDS[form.kind].is_metal or (form.kind == "schlick" and max(f0) > coat.HIGHEST_F0)


def diffuse(form: Form, share: float = 1.0, *, qualitative: bool = False) -> Inputs:
    """The diffuse part of Oren and Nayar. share: of the light, in 0..1."""
    sigma = form.parameters["sigma"]
    roughness = float(oren_nayar_fit.closure_roughness(sigma, qualitative=qualitative))
    return {"Base Color": Feed("albedo", share), "Diffuse Roughness": roughness}


def rgb(value: Any) -> tuple[float, float, float]:
    """A colour held within 0..1, as plain numbers."""
    r, g, b = np.clip(value, 0.0, 1.0).tolist()
    return r, g, b
