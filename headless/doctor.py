# SPDX-License-Identifier: GPL-3.0-or-later
"""What is out of date or missing in the materials of an opened .blend, and the fixes that the panel's buttons have."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import bpy

from ..addon.blender import facts, material, origin, roles
from ..addon.blender.choice import Choice
from ..addon.blender.lamps import materials_in
from ..addon.blender.material import lamps_to_bind
from ..addon.blender.rebuild import is_of_other_cycles, rebuild
from ..addon.choose.advice import Problem, cycles_problems, stale_problems
from ..addon.library import presets
from ..addon.library.errors import InputError
from ..nodegroups import REVISION_KEY, lamp

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, NodeTree, Scene

    from ..addon.blender.origin import Record

FROM_FILES = {"FILE", "SEQUENCE", "MOVIE", "TILED"}  # sources of images that are read from disk


def examine(scene: Scene) -> list[Problem]:
    """All problems of the file's materials, each of one material once; ``scene`` is where fixes find their lights.

    Builds node groups that nothing uses yet, which Blender does not save. Changes no material.
    """
    found: dict[str, Problem] = {}
    for problem in [*cycles_problems(scene), *_of_scenes(), *_of_materials(scene)]:
        found.setdefault(problem.key, problem)
    return list(found.values())


def mend(problems: list[Problem]) -> list[str]:
    """Fix what has a fix; returns, a sentence each, what could not be kept or fixed."""
    said: list[str] = []
    for problem in problems:
        if problem.fix is not None:
            try:
                said += cast("list[str] | None", problem.fix()) or []
            except InputError as error:
                said.append(str(error))
    return said


def _of_scenes() -> Iterator[Problem]:
    """Deleted tables and groups, lights that are not included yet, and lights that are gone."""
    for scene in bpy.data.scenes:
        if scene.library is None:
            known = facts.of(scene)
            yield from stale_problems(known)
            for made, now in known.origins.items():
                wanted = {str(light.slot) for light in known.to_bind(now.estimator, now.preset.model)} if now else set()
                gone = sorted(known.bound_slots(made) - wanted) if now and _only_in(made, scene) else []
                if gone:
                    text = f"{made.name} still has terms for lights that are gone: {', '.join(gone)}"
                    yield _rebuilt(f"gone {made.name}", text, made, scene)


def _only_in(made: Material, scene: Scene) -> bool:
    """Whether no other scene shows a material, whose lights it could read."""
    return not any(made in materials_in(one) for one in bpy.data.scenes if one != scene)


def _of_materials(scene: Scene) -> Iterator[Problem]:
    for made in bpy.data.materials:
        if roles.KEY in made:
            record = origin.read(made)
            if record is None:
                text = f"{made.name} was made by a later version of vgroove, or its record is damaged"
                yield Problem(f"unknown {made.name}", text)
            else:
                yield from _of_one(made, record, scene)
            yield from _missing_images(made)


def _of_one(made: Material, record: Record, scene: Scene) -> Iterator[Problem]:
    if roles.is_format_1(made) or f'"format": {origin.FORMAT}' not in str(made[roles.KEY]):
        text = f"{made.name} was saved by an earlier version; it renders as it did then"
        yield _rebuilt(f"format {made.name}", text, made, scene)
    elif not is_of_other_cycles(made) and _has_old_groups(made, record, scene):
        text = f"{made.name} has node groups of an earlier version; it renders as it did then"
        yield _rebuilt(f"revision {made.name}", text, made, scene)
    known = presets.all_presets().get(record.preset.id)
    # Numbers that somebody chose are not verified any more, and so are not compared.
    if known is not None and record.preset.verified and _numbers(known) != _numbers(record.preset):
        text = f"{made.name} has the numbers that the preset {known.id} had then; apply it for those of today"
        yield Problem(f"preset {made.name}", text)


def _has_old_groups(made: Material, record: Record, scene: Scene) -> bool:
    """Whether a material built from the same record today would have other groups."""
    node, lights = roles.node(made, roles.MODEL), lamps_to_bind(scene, record.estimator, record.preset.model)
    if node is None or len(lights) != len(record.lights):  # problems of their own; a group has the number of lights
        return False
    choice = Choice(
        record.backend, record.estimator, lights, record.shadows, record.bound, record.disperses, record.bounces
    )
    try:
        today = material.group_of(record.preset, choice)
    except InputError:  # this Blender has none such: nothing to update to
        return False
    bound = (light.node_tree for light in roles.nodes(made, roles.LIGHT))
    inside = (group.node_tree for group in roles.nodes(made, roles.ABSORPTION))
    return (
        node.node_tree != today
        or any(tree[REVISION_KEY] != lamp.REVISION for tree in bound)
        or any(tree != material.absorption_group() for tree in inside)
    )


def _numbers(preset: presets.Preset) -> tuple[Any, ...]:
    return preset.model, preset.kind, preset.flags, preset.parameters


def _missing_images(made: Material) -> Iterator[Problem]:
    """Images that a material shows, neither packed nor on disk."""
    for image in sorted(set(_images(made.node_tree, set())), key=lambda image: str(image.name)):
        path = Path(bpy.path.abspath(image.filepath, library=image.library))
        if image.source in FROM_FILES and not image.packed_files and not _is_there(path):
            text = f"{made.name} needs the image {image.name}, which is not packed and not at {image.filepath}"
            yield Problem(f"image {made.name} {image.name}", text)


def _is_there(path: Path) -> bool:
    """Whether a file, or of tiles <UDIM> one of them, is on disk."""
    for mark in ("<UDIM>", "<UVTILE>"):
        if mark in path.name:
            return any(path.parent.glob(path.name.replace(mark, "*")))
    return path.is_file()


def _images(tree: NodeTree | None, seen: set[NodeTree]) -> Iterator[bpy.types.Image]:
    if tree is None or tree in seen:
        return
    seen.add(tree)
    for node in tree.nodes:
        if (image := getattr(node, "image", None)) is not None:
            yield image
        yield from _images(getattr(node, "node_tree", None), seen)


def _rebuilt(key: str, text: str, made: Material, scene: Scene) -> Problem:
    """A problem that rebuilding the material fixes, if this file may change it."""
    locked = material.locked(made)
    return Problem(key, text, "" if locked else "Update", None if locked else partial(rebuild, made, scene))
