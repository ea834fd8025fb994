# SPDX-License-Identifier: GPL-3.0-or-later
"""Error against run time: each scene and subject by each estimator, backend and peer, from 4 to 4096 samples a pixel.

A cell holds, for each contender, one number a sample count: ``bias``, ``noise`` and ``rmse`` as ``statistics`` defines
them, FLIP of the whole picture, and seconds of the render call, by the wall and by the processor (median of seeds). A
render of one sample goes before each contender's, which loads and compiles it. Seeds go round all contenders, so that
what else the machine does falls on all alike. ``mirror`` takes more of them afterwards, without the clock: how its
noise falls with samples is to be known to a tenth of its slope.

The truth of a furnace is the reference's albedo. Elsewhere it is the sum of two pictures that ``vgroove check`` holds
against the reference: the world by ``mirror`` and the lamp by ``direct``, several of each by seeds of their own.
"""

from __future__ import annotations

import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any

import bpy
import numpy as np

from .. import gonio, headless, images
from ..files import replacing
from ..reference import albedo
from . import contenders, mitsuba_peer, statistics
from .contenders import Contender
from .findings import SELDOM
from .flip import flip
from .mitsuba_peer import Peer, PeerError
from .record import Cell
from .scenes import stage

if TYPE_CHECKING:
    from pathlib import Path

    from bpy.types import Material
    from numpy.typing import NDArray

    from ..presets import Preset
    from .scenes import Stage

SIZE, SMALLER = 14, 11  # pixels: a full report is to take less than an hour on two cores, on each Blender
SLOW = {"paint", "marble", "frosted", "glass"}  # shown smaller: many lobes, or many bounces
SEEDS, FEWER_SEEDS, MANY = 4, 2, 1024  # pictures of each count, and from how many samples on fewer do
# Of mirror. Noise is known to 1 / sqrt(2 (S - 1) P) of itself by S seeds of P pixels. Where a lamp's reflection lies on
# P = 10, the slope over these counts is then known to 0.024, where the seeds of all others would leave 0.06.
SLOPE_SEEDS = {64: 32, 256: 16, 1024: 12, 4096: 6}
PICTURE_SIZE, PICTURE_SAMPLES = 48, 64
TRUTHS, FIRST_TRUTH = 4, 101  # how many, and the first one's seed
WORLD_SAMPLES, LAMP_SAMPLES = 32768, 16384  # of each truth: biases of 1 % are to be told under a map
SLOW_TRUTH = 2  # of what is slow so many times fewer
DIM = 16  # a world that a lamp outshines takes this many times fewer
QUICK_TRUTH = 8  # a quick report's truths have this many times fewer
LOOKED_AT = 32  # as have the references of pictures to look at
# OSL shaders differ in time alone, and elsewhere by as much.
BOTH_BACKENDS = {("environment", "copper"), ("softbox", "copper")}


def cells(*, quick: bool) -> list[Cell]:
    return [
        Cell(f"accuracy/{name}/{of}", partial(measure, name=name, subject=of, quick=quick))
        for name, of in contenders.pairs(quick=quick)
    ]


def measure(folder: Path, name: str, subject: str, *, quick: bool) -> dict[str, Any]:
    """One scene and subject."""
    counts = contenders.counts(quick=quick)
    preset = contenders.subjects()[subject]
    with headless.quiet(), ExitStack() as stack:
        other, without = _mitsuba(stack, name, preset)
        with stage(name, size_of(subject)) as shown:
            backends = ("nodes", "osl") if (name, subject) in BOTH_BACKENDS else ("nodes",)
            rivals = [*contenders.ours(preset, backends, lamps=shown.lamp is not None), *contenders.peers(preset)]
            fewer = (QUICK_TRUTH if quick else 1) * (SLOW_TRUTH if subject in SLOW else 1)
            truths = truth(shown, name, preset, fewer)
            found = _race(shown, rivals, counts)
            if name not in SELDOM:  # where no slope is told
                _more(shown, rivals, counts, found)
            if other is not None:
                rivals.append(other.contender)
                found[other.contender.label] = other.race(name, counts, size_of(subject))
            scored = {rival.label: _scored(rival, found[rival.label], counts, truths, shown) for rival in rivals}
        drawn = None if name == "furnace" else pictures(folder, name, subject, preset, other)
    return {
        "scene": name, "subject": subject, "preset": preset.id, "model": preset.model, "m": preset.m,
        "size": size_of(subject), "samples": list(counts), "seeds": [_seeds(samples) for samples in counts],
        "first_seed": 1, "truth": _said(name), "first_truth_seed": FIRST_TRUTH, "without": without,
        "contenders": scored, "pictures": drawn,
    }  # fmt: skip


def size_of(subject: str) -> int:
    return SMALLER if subject in SLOW else SIZE


def truth(shown: Stage, name: str, preset: Preset, fewer: int = 1) -> NDArray[np.float64]:
    """Pictures of what is true, (A, H, W, 3): one without noise in a furnace, else independent ones."""
    size = shown.seen.shape[0]
    if name == "furnace":
        column = gonio.Geometry(furnace=True, resolution=(size, size)).wo()[:, :1]
        return np.broadcast_to(albedo(preset.reference(), column), (1, size, size, 3))
    return np.stack([_true(shown, preset, seed, fewer) for seed in range(FIRST_TRUTH, FIRST_TRUTH + TRUTHS)])


def _true(shown: Stage, preset: Preset, seed: int, fewer: int) -> NDArray[np.float64]:
    """The world by ``mirror``, the lamp by ``direct``."""
    total, lamp, of = np.zeros((*shown.seen.shape, 3)), shown.lamp, shown.scene
    made = {rival.estimator: rival for rival in contenders.ours(preset, ("nodes",), lamps=lamp is not None)}
    world_samples = WORLD_SAMPLES // fewer
    if lamp is not None:
        world, of.world = of.world, None
        shown.item.active_material = made["direct"].make(of)
        total += _render(shown, LAMP_SAMPLES // fewer, seed)[0]
        of.world = world
        lamp.hide_render = True
        world_samples //= DIM if shown.dim else 1
    shown.item.active_material = made["mirror"].make(of)
    total += _render(shown, world_samples, seed)[0]
    if lamp is not None:
        lamp.hide_render = False
    return total


@dataclass
class Taken:
    """The pictures of a contender at one sample count, by seed, and what each took, by wall and processor."""

    pictures: list[NDArray[np.float64]] = field(default_factory=list)
    wall: list[float] = field(default_factory=list)
    cpu: list[float] = field(default_factory=list)


def _race(shown: Stage, rivals: list[Contender], counts: tuple[int, ...]) -> dict[str, list[Taken]]:
    """Of each contender what it took at each count."""
    made: dict[str, Material] = {rival.label: rival.make(shown.scene) for rival in rivals}
    found = {rival.label: [Taken() for _ in counts] for rival in rivals}
    for seed in range(1, SEEDS + 1):
        for rival in rivals:
            shown.item.active_material = made[rival.label]
            shown.scene.cycles.shading_system = rival.osl
            _render(shown, 1, seed)
            for samples, taken in zip(counts, found[rival.label], strict=True):
                if seed <= _seeds(samples):
                    picture, wall, cpu = _render(shown, samples, seed)
                    taken.pictures.append(picture)
                    taken.wall.append(wall)
                    taken.cpu.append(cpu)
    return found


def _more(shown: Stage, rivals: list[Contender], counts: tuple[int, ...], found: dict[str, list[Taken]]) -> None:
    """Pictures of ``mirror`` by more seeds; they are not timed."""
    (mirror,) = (rival for rival in rivals if (rival.estimator, rival.backend) == ("mirror", "nodes"))
    shown.item.active_material = mirror.make(shown.scene)
    shown.scene.cycles.shading_system = mirror.osl
    for samples, taken in zip(counts, found[mirror.label], strict=True):
        for seed in range(len(taken.pictures) + 1, SLOPE_SEEDS.get(samples, 0) + 1):
            taken.pictures.append(_render(shown, samples, seed)[0])


@dataclass(frozen=True)
class Other:
    """Mitsuba, and what it shows a preset by."""

    peer: Peer
    bsdf: dict[str, Any]

    @property
    def contender(self) -> Contender:
        kind = self.bsdf["type"]
        quickest = "" if self.peer.variant == mitsuba_peer.VARIANTS[0] else ", not its quickest variant"
        differs = f"{kind}: {mitsuba_peer.DIFFERS[kind]} ({self.peer.version}, {self.peer.variant}{quickest})"
        return Contender("Mitsuba", lambda _shown: None, peer="mitsuba", differs=differs)

    def race(self, name: str, counts: tuple[int, ...], size: int) -> list[Taken]:
        """As ``_race``: after Cycles, as each takes all cores."""
        found = []
        for samples in counts:
            taken = Taken()
            for seed in range(1, _seeds(samples) + 1):
                one = self.peer.render(name, self.bsdf, samples, seed, size)
                taken.pictures.append(one.picture)
                taken.wall.append(one.wall)
                taken.cpu.append(one.cpu)
            found.append(taken)
        return found


def _mitsuba(stack: ExitStack, name: str, preset: Preset) -> tuple[Other | None, str]:
    """Mitsuba until the stack is left, if it has the scene and something like the preset; or why not."""
    if name not in mitsuba_peer.SCENES:
        return None, "Mitsuba has no gonioreflectometer"
    try:
        bsdf = mitsuba_peer.nearest(preset)
        return Other(stack.enter_context(Peer()), bsdf), ""
    except (ValueError, PeerError) as error:
        return None, str(error)


def _seeds(samples: int) -> int:
    return SEEDS if samples < MANY else FEWER_SEEDS


def _render(shown: Stage, samples: int, seed: int) -> tuple[NDArray[np.float64], float, float]:
    """The picture, and the seconds that its render took, by the wall and by the processor; files are not in them."""
    shown.scene.cycles.samples, shown.scene.cycles.seed = samples, seed
    clocks: list[tuple[float, float]] = []

    def note(*_: Any) -> None:
        clocks.append((time.perf_counter(), time.process_time()))

    around = (bpy.app.handlers.render_pre, bpy.app.handlers.render_post)
    for handlers in around:
        handlers.append(note)
    try:
        picture = gonio.rendered(shown.scene)
    finally:
        for handlers in around:
            handlers.remove(note)
    (wall, cpu), (wall_end, cpu_end) = clocks
    return picture.astype(np.float64), wall_end - wall, cpu_end - cpu


def _scored(
    rival: Contender, found: list[Taken], counts: tuple[int, ...], truths: NDArray[np.float64], shown: Stage
) -> dict[str, Any]:
    """What a contender errs by, and the time that it takes, at each sample count."""
    exact, reference = truths[:, shown.seen], truths.mean(axis=0)
    errors = [statistics.error(np.stack(taken.pictures)[:, shown.seen], exact) for taken in found]
    return {
        "estimator": rival.estimator, "backend": rival.backend, "peer": rival.peer, "differs": rival.differs,
        "seeds": [len(taken.pictures) for taken in found],
        "rmse": [one.rmse for one in errors],
        "bias2": [one.bias2 for one in errors], "bias2_error": [one.bias2_error for one in errors],
        "noise": [one.noise for one in errors],
        "resolved": statistics.resolved([one.noise for one in errors], counts),
        "flip": [float(np.mean([flip(reference, one) for one in taken.pictures])) for taken in found],
        "wall": [float(np.median(taken.wall)) for taken in found],
        "cpu": [float(np.median(taken.cpu)) for taken in found],
        "cpu_spread": [float(np.std(taken.cpu, ddof=1) / np.mean(taken.cpu)) for taken in found],
    }  # fmt: skip


def _said(name: str) -> str:
    if name == "furnace":
        return "the reference's directional albedo at each pixel's direction"
    seeds = f"{TRUTHS} independent pictures"
    return (
        f"{seeds} by mirror"
        if name in {"environment", "checker"}
        else f"{seeds}: the lamp by direct, the sky by mirror"
    )


def pictures(folder: Path, name: str, subject: str, preset: Preset, other: Other | None) -> dict[str, Any]:
    """Larger pictures to look at, as linear EXRs in the report's folder: the truth, and each contender in SVM."""
    target = folder / "pictures" / bpy.app.version_string.split()[0]
    target.mkdir(parents=True, exist_ok=True)
    with stage(name, PICTURE_SIZE) as shown:
        drawn = {"reference": _true(shown, preset, FIRST_TRUTH, fewer=LOOKED_AT)}
        for rival in (*contenders.ours(preset, ("nodes",), lamps=shown.lamp is not None), *contenders.peers(preset)):
            shown.item.active_material = rival.make(shown.scene)
            drawn[rival.label] = _render(shown, PICTURE_SAMPLES, 1)[0]
    if other is not None:
        one = other.peer.render(name, other.bsdf, PICTURE_SAMPLES, 1, PICTURE_SIZE)
        drawn[other.contender.label] = one.picture
    files = {}
    for label, picture in drawn.items():
        path = target / f"{name}-{subject}-{label.split(',')[0].replace(' ', '_').lower()}.exr"
        with replacing(path) as temporary:
            images.write(temporary, picture.astype(np.float32), {})
        files[label] = path.relative_to(folder).as_posix()
    return {"samples": PICTURE_SAMPLES, "files": files}
