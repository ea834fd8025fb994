# SPDX-License-Identifier: GPL-3.0-or-later
"""Ward's elliptical Gaussian over Lambert: the bounded form of 2010, and that of 1992.

Slopes along the tangent and across it, which Ward calls alpha_x and alpha_y, are those of ``anisotropic``. Duer's form
of 2006 is in the reference alone, as it sends back more light than arrives.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from ..reference.cook_torrance_fit import NARROWEST
from ..reference.ward import HIGHEST, Ward
from . import phong, principled
from .anisotropic import ANISOTROPY, PRINCIPLED, RADIAL, ROTATION
from .cook_torrance import SLOPE
from .oren_nayar import ALBEDO
from .spec import Form, Model

DIFFUSE = replace(ALBEDO, default=(0.5, 0.5, 0.5), tip=phong.DIFFUSE.tip)
SPECULAR = replace(
    phong.SPECULAR, tip="Ward's rho_s: the most that the highlight reflects, linear RGB" + phong.AT_MOST_ONE
)


def _reference(form: Form, _parts: object) -> Ward:
    of = form.parameters
    m, aspect = max(of["m"], SLOPE.low), (1.0 - (1.0 - NARROWEST) * of["anisotropy"]) ** 0.5  # 0 as its input has it
    slopes = m / aspect, m * aspect
    return Ward(of["albedo"], of["specular"], *slopes, 2.0 * pi * of["rotation"], form.kind)


def _flaw(form: Form) -> str:
    of, most = form.parameters, HIGHEST[form.kind]
    total = float(np.max(np.asarray(of["albedo"]) + most * np.asarray(of["specular"])))
    if total > 1.0 + 1e-9:
        sum_ = "albedo + specular" if most == 1.0 else f"albedo + {most:g} specular"
        return f"{sum_} must be at most 1, or more light would leave than arrives; got {total:g}"
    return ""


def _as_principled(form: Form) -> principled.Inputs:
    return {**phong.as_principled(form, SLOPE), **principled.ROUGHNESS, **PRINCIPLED}


MODEL = Model(
    name="ward",
    label="Ward",
    opening="",
    parameters=(DIFFUSE, SPECULAR, SLOPE, ANISOTROPY, ROTATION),
    kinds={"bounded": "", "ward_1992": "1992"},
    flags=(RADIAL,),
    estimators=("fit", "closure", "corrected", "mirror", "direct"),
    reference=_reference,
    flaw=_flaw,
    solid=phong.head_on,
    principled=_as_principled,
    is_diffuse=True,
    mirrors=False,
    most_lights_4_5={"corrected": 6},
)
