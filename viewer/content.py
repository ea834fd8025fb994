# SPDX-License-Identifier: GPL-3.0-or-later
"""What a page shows, as data: presets and measured files, and the registry's models with ranges and tips."""

from __future__ import annotations

import base64
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from ..addon.library.errors import InputError
from ..addon.measured import Merl, open_table, tabulate
from ..addon.models import MODELS, fresnel
from ..addon.reference.facet_distribution import FORMULAS
from . import bundle

if TYPE_CHECKING:
    from ..addon.library.preset import Preset
    from ..addon.measured import Table
    from ..addon.models import Model, Parameter
    from ..addon.reference.facet_distribution import Term

STOPS = 200  # positions of a slider


def form(preset: Preset) -> dict[str, Any]:
    """What decides a preset's BRDF. InputError if the viewer lacks its model, or its table cannot be read."""
    if preset.table is not None:
        return {"table": table(open_table(preset.table).table)}
    if preset.model not in bundle.models():
        message = f"{preset.id}: the page has no formula for the model {preset.model}; view another preset"
        raise InputError(message)
    return {
        "model": preset.model, "kind": preset.kind, "flags": list(preset.flags), "parameters": preset.parameters,
        "distribution": [term(one) for one in preset.distribution],
    }  # fmt: skip


def term(one: Term) -> dict[str, Any]:
    """A term of a distribution of facets."""
    return asdict(one)


def table(measured: Table) -> dict[str, Any]:
    """A grid of 90 theta_h, 30 theta_d and 36 phi_d, RGB in 1/sr as 16-bit floats, base64. InputError if anisotropic.

    Cells are the means of MERL's own; theta_h is as fine as MERL's, which narrow highlights need.
    """
    if not measured.contents.isotropic:
        message = "is anisotropic; the page draws isotropic measurements alone"
        raise InputError(message)
    merl = measured if isinstance(measured, Merl) else Merl(tabulate(measured.evaluate))
    whole = merl.table[..., :180] if merl.table.shape[3] == 180 else (merl.table[..., :180] + merl.table[..., 180:]) / 2
    cells = whole.reshape(3, 90, 30, 3, 36, 5).mean(axis=(3, 5))
    values = np.minimum(np.moveaxis(cells, 0, -1), 65504.0).astype("<f2")
    return {"size": values.shape[:3], "data": base64.b64encode(values.tobytes()).decode("ascii")}


def registry() -> dict[str, Any]:
    """Specs of all models that the viewer has, of Fresnel terms, and the numbers of formulas of facets."""
    return {
        "specs": {name: _spec(spec) for name, spec in MODELS.items() if name in bundle.models()},
        "fresnel": {
            name: {"label": kind.label, "parameters": [_parameter(one) for one in kind.parameters]}
            for name, kind in fresnel.KINDS.items()
        },
        "formulas": {
            kind: [{"name": name, "low": low, "high": high} for name, low, high in numbers]
            for kind, numbers in FORMULAS.items()
        },
    }


def _spec(spec: Model) -> dict[str, Any]:
    return {
        "label": spec.label,
        "kinds": dict(spec.kinds),
        "hasFresnel": spec.has_fresnel,
        "flags": [flag for flag in spec.flags if flag != "radial"],  # a matter of an object, not of a direction
        "parts": spec.parts,
        "lobes": [_parameter(one) for one in spec.lobes],
        "lobe_model": spec.lobe_model,
        "parameters": [_parameter(one) for one in spec.parameters if not one.in_volume],
    }


def _parameter(one: Parameter) -> dict[str, Any]:
    """Name, range, tip, and the values at a slider's stops, which are even in what Blender's input holds."""
    high = one.native_high or one.high
    first, last = sorted(float(one.scale.to_input(value)) for value in (one.low, high))
    values = np.sort([float(one.scale.of_input(x)) for x in np.linspace(first, last, STOPS + 1)])
    return {
        "name": one.name, "label": one.symbol or one.label, "input": one.label if one.symbol else "", "tip": one.tip,
        "unit": one.unit, "low": one.low, "high": one.high, "default": one.default, "rgb": one.is_rgb,
        "zero": one.zero_is_smooth, "stops": [float(f"{value:.4g}") for value in np.clip(values, one.low, high)],
    }  # fmt: skip
