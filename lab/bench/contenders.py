# SPDX-License-Identifier: GPL-3.0-or-later
"""What is compared: every estimator and backend of a subject, and Cycles' own materials beside them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from ...addon.blender import material
from ...addon.blender.material import BUILDERS, Choice, lamps_to_bind
from ...addon.library import presets
from . import peers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from bpy.types import Material, Scene

    from ...addon.library.presets import Preset


COUNTS, QUICK_COUNTS = (4, 16, 64, 256, 1024, 4096), (16, 64, 256)
# Not in the furnace: glass, which sends back all of it. By the map alone: subsurface scattering, as direct has none.
LIT = ("environment", "softbox", "sun")
PAIRS = (
    *((name, of) for of in ("copper", "plaster", "plastic") for name in ("furnace", *LIT)),
    *((name, of) for of in ("satin", "rough") for name in ("environment", "softbox")),
    *(("outdoors", of) for of in ("copper", "plaster")),
    ("environment", "paint"),
    ("softbox", "paint"),
    ("environment", "marble"),
    *((name, of) for of in ("brushed", "sheet", "walnut", "phong", "steel") for name in ("environment", "softbox")),
    ("checker", "frosted"),
    ("checker", "glass"),
)
QUICK_PAIRS = (("furnace", "copper"), ("sun", "copper"), ("softbox", "plaster"))


def names(*, quick: bool) -> list[str]:
    """SCENE/SUBJECT of all that is rendered."""
    return ["/".join(pair) for pair in (QUICK_PAIRS if quick else PAIRS)]


def counts(*, quick: bool) -> tuple[int, ...]:
    """Samples a pixel."""
    return QUICK_COUNTS if quick else COUNTS


def subjects() -> dict[str, Preset]:
    """The materials that are shown, by what a report calls them."""
    copper = presets.find("lecture/copper")
    return {
        "satin": copper.with_parameters(m=0.1),
        "copper": copper,
        "rough": copper.with_parameters(m=0.6),
        "plaster": presets.find("diffuse/plaster"),
        "plastic": presets.find("plastics/red_plastic"),
        "paint": presets.find("car_paints/blue"),
        "marble": presets.find("translucent/marble"),
        "brushed": presets.find("finished_metals/stainless_steel_hair_line").with_parameters(m=0.3),
        "sheet": presets.find("finished_metals/rolled_steel_sheet"),
        "walnut": presets.find("ashikhmin_shirley/varnished_walnut_as"),
        "phong": presets.find("phong/phong_red_plastic"),
        "steel": presets.find("merl_fits/black_oxidized_steel_merl"),
        "glass": presets.find("glasses/fused_silica"),
        "frosted": presets.find("glasses/frosted_glass"),
    }


@dataclass(frozen=True)
class Method:
    """A way to show a subject. peer: "" if it is ours; differs: how its model differs."""

    label: str
    make: Callable[[Scene], Material | None]  # nothing to make of what is rendered elsewhere
    estimator: str = ""
    backend: str = ""
    peer: str = ""
    differs: str = ""


def ours(preset: Preset, backends: tuple[str, ...], *, lamps: bool) -> Iterator[Method]:
    """Every estimator that shows something else than another: without lamps corrected is fit, and direct is black."""
    for backend in backends:
        for estimator in BUILDERS[preset.model]:
            if lamps or estimator not in material.EVERY_LIGHT:
                make = partial(_built, preset, estimator, backend)
                yield Method(f"{estimator}, {backend}", make, estimator, backend)


def _built(preset: Preset, estimator: str, backend: str, shown: Scene) -> Material:
    return material.build(preset, Choice(backend, estimator, lamps_to_bind(shown, estimator, preset.model)))


def native(preset: Preset) -> Iterator[Method]:
    """Cycles' own materials that an artist would take instead, with the preset's numbers."""
    for peer in peers.of(preset).cycles(preset):
        yield Method(peer.label, peer.material, peer="cycles", differs=peer.differs)
