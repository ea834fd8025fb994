# SPDX-License-Identifier: GPL-3.0-or-later
"""What is held against each other: every estimator and backend of a subject, and Cycles' own materials beside them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ...addon.blender import material
from ...addon.blender.material import BUILDERS, Choice, lamps_to_bind
from ...addon.library import presets
from ...nodegroups.versions import empty_material

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
    ("checker", "frosted"),
    ("checker", "glass"),
)
QUICK_PAIRS = (("furnace", "copper"), ("sun", "copper"), ("softbox", "plaster"))
COAT = "the base under a coat that dims it and mirrors all at the edge, where the preset adds shares of each"
LEVEL, F0_OF_GLASS = 0.5, 0.04  # Principled's level at which its IOR stands; what its usual IOR of 1.5 sends back
LOBE = "GGX in place of Beckmann's D, and light lost between facets is given back"


def pairs(*, quick: bool) -> tuple[tuple[str, str], ...]:
    """Scenes and subjects that are rendered."""
    return QUICK_PAIRS if quick else PAIRS


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
        "glass": presets.find("glasses/fused_silica"),
        "frosted": presets.find("glasses/frosted_glass"),
    }


@dataclass(frozen=True)
class Contender:
    """A way to show a subject. peer: "" of ours, else whose it is; differs: in what its model is another."""

    label: str
    make: Callable[[Scene], Material | None]  # nothing to make of what is rendered elsewhere
    estimator: str = ""
    backend: str = ""
    peer: str = ""
    differs: str = ""
    osl: bool = False  # whether Cycles runs it as OSL


def ours(preset: Preset, backends: tuple[str, ...], *, lamps: bool) -> Iterator[Contender]:
    """Every estimator that shows something else than another: without lamps corrected is fit, and direct is black."""
    for backend in backends:
        for estimator in BUILDERS[preset.model]:
            if lamps or estimator not in material.EVERY_LIGHT:
                yield Contender(
                    f"{estimator}, {backend}", _maker(preset, estimator, backend), estimator, backend,
                    osl=backend == "osl",
                )  # fmt: skip


def _maker(preset: Preset, estimator: str, backend: str) -> Callable[[Scene], Material]:
    def make(shown: Scene) -> Material:
        return material.build(preset, Choice(backend, estimator, lamps_to_bind(shown, estimator, preset.model)))

    return make


def peers(preset: Preset) -> Iterator[Contender]:
    """Cycles' own materials that an artist would take instead, with the preset's numbers."""
    of: dict[str, Any] = preset.parameters
    if preset.model == "cook_torrance":
        colour, roughness = of["f0"], of["m"] ** 0.5
        yield _peer(
            "Metallic BSDF", "Smith's G",
            "BsdfMetallic", {"Base Color": colour, "Edge Tint": (1.0, 1.0, 1.0), "Roughness": roughness},
            distribution="BECKMANN", fresnel_type="F82",
        )  # fmt: skip
        yield _peer(
            "Glossy BSDF", "Smith's G; reflects the same share at every angle",
            "BsdfGlossy", {"Color": colour, "Roughness": roughness}, distribution="BECKMANN",
        )  # fmt: skip
        yield _peer(
            "Principled BSDF", LOBE,
            "BsdfPrincipled", {"Base Color": colour, "Metallic": 1.0, "Roughness": roughness},
        )  # fmt: skip
    elif preset.model == "oren_nayar":
        yield _peer(
            "Diffuse BSDF", "Fujii's fit of Oren and Nayar's model",
            "BsdfDiffuse", {"Color": of["albedo"], "Roughness": of["sigma"]},
        )  # fmt: skip
        yield _peer(
            "Principled BSDF", "Fujii's fit, under no coat",
            "BsdfPrincipled",
            {"Base Color": of["albedo"], "Diffuse Roughness": of["sigma"], "Specular IOR Level": 0.0},
        )  # fmt: skip
    elif preset.model == "sum":
        yield _peer(
            "Principled BSDF", f"{LOBE}; {COAT}",
            "BsdfPrincipled",
            {
                "Base Color": tuple(of["d"] * c for c in of["albedo"]), "IOR": of["eta"],
                "Specular IOR Level": LEVEL * of["s"], "Roughness": of["m"] ** 0.5,
            },
        )  # fmt: skip
    elif preset.model == "car_paint":
        lobes = [(of[f"s_{k}"] * sum(of[f"f0_{k}"]) / 3, of[f"m_{k}"]) for k in range(1, preset.lobes + 1)]
        f0, m = max(lobes)
        yield _peer(
            "Principled BSDF", f"{LOBE}; {COAT}, and of {preset.lobes} lobes the strongest, grey",
            "BsdfPrincipled",
            {"Base Color": of["albedo"], "Specular IOR Level": LEVEL * f0 / F0_OF_GLASS, "Roughness": m**0.5},
        )  # fmt: skip
    elif preset.model == "translucent":
        yield _peer(
            "Principled BSDF", f"{LOBE}; the same scattering below it",
            "BsdfPrincipled",
            {
                "Base Color": of["reflectance"], "Subsurface Weight": 1.0, "Subsurface Radius": of["mean_free_path"],
                "Subsurface Scale": 1.0, "IOR": of["eta"], "Roughness": of["m"] ** 0.5,
            },
        )  # fmt: skip
    elif preset.model == "glass":
        numbers = {"IOR": of["eta"], "Roughness": of["m"] ** 0.5}
        yield _peer("Glass BSDF", "Smith's G", "BsdfGlass", {"Color": of["tint"], **numbers}, distribution="BECKMANN")
        yield _peer(
            "Principled BSDF", LOBE,
            "BsdfPrincipled", {"Base Color": of["tint"], "Transmission Weight": 1.0, **numbers},
        )  # fmt: skip


def _peer(label: str, differs: str, node: str, inputs: dict[str, Any], **properties: str) -> Contender:
    def make(_shown: Scene) -> Material:
        made = empty_material(label)
        tree = made.node_tree
        bsdf, output = tree.nodes.new(f"ShaderNode{node}"), tree.nodes.new("ShaderNodeOutputMaterial")
        for name, value in properties.items():
            setattr(bsdf, name, value)
        for name, value in inputs.items():
            takes_alpha = bsdf.inputs[name].type == "RGBA" and isinstance(value, tuple)
            bsdf.inputs[name].default_value = (*value, 1.0) if takes_alpha else value
        tree.links.new(bsdf.outputs[0], output.inputs["Surface"])
        return made

    return Contender(label, make, peer="cycles", differs=differs)
