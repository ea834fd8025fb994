# SPDX-License-Identifier: GPL-3.0-or-later
"""What is wrong with a scene for an estimator, and how to fix it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import bpy

from ...nodegroups import lamp, versions
from ..blender import facts, lamps, rays
from ..blender.groups import TABLES
from ..blender.material import binds, locked
from ..blender.rebuild import is_of_other_cycles, rebuild
from ..models import MODELS
from ..models.estimators import BORROWING, EVERY_LIGHT, NATIVE, RANDOM
from ..reference import cycles
from .automatic import slope_limit
from .fixes import clear_offsets, give_size, rebuild_all, sample_lights, set_size, set_values

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from bpy.types import Scene

    from ..blender.facts import SceneFacts
    from ..blender.lamps import Light
    from ..library.presets import Preset

WEAKEST = 0.02  # lowest reflectance at normal incidence to which tools/fit_cook_torrance.py holds the bound of hybrid
LIGHTEST = 1e-5  # Cycles drops closures of lower weight
FEWEST_BOUNCES = 12  # Cycles' default total; inside glass, light needs as many of each kind, and more
FEWEST_RAYS = 8  # different rays for each sample: noise is then at most sqrt(1 + 1/8) times what it should be, 6 % more

NAMES = {"auto": "Standard", "corrected": "Exact Lights", "mirror": "Reference"}  # others go by their own names
SHARPEST = 0.075  # slope m up to which Cycles treats its own lobes, too, as mirrors when it stores denoising data
LIGHTING_PASSES = ("diffuse", "glossy", "transmission", "subsurface")


@dataclass(frozen=True)
class Problem:
    """A scene setting that would spoil the render. ``fix`` fixes it; None where only the user can.

    costs: the side effect of the fix elsewhere in the scene, for which *Fix All* leaves it out; "" if there is none.
    """

    key: str
    text: str
    button: str = ""
    fix: Callable[[], object] | None = None
    costs: str = ""


def problems(
    scene: Scene | SceneFacts, backend: str, estimator: str, m: float = 0.0, model: str = "cook_torrance"
) -> list[Problem]:
    """What is wrong with a scene for this choice, the gravest first."""
    known = facts.of(scene)
    spec = MODELS[model]
    by_nodes = backend == "nodes" and (estimator in NATIVE or (m == 0.0 and estimator == spec.smooth_estimator))
    found = list(_engine_problems(known.scene, backend, in_eevee=by_nodes))
    if estimator not in spec.estimators:
        others = ", ".join(map(name_of, spec.estimators))
        text = f"This material has no {name_of(estimator)}; choose {others} or Standard"
        return [*found, Problem("model", text)]
    bound = known.to_bind(estimator, model)
    if estimator in RANDOM and (m > 0.0 or not spec.smooth_estimator):  # a smooth interface draws nothing
        found += [*_unseen_problems(known, estimator, model), *_setting_problems(known.scene, estimator)]
        found += _ray_problems(known)
    if estimator in RANDOM:
        found += _caustics_problems(known.scene, model)
    if estimator == "direct":
        found += _direct_problems(known)
    if estimator in EVERY_LIGHT:
        found += _followed_problems(known, estimator, bound)
    if bound:
        found += [*_shadow_problems(backend, estimator, bound), *_emitted_problems(known, estimator)]
    if estimator not in NATIVE:
        found += _terminator_problems(known, estimator, model)
        found += _picture_problems(known.scene, estimator, model, bound)
        mirrored = estimator in RANDOM and spec.mirrors and (m > SHARPEST or spec.is_diffuse)
        if mirrored or (
            estimator in EVERY_LIGHT and bound
        ):  # of a translucent body Cycles stores what is below the coat
            found += _denoiser_problems(known.scene, estimator)
    if estimator in BORROWING and m > 1.0:
        found.append(Problem("slope", slope_limit(m)))
    return found


def problems_with(scene: Scene | SceneFacts, preset: Preset, backend: str, estimator: str) -> list[Problem]:
    """The same for a preset, and what its own numbers need of the estimator and of the scene."""
    known = facts.of(scene)
    found = problems(known, backend, estimator, preset.m, preset.model)
    for part in list(preset.parts().values()) or [preset]:
        if part.spec.has_fresnel and estimator in preset.spec.estimators:
            found += [p for p in _fresnel_problems(part, backend, estimator) if p not in found]
    if preset.refracts:
        found += [*_bounce_problems(known.scene), *_raytracing_problems(known.scene)]
    return [*found, *cycles_problems(known.scene), *stale_problems(known)]


def problems_in(scene: Scene | SceneFacts, found: Iterable[Problem] = ()) -> list[Problem]:
    """``found``, and beside that what is wrong for the materials that the scene has, by the first one's name."""
    known = facts.of(scene)
    listed = list(found) or [*cycles_problems(known.scene), *stale_problems(known)]
    texts = {problem.text for problem in listed}
    for made, origin in known.origins.items():
        for problem in problems_with(known, origin.preset, origin.backend, origin.estimator) if origin else ():
            if problem.text not in texts:
                texts.add(problem.text)
                listed.append(replace(problem, text=f"{made.name}: {problem.text}"))
    return listed


def name_of(estimator: str) -> str:
    """What artists call an estimator."""
    return NAMES.get(estimator, estimator.title())


def _fresnel_problems(preset: Preset, backend: str, estimator: str) -> Iterator[Problem]:
    off = native_fresnel_error(preset.kind, backend)
    if off and estimator not in {"mirror", "direct"}:
        remedy = "choose Reference" if preset.kind == "conductor" else "choose OSL or Reference"
        text = f"Blender {bpy.app.version_string} approximates this Fresnel term"
        yield Problem("fresnel", f"{text}: up to {100 * off:g} % of the light is wrong; {remedy}")
    f0 = preset.reference_fresnel()(1.0)
    weak = preset.kind != "conductor" and (min(f0) < WEAKEST or _is_thinner(preset))
    if estimator == "hybrid" and weak:
        text = f"Hybrid's bound holds only for reflectances of at least {WEAKEST:g}, from outside"
        yield Problem("bound", f"{text}; this material has {min(f0):.2g}. Choose Reference")
    if preset.kind == "dielectric" and 0.0 < max(f0) < LIGHTEST and estimator != "direct":
        text = f"The reflection is too weak for Cycles ({max(f0):.2g} at normal incidence)"
        yield Problem("faint", f"{text}; move the IOR away from 1")


def _bounce_problems(scene: Scene) -> Iterator[Problem]:
    """Cycles ends paths that are still inside a piece of glass."""
    cycles = scene.cycles
    kinds = {"max_bounces": "Total", "glossy_bounces": "Glossy", "transmission_bounces": "Transmission"}
    few = {name: most for name in kinds if (most := getattr(cycles, name)) < FEWEST_BOUNCES}
    if few:
        said = ", ".join(f"{kinds[name]} {most}" for name, most in few.items())
        text = f"Too few bounces for glass, light is lost: {said}"
        enough = dict.fromkeys(few, FEWEST_BOUNCES)
        yield Problem(
            "bounces", text, f"Allow {FEWEST_BOUNCES} Bounces", partial(set_values, cycles, **enough), "longer renders"
        )


def _raytracing_problems(scene: Scene) -> Iterator[Problem]:
    """Without raytracing EEVEE refracts light probes and the world alone."""
    if scene.render.engine == versions.EEVEE and not scene.eevee.use_raytracing:
        text = "EEVEE's Raytracing is off: this glass shows only the world behind it"
        fix = partial(set_values, scene.eevee, use_raytracing=True)
        yield Problem("raytracing", text, "Switch Raytracing On", fix, "longer renders")


def _is_thinner(preset: Preset) -> bool:
    eta = preset.parameters.get("eta", 1.0)
    return isinstance(eta, float) and eta < 1.0


def native_fresnel_error(kind: str, backend: str) -> float:
    """Largest error of the Fresnel term of Cycles' own closures on this Blender, a reflectance; 0 if it is exact."""
    if versions.EXACT_CONDUCTOR or kind not in {"conductor", "dielectric"}:
        return 0.0
    if kind == "conductor":
        return 0.01
    return 0.035 if backend == "nodes" else 0.0


def cycles_problems(scene: Scene) -> Iterator[Problem]:
    """All materials of the file that were built for a Cycles that renders them otherwise, as one problem."""
    found = [made for made in bpy.data.materials if is_of_other_cycles(made)]
    if found:
        before = cycles.version() == cycles.SINCE_5_3
        where = "5.2 or earlier" if before else "5.3 or later"
        names = ", ".join(one.name for one in found)
        text = f"Made in Blender {where}, these render differently here until you update them: {names}"
        fixable = [made for made in found if not locked(made)]
        fix = partial(rebuild_all, fixable, scene) if fixable else None
        yield Problem("cycles", text, "Update" if fix else "", fix)


def stale_problems(known: SceneFacts) -> Iterator[Problem]:
    """Materials that lost their node group or table, and those made before a light was added or lost its size."""
    for table in TABLES:
        if table.nodes_without():
            text = f"The image {table.name} was deleted: materials that need it render pink"
            yield Problem("table", text, "Update", table.restore)
    for made, origin in known.origins.items():
        update = None if locked(made) else partial(rebuild, made, known.scene)
        if origin is None:
            yield Problem(f"lost {made.name}", f"{made.name} has lost its node group", "Update", update)
            continue
        held = known.bound_slots(made) if origin.estimator not in NATIVE else set()
        missing = [one for one in known.to_bind(origin.estimator, origin.preset.model) if str(one.slot) not in held]
        if missing:
            names = f"Lights {_names(missing)} are" if len(missing) > 1 else f"Light {_names(missing)} is"
            then = "; rendered as Standard" if origin.estimator == "corrected" else ""
            text = f"{names} not included in {made.name} yet{then}"
            yield Problem(f"stale {made.name}", text, "Update", update)


def _engine_problems(scene: Scene, backend: str, *, in_eevee: bool) -> Iterator[Problem]:
    """in_eevee: whether EEVEE shows these closures as Cycles renders them."""
    render, cycles = scene.render, scene.cycles
    if render.engine != "CYCLES" and not (in_eevee and render.engine == versions.EEVEE):
        text = "EEVEE shows this as Standard" if render.engine == versions.EEVEE else "The render engine is not Cycles"
        yield Problem("engine", text, "Use Cycles", partial(set_values, render, engine="CYCLES"))
    if backend == "osl" and not bpy.app.build_options.cycles_osl:
        yield Problem("osl-build", "This Blender was built without OSL; choose the backend Nodes")
    elif backend == "osl" and not cycles.shading_system:
        text = "Open Shading Language is off: OSL materials render black"
        yield Problem("osl", text, "Switch OSL On", lambda: set_values(cycles, shading_system=True))
    elif backend == "osl" and cycles.device == "GPU" and _compute_device() not in {"NONE", "OPTIX"}:
        text = f"OSL runs on the CPU and on OptiX, not on {_compute_device()}; choose the backend Nodes"
        fix = partial(set_values, cycles, device="CPU")
        yield Problem("device", text, "Render on the CPU", fix, "everything renders on the CPU")


def _compute_device() -> str:
    """The GPU backend in Blender's preferences: NONE, CUDA, OPTIX, HIP, METAL or ONEAPI."""
    addon = bpy.context.preferences.addons.get("cycles")
    return addon.preferences.compute_device_type if addon else "NONE"


def _unseen_problems(known: SceneFacts, estimator: str, model: str) -> Iterator[Problem]:
    """Lights that random facets miss or rarely hit."""
    name, but = name_of(estimator), "" if estimator == "mirror" else ", except in Fit's share"
    sought, world = known.unbound(known.to_bind(estimator, model)), known.scene.world
    pointlike = [one for one in sought if not one.sized]
    if pointlike:
        text = f"{name} misses lights of zero size{but}: {_lights(pointlike)}"
        fix = partial(give_size, pointlike)
        yield Problem("size", text, "Give Lights a Size", fix, "softer shadows everywhere")
    unsampled = [one for one in sought if not one.sampled]
    if unsampled:
        text = f"{name} misses lights with Multiple Importance off{but}: {_lights(unsampled)}"
        yield Problem("mis", text, "Switch Multiple Importance On", partial(sample_lights, unsampled))
    if world is not None and not known.sky.sampled:
        text = f"{name} misses the world, whose Multiple Importance is off{but}"
        yield Problem("world", text, "Sample the World", partial(set_values, world.cycles, sampling_method="AUTOMATIC"))
    if known.sky.sun_disc:
        text = f"{name} rarely hits the sun disc of the world's {known.sky.sun_disc}, whose light is lost or noisy"
        yield Problem("disc", f"{text}; turn Sun Disc off and add a Sun light with angle 0")
    emitters = [one for one in known.emitters if one.small]
    if emitters:
        text = f"{name} rarely hits small emissive objects, whose light is lost or noisy"
        yield Problem("emitters", f"{text}: {', '.join(one.name for one in emitters)}")
    small = [one for one in sought if one.sized and one.small]
    if small:
        text = f"{name} rarely hits small lights and is noisy: {_lights(small)}"
        shrinking = [one.item for one in small if not one.via and one.item.data.type != "AREA"]
        if shrinking and binds(estimator, 0.0, model):
            fix, costs = partial(set_size, shrinking, 0.0), "sharp shadows everywhere"
            more = ". Lights of size 0 are evaluated exactly once you apply"
            yield Problem("small", text + more, "Set Their Size to 0", fix, costs)
        else:
            yield Problem("small", f"{text}; make them larger, or choose Standard")


def _setting_problems(scene: Scene, estimator: str) -> Iterator[Problem]:
    """Settings that darken or blur what random facets reflect."""
    cycles, name = scene.cycles, name_of(estimator)
    if cycles.use_adaptive_sampling:
        text = f"Noise Threshold stops pixels before they hit a light, which darkens {name}"
        fix = partial(set_values, cycles, use_adaptive_sampling=False)
        yield Problem("adaptive", text, "Switch Noise Threshold Off", fix, "longer renders")
    if cycles.blur_glossy > 0:
        fix = partial(set_values, cycles, blur_glossy=0.0)
        text = f"Filter Glossy is on and blurs {name}"
        yield Problem("filter", text, "Set Filter Glossy to 0", fix, "more fireflies")
    if cycles.sample_clamp_indirect > 0:
        fix = partial(set_values, cycles, sample_clamp_indirect=0.0)
        text = f"Clamp Indirect is on and darkens {name}"
        yield Problem("clamp", text, "Set Clamp Indirect to 0", fix, "more fireflies")


def _caustics_problems(scene: Scene, model: str) -> Iterator[Problem]:
    cycles = scene.cycles
    if MODELS[model].transparent and not cycles.caustics_refractive:
        text = "Refractive Caustics are off: light through this glass is lost"
        fix = partial(set_values, cycles, caustics_refractive=True)
        yield Problem("refractive", text, "Switch Caustics On", fix, "more noise")
    if not cycles.caustics_reflective:
        text = "Reflective Caustics are off: light reflected by this material is lost"
        fix = partial(set_values, cycles, caustics_reflective=True)
        yield Problem("caustics", text, "Switch Caustics On", fix, "more noise")


def _ray_problems(known: SceneFacts) -> Iterator[Problem]:
    """Too few different rays to hash random numbers from: more samples do not reduce this noise, other seeds do."""
    scene, found = known.scene, known.different_rays
    samples = scene.cycles.samples
    if found >= FEWEST_RAYS * min(samples, rays.MOST):
        return
    where = " where nothing moves" if scene.render.use_motion_blur else ""
    text = f"Only {found:.0f} different rays per pixel{where}"
    text += f": {samples} samples are as noisy as {1.0 / (1.0 / samples + 1.0 / found):.0f}"
    if rays.filter_width(scene) < 1.0:
        widen = partial(set_values, scene.cycles, filter_width=1.5)
        yield Problem("rays", f"{text}. The pixel filter is too narrow", "Widen the Pixel Filter", widen)
    elif scene.camera.data.type == "ORTHO":
        why = "An orthographic camera is too far from the origin"
        yield Problem("rays", f"{text}. {why}", "Open the Aperture Slightly", partial(rays.open_aperture, scene))
    else:
        yield Problem("rays", f"{text}. The camera has too narrow a view; move it closer and shorten its focal length")


def _direct_problems(known: SceneFacts) -> Iterator[Problem]:
    if not known.followable:
        yield Problem("lamps", "Direct renders only the lights that it evaluates itself, and this scene has none")
    else:
        yield Problem(
            "alone",
            "Direct renders only the lights that it evaluates itself: no world, no reflections of other objects",
        )


def _followed_problems(known: SceneFacts, estimator: str, bound: Sequence[Light]) -> Iterator[Problem]:
    """Lights at which the formula is not evaluated."""
    name, rest = name_of(estimator), "left out" if estimator == "direct" else "rendered as Standard"
    if not known.followable and estimator == "corrected":
        yield Problem("lamps", f"{name} has no light to evaluate here; it renders like Standard")
    for light, why in known.refusals.items():
        if any(one.item == light.item for one in known.lights):  # a portal is none
            yield Problem("refused", why[0].upper() + why[1:])
    brought = [one for one in known.unbound([*known.followable, *known.refusals]) if one.via]
    if brought:
        text = f"{name} does not evaluate lights from nested instances, particles or Geometry Nodes"
        yield Problem("brought", f"{text}; {rest}: {_lights(brought)}")
    items = {light.item for light in bound}
    if left := [light for light in known.followable if light.item not in items]:
        yield Problem("limit", f"{name} evaluates the {len(bound)} strongest lights; {rest}: {_names(left)}")
    if any(lamps.size(item) > 0 for item in items):
        yield from _ray_problems(known)


def _emitted_problems(known: SceneFacts, estimator: str) -> Iterator[Problem]:
    """Where light that a material adds as emission differs from Cycles' own."""
    name, layers = name_of(estimator), [layer for layer in known.scene.view_layers if layer.use]
    between = [f"{one} (hidden from shadow rays)" for one in known.unshadowed]
    between += [f"{one} (transparent)" for one in known.seen_through]
    between += [f"{one} (volume)" for one in known.volumes]
    if between:
        then = "; what they shade renders as Standard" if estimator == "corrected" else ""
        text = f"{name} treats these as opaque at bound lights: {', '.join(between)}{then}"
        yield Problem("between", text)
    if known.groups:
        yield Problem("groups", f"What {name} adds for bound lights is missing from light groups")
    if any(getattr(layer, name) for layer in layers for name in _lighting_passes()):
        yield Problem("passes", f"What {name} adds for bound lights goes into the Emission pass")


def _denoiser_problems(scene: Scene, estimator: str) -> Iterator[Problem]:
    """Denoising passes that differ from those of Cycles' own closures.

    Emission adds its radiance to the albedo. A mirror passes on the albedo and normal of what it reflects.
    """
    layers = [layer.cycles for layer in scene.view_layers if layer.use]
    denoised = scene.cycles.use_denoising and any(layer.use_denoising for layer in layers)
    guided = denoised and scene.cycles.denoising_input_passes != "RGB"
    if not guided and not any(layer.denoising_store_passes for layer in layers):
        return
    name = name_of(estimator)
    text = f"What {name} adds for bound lights goes into the Denoising Albedo"
    if estimator == "direct":
        text = f"The light of {name} goes into the Denoising Albedo, and there is no Denoising Normal"
    elif estimator in RANDOM:
        part = "part of " if estimator == "hybrid" else ""
        text = f"Denoising Albedo and Normal of {part}{name} show what the surface reflects"
    if guided:
        fix = partial(set_values, scene.cycles, denoising_input_passes="RGB")
        yield Problem("denoiser", text, "Denoise Without Albedo and Normal", fix, "softer edges and textures")
    else:
        yield Problem("denoiser", text)


def _terminator_problems(known: SceneFacts, estimator: str, model: str) -> Iterator[Problem]:
    """Shading Offset bends the cosine to each closure's own normal, which no light grazes on a random facet."""
    if known.shifted and estimator in {*RANDOM, "direct"} and not MODELS[model].transparent:
        items = [item for name in known.shifted if (item := known.scene.objects.get(name)) is not None]
        share = " in its mirrored part" if estimator == "hybrid" else ""
        text = f"{name_of(estimator)} ignores Shading Offset{share} and is too bright"
        fix = partial(clear_offsets, items)
        yield Problem(
            "terminator",
            f"{text}: {', '.join(known.shifted)}",
            "Set Shading Offset to 0",
            fix,
            "jagged shadow lines on coarse meshes",
        )


def _lighting_passes() -> list[str]:
    kinds = [f"{of}_{part}" for of in LIGHTING_PASSES for part in ("direct", "indirect", "color")]
    return [f"use_pass_{kind}" for kind in ("emit", *kinds)]


def _picture_problems(scene: Scene, estimator: str, model: str, bound: Sequence[Light]) -> Iterator[Problem]:
    """Clamping, baking, and material overrides."""
    name, cycles = name_of(estimator), scene.cycles
    if cycles.sample_clamp_direct > 0 and (estimator == "hybrid" or (estimator == "corrected" and bound)):
        fix = partial(set_values, cycles, sample_clamp_direct=0.0)
        text = f"Clamp Direct clamps each part of {name} separately, which changes the image"
        yield Problem("clamp-direct", text, "Set Clamp Direct to 0", fix, "more fireflies")
    diffuse = estimator in RANDOM and MODELS[model].is_diffuse and MODELS[model].mirrors
    if cycles.bake_type in {"DIFFUSE", "GLOSSY"} and (bound or diffuse):
        what = "what it adds for bound lights" if bound else "its diffuse part"
        text = f"A {cycles.bake_type.title()} bake of {name} lacks {what}; bake Combined, or choose Standard"
        yield Problem("bake", text)
    for layer in scene.view_layers:
        if layer.use and layer.material_override is not None:
            text = f"The view layer {layer.name} replaces every material by {layer.material_override.name}"
            yield Problem(f"override {layer.name}", text)


def _shadow_problems(backend: str, estimator: str, bound: Sequence[Light]) -> Iterator[Problem]:
    if backend == "nodes" and not lamp.can_cast_shadows():
        what = {"direct": "Bound lights shine", "corrected": "The light that Exact Lights adds shines"}
        text = f"{what.get(estimator, 'Lights of zero size shine')} through objects"
        text += ": nodes cannot cast shadows in this Blender"
        yield Problem("shadows", f"{text}; choose OSL: {_names(bound)}")


def _names(items: Sequence[Light]) -> str:
    return ", ".join(item.name for item in items)


def _lights(found: Sequence[facts.Light]) -> str:
    return ", ".join(one.name for one in found)
