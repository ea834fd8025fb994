# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel's choices, kept with the scene."""

from __future__ import annotations

import bpy

from .. import presets
from ..reference.hybrid import BOUNDS, DEFAULT_BOUND

BACKENDS = (
    (
        "nodes",
        "Nodes",
        "Plain shader nodes, for every device; EEVEE shows Closure, whichever estimator is chosen",
        "NODETREE",
        0,
    ),
    ("osl", "OSL", "Open Shading Language: CPU and OptiX only; switch it on in the render properties", "SCRIPT", 1),
)
ESTIMATORS = (
    ("auto", "Automatic", "What errs least in this scene at its number of samples; the panel says why", 0),
    (
        "fit",
        "Fit",
        "A fixed mixture of Cycles' own closures within a few percent of the formula: every light, no added noise",
        4,
    ),
    (
        "closure",
        "Closure",
        "Cycles' own closure: every light, least noise, but another model: Smith's shadowing, Fujii's rough diffuse",
        1,
    ),
    (
        "corrected",
        "Corrected",
        "Fit, made exact for the eight strongest lamps: no noise from lamps of zero size, little from others",
        5,
    ),
    (
        "hybrid",
        "Hybrid",
        "Fit for the most part, the rest by Mirror: exact within a bound that you set, with less noise than Mirror",
        6,
    ),
    ("mirror", "Mirror", "Exact: a random facet for each sample. Lamps of zero size are added by the formula", 2),
    ("direct", "Direct", "Exact and free of noise, for the eight strongest lamps alone: no world, no reflections", 3),
)

_items: list[tuple[str, str, str, int]] = []  # Blender keeps no reference to the texts of a dynamic enum


def _tip(preset: presets.Preset) -> str:
    numbers = ", ".join(f"{key} {value}" for key, value in preset.parameters.items())
    what = {"cook_torrance": "Reflection of ", "glass": "Transparent ", "oren_nayar": "Rough "}.get(preset.model, "")
    return f"{what}{preset.name.lower()}: {numbers}. Source: {preset.source['data']}. {preset.notes}".strip()


def preset_items(_self: object, _context: object) -> list[tuple[str, str, str, int]]:
    """Enum items of all presets, read from disk once."""
    if not _items:
        found = sorted(presets.all_presets().values(), key=lambda p: (p.family != presets.FIRST_FAMILY, p.id))
        _items.extend((p.id, f"{p.name} ({p.family})", _tip(p), i) for i, p in enumerate(found))
    return _items


class VGrooveSettings(bpy.types.PropertyGroup):
    """What Apply will give to the selected objects."""

    preset: bpy.props.EnumProperty(name="Preset", description="The material to apply", items=preset_items)
    backend: bpy.props.EnumProperty(
        name="Backend", description="What the material is built of", items=BACKENDS, default="nodes"
    )
    estimator: bpy.props.EnumProperty(
        name="Estimator", description="How the formula reaches the renderer", items=ESTIMATORS, default="auto"
    )
    bound: bpy.props.FloatProperty(
        name="Bound",
        description="How much of the reflected light Hybrid may have wrong; less is noisier",
        default=100.0 * DEFAULT_BOUND,
        min=100.0 * BOUNDS[0],
        max=100.0 * BOUNDS[1],
        subtype="PERCENTAGE",
        precision=1,
    )


CLASSES = (VGrooveSettings,)
