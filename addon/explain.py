# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material is built of, what was left out of it, and why: ``vgroove explain``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from . import lamps as lamp_binding
from . import scene
from .material import NATIVE, Choice, build

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, NodeTree, Scene

    from .presets import Preset

FRESNEL = {
    "schlick": "Schlick's formula from F0",
    "dielectric": "exact, from the index of refraction",
    "conductor": "exact, from n and k",
}
KINDS_OF_RANDOM = {"mirror", "hybrid"}


@dataclass(frozen=True)
class Line:
    """One thing that the material holds, or that it does without, and why."""

    what: str
    why: str
    kept: bool


@dataclass(frozen=True)
class Account:
    """A material, the estimator that it was built by, and what it holds and does without."""

    material: Material
    estimator: str
    lines: list[Line]


def explain(preset: Preset, shown: Scene, backend: str, estimator: str = "auto") -> Account:
    """The material that ``preset`` gets in ``shown``, with its account; raises what ``build`` raises."""
    pick = (
        scene.pick(shown, preset.m, preset.model) if estimator == "auto" else scene.Pick(estimator, "it was asked for")
    )
    lamps = scene.lamps_to_bind(shown, pick.estimator, preset.model)
    made = build(preset, Choice(backend, pick.estimator, lamps))
    lines = [*_kept(preset, pick, backend, made, [lamp.name for lamp in lamps]), *_left_out(preset, pick, shown, made)]
    return Account(made, pick.estimator, lines)


def _kept(preset: Preset, pick: scene.Pick, backend: str, made: Material, lamps: list[str]) -> Iterator[Line]:
    nodes = sum(1 for _ in nodes_inside(made.node_tree))
    yield Line(f"estimator {pick.estimator}", pick.why, kept=True)
    if preset.kind in FRESNEL:
        yield Line(f"Fresnel term: {preset.kind}", FRESNEL[preset.kind], kept=True)
    else:
        yield Line(f"model {preset.model}", preset.kind, kept=True)
    yield Line(f"backend {backend}", f"{nodes} nodes in all", kept=True)
    if lamps:
        yield Line(f"{len(lamps)} bound lamps", f"evaluated by the formula: {', '.join(lamps)}", kept=True)


def _left_out(preset: Preset, pick: scene.Pick, shown: Scene, made: Material) -> Iterator[Line]:
    if preset.kind in FRESNEL:
        others = [kind for kind in FRESNEL if kind != preset.kind]
        yield Line(f"Fresnel terms: {', '.join(others)}", "the preset needs one", kept=False)
    yield Line("time", "the preset does not change: no drivers of time, no keys", kept=False)
    if preset.model not in {"oren_nayar", "sum"}:
        yield Line("diffuse part", "the preset has none", kept=False)
    if not preset.transparent:
        yield Line("transmission", "the preset is opaque", kept=False)
    if preset.model == "glass" and preset.m == 0:
        yield Line("facets and random numbers", "m = 0 is a smooth interface", kept=False)
    elif pick.estimator not in KINDS_OF_RANDOM:
        yield Line("random numbers", f"{pick.estimator} draws no facets", kept=False)
    if made.node_tree.animation_data is None:
        why = "see every lamp by themselves" if pick.estimator in NATIVE else "there is none to bind"
        yield Line("lamp terms", f"Cycles' closures {why}" if pick.estimator in NATIVE else why, kept=False)
    unfollowed = [lamp.name for lamp in lamp_binding.of_scene(shown) if lamp_binding.refusal(lamp)]
    if unfollowed and pick.estimator not in NATIVE:
        yield Line(f"lamps {', '.join(unfollowed)}", "the formula cannot follow them", kept=False)


def nodes_inside(tree: NodeTree) -> Iterator[object]:
    """The nodes of a tree and of all groups in it, as Cycles gets them: each use of a group counts."""
    for node in tree.nodes:
        if node.bl_idname == "ShaderNodeGroup":
            yield from nodes_inside(node.node_tree)
        elif node.bl_idname not in {"NodeGroupInput", "NodeGroupOutput", "NodeFrame"}:
            yield node
