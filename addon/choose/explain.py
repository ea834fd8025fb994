# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material consists of, what was left out of it, and why: ``vgroove explain``."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...nodegroups import eevee
from ..blender import course, facts
from ..blender.course import Play
from ..blender.material import Choice, absorbs, build
from ..models import fresnel
from ..models.estimators import NATIVE, RANDOM
from . import automatic

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, Node, NodeSocket, NodeTree, Scene

    from ..blender.facts import SceneFacts
    from ..library.presets import Preset


@dataclass(frozen=True)
class Line:
    """A part that the material has (``kept``) or that the builder left out, and why."""

    what: str
    why: str
    kept: bool


@dataclass(frozen=True)
class Account:
    """A material, how it was built, its parts and what was left out."""

    material: Material
    choice: Choice
    lines: list[Line]

    @property
    def estimator(self) -> str:
        return self.choice.estimator


@dataclass(frozen=True)
class Size:
    """A material's nodes, as ``nodes_inside`` counts them, and the instructions of its OSL shaders."""

    nodes: int
    instructions: int


def explain(preset: Preset, shown: Scene | SceneFacts, backend: str, estimator: str = "auto") -> Account:
    """The material that ``preset`` gets in ``shown``, with its account; raises what ``build`` raises."""
    known = facts.of(shown)
    choice, pick = chosen(preset, known, backend, estimator)
    made = build(preset, choice)
    lines = [Line(f"estimator {pick.estimator}", pick.why, kept=True)]
    if pick.estimator != "closure":
        lines.append(Line("closure beside it", "EEVEE shows it; Cycles ignores it", kept=True))
    lines += [*_model(preset), *_nodes(made, backend), *_left_out(preset, pick.estimator)]
    lines += _lights(pick.estimator, known, [one.name for one in choice.lamps])
    return Account(made, choice, lines)


def chosen(
    preset: Preset, shown: Scene | SceneFacts, backend: str, estimator: str = "auto"
) -> tuple[Choice, automatic.Pick]:
    """How ``preset`` is built in ``shown``, and why by that estimator."""
    known = facts.of(shown)
    pick = automatic.Pick(estimator, "you chose it")
    if estimator == "auto":
        pick = automatic.pick(known, preset)
    return Choice(backend, pick.estimator, known.to_bind(pick.estimator, preset.model)), pick


def size_of(made: Material) -> Size:
    """The size of what Cycles evaluates of a material.

    Instructions are counted in the shaders' bytecode, before OSL folds constants; each use of a shader counts.
    """
    found = nodes_inside(made.node_tree)
    scripts = [node.bytecode for node in found if node.bl_idname == "ShaderNodeScript"]
    return Size(len(found), sum(map(_instructions, scripts)))


def _instructions(bytecode: str) -> int:
    """An .oso file has a line for each symbol, and after the first ``code`` a line, indented, for each instruction."""
    _, _, code = bytecode.partition("\ncode ")
    return sum(line.startswith("\t") for line in code.splitlines())


def _model(preset: Preset) -> Iterator[Line]:
    spec = preset.spec
    if spec.account:
        yield from (Line(what, why, kept=True) for what, why in spec.account(preset))
    else:
        yield Line(f"model {preset.model}", "" if spec.has_fresnel else preset.kind, kept=True)
    if absorbs(preset):
        yield Line(
            "absorption: Cycles' volume",
            "grows with the distance inside the body, whose mesh must be closed",
            kept=True,
        )
    if preset.kind in fresnel.KINDS:
        yield Line(f"Fresnel term: {preset.kind}", fresnel.KINDS[preset.kind].says, kept=True)


def _nodes(made: Material, backend: str) -> Iterator[Line]:
    found = nodes_inside(made.node_tree)
    shaders = sum(node.bl_idname == "ShaderNodeScript" for node in found)
    scripts = f", {shaders} of them OSL shader{'s' * (shaders > 1)}" if shaders else ""
    yield Line(f"backend {backend}", f"{len(found)} nodes{scripts}", kept=True)


def _left_out(preset: Preset, estimator: str) -> Iterator[Line]:
    if preset.kind in fresnel.KINDS:
        others = [kind for kind in fresnel.KINDS if kind != preset.kind]
        yield Line(f"Fresnel terms: {', '.join(others)}", "the preset needs one", kept=False)
    if preset.time is None:
        yield Line("time", "the preset does not change: no time drivers, no keys", kept=False)
    else:
        of, keys = preset.time, course.keyframes(preset.trajectory(), Play())
        counts = ", ".join(f"{name} {found.times.size}" for name, found in keys.items())
        why = f"a still shows one moment of {of.start:g} to {of.end:g} {of.unit}; a sequence plays keys: {counts}"
        yield Line(f"course over time ({of.kind})", why, kept=False)
    if not preset.spec.is_diffuse:
        yield Line("diffuse part", "the preset has none", kept=False)
    if preset.transparent and not absorbs(preset):
        why = "a sheet has no inside" if preset.is_sheet else "the body is clear"
        yield Line("absorption", why, kept=False)
    if not preset.transparent:
        yield Line("transmission", "the preset is opaque", kept=False)
    if preset.is_smooth:
        yield Line("facets and random numbers", "m = 0 is a smooth interface", kept=False)
    elif estimator not in RANDOM:
        yield Line("random numbers", f"{estimator} draws no facets", kept=False)


def _lights(estimator: str, known: SceneFacts, bound: list[str]) -> Iterator[Line]:
    if bound:
        yield Line(
            f"{len(bound)} bound light{'s' * (len(bound) > 1)}",
            f"evaluated by the formula: {', '.join(bound)}; every blocker counts as opaque",
            kept=True,
        )
    else:
        why = "Cycles' closures see every light" if estimator in NATIVE else "there is no light to evaluate"
        yield Line("lamp terms", why, kept=False)
    if estimator not in NATIVE and known.refusals:
        names = ", ".join(one.name for one in known.refusals)
        yield Line(f"lights {names}", "the formula cannot evaluate them", kept=False)


def nodes_inside(tree: NodeTree) -> list[Node]:
    """The nodes of a tree and of all groups in it that feed Cycles' outputs; each use of a group counts."""
    return _inside(tree, {})


def _inside(tree: NodeTree, known: dict[NodeTree, list[Node]]) -> list[Node]:
    """``known``: the nodes of groups that were searched already."""
    if tree in known:
        return known[tree]
    sources: dict[NodeSocket, list[Node]] = {}  # socket.links goes through all links of the tree each time
    for link in tree.links:
        sources.setdefault(link.to_socket, []).append(link.from_node)
    ends = [node for node in tree.nodes if node.bl_idname == "NodeGroupOutput"]
    ends += [node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial" and node.target != "EEVEE"]
    wanted = [socket for node in ends for socket in node.inputs if socket.name != eevee.OUTPUT]
    feeding = {node: None for node in ends if node.bl_idname == "ShaderNodeOutputMaterial"}
    while wanted:
        for node in sources.get(wanted.pop(), ()):
            if node not in feeding and not eevee.is_formula(node):
                feeding[node] = None
                wanted += node.inputs
    found: list[Node] = []
    for node in feeding:
        if node.bl_idname == "ShaderNodeGroup":
            found += _inside(node.node_tree, known)
        elif node.bl_idname != "NodeGroupInput":
            found.append(node)
    known[tree] = found
    return found
