# SPDX-License-Identifier: GPL-3.0-or-later
"""Microfacet generator (Ashikhmin, Premoze & Shirley 2000): V-grooves of any distribution of facets, over Lambert."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..reference.facet_distribution import Distribution, Term
from ..reference.fresnel import F82_COSINE, schlick
from ..reference.generator import Generator
from ..reference.generator_fit import beckmann_terms, distance
from . import fresnel, phong, principled
from .oren_nayar import ALBEDO
from .spec import Form, Model

if TYPE_CHECKING:
    from collections.abc import Iterator

SPECULAR = replace(
    phong.SPECULAR,
    tip="Multiplies what the facets mirror, linear RGB",
    default=(1.0, 1.0, 1.0),
)
DIFFUSE = replace(ALBEDO, default=(0.0, 0.0, 0.0))


def _reference(form: Form, _parts: object) -> Generator:
    of = form.parameters
    return Generator(of["albedo"], of["specular"], Distribution(form.distribution), fresnel.reference(form))


def _head_on(form: Form) -> tuple[float, ...]:
    """RGB of the light that leaves head-on, as if all facets mirrored it there."""
    mirrored = np.asarray(form.parameters["specular"]) * fresnel.reference(form)(1.0)
    return principled.rgb(np.asarray(form.parameters["albedo"]) + mirrored)


def _flaw(form: Form) -> str:
    total = np.asarray(form.parameters["albedo"]) + form.parameters["specular"] * fresnel.reference(form)(1.0)
    if total.max() > 1.0 + 1e-9:
        return f"albedo + specular F0 must be at most 1, or more light would leave than arrives; got {total.max():g}"
    return ""


def _account(form: Form) -> Iterator[tuple[str, str]]:
    of = Distribution(form.distribution)
    terms = beckmann_terms(of)
    yield "facets", ", ".join(f"{share:.3g} of {one.kind}" for share, one in zip(of.shares, of.terms, strict=True))
    differs = f"{100.0 * distance(of, terms):.2g} % of the mirrored light differs"
    yield "Fit", f"{len(terms)} Beckmann distributions in their place; {differs}"


def _principled(form: Form) -> principled.Inputs:
    """Roughness of the Beckmann distribution half of whose facets lean as little."""
    roughness = min(1.0, Distribution(form.distribution).slope ** 0.5)
    F, specular = fresnel.reference(form), np.asarray(form.parameters["specular"])
    f0 = specular * F(1.0)
    inputs: principled.Inputs = {"Roughness": roughness, "Base Color": principled.Feed("albedo")}
    if not principled.is_metallic(form) and max(form.parameters["albedo"]) > 0.0:
        root = float(np.max(f0)) ** 0.5
        tint = principled.rgb(f0 / max(float(np.max(f0)), 1e-9))
        return inputs | {"Specular IOR Level": 0.5, "IOR": (1.0 + root) / (1.0 - root), "Specular Tint": tint}
    edge = principled.rgb(specular * F(F82_COSINE) / schlick(F82_COSINE, f0))
    metal: principled.Inputs = {"Metallic": 1.0, "Base Color": principled.rgb(f0), "Specular Tint": edge}
    return inputs | metal


MODEL = Model(
    name="generator",
    label="Microfacet Generator",
    opening="",
    parameters=(DIFFUSE, SPECULAR),
    has_fresnel=True,
    kinds=fresnel.LABELS,
    distribution=(Term("beckmann", (0.3,)),),
    labels={"f0": "Facet Color"},
    estimators=("fit", "closure", "mirror", "direct"),
    reference=_reference,
    flaw=_flaw,
    account=_account,
    solid=_head_on,
    principled=_principled,
    is_diffuse=True,
    mirrors=False,
)
