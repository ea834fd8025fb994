# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of ``vgroove check`` for materials that change: Cycles at moments of a preset's course, however it is played.

The reference plays the same keys as Blender, between them straight; how near these keys are to the preset's law is what
``place_keys`` promises and the reference's own tests hold.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np

from ... import headless
from ...addon.blender import course, gonio
from ...addon.blender.course import Play
from ...addon.library.presets import Preset, find
from ...addon.library.timeline import plain
from ...addon.models import parameter
from ...addon.reference import OrenNayar, Sum, albedo, rendered
from ...addon.reference.hybrid import DEFAULT_BOUND
from ...addon.reference.quadrature import diffuse_albedo
from ...addon.reference.sum import quick_diffuse_share
from .cook_torrance import fresnel_approximation
from .hybrid import excess
from .rows import SETUPS, Plan, Row, Setup, View, side_by_side
from .views import WINDOW, direct_bar

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ...addon.reference import Keyframes, Model

MOMENTS, FURNACE_MOMENTS = 20, 8  # of a course; the reference of hybrid's furnace takes a second or more per moment
# theta_i and window, in turn: each takes all parameters of its moments, and building a course takes longer than a view
WAYS = ((20.0, 0.0), (45.0, WINDOW), (70.0, 0.0), (85.0, WINDOW))
FRAMES, MOST_FRAMES = 240.0, 1e6  # a course is played in at least so many; Blender ends at 1048574
APART = 0.01  # frames between keys, at least: ten times CLOSEST
FURNACE, FURNACE_SAMPLES = gonio.Geometry(furnace=True, resolution=(64, 8)), 128
AVERAGED = 8  # pixels of a row of the furnace; Cycles' sampler is stratified only over powers of two
GRIDS = (20, 30)  # nodes of two quadratures; they part by as much as the finer is known
NOISY_ROWS = 4  # of the plan; a test holds it to the plan


@cache
def _keys(identity: str) -> dict[str, Keyframes]:
    return course.keyframes(find(identity).trajectory(), Play())


def play_of(preset: Preset, driving: str) -> Play:
    """Slow enough that Blender can tell all keys apart."""
    nearest = min(float(np.min(np.diff(of.times))) for of in _keys(preset.id).values())
    return Play(driving, 1.0, min(max(FRAMES, np.ceil(APART / nearest)), MOST_FRAMES))


def moments(preset: Preset, play: Play, count: int = MOMENTS) -> list[float]:
    """Frames of the course's two ends, and midway between keys, taken evenly from those of all parameters."""
    ages = np.unique(np.concatenate([of.times for of in _keys(preset.id).values()]))
    middle = 0.5 * (ages[:-1] + ages[1:])
    chosen = middle[np.linspace(0, middle.size - 1, count - 2).round().astype(int)]
    frames = play.start + np.concatenate([[0.0], chosen, [1.0]]) * play.length
    return frames.astype(np.float32).astype(float).tolist()  # as Blender holds a frame


def at_frame(preset: Preset, play: Play, frame: float) -> Preset:
    """The material that Blender shows at a frame: its inputs go straight from key to key."""
    age = np.clip((frame - play.start) / play.length, 0.0, 1.0)
    now = {name: plain(parameter(name).scale.of_input(of.law()(age))) for name, of in _keys(preset.id).items()}
    return replace(preset, parameters=preset.parameters | now, time=None)


def direct_row(setup: Setup, driving: str, name: str) -> Row:
    """``direct`` at each moment by the bar of its slope, in turn on the hemisphere and around the mirror direction."""
    preset = find(name)
    play = play_of(preset, driving)
    frames = moments(preset, play)
    row = Row(f"direct by {driving}", setup, preset.model, preset.name)
    for index, (theta_i, window) in enumerate(WAYS):
        geometry = gonio.Geometry(theta_i, window, (32, 32))
        wi, wo = geometry.wi(), geometry.wo()
        now = frames[index :: len(WAYS)]
        with headless.quiet():
            images = gonio.measure_course(
                preset, setup.backend, "direct", geometry, play, now, shading_osl=setup.shading_osl
            )
        for frame, image in zip(now, images.astype(np.float64), strict=True):
            shown = at_frame(preset, play, frame)
            expected = rendered(shown.reference(), "direct")(wi, wo)
            bar = direct_bar(shown.m or 1.0)  # a diffuse material has no slope
            row.views.append(View(geometry, image, expected, bar, float(np.max(expected))))
    return row


def hybrid_row(setup: Setup, driving: str, name: str) -> Row:
    """``hybrid`` under a white sky, at each moment: the directional albedo of what it renders."""
    preset = find(name)
    play = play_of(preset, driving)
    frames = moments(preset, play, FURNACE_MOMENTS)
    with headless.quiet():
        images = gonio.measure_course(
            preset, setup.backend, "hybrid", FURNACE, play, frames,
            samples=FURNACE_SAMPLES, shading_osl=setup.shading_osl,
        )  # fmt: skip
    images = images.astype(np.float64)
    known = [sent_back(preset, play, frame) for frame in frames]
    expected = np.stack([one for one, _ in known])
    native = [native_doubt(setup, at_frame(preset, play, frame)) for frame in frames]
    doubt = np.stack([one + more for (_, one), more in zip(known, native, strict=True)])
    width, height = FURNACE.resolution
    # The pixels of a row see alike. One that met no rare facet looks more certain than it is: its variance is
    # no less than, in proportion, the mean of all moments.
    own = np.var(images, axis=2, ddof=1)
    alike = np.mean(own / np.square(expected), axis=0) * np.square(expected)
    # Means of some pixels are judged, as the weight of a random facet is skewed. A wrong reference is the same in all
    # groups of a row, whose sum it moves as often.
    variance = np.maximum(own, alike) / AVERAGED + width / AVERAGED * np.square(doubt)
    row = Row(f"hybrid by {driving}", setup, preset.model, preset.name, noisy_rows=NOISY_ROWS)
    for image, mean, spread in zip(images, expected, variance, strict=True):
        means = image.reshape(height, width // AVERAGED, AVERAGED, 3).mean(axis=2)
        full = np.ones_like(means)
        row.views.append(View(FURNACE, means, mean[:, None] * full, variance=spread[:, None] * full, degrees=width - 1))
    return row


def native_doubt(setup: Setup, preset: Preset) -> NDArray[np.float64] | float:
    """How far Cycles' own Fresnel terms may be off on this Blender, as a share of the light."""
    off = fresnel_approximation(setup, preset.kind)
    return off * float(preset.parameters.get("s", 1.0)) if off else 0.0  # type: ignore[arg-type]


@cache
def _sent_back(identity: str, play: Play, frame: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    model = at_frame(find(identity), play, frame).reference()
    cosine = FURNACE.wo()[:, 0, 2]
    wo = np.stack([np.sqrt(1.0 - cosine**2), 0.0 * cosine, cosine], axis=-1)
    coarse, fine = (hybrid_albedo(model, wo, nodes) for nodes in GRIDS)
    return fine, fine - coarse


def sent_back(preset: Preset, play: Play, frame: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Albedo of each row of the furnace, (8, 3), and how well it is known; the same however the course is played."""
    return _sent_back(preset.id, replace(play, driving="curves"), frame)


def hybrid_albedo(model: Model, wo: NDArray[np.float64], nodes: int) -> NDArray[np.float64]:
    """What ``hybrid`` sends back of a white sky, (..., 3)."""
    if isinstance(model, Sum):
        under = quick_diffuse_share(model, wo) * hybrid_albedo(model.diffuse, wo, nodes)
        return under + model.s * hybrid_albedo(model.specular, wo, nodes)
    if isinstance(model, OrenNayar):
        return diffuse_albedo(wo, rendered(model, "hybrid", DEFAULT_BOUND), nodes)
    m, fresnel = model.m, model.fresnel  # type: ignore[attr-defined]  # Cook-Torrance: no preset that changes is smooth
    return albedo(model, wo) + np.stack([excess(view, m, fresnel, DEFAULT_BOUND, 2 * nodes) for view in wo])


def plan() -> Plan:
    """Every row of one course; the tests have those of all presets."""
    rows: Plan = []
    for setup in (SETUPS[0], SETUPS[2]):
        for driving in course.DRIVINGS:
            rows += [partial(row, setup, driving, "time_varying/rusting_iron") for row in (direct_row, hybrid_row)]
    return side_by_side(rows)
