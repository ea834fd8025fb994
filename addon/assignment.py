# SPDX-License-Identifier: GPL-3.0-or-later
"""Give objects of a scene the materials of presets."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from .advice import problems_with
from .automatic import pick_estimator
from .material import Choice, apply, build, lamps_to_bind
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
    said: dict[str, None] = {}
    for name, preset in given:
        chosen = pick_estimator(scene, preset) if estimator == "auto" else estimator
        item = scene.objects.get(name)
        if item is None:
            known = ", ".join(sorted(other.name for other in scene.objects if other.type == "MESH"))
            message = f'{where}"{name}={preset.id}": the scene has no object of that name; it has {known}'
            raise SceneError(message)
        bound_lamps = lamps_to_bind(scene, chosen, preset.model)
        choice = Choice(backend, chosen, bound_lamps, bound=bound, play=play if preset.time else None)
        if into is not None and name not in into:  # of its own, though there be another like it
            into[name] = bpy.data.materials.new(preset.name)
        made = build(preset, choice, into[name] if into is not None else None)
        if not apply(made, [item]):
            message = f'{where}"{name}={preset.id}": {item.type.lower()} objects have no material; name a mesh'
            raise SceneError(message)
        said |= dict.fromkeys(problem.text for problem in problems_with(scene, preset, backend, chosen))
    return list(said)
