# SPDX-License-Identifier: GPL-3.0-or-later
"""The default material in everyday scenes, beside the nearest material of Cycles' own nodes, wired by hand."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import headless
from ...addon.blender import gonio, material, slots
from ...addon.blender.material import BUILDERS
from ...addon.library import presets
from ...addon.reference import spherical
from ...addon.reference.estimators import rendered as brdf
from ...headless import assignment
from ...nodegroups import versions
from ..scenery import surface
from . import contenders, peers
from .cells import Everyday
from .everyday_scenes import SCENES
from .everyday_stage import SAMPLES, SIZE, prepare, shaded
from .truth import frame

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bpy.types import Material, Scene
    from numpy.typing import NDArray

    from ...addon.library.presets import Preset
    from .everyday_stage import Scenario

    Floats = NDArray[np.float64]

SEEDS = (0, 1)
QUICK = ("start", "area", "even_sky")
CLOSE = 0.05  # by which a mean may be off where the models do not differ by more
BACK = 120.0  # degrees from the view, up to which lights stand in these scenes
FAINT = 0.25  # of the native picture's mean: differences of less are not seen
FACTOR = 2.0  # a pixel is black below its darkest native neighbour over this, bright above the brightest times this
CHANCE = 6.0  # standard errors; the noise of 3 x 3 pixels by two seeds is known to 24 %, which leaves 4.5 at least
MEAN_NOISE = 0.8  # of |x| of a normal variable, in its standard deviations; where tails are heavier it is less
BEACON = 2e4  # radiance that tells in which pixels the material is seen
TIMING_SIZE, TIMING_SAMPLES, ROUNDS = 48, 128, 5


@dataclass(frozen=True)
class Seen:
    """Pictures by seed (S, H, W, 3), ours and the native ones, and where they show the material (H, W)."""

    ours: Floats
    natives: Floats
    where: NDArray[np.bool_]
    estimator: str
    said: list[str]


@dataclass(frozen=True)
class Verdict:
    """Our picture beside the native one. mean: ours over the native one's, by channel; doubt: its standard error."""

    mean: tuple[float, ...]
    doubt: tuple[float, ...]
    apart: float
    black: int
    bright: int


def names(*, quick: bool) -> list[str]:
    return [*(QUICK if quick else SCENES)]


def measure(name: str, **_quick: bool) -> tuple[Everyday, ...]:
    """One scene with all of its subjects; none where this Blender cannot make it."""
    one = SCENES[name]
    return tuple(_measured(name, subject) for subject in one.subjects if versions.since(*one.since))


def _measured(name: str, subject: str) -> Everyday:
    one = SCENES[name]
    with headless.quiet():
        seen = look(name, subject)
        slowdown = time_over_native(name, subject) if one.timed else None
    verdict = judge(seen.ours, seen.natives, seen.where)
    mean, doubt = max(zip(verdict.mean, verdict.doubt, strict=True), key=lambda of: abs(of[0] - 1.0))
    return Everyday(
        title=one.title, subject=subject, estimator=seen.estimator, mean=mean, doubt=doubt,
        band=band(subject), apart=verdict.apart, bar=bar(subject), black=verdict.black, bright=verdict.bright,
        slowdown=slowdown, warnings=tuple(seen.said),
    )  # fmt: skip


def preset_of(subject: str) -> Preset:
    return presets.find("metals/gold") if subject == "conductor" else contenders.subjects()[subject]


# --- renders --------------------------------------------------------------------------------------------------------


def look(name: str, subject: str, size: int = SIZE, samples: int = SAMPLES) -> Seen:
    """Both materials in a scene. Empties the session."""
    preset, one = preset_of(subject), SCENES[name]
    shown = prepare(one, size, samples)
    ours, said = default(shown, preset, one)
    pictures = _pictures(shown, one)
    _give(shown, native(preset), one)
    natives = _pictures(shown, one)
    where = np.ones(natives.shape[1:3], np.bool_) if one.everywhere else _where(shown, one)
    wrong = [text for text in said if not any(words in text for words in one.says)]
    return Seen(pictures, natives, where, material.origin_of(ours).estimator, wrong)


def default(shown: Scene, preset: Preset, one: Scenario) -> tuple[Material, list[str]]:
    """What Automatic gives the scene's objects, and the warnings that come with it."""
    said = assignment.assign(shown, [(name, preset) for name in one.names], "nodes", "auto", 0.005)
    made = shown.objects[one.names[0]].active_material
    one.finish(shown, made)
    return made, said


def _give(shown: Scene, made: Material, one: Scenario) -> None:
    slots.apply(made, [shown.objects[name] for name in one.names])
    one.finish(shown, made)


def _pictures(shown: Scene, one: Scenario) -> Floats:
    """EEVEE draws nothing from a seed, and a render without a window takes seconds: one stands for all."""
    found: list[NDArray[np.float32]] = []
    for seed in SEEDS:
        if found and shown.render.engine != "CYCLES":
            found.append(found[0])
            continue
        shown.cycles.seed = seed
        found.append(one.render(shown))
    return np.stack(found).astype(np.float64)


def _where(shown: Scene, one: Scenario) -> NDArray[np.bool_]:
    """The pixels in which the material is seen, also through glass and in mirrors: where it would shine in Cycles."""
    shown.render.engine = "CYCLES"
    shown.view_layers[0].material_override = None
    shown.cycles.sample_clamp_direct = shown.cycles.sample_clamp_indirect = 0.0
    shown.cycles.use_denoising = False
    beacon = shaded("Emission", Strength=BEACON)
    slots.apply(beacon, [shown.objects[name] for name in one.names])
    return np.mean(gonio.rendered(shown), axis=-1) > BEACON / 2.0


def time_over_native(
    name: str, subject: str, size: int = TIMING_SIZE, samples: int = TIMING_SAMPLES, rounds: int = ROUNDS
) -> float:
    """Processor time of the default over the native material's. The first round warms up."""
    preset, one = preset_of(subject), SCENES[name]
    shown = prepare(one, size, samples)
    shown.cycles.use_adaptive_sampling = False
    ours, _ = default(shown, preset, one)
    other = native(preset)
    one.finish(shown, other)

    def seconds(made: Material) -> float:
        slots.apply(made, [shown.objects[name] for name in one.names])
        began = time.process_time()
        one.render(shown)
        return time.process_time() - began

    return statistics.median([seconds(ours) / seconds(other) for _ in range(rounds + 1)][1:])


# --- the native material --------------------------------------------------------------------------------------------


def native(preset: Preset) -> Material:
    """What an artist would wire without us: Metallic, Diffuse and Glass BSDFs with the preset's numbers."""
    return surface(f"Native {preset.name}", partial(peers.of(preset).native, preset=preset))


# --- judgement ------------------------------------------------------------------------------------------------------


def judge(ours: Floats, natives: Floats, where: NDArray[np.bool_]) -> Verdict:
    """Our pictures against the native ones; as ``Seen`` has them.

    Noise is that of the difference of two pictures of one seed, which share random numbers. A pixel is black or bright
    by the mean of its channels and of all seeds, beside the native picture's 3 x 3 pixels around it, as edges may shift
    a little; and only if it is plainly another than the native picture's pixel.
    """
    seeds, pixels = len(ours), np.count_nonzero(where)
    mean, native_mean = (pictures[:, where].mean(axis=(0, 1)) for pictures in (ours, natives))
    ratio = mean / native_mean
    variance = np.var((ours - ratio * natives)[:, where], axis=0, ddof=1).sum(axis=0) / seeds
    doubt = np.sqrt(variance) / pixels / native_mean
    difference = (ours - natives).mean(axis=-1)
    noise = np.sqrt(_around(np.var(difference, axis=0, ddof=1), where).mean(axis=0) / seeds)
    level, native_level = (pictures.mean(axis=(0, -1)) for pictures in (ours, natives))
    off, beside = np.abs(level - native_level), _around(native_level, where)
    apart = (off - MEAN_NOISE * noise)[where].sum() / native_level[where].sum()
    plain = where & (off > CHANCE * noise) & (off > FAINT * native_level[where].mean())
    black, bright = plain & (level < beside.min(axis=0) / FACTOR), plain & (level > beside.max(axis=0) * FACTOR)
    counts = (int(np.count_nonzero(of)) for of in (black, bright))
    return Verdict(tuple(map(float, ratio)), tuple(map(float, doubt)), float(apart), *counts)


def _around(values: Floats, where: NDArray[np.bool_]) -> Floats:
    """The 3 x 3 pixels around each (9, H, W); what does not show the material stands back for the pixel itself."""
    height, width = values.shape
    padded, there = np.pad(values, 1), np.pad(where, 1)
    shifts = [(slice(y, y + height), slice(x, x + width)) for y in range(3) for x in range(3)]
    return np.stack([np.where(there[shift], padded[shift], values) for shift in shifts])


@cache
def band(subject: str) -> tuple[float, float]:
    """Where our mean over the native material's should be.

    R is what a ball, lit from one direction, sends to a far camera by ``fit`` over what it sends by ``closure``, by the
    reference. Any distant light is a sum of such, so that the ratio of means lies between the least and the greatest R
    of the directions that light comes from.
    """
    ratios = [fit.sum(axis=(0, 1)) / closure.sum(axis=(0, 1)) for fit, closure in _balls(subject)]
    return min([1.0 - CLOSE, *np.ravel(ratios)]), max([1.0 + CLOSE, *np.ravel(ratios)])


@cache
def bar(subject: str) -> float:
    """What ``apart`` should not exceed: of the same balls; of a sum of lights it is at most that of one of them."""
    grey = [(fit.mean(axis=-1), closure.mean(axis=-1)) for fit, closure in _balls(subject)]
    return max([CLOSE, *(np.abs(fit - closure).sum() / closure.sum() for fit, closure in grey)])


def _balls(subject: str) -> Iterator[tuple[Floats, Floats]]:
    """``of_ball`` from every side that light comes from; none of a model without a fit, which is shown as it is."""
    preset = preset_of(subject)
    if {"fit", "closure"} <= BUILDERS[preset.model].keys():
        yield from (of_ball(preset.reference(), angle) for angle in np.arange(0.0, BACK + 1.0, 10.0))


def of_ball(model: Any, angle: float, size: int = SIZE) -> tuple[Floats, Floats]:
    """Pictures (H, W, 3) of a ball by ``fit`` and by ``closure``, lit from ``angle`` degrees beside the view."""
    place = (np.arange(size) + 0.5) / size * 2.0 - 1.0
    x, y = (axis.ravel() for axis in np.meshgrid(place, place))
    normal = np.stack([x, y, np.sqrt(np.maximum(1.0 - x**2 - y**2, 0.0))], axis=-1)
    eye, light = np.array([0.0, 0.0, 1.0]), spherical(np.radians(angle))
    lit = normal @ light
    shown = (normal @ eye > 0.02) & (lit > 1e-3)
    axes = frame(normal[shown] / np.linalg.norm(normal[shown], axis=-1, keepdims=True))
    wo, wi = axes @ eye, axes @ light
    pictures = []
    for estimator in ("fit", "closure"):
        picture = np.zeros((size * size, 3))
        picture[shown] = brdf(model, estimator)(wi, wo) * lit[shown, None]
        pictures.append(picture.reshape(size, size, 3))
    return pictures[0], pictures[1]
