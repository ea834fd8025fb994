# SPDX-License-Identifier: GPL-3.0-or-later
"""What was left out: each material as it is built, against one universal material and with each omitted part put back.

For each preset and scene: nodes, compiled OSL instructions and processor time of the material as built and of the
universal one, and whether pictures of the same seed agree; then each component that the builder left out is put back
with a weight of 0 by data.

Renders are timed by a Cycles that has compiled before; times are medians of rounds that take turns. SVM's count of
instructions is only in Cycles' log, which the Python module cannot switch on: nodes have no figure but their number.
"""

from __future__ import annotations

import statistics
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import headless
from ...addon.blender import gonio
from ...addon.blender.course import Play
from ...addon.blender.material import RANDOM, build
from ...addon.choose import explain
from ...addon.library import presets
from ..scenery import add_object, light_data
from . import scenes, universal, universal_data
from .cells import LeftOut, OmittedPart

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from bpy.types import Material, Object, Scene
    from numpy.typing import NDArray

    from ...addon.blender.material import Choice
    from ...addon.choose.explain import Account, Line
    from ...addon.library.presets import Preset

CASES = {
    "schlick": "lecture/copper",
    "conductor": "metals/copper",
    "oren_nayar": "diffuse/clay",
    "plastic": "plastics/abs_plastic",
    "glass": "glasses/frosted_glass",
    "car_paint": "car_paints/blue",
    "over_time": "time_varying/rusting_iron",
}
QUICK, QUICK_LINES = ("schlick", "plastic"), 3
SCENES = ("environment", "softbox", "lamps")
OSL_SCENE, OSL_CASES = "softbox", ("schlick", "plastic", "glass", "car_paint")  # the rest take long and differ little
BY_MIRROR, MIRROR_SCENE = ("schlick", "glass"), "environment"  # which Automatic does not pick in these scenes
SIZE, ROUNDS, SEED = 40, 3, 0
SAMPLES = {"nodes": 64, "osl": 32}
LENGTH, FRAME = 240.0, 97  # of a course that is played, and where in it the picture is taken
# Pictures of the same seed are made of the same random numbers. Weights go through some 100 more operations of 6e-8
# each, 6e-6 in all, and near a threshold a share of that of about 4 choices a sample falls otherwise: of a pixel's N
# samples 4 * 6e-6 N, each of which changes it by no more than one sample, BRIGHT means of the picture, over N. The root
# mean square over the pixels is then BRIGHT sqrt(4 * 6e-6 / N): 6e-3 for 64 samples. They fall either way: the mean of
# P pixels is off by no more than MOST_Z of that over the root of P, 7e-4 for 64 samples, and by what weights are.
WEIGHTS = 6e-6
FLIPS, BRIGHT = 4 * WEIGHTS, 10.0
MOST_Z = 4.4  # two-sided, 1 % with a Sidak correction for three channels of some 200 pictures, on two Blenders
PUT_BACK = {  # what ``explain`` calls it -> what ``universal`` puts back
    "Fresnel terms": "specular",
    "time": "time",
    "course over time": "time",
    "diffuse part": "diffuse",
    "absorption": "absorption",
    "transmission": "transmission",
    "random numbers": "random",
    "facets and random numbers": "random",
    "lamp terms": "lamps",
    "closure beside it": "eevee",
}


def names(*, quick: bool) -> list[str]:
    return [*(QUICK if quick else CASES)]


def measure(case: str, *, quick: bool = False) -> tuple[LeftOut, ...]:
    """A preset in all scenes."""
    preset, backend = presets.find(CASES[case]), _backend()
    rounds = 1 if quick else ROUNDS
    most = QUICK_LINES if quick else None
    found = [setup(case, preset, name, backend, rounds, most=most) for name in (("lamps",) if quick else SCENES)]
    if not quick and backend == "nodes" and case in OSL_CASES:
        found.append(setup(case, preset, OSL_SCENE, "osl", rounds))
    if not quick and case in BY_MIRROR:
        found.append(setup(case, preset, MIRROR_SCENE, backend, rounds, estimator="mirror", most=0))
    return tuple(found)


def _backend() -> str:
    """What is measured in all scenes."""
    return "nodes" if universal.fits() else "osl"


def stage(name: str, size: int = SIZE) -> Scene:
    """A ball under one of ``SCENES``: an environment map, an area lamp alone, or a sky and two lamps of no size.

    The ball is at the origin, unturned: else Cycles rounds its points again where it cannot apply transforms, such as
    with subsurface scattering, and the hash of a position would give other random numbers.
    """
    shown = scenes.ball(size, height=0.0)
    shown.render.use_persistent_data = False
    shown.world.cycles.sampling_method, shown.world.cycles.sample_map_resolution = "MANUAL", 256  # else 2 s a render
    if name == "softbox":
        shown.world = None
        _lamp(shown, "AREA", energy=60.0, size=1.0)
    elif name == "lamps":
        _lamp(shown, "SUN", energy=1.6, angle=0.0)
        _lamp(shown, "POINT", energy=200.0, shadow_soft_size=0.0)
    shown.frame_set(FRAME)
    shown.view_layers[0].update()
    return shown


def _lamp(shown: Scene, kind: str, **settings: float) -> None:
    side = 1.0 if kind != "POINT" else -1.0
    at, turned = (1.3 * side, -1.6, 1.6), (45.0, 0.0, 39.0 * side)
    add_object(shown, "Lamp", light_data("Lamp", kind, **settings), at, turned)


def setup(
    case: str, preset: Preset, name: str, backend: str, rounds: int, *, estimator: str = "auto", most: int | None = None
) -> LeftOut:
    """One scene and backend: both materials, and what was left out of the one, of which ``most`` are put back."""
    with headless.quiet():
        shown = stage(name)
        shown.cycles.shading_system = backend == "osl"
        account = explain.explain(preset, shown, backend, estimator)
        play = Play("age", 1.0, LENGTH) if preset.time else None
        choice = replace(account.choice, play=play)
        data = universal_data.data_of(preset, (FRAME - 1.0) / LENGTH, play)
        pair = {"built": (build(preset, choice), data), "universal": (universal.build(choice), data)}
        seconds, pictures = _turns(shown, pair, rounds, backend)
        independent = _redraws(preset, choice)
        same = _compared(pictures["built"], pictures["universal"], SAMPLES[backend], independent=independent)["same"]
        lines = _lines(shown, preset, account, most=0 if name == OSL_SCENE else most)
        sizes = {which: explain.size_of(made) for which, (made, _) in pair.items()}
    ratios = [one["universal"] / max(one["built"], 1e-3) for one in seconds]
    return LeftOut(
        case=case, preset=preset.id, scene=name, backend=backend, estimator=account.estimator,
        slowdown=statistics.median(ratios), spread=(min(ratios), max(ratios)),
        nodes=(sizes["built"].nodes, sizes["universal"].nodes),
        instructions=(sizes["built"].instructions, sizes["universal"].instructions),
        same=same, omitted=lines,
    )  # fmt: skip


def _turns(
    shown: Scene, pair: Mapping[str, tuple[Material, dict[str, Any]]], rounds: int, backend: str
) -> tuple[list[dict[str, float]], dict[str, NDArray[np.float64]]]:
    """Processor seconds, round by round, and the pictures. Each material has a scene of its own, whose Cycles keeps
    what it compiled.
    """  # noqa: D205
    twins = {which: _twin(shown) for which in pair}
    for which, of in pair.items():
        _render(twins[which], *of, 1)
    seconds: list[dict[str, float]] = []
    for _ in range(rounds):
        renders = {which: _render(twins[which], *of, SAMPLES[backend]) for which, of in pair.items()}
        seconds.append({which: taken for which, (_, taken) in renders.items()})
    return seconds, {which: picture for which, (picture, _) in renders.items()}


def _twin(shown: Scene) -> Scene:
    """A copy of a scene with a ball of its own."""
    twin, ball = shown.copy(), _ball(shown)
    other = ball.copy()
    other.data = ball.data.copy()
    twin.collection.objects.unlink(ball)
    twin.collection.objects.link(other)
    twin.render.use_persistent_data = True
    return twin


def _ball(shown: Scene) -> Object:
    return next(item for item in shown.objects if item.type == "MESH")


def _lines(shown: Scene, preset: Preset, account: Account, *, most: int | None = None) -> tuple[OmittedPart, ...]:
    """Each component that was left out, ``most`` of them put back."""
    listed = list(_listed(account))
    most = len(listed) if most is None else most
    named = [OmittedPart(what=line.what, why=line.why) for line, _ in listed]
    if not most:
        return tuple(named)
    built, samples = build(preset, account.choice), SAMPLES[account.choice.backend]
    independent = _redraws(preset, account.choice)
    start = universal_data.data_of(preset, 0.0, Play("age", 1.0, LENGTH) if preset.time else None)
    nothing = universal_data.data_of(None)
    plain, _ = _render(shown, built, nothing, samples)
    for index, (_, part) in enumerate(listed[:most]):
        if part == "time":
            other, data = universal.with_time(built), start
        elif part == "eevee":
            other, data = universal.without_eevee(built), nothing
        else:
            other, data = universal.with_part(built, account.choice, part), nothing
        picture, _ = _render(shown, other, data, samples)
        nodes = abs(explain.size_of(other).nodes - explain.size_of(built).nodes)
        same = _compared(plain, picture, samples, independent=independent)["same"]
        named[index] = replace(named[index], nodes=nodes, same=same)
    return tuple(named)


def _listed(account: Account) -> Iterator[tuple[Line, str]]:
    """What was left out and can be put back, and as what."""
    for line in account.lines:
        part = PUT_BACK.get(line.what.partition(":")[0].partition(" (")[0])
        if part is not None and (part == "eevee" or not line.kept):
            yield line, part


def _render(
    shown: Scene, made: Material, data: Mapping[str, Any], samples: int
) -> tuple[NDArray[np.float64], float]:  # fmt: skip
    """The picture, and the processor seconds that it took."""
    ball = _ball(shown)
    if ball.active_material != made:
        ball.active_material = made
        universal_data.set_data(ball, data)
        shown.view_layers[0].update()
    shown.cycles.samples, shown.cycles.seed = samples, SEED
    start = time.process_time()
    picture = gonio.rendered(shown).astype(np.float64)
    return picture, time.process_time() - start


def _compared(
    a: NDArray[np.float64], b: NDArray[np.float64], samples: int, *, independent: bool = False
) -> dict[str, Any]:  # fmt: skip
    """Root mean square difference of two pictures, over that of the first, and whether it is only chance.

    "off": the largest difference of a channel's mean, over the same. independent: the pictures have random numbers of
    their own, and "z" says by how many standard errors the means differ.
    """
    d, scale, pixels = a - b, float(np.sqrt(np.mean(a**2))), a.shape[0] * a.shape[1]
    difference = float(np.sqrt(np.mean(d**2))) / scale
    means = np.abs(np.mean(d, axis=(0, 1)))
    off = float(np.max(means)) / scale
    z = float(np.max(means / np.maximum(np.std(d, axis=(0, 1)) / pixels**0.5, 1e-30)))
    most = BRIGHT * (FLIPS / samples) ** 0.5
    same = z < MOST_Z if independent else difference < most and off < MOST_Z * most / pixels**0.5 + WEIGHTS
    return {"difference": difference, "off": off, "z": z, "same": bool(same)}


def _redraws(preset: Preset, choice: Choice) -> bool:
    """Whether a ray that met the material once draws a facet where it meets it again.

    It does so at another place, by the last digit, and the hash of that has nothing to do with the other's.
    """
    return preset.transparent and preset.m > 0.0 and choice.estimator in RANDOM
