# SPDX-License-Identifier: GPL-3.0-or-later
"""Give objects of a scene the materials of presets."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

import bpy

from ..addon.blender import facts
from ..addon.blender.material import Choice, build
from ..addon.blender.slots import give, refusal
from ..addon.choose.advice import problems_in, problems_with
from ..addon.choose.automatic import pick_estimator
from .scene import SceneError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import Material, Object, Scene

    from ..addon.blender.course import Play
    from ..addon.library.presets import Preset


def assign(
    scene: Scene,
    assignments: Sequence[tuple[str, Preset]],
    backend: str,
    estimator: str,
    bound: float,
    play: Play | None = None,
    *,
    disperses: bool = False,
    bounces: bool = False,
    into: dict[str, Material] | None = None,
    where: str = "",
) -> list[str]:
    """Assign presets to objects by name; those that change are animated by ``play``.

    Returns warnings, each once, also of the materials that the scene had before.

    assignments: by name, "OBJECT" for its active slot or "OBJECT:SLOT". Objects that share a mesh each get their own.
    estimator: "auto" picks one for each. into: objects' materials of an earlier call, which become those of this one.
    SceneError, opened by ``where``, for a name that cannot have a material.
    """
    if backend == "osl":
        scene.cycles.shading_system = True
    known, chosen_for = facts.of(scene), []
    said: dict[str, None] = {}
    for name, preset in assignments:
        wanted = f'{where}"{name}={preset.id}"'
        made = into.get(name) if into is not None else None
        item, index, note = _slot(scene, name, wanted, made)
        chosen = pick_estimator(known, preset) if estimator == "auto" else estimator
        bound_lights = known.to_bind(chosen, preset.model)
        choice = Choice(
            backend, chosen, bound_lights, bound=bound, disperses=disperses, bounces=bounces,
            play=play if preset.time else None,
        )  # fmt: skip
        if into is not None and made is None:  # of its own, though there be another like it
            made = into[name] = bpy.data.materials.new(preset.name)
        give(build(preset, choice, made), item, index, alone=True)
        said |= dict.fromkeys(note)
        chosen_for.append((preset, chosen))
    known = facts.of(scene)  # with the new materials
    found = [p for preset, chosen in chosen_for for p in problems_with(known, preset, backend, chosen)]
    return list(said | dict.fromkeys(problem.text for problem in problems_in(known, found)))


def _slot(scene: Scene, name: str, wanted: str, known: Material | None) -> tuple[Object, int, list[str]]:
    """The object and slot that "OBJECT" or "OBJECT:SLOT" names, and what to say if the name leaves the slot open.

    known: the material that an earlier call put into the slot. An object of exactly this name comes first; a slot goes
    by the name of its material, else by its number from 1.
    """
    item, slot = scene.objects.get(name), ""
    if item is None and ":" in name:
        of, _, slot = name.rpartition(":")
        item = scene.objects.get(of)
    if item is None:
        meshes = ", ".join(sorted(other.name for other in scene.objects if other.type == "MESH"))
        message = f"{wanted}: the scene has no object of that name; it has {meshes}"
        raise SceneError(message)
    if reason := refusal(item):
        message = f"{wanted}: {reason}"
        raise SceneError(message)
    names = [one.name for one in item.material_slots]
    held = [one.material for one in item.material_slots]
    if known is not None and known in held:
        return item, held.index(known), []
    listed = ", ".join(f"{k} {one or '(empty)'}" for k, one in enumerate(names, 1))
    if not slot:
        index = item.active_material_index
        if len(names) < 2:
            return item, index, []
        text = f"{item.name} has {len(names)} slots ({listed}); slot {index + 1} gets the material"
        return item, index, [f"{text}. Name another one as {item.name}:SLOT"]
    if slot in names:
        return item, names.index(slot), []
    if re.fullmatch(r"[0-9]{1,5}", slot) and 1 <= int(slot) <= len(names):
        return item, int(slot) - 1, []
    message = f'{wanted}: {item.name} has no slot "{slot}"; it has {listed or "none"}'
    raise SceneError(message)
