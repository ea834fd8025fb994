# SPDX-License-Identifier: GPL-3.0-or-later
"""A body that scatters light below its surface, under a brushed coat."""

from __future__ import annotations

from dataclasses import replace

from . import anisotropic, translucent

MODEL = replace(
    translucent.MODEL,
    name="anisotropic_translucent",
    label="Anisotropic Translucent",
    opening="Brushed ",
    parameters=(translucent.REFLECTANCE, translucent.MEAN_FREE_PATH, *anisotropic.MODEL.parameters),
    flags=anisotropic.MODEL.flags,
    parts=(("specular", anisotropic.MODEL.name),),
    estimators=tuple(name for name in anisotropic.MODEL.estimators if name in translucent.MODEL.estimators),
    account=lambda form: translucent.account(form, anisotropic.MODEL.name),
    principled=lambda form: {**translucent.as_principled(form), **anisotropic.PRINCIPLED},
)
