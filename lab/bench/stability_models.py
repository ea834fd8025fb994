# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme shapes of highlights that are not Cook-Torrance's, and tangents that say nothing."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import headless
from ...addon.blender import gonio
from ...addon.blender.material import Choice, build, lamps_to_bind
from ...addon.blender.roles import MODEL, nodes
from ...addon.library.presets import parse
from ...addon.reference import albedo
from ...addon.reference.facet_distribution import Term
from ..check.views import measure
from ..scenery import add_node, wire
from .stability_measures import DARKEST, SAMPLES, SKY, Outcome

if TYPE_CHECKING:
    from collections.abc import Callable

    from bpy.types import Material, Object, Scene

    from ...addon.library.presets import Preset
    from ..check.rows import Setup

LOOKED_AT = SKY.wo()[::8, :2]  # views, at azimuths whose mirror images the others are
GRAZING_SUN = gonio.Geometry(70.0, resolution=(16, 16), phi_i=30.0)
TANGENTS = ("along the normal", "long", "none", "UVs of no extent")
SLOPES, EXPONENTS = (1e-4, 1e-2, 0.3, 1.0, 10.0), (0.0, 1.0, 1e2, 1e4)
WHITE = 'name = "White"\nmodel = "{}"\nalbedo = 0.0\nspecular = 1.0\n{}\n[source]\ndata = "check"\n'
ROUGH = "m = 0.3\nanisotropy = 1.0"  # slopes of 10:1, exponents of 100:1


def _white(model: str, name: str, text: str, value: float) -> Preset:
    """A material that mirrors all light, one of whose numbers is varied."""
    return parse(WHITE.format(model, text), "check/white", "check").with_parameters(**{name: value})


def _brushed(value: float) -> Preset:
    text = WHITE.format("anisotropic", f"{ROUGH}\n[fresnel]\nf0 = 1.0").replace("albedo = 0.0\nspecular = 1.0\n", "")
    return parse(text, "check/white", "check").with_parameters(m=value)


def _generated(value: float) -> Preset:
    text = WHITE.format("generator", "[fresnel]\nf0 = 1.0") + "[[distribution]]\nggx = 0.3\n"
    return replace(parse(text, "check/white", "check"), distribution=(Term("ggx", (value,)),))


# By model: what is varied, its values, and the material of a value
VARIED: dict[str, tuple[str, tuple[float, ...], Callable[[float], Preset]]] = {
    "anisotropic": ("m", SLOPES, _brushed),
    "ward": ("m", SLOPES, partial(_white, "ward", "m", ROUGH)),
    "ashikhmin_shirley": (
        "n", (0.0, 1.0, 1e2, 1e5), partial(_white, "ashikhmin_shirley", "sharpness", "sharpness = 9\nanisotropy = 1.0"),
    ),
    "phong": ("n", EXPONENTS, partial(_white, "phong", "exponent", "exponent = 9.0")),
    "blinn_phong": ("n", EXPONENTS, partial(_white, "blinn_phong", "shininess", "shininess = 9.0")),
    "generator": ("m", SLOPES, _generated),
}  # fmt: skip
GROOVED = {
    "anisotropic": 0.3,
    "ward": 0.3,
    "ashikhmin_shirley": 20.0,
}  # those with a tangent; a rough one


def sky(estimator: str, of: Callable[[float], Preset], value: float, setup: Setup) -> Outcome:
    """Under a white sky: no row of pixels, which is all azimuths of a view, is brighter than it or much too dark."""
    preset = of(value)
    image = measure(preset, setup, estimator, SKY, SAMPLES)
    expected = albedo(preset.reference(), LOOKED_AT).mean(axis=(1, 2))
    return Outcome(image, alike=True, holds=bool((image[::8].mean(axis=(1, 2)) >= DARKEST * expected).all()))


def tangent(estimator: str, model: str, how: str, setup: Setup) -> Outcome:
    """A sun on a surface whose tangent says nothing: of ``TANGENTS``."""
    *_, of = VARIED[model]
    preset = of(GROOVED[model])

    def material(scene: Scene) -> Material:
        suns = lamps_to_bind(scene, estimator, model)
        made = build(preset, Choice(setup.backend, estimator, suns, shadows=False))
        if how in {"along the normal", "long"}:
            x, y, z = (0.0, 0.0, 1.0) if how == "along the normal" else (1e30, -1e30, 0.0)
            given = add_node(made.node_tree, "CombineXYZ", X=x, Y=y, Z=z)
            (group,) = nodes(made, MODEL)
            wire(made.node_tree, given, group.inputs["Tangent"])
        return made

    with headless.quiet(), gonio.instrument(material, GRAZING_SUN, shading_osl=True) as scene:
        _take_away(next(one for one in scene.objects if one.type == "MESH"), how)
        scene.cycles.shading_system = setup.shading_osl
        image = gonio.rendered(scene).astype(np.float64)
    return Outcome(image, holds=bool(image.any()))


def _take_away(patch: Object, how: str) -> None:
    layers: Any = patch.data.uv_layers
    if how == "none":
        layers.remove(layers[0])
    if how == "UVs of no extent":
        layers[0].uv.foreach_set("vector", np.zeros(2 * len(layers[0].uv), np.float32))
