# SPDX-License-Identifier: GPL-3.0-or-later
"""A diffuse base under one to four Cook-Torrance lobes, as measured car paints are fitted (Günther et al. 2005)."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..reference import CarPaint
from . import fresnel, oren_nayar, principled
from .cook_torrance import SLOPE
from .spec import Form, Model
from .sum import S

if TYPE_CHECKING:
    from collections.abc import Iterator

TIP = "Share of this lobe; all shares plus the brightest channel of Base Color must not exceed 1"
SHARE = replace(S, tip=TIP, default=0.1)
COAT_IOR, COAT_F0 = 1.5, 0.04  # of a clear coat, which glTF and USD take for granted


def _shares(form: Form) -> list[float]:
    """s_1, s_2 and so on."""
    return [value for name, value in form.parameters.items() if name.startswith("s_")]


def _reference(form: Form, parts: dict[str, Any]) -> CarPaint:
    base, *lobes = parts.values()
    return CarPaint(base, tuple(lobes), tuple(_shares(form)))


def _flaw(form: Form) -> str:
    base, lobes = max(form.parameters["albedo"]), sum(_shares(form))
    if base + lobes > 1.0 + 1e-9:
        most = "albedo and all s must together be at most 1, or more light would leave than arrives"
        return f"{most}; got {base:g} + {lobes:g}"
    return ""


def _account(form: Form) -> Iterator[tuple[str, str]]:
    shares = _shares(form)
    yield "base: oren_nayar", "under the lobes"
    yield f"{len(shares)} lobes: cook_torrance", f"{', '.join(f'{s:g}' for s in shares)} of the light"


def _solid(form: Form) -> tuple[float, ...]:
    color = form.parameters["albedo"]
    for k, s in enumerate(_shares(form), 1):
        color = tuple(c + s * f0 for c, f0 in zip(color, form.parameters[f"f0_{k}"], strict=True))
    return tuple(color)


def _principled(form: Form) -> principled.Inputs:
    """The narrowest lobe is the coat; the others are flakes, mixed with the base by what they send back head-on."""
    of, count = form.parameters, len(_shares(form))
    m = np.array([of[f"m_{k}"] for k in range(1, count + 1)])
    head_on = np.array([of[f"s_{k}"] * np.asarray(of[f"f0_{k}"]) for k in range(1, count + 1)])
    coat = int(np.argmin(m))
    flakes, slopes = np.delete(head_on, coat, axis=0), np.delete(m, coat)
    weights = flakes.mean(axis=1)
    color = np.asarray(of["albedo"]) + flakes.sum(axis=0)
    slope = float(np.average(slopes, weights=weights)) if weights.sum() > 0.0 else 1.0
    return {
        **principled.diffuse(form),
        **principled.NO_SPECULAR,
        "Base Color": principled.rgb(color),
        "Metallic": min(1.0, float(weights.sum()) / max(float(color.mean()), 1e-9)),
        "Roughness": min(1.0, slope**0.5),
        "Coat Weight": min(1.0, float(head_on[coat].mean()) / COAT_F0),
        "Coat Roughness": min(1.0, float(m[coat]) ** 0.5),
        "Coat IOR": COAT_IOR,
    }


MODEL = Model(
    name="car_paint",
    label="Car Paint",
    opening="",
    parameters=oren_nayar.MODEL.parameters,
    kinds={"f82": fresnel.LABELS["f82"]},
    parts=(("diffuse", "oren_nayar"),),
    labels={"sigma": "Diffuse Roughness", "f0": "Color"},
    lobes=(SHARE, SLOPE, fresnel.F0, fresnel.F82_TINT),
    lobe_model="cook_torrance",
    most_lobes=4,
    reference=_reference,
    flaw=_flaw,
    account=_account,
    solid=_solid,
    principled=_principled,
    is_diffuse=True,
    most_lights={"corrected": 4, "hybrid": 3},
    most_lights_4_5={"corrected": 3, "hybrid": 3, "direct": 6},
)
