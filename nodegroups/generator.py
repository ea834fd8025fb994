# SPDX-License-Identifier: GPL-3.0-or-later
"""What all groups of the microfacet generator share: the artist's inputs; D is built into the group.

Sources: as ``addon/reference/generator.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..addon.models import label
from ..addon.models.fresnel import KINDS
from ..addon.models.generator import DIFFUSE, MODEL, SPECULAR
from ..addon.reference.facet_distribution import Distribution
from . import facet_density, fresnel, shading_normal
from .osl_script import script as osl_script
from .parameters import add_input

if TYPE_CHECKING:
    from bpy.types import Node

    from ..addon.models import Form
    from ._tree import Number, Tree, Value


@dataclass(frozen=True)
class Inputs:
    """The artist's inputs: both colours, Fresnel parameters by reference name, and the normal as linked (or not)."""

    albedo: Value
    specular: Value
    fresnel: dict[str, Value]
    normal: Value


def interface(tree: Tree, kind: str) -> Inputs:
    """Base Color; Specular Color; the Fresnel term's; Normal. The same for every estimator and backend."""
    albedo, specular = add_input(tree, DIFFUSE), add_input(tree, SPECULAR)
    terms = {
        one.name: add_input(tree, replace(one, label=label(MODEL.name, one.name))) for one in KINDS[kind].parameters
    }
    return Inputs(albedo, specular, terms, shading_normal.interface(tree))


def script(tree: Tree, estimator: str, kind: str, of: Distribution, inputs: Inputs, **more: Number) -> Node:
    """The OSL shader ``generator_ESTIMATOR`` of this distribution, fed by these inputs."""
    variant = f"generator_{estimator} {facet_density.digest(of)}", {facet_density.HEADER: facet_density.header(of)}
    given = {"albedo": inputs.albedo, "specular": inputs.specular, "Normal": inputs.normal, **inputs.fresnel}
    kinds = list(fresnel.KINDS).index(kind)
    return osl_script(tree, f"generator_{estimator}", variant, kind=kinds, **given, **more)


def variant(form: Form) -> tuple[str, dict[str, Any]]:
    """What the name of a preset's group says of its form, and what its builder has to know."""
    of = Distribution(form.distribution)
    return f"{MODEL.kinds[form.kind]} {facet_density.digest(of)}", {"kind": form.kind, "of": of}
