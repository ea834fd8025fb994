# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against run time: each scene and subject by each estimator, backend and peer, from 4 to 4096 samples per pixel.

``statistics`` defines bias and noise; times are those of the render call. Each contender first renders one sample,
which loads and compiles it. Seeds go round all contenders, so other work on the machine slows all of them alike.
``mirror`` then renders more seeds, untimed, until the slope of its noise over samples is known.

The truth is the reference's: its albedo in a furnace; the integral of ``truth`` for an opaque ball, several times with
independent random numbers. For what light passes through it is pictures by ``mirror``, which ``vgroove check`` compares
with the reference.
"""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from ... import headless
from ...addon.blender import gonio
from ...addon.reference import albedo
from . import contenders, mitsuba_peer, mitsuba_scenes, statistics, truth
from .cells import Accuracy, Contender
from .contenders import Method
from .mitsuba_peer import PeerError, Rendered
from .scene_table import SCENES
from .scenes import stage

if TYPE_CHECKING:
    from bpy.types import Material
    from numpy.typing import NDArray

    from ...addon.library.presets import Preset
    from .mitsuba_peer import Peer
    from .scenes import Stage

names = contenders.names
SIZE, SMALLER = 14, 11  # pixels: a full report is to take less than an hour on two cores, on each Blender
SLOW = {"paint", "marble", "frosted", "glass"}  # shown smaller: many lobes, or many bounces
MIRROR = "mirror, nodes"
SEEDS, FEWER_SEEDS, FEWER_SEEDS_FROM = 4, 2, 1024  # pictures of each count; from so many samples on fewer do
# Seeds that mirror takes more of, as often as it takes to know the slope of its noise well within 0.05, but no less
# often than tells how well it is known: furnaces need the least, a lamp whose reflection lies on few pixels the most.
ROUND, ROUNDS, SLOPE_KNOWN = {64: 16, 256: 8, 1024: 4, 4096: 2}, range(2, 11), 0.02
TRUTHS, FIRST_TRUTH = 4, 1001  # how many, and the first one's seed
TRUTH_SAMPLES, RENDERED_SAMPLES = 8192, 16384  # a pixel of each truth
QUICK_TRUTH = 8  # a quick report's truths have this many times fewer
FURNACE = "the reference's directional albedo at each pixel's direction"
FORMULA = f"the reference's integral over lights and directions, {TRUTHS} times with independent random numbers"
BY_MIRROR = f"{TRUTHS} independent pictures by mirror"
# OSL shaders differ from nodes in time, elsewhere by about as much; and in Blender 4.5 where Cycles' own lobes have the
# Fresnel term of a dielectric, exact only in OSL there.
BOTH_BACKENDS = {("environment", "copper"), ("softbox", "copper"), ("softbox", "plastic")}


def measure(name: str, subject: str, *, quick: bool) -> Accuracy:
    """One scene and subject."""
    counts = contenders.counts(quick=quick)
    preset = contenders.subjects()[subject]
    source = FURNACE if name == "furnace" else FORMULA if truth.has(preset, name) else BY_MIRROR
    with headless.quiet(), ExitStack() as stack:
        other, without = _mitsuba(stack, name, preset)
        with stage(name, size_of(subject)) as shown:
            backends = ("nodes", "osl") if (name, subject) in BOTH_BACKENDS else ("nodes",)
            methods = [*contenders.ours(preset, backends, lamps=shown.lamp is not None), *contenders.native(preset)]
            truths = truths_of(shown, name, preset, fewer=QUICK_TRUTH if quick else 1)
            found = _race(shown, methods, counts)
            slope_error = None if SCENES[name].rarely_hit else _slope_error(shown, methods, counts, found)
            if other is not None:
                methods.append(other.method)
                found[other.method.label] = other.race(name, counts, size_of(subject))
            scored = {one.label: _scored(one, found[one.label], counts, truths, shown) for one in methods}
            scored[MIRROR] = replace(scored[MIRROR], slope_error=slope_error)
    return Accuracy(
        scene=name, subject=subject, model=preset.model, roughness=roughness_of(preset), size=size_of(subject),
        samples=counts,
        seeds=tuple(map(_seeds, counts)), truth=source, independent=source != BY_MIRROR,
        smooth=preset.transparent and preset.m == 0.0, contenders=scored, without=without,
    )  # fmt: skip


def roughness_of(preset: Preset) -> dict[str, float]:
    """Its slope m, sigma and sharpness, those that it has."""
    found: dict[str, Any] = preset.parameters
    return {name: float(found[name]) for name in ("m", "sigma", "sharpness") if name in found}


def size_of(subject: str) -> int:
    return SMALLER if subject in SLOW else SIZE


def truths_of(shown: Stage, name: str, preset: Preset, fewer: int = 1) -> NDArray[np.float64]:
    """Pictures of what is true, (A, H, W, 3): one without noise in a furnace, else independent ones."""
    size = shown.judged.shape[0]
    if name == "furnace":
        column = gonio.Geometry(furnace=True, resolution=(size, size)).wo()[:, :1]
        return np.broadcast_to(albedo(preset.reference(), column), (1, size, size, 3))
    return np.stack([_true(shown, name, preset, seed, fewer) for seed in range(FIRST_TRUTH, FIRST_TRUTH + TRUTHS)])


def _true(shown: Stage, name: str, preset: Preset, seed: int, fewer: int) -> NDArray[np.float64]:
    if truth.has(preset, name):
        return truth.picture(shown, preset.reference(), TRUTH_SAMPLES // fewer, seed)
    (mirror,) = (one for one in contenders.ours(preset, ("nodes",), lamps=False) if one.label == MIRROR)
    shown.item.active_material = mirror.make(shown.scene)
    return _render(shown, RENDERED_SAMPLES // fewer, seed).picture


def _race(shown: Stage, methods: list[Method], counts: tuple[int, ...]) -> dict[str, list[list[Rendered]]]:
    """What each method renders at each count, by seed."""
    made: dict[str, Material] = {one.label: one.make(shown.scene) for one in methods}
    found: dict[str, list[list[Rendered]]] = {one.label: [[] for _ in counts] for one in methods}
    for seed in range(1, SEEDS + 1):
        for one in methods:
            shown.item.active_material = made[one.label]
            shown.scene.cycles.shading_system = one.backend == "osl"
            _render(shown, 1, seed)
            for samples, renders in zip(counts, found[one.label], strict=True):
                if seed <= _seeds(samples):
                    renders.append(_render(shown, samples, seed))
    return found


def _slope_error(
    shown: Stage, methods: list[Method], counts: tuple[int, ...], found: dict[str, list[list[Rendered]]]
) -> float:
    """Standard error of the slope of ``mirror``'s noise, after as many more pictures as that takes, untimed."""
    (mirror,) = (one for one in methods if one.label == MIRROR)
    shown.item.active_material = mirror.make(shown.scene)
    shown.scene.cycles.shading_system = False
    of = {samples: renders for samples, renders in zip(counts, found[MIRROR], strict=True) if samples in ROUND}
    error = np.inf
    for done in range(1, ROUNDS[-1] + 1):
        for samples, renders in of.items():
            first = len(renders) + 1
            renders += [_render(shown, samples, seed) for seed in range(first, first + ROUND[samples])]
        if done in ROUNDS:
            error = statistics.slope({samples: _judged(renders, shown) for samples, renders in of.items()})[1]
            if error <= SLOPE_KNOWN:
                break
    return float(error)


def _judged(renders: list[Rendered], shown: Stage) -> NDArray[np.float64]:
    """The judged pixels of pictures by S seeds, (S, P, 3)."""
    return np.stack([one.picture for one in renders])[:, shown.judged]


@dataclass(frozen=True)
class Other:
    """Mitsuba, and what it shows a preset by."""

    peer: Peer
    bsdf: dict[str, Any]

    @property
    def method(self) -> Method:
        kind = self.bsdf["type"]
        quickest = "" if self.peer.variant == mitsuba_peer.VARIANTS[0] else ", not its quickest variant"
        differs = f"{kind}: {mitsuba_peer.DIFFERS[kind]} ({self.peer.version}, {self.peer.variant}{quickest})"
        return Method("Mitsuba", lambda _shown: None, peer="mitsuba", differs=differs)

    def race(self, name: str, counts: tuple[int, ...], size: int) -> list[list[Rendered]]:
        """As ``_race``: after Cycles, as each takes all cores."""
        return [
            [self.peer.render(name, self.bsdf, samples, seed, size) for seed in range(1, _seeds(samples) + 1)]
            for samples in counts
        ]


def _mitsuba(stack: ExitStack, name: str, preset: Preset) -> tuple[Other | None, str]:
    """Mitsuba until the stack is left, if it has the scene and something like the preset; or why not."""
    if name not in mitsuba_scenes.SCENES:
        return None, "Mitsuba has no gonioreflectometer"
    try:
        bsdf = mitsuba_peer.nearest(preset)
        return Other(stack.enter_context(mitsuba_peer.started()), bsdf), ""
    except (ValueError, PeerError) as error:
        return None, str(error)


def _seeds(samples: int) -> int:
    return SEEDS if samples < FEWER_SEEDS_FROM else FEWER_SEEDS


def _render(shown: Stage, samples: int, seed: int) -> Rendered:
    """A render, and how long it took; files are not in that."""
    shown.scene.cycles.samples, shown.scene.cycles.seed = samples, seed
    clocks: list[float] = []

    def note(*_: Any) -> None:
        clocks.append(time.process_time())

    around = (bpy.app.handlers.render_pre, bpy.app.handlers.render_post)
    for handlers in around:
        handlers.append(note)
    try:
        picture = gonio.rendered(shown.scene)
    finally:
        for handlers in around:
            handlers.remove(note)
    start, end = clocks
    return Rendered(picture.astype(np.float64), end - start)


def _scored(
    method: Method, found: list[list[Rendered]], counts: tuple[int, ...], truths: NDArray[np.float64], shown: Stage
) -> Contender:
    """A contender's bias, noise and time at each sample count."""
    exact = truths[:, shown.judged]
    errors = [statistics.error(_judged(renders, shown), exact) for renders in found]
    cpu = [[one.cpu for one in of[: _seeds(samples)]] for samples, of in zip(counts, found, strict=True)]
    return Contender(
        estimator=method.estimator, backend=method.backend, peer=method.peer, differs=method.differs,
        seeds=np.array([float(len(renders)) for renders in found]),
        bias2=np.array([one.bias2 for one in errors]),
        bias2_error=np.array([one.bias2_error for one in errors]),
        noise=np.array([one.noise for one in errors]),
        resolved=np.array(statistics.resolved([one.noise for one in errors], counts)),
        cpu=np.array([np.median(seconds) for seconds in cpu]),
        cpu_spread=np.array([np.std(seconds, ddof=1) / np.mean(seconds) for seconds in cpu]),
    )  # fmt: skip
