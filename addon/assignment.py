# SPDX-License-Identifier: GPL-3.0-or-later
"""Give objects of a scene the materials of presets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from . import facts
from .advice import problems_with
from .automatic import pick_estimator
from .material import Choice, apply, build
from .scene import SceneError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from bpy.types import Material, Scene

    from .animation import Play
    from .presets import Preset


def assign(
    scene: Scene,
    given: Sequence[tuple[str, Preset]],
    backend: str,
    estimator: str,
    bound: float,
    play: Play | None = None,
    *,
    into: dict[str, Material] | None = None,
    where: str = "",
) -> list[str]:
    """Give objects, by name, the materials of presets, those that change by ``play``; returns warnings, each once.

    estimator: "auto" picks one for each. into: objects' materials of an earlier call, which become those of this one.
    SceneError, opened by ``where``, for a name that cannot have a material.
    """
    if backend == "osl":
        scene.cycles.shading_system = True
    chosen_for: list[tuple[Preset, str]] = []
    lit = facts.of(scene)
    for name, preset in given:
        chosen = pick_estimator(lit, preset) if estimator == "auto" else estimator
        item = scene.objects.get(name)
        if item is None:
            known = ", ".join(sorted(other.name for other in scene.objects if other.type == "MESH"))
            message = f'{where}"{name}={preset.id}": the scene has no object of that name; it has {known}'
            raise SceneError(message)
        choice = Choice(
            backend, chosen, lit.to_bind(chosen, preset.model), bound=bound, play=play if preset.time else None
        )
        if into is not None and name not in into:  # of its own, though there be another like it
            into[name] = bpy.data.materials.new(preset.name)
        made = build(preset, choice, into[name] if into is not None else None)
        if not apply(made, [item]):
            message = f'{where}"{name}={preset.id}": {item.type.lower()} objects have no material; name a mesh'
            raise SceneError(message)
        chosen_for.append((preset, chosen))
    lit = facts.of(scene)  # with the materials that were given
    found = [p for preset, chosen in chosen_for for p in problems_with(lit, preset, backend, chosen)]
    return list(dict.fromkeys(problem.text for problem in found))
