# SPDX-License-Identifier: GPL-3.0-or-later
"""A diffuse part under a brushed specular one: satin cloth, wood finish, brushed plastic."""

from __future__ import annotations

from dataclasses import replace

from . import anisotropic
from . import sum as plain
from .oren_nayar import MODEL as DIFFUSE

MODEL = replace(
    plain.MODEL,
    name="anisotropic_sum",
    label="Anisotropic Sum",
    opening="Brushed ",
    parameters=(plain.D, plain.S, *DIFFUSE.parameters, *anisotropic.MODEL.parameters),
    flags=(*plain.MODEL.flags, *anisotropic.MODEL.flags),
    parts=(("diffuse", DIFFUSE.name), ("specular", anisotropic.MODEL.name)),
    estimators=anisotropic.MODEL.estimators,
    most_lights_4_5=anisotropic.MODEL.most_lights_4_5,
    account=lambda form: plain.account(form, anisotropic.MODEL.name),
    principled=lambda form: {**plain.as_principled(form), **anisotropic.PRINCIPLED},
)
