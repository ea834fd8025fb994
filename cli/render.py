# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove render``: a still or a sequence, of a preset or of a scene with presets on its objects."""

from __future__ import annotations

import re
from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..addon.library import inputs, presets
from ..addon.library.errors import InputError
from ..addon.library.files import check_writable
from ..addon.library.inputs import MOST_SAMPLES
from ..addon.reference.hybrid import DEFAULT_BOUND
from ..addon.reference.keyframes import TOLERANCE
from ..batch.job import PREVIEW_SAMPLES, PREVIEW_SIZE, digest_of
from .environment import start_blender, versions
from .options import (
    AUTO,
    Backend,
    BackendOption,
    BoundOption,
    Estimator,
    SeedOption,
    SetOption,
    TimeOption,
    apply_settings,
    parse_resolution,
    real,
    whole,
)
from .terminal import progress, say

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..addon.blender.course import Play
    from ..addon.library.presets import Preset

    Assigned = list[tuple[str, Preset]]  # names of objects, or OBJECT:SLOT, with the preset of each


class Driving(StrEnum):
    CURVES = "curves"
    AGE = "age"


WhatArgument = Annotated[
    str, typer.Argument(metavar="PRESET|SCENE.blend", help="A preset, shown in the preview scene, or a scene")
]
OutputOption = Annotated[
    Path,
    typer.Option("-o", "--output", metavar="FILE", help=".exr (linear, float) or .png; with --frames name_####.png"),
]
AssignOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="OBJECT[:SLOT]=PRESET",
        help="Assign a preset to an object, or to one of its material slots by name or number (repeatable)",
    ),
]
EstimatorOption = Annotated[
    Estimator, typer.Option(help="auto: closure or fit, the smaller expected error in this scene; see explain")
]
DispersionOption = Annotated[
    bool, typer.Option("--dispersion", help="Clear materials spread colors by their Abbe number (Blender 5.3)")
]
ScatteringOption = Annotated[
    bool,
    typer.Option("--multiple-scattering", help="Metals show light that bounces within their grooves (not in direct)"),
]
FramesOption = Annotated[
    str | None,
    typer.Option(
        metavar="A-B",
        help="Render a sequence; presets that change go from start to end. Existing complete frames are kept",
    ),
]
DrivingOption = Annotated[
    Driving, typer.Option(help="with --frames: F-curves on the inputs, or one keyed Age within the material")
]
ToleranceOption = Annotated[
    float,
    typer.Option(
        parser=real(),
        metavar="SHARE",
        help="with --frames: largest error of the keys, as a share of the parameter's range",
    ),
]
ShutterOption = Annotated[
    float,
    typer.Option(
        parser=real(0.0, 1.0),
        metavar="SHARE",
        help="with --frames: how long the shutter is open, as a share of a frame; materials that change blur too",
    ),
]
StripOption = Annotated[
    Path | None, typer.Option(metavar="FILE.png", help="with --frames: also write a contact strip of the sequence")
]
MovieOption = Annotated[
    Path | None, typer.Option(metavar="FILE", help="with --frames: also write a movie, .mp4 or .webm")
]
FpsOption = Annotated[int, typer.Option(parser=whole(1, 240), metavar="N", help="Frames per second of the movie")]
SamplesOption = Annotated[
    int | None,
    typer.Option(
        parser=whole(1, MOST_SAMPLES),
        metavar="N",
        help="Samples per pixel; 128 for a preset, the scene's own for a .blend",
    ),
]
ResolutionOption = Annotated[
    str | None, typer.Option(metavar="WxH", help="640x480 for a preset, the scene's own for a .blend")
]


def render(
    what: WhatArgument,
    output: OutputOption,
    *,
    assign: AssignOption = None,
    settings: SetOption = None,
    backend: BackendOption = Backend.NODES,
    estimator: EstimatorOption = AUTO,
    bound: BoundOption = DEFAULT_BOUND,
    dispersion: DispersionOption = False,
    multiple_scattering: ScatteringOption = False,
    at_time: TimeOption = None,
    frames: FramesOption = None,
    driving: DrivingOption = Driving.CURVES,
    tolerance: ToleranceOption = TOLERANCE,
    shutter: ShutterOption = 0.0,
    strip: StripOption = None,
    movie: MovieOption = None,
    fps: FpsOption = 24,
    samples: SamplesOption = None,
    seed: SeedOption = 0,
    resolution: ResolutionOption = None,
) -> None:
    """Render a preset, or a .blend with presets assigned to its objects."""
    is_scene = what.endswith(".blend")
    span = _frames(frames, output)
    size = parse_resolution(resolution) if resolution is not None else None
    _check_outputs(output, strip, movie, span, at_time, shutter)
    assigned = _with_settings(_presets_to_show(what, assign or []), settings, at_time)
    start_blender()
    from .. import headless
    from ..addon.blender import lamps
    from ..headless import assignment, scene

    play = _play(driving, span, tolerance) if span else None
    size = size or (None if is_scene else PREVIEW_SIZE)
    pixels: dict[str, Any] = {"samples": samples, "seed": seed, "resolution": size}
    with headless.quiet():
        stage = scene.open_file(Path(what)) if is_scene else scene.preview()
        stage.cycles.samples = samples or (stage.cycles.samples if is_scene else PREVIEW_SAMPLES)
    with lamps.read_once():
        with headless.quiet():
            advice = assignment.assign(
                stage, assigned, str(backend), str(estimator), bound, play, disperses=dispersion,
                bounces=multiple_scattering, where="--assign ",
            )  # fmt: skip
        for text in advice:
            say(f"warning: {text}")
        if not span:
            if headless.stack_overflows(lambda: scene.still(stage, output, **pixels)):
                say(f"warning: {headless.OVERFLOWED}")
            say(f"wrote {output}")
            return
    identity = [
        what, digest_of(Path(what)) if is_scene else "", [(name, asdict(preset)) for name, preset in assigned],
        play and asdict(play), str(backend), str(estimator), bound, dispersion, multiple_scattering,
        stage.cycles.samples, seed, size, shutter, versions(),
    ]  # fmt: skip
    _render_frames(stage, span, output, identity, movie, shutter=shutter, **pixels)
    _write_extras(output, span, assigned, strip, movie, fps)


# What is asked for


def _frames(text: str | None, output: Path) -> range:
    """The frames of text "A-B"; none without a text."""
    if text is None:
        return range(0)
    try:
        span = inputs.frame_range(text)
    except InputError as error:
        message = f'--frames "{text}": {error}'
        raise InputError(message) from error
    if "#" not in output.name:
        message = f"{output}: a sequence needs #### in the file name, as in rust_####.png"
        raise InputError(message)
    return span


def _check_outputs(
    output: Path, strip: Path | None, movie: Path | None, span: Sequence[int], at_time: float | None, shutter: float
) -> None:
    """InputError or OSError, before any work, for outputs that could not be written or do not go together."""
    if output.suffix.lower() not in {".exr", ".png"}:
        message = f"{output}: unknown ending; use .exr (linear, float) or .png"
        raise InputError(message)
    for place in {_numbered(output, span[0]), _numbered(output, span[-1])} if span else {output}:
        check_writable(place)
    if span and at_time is not None:
        message = "--time shows one moment and --frames a sequence; give one of them"
        raise InputError(message)
    for name, path in (("--strip", strip), ("--movie", movie)):
        if path is not None and not span:
            message = f"{name} {path}: goes with --frames, of which it is made"
            raise InputError(message)
    if strip is not None:
        if strip.suffix.lower() != ".png":
            message = f"--strip {strip}: a strip is a PNG; name a file that ends in .png"
            raise InputError(message)
        check_writable(strip)
    if movie is not None:
        start_blender()
        from ..headless import sequence

        sequence.check_movie(movie)
    if shutter and not span:
        message = f"--shutter {shutter:g}: goes with --frames, each of which it exposes"
        raise InputError(message)


def _presets_to_show(what: str, assign: list[str]) -> Assigned:
    """The presets to show: those of ``--assign`` in a scene, or the one on the preview scene's ball."""
    if not what.endswith(".blend"):
        if assign:
            message = "--assign goes with a SCENE.blend; the preview scene shows the preset itself"
            raise InputError(message)
        return [("Ball", presets.find(what))]
    if not Path(what).is_file():
        message = f"{what}: no such scene; name a .blend file"
        raise InputError(message)
    return assignments(assign)


def assignments(items: list[str]) -> Assigned:
    """What each OBJECT[:SLOT]=PRESET says. A preset's id has no "=", so the last one divides."""
    found: dict[str, Preset] = {}
    for item in items:
        name, equals, preset = item.rpartition("=")
        if not equals or not name or not preset:
            message = f'--assign "{item}": write OBJECT=PRESET or OBJECT:SLOT=PRESET, as in Ball=copper'
            raise InputError(message)
        try:
            name = inputs.name(name)
        except InputError as error:
            message = f'--assign "{item}": the name {error}'
            raise InputError(message) from error
        if name in found:
            message = f'--assign "{item}": gives "{name}" a second preset; leave one of them out'
            raise InputError(message)
        found[name] = presets.find(preset)
    return list(found.items())


def _with_settings(assigned: Assigned, settings: list[str] | None, at_time: float | None) -> Assigned:
    """Each preset with the settings, and at the time if it changes; InputError for a time if none does."""
    if at_time is not None and not any(preset.time for _, preset in assigned):
        names = ", ".join(preset.id for _, preset in assigned) or "no preset"
        message = f"--time: {names} does not change over time; leave it out"
        raise InputError(message)
    return [(name, apply_settings(preset, settings, at_time if preset.time else None)) for name, preset in assigned]


def _play(driving: Driving, span: Sequence[int], tolerance: float) -> Play:
    from ..addon.blender.course import Play

    return Play(str(driving), float(span[0]), float(max(span[-1] - span[0], 1)), tolerance)


# Sequences


def _render_frames(
    stage: Any, span: Sequence[int], output: Path, identity: list[Any], movie: Path | None, **settings: Any
) -> None:
    """Render the frames that are not there yet. identity: all that decides what they show."""
    from .. import headless
    from ..headless import scene, sequence

    if movie is not None:
        sequence.check_size(settings["resolution"] or scene.size(stage))
    if not scene.remembers(stage):
        stage.render.use_persistent_data = True  # Cycles is given only what changes from frame to frame
    kept, note, overflowed = [], sequence.note(identity), False
    for frame in progress(span, "rendering", len(span)):

        def render_frame(frame: int = frame) -> None:
            kept.append(sequence.frame_to(stage, frame, _numbered(output, frame), note, **settings))

        overflowed |= headless.stack_overflows(render_frame)
    if overflowed:
        say(f"warning: {headless.OVERFLOWED}")
    before = f", {sum(kept)} of them there already" if any(kept) else ""
    say(f"wrote {len(span)} frames, {output}{before}")


def _write_extras(
    output: Path, span: Sequence[int], assigned: Assigned, strip: Path | None, movie: Path | None, fps: int
) -> None:
    """The contact strip and the movie of a sequence, where they are asked for."""
    from .. import headless
    from ..headless import sequence

    paths = [_numbered(output, frame) for frame in span]
    if strip:
        with headless.quiet():
            sequence.strip(paths, _labels(span, assigned), strip)
        say(f"wrote {strip}")
    if movie:
        with headless.quiet():
            sequence.movie(paths, movie, fps)
        say(f"wrote {movie}")


def _labels(span: Sequence[int], assigned: Assigned) -> list[str]:
    """The time of the first preset that changes, at each frame; without one, the frame's number."""
    changing = next((preset for _, preset in assigned if preset.time), None)
    if changing is None or changing.time is None:
        return [f"frame {frame}" for frame in span]
    ages = [(frame - span[0]) / max(span[-1] - span[0], 1) for frame in span]
    unit = "of its course" if changing.time.unit == "share" else changing.time.unit
    return [f"{time:.3g} {unit}" for time in changing.trajectory().time(ages)]


def _numbered(output: Path, frame: int) -> Path:
    return output.with_name(re.sub("#+", lambda marks: f"{frame:0{len(marks[0])}d}", output.name, count=1))
