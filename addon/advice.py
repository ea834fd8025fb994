# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a scene for an estimator, and how to mend it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from math import radians
from typing import TYPE_CHECKING

import bpy

from ..nodegroups import cook_torrance_closure, lamp
from . import lamps, rays
from .material import (
    BUILDERS,
    EVERY_LAMP,
    NATIVE,
    RANDOM,
    binds,
    is_ours,
    lamps_to_bind,
    locked,
    origin_of,
)
from .rebuild import rebuild

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from bpy.types import Material, Object, Scene

    from .presets import Preset

SUN_SIZE = radians(0.526)  # the real sun's mean angular diameter
LAMP_SIZE = 0.05  # metres: what "Give lamps a size" gives points and spots
WEAKEST = 0.02  # reflectance head-on from which the bound of hybrid is held by tools/fit_cook_torrance.py
LIGHTEST = 1e-5  # weight of a closure, below which Cycles makes none
FEWEST_BOUNCES = 12  # Cycles' own limit of all kinds together; of each, light turns in glass that often and more
FEWEST_RAYS = 8  # that differ, for each sample: then noise is at most sqrt(1 + 1/8) of what it should be, 6 % more


@dataclass(frozen=True)
class Problem:
    """Something that keeps an estimator from rendering as it should; ``mend`` is None where only the user can."""

    key: str
    text: str
    button: str = ""
    mend: Callable[[], None] | None = None


def problems(scene: Scene, backend: str, estimator: str, m: float = 0.0, model: str = "cook_torrance") -> list[Problem]:
    """What is wrong with ``scene`` for this choice, the gravest first."""
    found = list(_engine_problems(scene, backend))
    known = BUILDERS[model]
    if estimator not in known:
        text = f"This material has no {estimator.title()}; choose {', '.join(map(str.title, known))} or Automatic"
        return [*found, Problem("model", text)]
    if estimator in RANDOM:
        found += _mirror_problems(scene, estimator, model)
        if model != "glass" or m > 0.0:  # a smooth interface draws nothing
            found += _ray_problems(scene)
        found += _shadow_problems(backend, estimator, lamps_to_bind(scene, estimator, model))
    if estimator == "direct":
        found += _direct_problems(scene)
    if estimator in EVERY_LAMP:
        found += _bound_problems(scene, backend, estimator)
    if estimator in {*NATIVE, "corrected", "hybrid"} and m > 1.0:
        but = " but at bound lamps" if estimator == "corrected" else ""
        text = f"{estimator.title()} ends at m = 1{but}, to which Cycles clamps; m is {m:g}. Choose Mirror"
        found.append(Problem("slope", text))
    return found


def problems_with(scene: Scene, preset: Preset, backend: str, estimator: str) -> list[Problem]:
    """The same for a preset, and what the preset's own numbers ask of the estimator."""
    found = problems(scene, backend, estimator, preset.m, preset.model)
    for part in list(preset.parts().values()) or [preset]:
        if part.model == "cook_torrance" and estimator in BUILDERS[preset.model]:
            found += [p for p in _fresnel_problems(part, backend, estimator) if p not in found]
    if preset.model == "glass" and preset.kind != "thin":  # a sheet has no inside
        found += _bounce_problems(scene)
    return [*found, *_stale_problems(scene)]


def _fresnel_problems(preset: Preset, backend: str, estimator: str) -> Iterator[Problem]:
    off = native_fresnel_error(preset.kind, backend)
    if off and estimator not in {"mirror", "direct"}:
        mend = "choose Mirror" if preset.kind == "conductor" else "choose OSL or Mirror"
        text = f"Cycles' own lobes approximate this Fresnel term in Blender {bpy.app.version_string}"
        yield Problem("fresnel", f"{text}: up to {100 * off:g} % of the light; {mend}")
    head_on = preset.reference_fresnel()(1.0)
    weak = preset.kind != "conductor" and (min(head_on) < WEAKEST or _is_thinner(preset))
    if estimator == "hybrid" and weak:
        text = f"Hybrid's bound holds for reflectances head-on from {WEAKEST:g}, seen from the thinner side"
        yield Problem("bound", f"{text}; this material has {min(head_on):.2g}. Choose Mirror")
    if preset.kind == "dielectric" and 0.0 < max(head_on) < LIGHTEST and estimator != "direct":
        text = f"Cycles leaves out light below {LIGHTEST:g} of what came, and this material reflects {max(head_on):.2g}"
        yield Problem("faint", f"{text} head-on; an IOR farther from 1 reflects more")


def _bounce_problems(scene: Scene) -> Iterator[Problem]:
    """Light that is still on its way through a piece of glass when Cycles ends its path."""
    cycles = scene.cycles
    kinds = {"max_bounces": "Total", "glossy_bounces": "Glossy", "transmission_bounces": "Transmission"}
    few = {name: most for name in kinds if (most := getattr(cycles, name)) < FEWEST_BOUNCES}
    if few:
        said = ", ".join(f"{kinds[name]} {most}" for name, most in few.items())
        text = f"Light that glass turns more often than Max Bounces allow is lost: {said}"
        enough = dict.fromkeys(few, FEWEST_BOUNCES)
        yield Problem("bounces", text, f"Allow {FEWEST_BOUNCES} Bounces", partial(_set, cycles, **enough))


def _is_thinner(preset: Preset) -> bool:
    eta = preset.parameters.get("eta", 1.0)
    return isinstance(eta, float) and eta < 1.0


def native_fresnel_error(kind: str, backend: str) -> float:
    """How far the Fresnel term of Cycles' own lobes may be off on this Blender, as a reflectance; 0 if it is exact."""
    if cook_torrance_closure.has_exact_conductor() or kind not in {"conductor", "dielectric"}:
        return 0.0
    if kind == "conductor":
        return 0.01
    return 0.035 if backend == "nodes" else 0.0


def _stale_problems(scene: Scene) -> Iterator[Problem]:
    """Materials made before a lamp was added or lost its size: what that lamp gives would be missing."""
    used = {
        slot.material
        for item in lamps.rendered(scene)
        for slot in item.material_slots
        if slot.material and is_ours(slot.material)
    }
    for made in sorted(used, key=lambda one: one.name):
        origin = origin_of(made)
        missing = [
            item.name for item in lamps_to_bind(scene, origin.estimator, origin.preset.model)
            if item not in lamps.bound(made)
        ]  # fmt: skip
        if missing:
            text = f"{made.name} was made before {', '.join(missing)} had to be bound, and misses that light"
            yield Problem(f"stale {made.name}", text, "Update", None if locked(made) else partial(_update, made, scene))


def _update(made: Material, scene: Scene) -> None:
    rebuild(made, scene)


def _engine_problems(scene: Scene, backend: str) -> Iterator[Problem]:
    render, cycles = scene.render, scene.cycles
    if render.engine != "CYCLES":
        yield Problem("engine", "The render engine is not Cycles", "Use Cycles", lambda: _set(render, engine="CYCLES"))
    if backend == "osl" and not bpy.app.build_options.cycles_osl:
        yield Problem("osl-build", "This Blender was built without OSL; choose the backend Nodes")
    elif backend == "osl" and not cycles.shading_system:
        text = "Open Shading Language is off: OSL materials render black"
        yield Problem("osl", text, "Switch OSL On", lambda: _set(cycles, shading_system=True))
    elif backend == "osl" and cycles.device == "GPU" and _compute_device() not in {"NONE", "OPTIX"}:
        text = f"OSL runs on the CPU and on OptiX, not on {_compute_device()}; choose the backend Nodes"
        yield Problem("device", text, "Render on the CPU", lambda: _set(cycles, device="CPU"))


def _compute_device() -> str:
    """What Blender's preferences have for rendering on a GPU: NONE, CUDA, OPTIX, HIP, METAL or ONEAPI."""
    addon = bpy.context.preferences.addons.get("cycles")
    return addon.preferences.compute_device_type if addon else "NONE"


def _mirror_problems(  # noqa: C901 - one condition a problem
    scene: Scene, estimator: str = "mirror", model: str = "cook_torrance"
) -> Iterator[Problem]:
    cycles, world, name = scene.cycles, scene.world, estimator.title()
    part = "" if estimator == "mirror" else " but Fit's share"
    bound = lamps_to_bind(scene, estimator, model)
    sought = [item for item in lamps.of_scene(scene) if item not in bound]
    pointlike = [item for item in sought if lamps.size(item) == 0.0]
    if pointlike:
        text = f"{name} cannot see{part or ' anything'} of lamps of zero size that are not bound: {_names(pointlike)}"
        yield Problem("size", text, "Give Lamps a Size", lambda: _give_size(pointlike))
    unseen = [item for item in sought if not item.data.cycles.use_multiple_importance_sampling]
    if unseen:
        text = f"{name} sees nothing{part} of lamps with Multiple Importance off: {_names(unseen)}"
        yield Problem("mis", text, "Switch Multiple Importance On", lambda: _use_mis(unseen))
    if world is not None and world.cycles.sampling_method == "NONE":
        text = f"{name} sees nothing{part} of a world with Multiple Importance off"
        yield Problem("world", text, "Sample the World", lambda: _set(world.cycles, sampling_method="AUTOMATIC"))
    small = [item for item in sought if lamps.size(item) > 0.0 and is_small(item)]
    if small:
        text = f"{name} seldom hits small lamps and is noisy: {_names(small)}"
        if binds(estimator, 0.0, model):
            more = ". Of size 0 they are bound when you apply"
            yield Problem("small", text + more, "Set Their Size to 0", lambda: _set_size(small, 0.0))
        else:
            yield Problem("small", f"{text}; make them larger, or choose Closure")
    if cycles.use_adaptive_sampling:
        text = f"Noise Threshold stops pixels that have not yet found a light, which darkens {name}"
        yield Problem("adaptive", text, "Switch Noise Threshold Off", lambda: _set(cycles, use_adaptive_sampling=False))
    if cycles.blur_glossy > 0:
        text = f"Filter Glossy is on and blurs {name}'s facets"
        yield Problem("filter", text, "Set Filter Glossy to 0", lambda: _set(cycles, blur_glossy=0.0))
    if cycles.sample_clamp_indirect > 0:
        text = f"Clamp Indirect is on and darkens {name}"
        yield Problem("clamp", text, "Set Clamp Indirect to 0", lambda: _set(cycles, sample_clamp_indirect=0.0))
    if model == "glass" and not cycles.caustics_refractive:
        text = f"Refractive Caustics are off: light through {name} is lost"
        yield Problem("refractive", text, "Switch Caustics On", lambda: _set(cycles, caustics_refractive=True))
    if not cycles.caustics_reflective:
        text = f"Reflective Caustics are off: light by way of {name} is lost"
        yield Problem("caustics", text, "Switch Caustics On", lambda: _set(cycles, caustics_reflective=True))


def unseen(scene: Scene, model: str) -> bool:
    """Whether random rays miss a light of the scene, or nearly so."""
    return any(problem.key in {"size", "mis", "world", "small"} for problem in _mirror_problems(scene, model=model))


def _ray_problems(scene: Scene) -> Iterator[Problem]:
    """Too few different rays to hash random numbers from: noise that no more samples take away, but other seeds do."""
    samples, found = scene.cycles.samples, rays.different_rays(scene)
    if found >= FEWEST_RAYS * min(samples, rays.MOST):
        return
    where = " where nothing moves" if scene.render.use_motion_blur else ""
    text = f"Of the rays in a pixel{where} only {found:.0f} differ, and random numbers with them"
    text += f": {samples} samples have the noise of {1.0 / (1.0 / samples + 1.0 / found):.0f}"
    if rays.filter_width(scene) < 1.0:
        widen = partial(_set, scene.cycles, filter_width=1.5)
        yield Problem("rays", f"{text}. The pixel filter is too narrow", "Widen the Pixel Filter", widen)
    elif scene.camera.data.type == "ORTHO":
        why = "An orthographic camera is too far from the origin"
        yield Problem("rays", f"{text}. {why}", "Open Its Aperture a Little", partial(rays.open_aperture, scene))
    else:
        yield Problem("rays", f"{text}. The camera looks at too small an angle; move it nearer and shorten its lens")


def _direct_problems(scene: Scene) -> Iterator[Problem]:
    if not any(lamps.refusal(item) is None for item in lamps.of_scene(scene)):
        yield Problem("lamps", "Direct shows bound lamps alone, and this scene has none that it can follow")
    else:
        yield Problem("alone", "Direct shows bound lamps alone: no world, no reflections of other objects")


def _bound_problems(scene: Scene, backend: str, estimator: str) -> Iterator[Problem]:
    name, rest = estimator.title(), "left out" if estimator == "direct" else "as Fit has them"
    shown = lamps.of_scene(scene)
    followed = [item for item in shown if lamps.refusal(item) is None]
    if not followed and estimator == "corrected":
        yield Problem("lamps", "Corrected has no lamp to correct here and is the same as Fit")
    for item in shown:
        if refused := lamps.refusal(item):
            yield Problem("refused", refused[0].upper() + refused[1:])
    if len(followed) > lamps.LIMIT:
        text = f"{name} binds the {lamps.LIMIT} strongest lamps; {rest}: {_names(followed[lamps.LIMIT :])}"
        yield Problem("limit", text)
    sized = [item for item in followed if lamps.size(item) > 0]
    if sized:
        text = f"{name} draws a random point on lamps with a size, which brings noise: {_names(sized)}"
        yield Problem("sized", text)
        yield from _ray_problems(scene)
    yield from _shadow_problems(backend, estimator, followed)


def _shadow_problems(backend: str, estimator: str, bound: Sequence[Object]) -> Iterator[Problem]:
    if bound and backend == "nodes" and not lamp.can_cast_shadows():
        what = {"direct": "Bound lamps", "corrected": "What Corrected adds of lamps"}
        text = f"{what.get(estimator, 'Lamps of zero size')} shine through things with nodes in this Blender"
        yield Problem("shadows", f"{text}, which has no Raycast node; choose OSL: {_names(bound)}")


def _names(items: Sequence[Object]) -> str:
    return ", ".join(item.name for item in items)


def is_small(item: Object) -> bool:
    """Whether a random mirror direction seldom meets this lamp: suns under 5 degrees, and all points and spots."""
    return item.data.type in {"POINT", "SPOT"} or (item.data.type == "SUN" and item.data.angle < radians(5.0))


def _set(owner: object, **values: object) -> None:
    for name, value in values.items():
        setattr(owner, name, value)


def _give_size(pointlike: Sequence[Object]) -> None:
    for item in pointlike:
        _set_size([item], SUN_SIZE if item.data.type == "SUN" else LAMP_SIZE)


def _set_size(items: Sequence[Object], size: float) -> None:
    for item in items:
        setattr(item.data, {"SUN": "angle", "AREA": "size"}.get(item.data.type, "shadow_soft_size"), size)


def _use_mis(unseen: Sequence[Object]) -> None:
    for item in unseen:
        item.data.cycles.use_multiple_importance_sampling = True
