# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``vgroove`` command. Exit codes: 0 done, 1 a check failed, 2 bad input (one line), 3 the work failed."""

from __future__ import annotations

import errno
import importlib.util
import json
import math
import re
import sys
import tempfile
import time
import warnings
from contextlib import closing, contextmanager
from dataclasses import asdict, replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from ..addon.library import inputs, presets
from ..addon.library.files import check_writable, is_plain, replacing, write_text
from ..addon.library.inputs import MOST_MEGABYTES, MOST_SAMPLES, MOST_SEED, MOST_WORKERS, InputError
from ..addon.reference.hybrid import BOUNDS, DEFAULT_BOUND
from ..addon.reference.keyframes import TOLERANCE
from ..batch.job import PREVIEW_SAMPLES, PREVIEW_SIZE, digest_of

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator, Sequence

    from ..addon.blender.material import Choice
    from ..addon.library.presets import Preset
    from ..batch.job import Task
    from ..batch.outcome import Outcome
    from ..lab.bench.record import Cell, Record

INTERRUPTED = 130  # exit code, as shells have it
LONGEST_LINE = 1000  # characters of what is said of an error
BROKEN_MACHINE = {errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.ENOMEM, errno.EMFILE}  # no fault of the input
T = TypeVar("T")
app = typer.Typer(add_completion=False, no_args_is_help=True, help=__doc__, rich_markup_mode=None)
out, err = Console(), Console(stderr=True)


class Backend(StrEnum):
    NODES = "nodes"
    OSL = "osl"


class Estimator(StrEnum):
    AUTO = "auto"
    FIT = "fit"
    CLOSURE = "closure"
    CORRECTED = "corrected"
    HYBRID = "hybrid"
    MIRROR = "mirror"
    DIRECT = "direct"


class Driving(StrEnum):
    CURVES = "curves"
    AGE = "age"


class Part(StrEnum):
    """Of a report."""

    ACCURACY = "accuracy"
    PICKS = "picks"
    STABILITY = "stability"
    LEFT_OUT = "left_out"
    EVERYDAY = "everyday"
    FIGURES = "figures"


def _whole(low: int, high: int) -> Callable[[Any], int]:
    """Reads a whole number of the command line."""
    return _option(lambda text: inputs.whole(text, low, high))


def _real(low: float = -math.inf, high: float = math.inf) -> Callable[[Any], float]:
    """Reads a number of the command line."""
    return _option(lambda text: inputs.real(text, low, high))


def _option(read: Callable[[str], T]) -> Callable[[Any], T]:
    def parsed(value: Any) -> T:  # a default is a number already
        try:
            return read(str(value))
        except InputError as error:
            raise typer.BadParameter(str(error)) from error

    return parsed


SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Change a parameter: m=0.2, eta=1.5, f0=0.9,0.6,0.5"),
]
BackendOption = Annotated[Backend, typer.Option(help="nodes: every device; osl: CPU and OptiX")]
BoundOption = Annotated[
    float,
    typer.Option(parser=_real(*BOUNDS), metavar="SHARE", help="hybrid: how much of the reflected light may be wrong"),
]
SamplesOption = Annotated[int, typer.Option(parser=_whole(1, MOST_SAMPLES), metavar="N", help="Samples a pixel")]
SeedOption = Annotated[int, typer.Option(parser=_whole(0, MOST_SEED), metavar="N", help="Of Cycles' random numbers")]
TimeOption = Annotated[
    float | None,
    typer.Option(
        "--time", parser=_real(), metavar="T", help="Time in the preset's own unit; for presets that change over time"
    ),
]


@app.command("presets")
def list_presets(
    query: Annotated[str, typer.Argument(help="Words to look for in id, name and tags")] = "",
    *,
    as_json: Annotated[
        bool, typer.Option("--json", help="A list of {id, name, family, model, parameters, source}")
    ] = False,
) -> None:
    """List the presets, yours too: those in the folder that VGROOVE_PRESETS names."""
    found = presets.search(query)
    for error in presets.refused():
        err.print(f"vgroove: left out: {error}", style="yellow", highlight=False, soft_wrap=True, markup=False)
    if as_json:
        print(json.dumps([_preset_json(preset) for preset in found], indent=1))
        return
    table = Table("id", "name", "parameters", "source")
    for preset in found:
        numbers = ", ".join(f"{key} {_plain(value)}" for key, value in preset.parameters.items())
        if preset.time:
            of = preset.time
            numbers += f"; changes from {of.start:g} to {of.end:g} {of.unit}: {', '.join(of.laws)}"
        table.add_row(preset.id, escape(preset.name), numbers, escape(preset.source["data"]))
    out.print(table)


@app.command()
def render(
    what: Annotated[
        str, typer.Argument(metavar="PRESET|SCENE.blend", help="A preset, shown on the preview scene, or a scene")
    ],
    output: Annotated[
        Path,
        typer.Option(
            "-o", "--output", metavar="FILE", help=".exr (linear, float) or .png; with --frames name_####.png"
        ),
    ],
    *,
    assign: Annotated[
        list[str] | None,
        typer.Option(
            metavar="OBJECT[:SLOT]=PRESET",
            help="Give an object of the scene a preset, or one of its material slots, by name or by number from 1",
        ),
    ] = None,
    settings: SetOption = None,
    backend: BackendOption = Backend.NODES,
    estimator: Annotated[
        Estimator, typer.Option(help="auto: closure or fit, whichever comes closer in this scene; see explain")
    ] = Estimator.AUTO,
    bound: BoundOption = DEFAULT_BOUND,
    at_time: TimeOption = None,
    frames: Annotated[
        str | None,
        typer.Option(
            metavar="A-B", help="A sequence; presets that change go from start to end. Frames that are there are kept"
        ),
    ] = None,
    driving: Annotated[
        Driving, typer.Option(help="with --frames: F-curves on the inputs, or one keyed Age within the material")
    ] = Driving.CURVES,
    tolerance: Annotated[
        float,
        typer.Option(
            parser=_real(),
            metavar="SHARE",
            help="with --frames: by how much of a parameter's range its keys may miss its law",
        ),
    ] = TOLERANCE,
    shutter: Annotated[
        float,
        typer.Option(
            parser=_real(0.0, 1.0),
            metavar="SHARE",
            help="with --frames: how much of a frame it is open, so that what changes within it is seen, materials too",
        ),
    ] = 0.0,
    strip: Annotated[
        Path | None, typer.Option(metavar="FILE.png", help="with --frames: a contact strip of the sequence")
    ] = None,
    movie: Annotated[
        Path | None, typer.Option(metavar="FILE", help="with --frames: a movie of the sequence, .mp4 or .webm")
    ] = None,
    fps: Annotated[int, typer.Option(parser=_whole(1, 240), metavar="N", help="Frames a second of the movie")] = 24,
    samples: Annotated[
        int | None,
        typer.Option(
            parser=_whole(1, MOST_SAMPLES),
            metavar="N",
            help="Samples a pixel; 128 for a preset, the scene's own for a .blend",
        ),
    ] = None,
    seed: SeedOption = 0,
    resolution: Annotated[
        str | None, typer.Option(metavar="WxH", help="640x480 for a preset, the scene's own for a .blend")
    ] = None,
) -> None:
    """Render a preset, or a .blend with presets assigned to its objects."""
    is_scene = what.endswith(".blend")
    span = _frames(frames, output)
    size = _resolution(resolution) if resolution is not None else None
    _check_outputs(output, strip, movie, span, at_time)
    if shutter and not span:
        message = f"--shutter {shutter:g}: goes with --frames, each of which it exposes"
        raise InputError(message)
    assigned = _assignments(assign or []) if is_scene else [("Ball", presets.find(what))]
    changed = _all_changed(assigned, settings, at_time)
    if is_scene and not Path(what).is_file():
        message = f"{what}: no such scene; name a .blend file"
        raise InputError(message)
    if assign and not is_scene:
        message = "--assign goes with a SCENE.blend; the preview scene shows the preset itself"
        raise InputError(message)
    _with_blender()
    from .. import headless
    from ..addon.blender import course as animation
    from ..headless import assignment, scene

    play = None
    if span:
        play = animation.Play(str(driving), float(span[0]), float(max(span[-1] - span[0], 1)), tolerance)
    with headless.quiet():
        shown = scene.opened(Path(what)) if is_scene else scene.preview()
        shown.cycles.samples = samples or (shown.cycles.samples if is_scene else PREVIEW_SAMPLES)
        advised = assignment.assign(shown, changed, str(backend), str(estimator), bound, play, where="--assign ")
    for text in advised:
        _say(f"warning: {text}")
    if not is_scene:
        size = size or PREVIEW_SIZE
    if not span:
        with headless.quiet():
            scene.still(shown, output, samples=samples, seed=seed, resolution=size)
        _say(f"wrote {output}")
        return
    source = digest_of(Path(what)) if is_scene else ""
    wanted = [
        what, source, [(name, asdict(preset)) for name, preset in changed], play and asdict(play), str(backend),
        str(estimator), bound, shown.cycles.samples, seed, size, shutter, _versions(),
    ]  # fmt: skip
    _sequence(shown, span, output, wanted, movie, shutter=shutter, samples=samples, seed=seed, resolution=size)
    paths = [_numbered(output, frame) for frame in span]
    if strip:
        with headless.quiet():
            _strip(paths, span, changed, strip)
        _say(f"wrote {strip}")
    if movie:
        from ..headless import sequence

        with headless.quiet():
            sequence.movie(paths, movie, fps)
        _say(f"wrote {movie}")


def _check_outputs(
    output: Path, strip: Path | None, movie: Path | None, span: Sequence[int], at_time: float | None
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
        _with_blender()
        from ..headless import sequence

        sequence.check_movie(movie)


def _all_changed(
    assigned: list[tuple[str, Preset]], settings: list[str] | None, at_time: float | None
) -> list[tuple[str, Preset]]:
    """Each preset with the settings, and at the time if it changes; one of them must."""
    if at_time is not None and not any(preset.time for _, preset in assigned):
        names = ", ".join(preset.id for _, preset in assigned) or "no preset"
        message = f"--time: {names} does not change over time; leave it out"
        raise InputError(message)
    return [(name, _changed(preset, settings, at_time if preset.time else None)) for name, preset in assigned]


def _sequence(shown: Any, span: Sequence[int], output: Path, wanted: Any, movie: Path | None, **settings: Any) -> None:
    from .. import headless
    from ..headless import scene, sequence

    if movie is not None:
        sequence.check_size(settings["resolution"] or scene.size(shown))
    if not scene.remembers(shown):
        shown.render.use_persistent_data = True  # Cycles is given only what changes from frame to frame
    kept, note = 0, sequence.note(wanted)
    for frame in _progress(span, "rendering", len(span)):
        with headless.quiet():
            kept += sequence.frame_to(shown, frame, _numbered(output, frame), note, **settings)
    left = f", {kept} of them there already" if kept else ""
    _say(f"wrote {len(span)} frames, {output}{left}")


def _strip(paths: list[Path], span: Sequence[int], changed: list[tuple[str, Preset]], output: Path) -> None:
    """A contact strip, labelled by the time of the first preset that changes, or by frame."""
    from ..headless import sequence

    moved = next((preset for _, preset in changed if preset.time), None)
    labels = [f"frame {frame}" for frame in span]
    if moved and moved.time:
        ages = [(frame - span[0]) / max(span[-1] - span[0], 1) for frame in span]
        unit = "of its course" if moved.time.unit == "share" else moved.time.unit
        labels = [f"{time:.3g} {unit}" for time in moved.trajectory().time(ages)]
    sequence.strip(paths, labels, output)


@app.command()
def measure(
    name: Annotated[str, typer.Argument(metavar="PRESET")],
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE.exr", help="float32 EXR, channels R G B, f in 1/sr")
    ],
    *,
    settings: SetOption = None,
    theta_i: Annotated[
        float | None, typer.Option(parser=_real(0.0, 89.99), metavar="DEG", help="Angle of the sun from the normal")
    ] = None,
    sun_angle: Annotated[
        float,
        typer.Option(parser=_real(0.0, 90.0), metavar="DEG", help="Full angle of the sun's disc; mirror needs one"),
    ] = 0.0,
    furnace: Annotated[bool, typer.Option(help="Directional albedo under a uniform white world")] = False,
    window: Annotated[
        float,
        typer.Option(
            parser=_real(0.0, 45.0), metavar="DEG", help="Half width around the mirror direction; 0: hemisphere"
        ),
    ] = 0.0,
    at_time: TimeOption = None,
    resolution: Annotated[str, typer.Option(metavar="WxH")] = "64x64",
    samples: SamplesOption = 1,
    seed: SeedOption = 0,
    backend: BackendOption = Backend.NODES,
    estimator: Annotated[
        Estimator, typer.Option(help="auto: mirror for a sun with an angle or a furnace, else direct (glass: closure)")
    ] = Estimator.AUTO,
    bound: BoundOption = DEFAULT_BOUND,
) -> None:
    """Measure a preset's BRDF in Cycles with the virtual gonioreflectometer."""
    preset = _changed(presets.find(name), settings, at_time)
    size = _resolution(resolution)
    if (theta_i is None) != furnace:
        message = "give either --theta-i DEG or --furnace"
        raise InputError(message)
    if furnace and (window or sun_angle):
        message = "--furnace has no sun: leave --window and --sun-angle out"
        raise InputError(message)
    if output.suffix.lower() != ".exr":
        message = f"{output}: measurements are EXR files; name one that ends in .exr"
        raise InputError(message)
    extended = furnace or sun_angle > 0
    if estimator == Estimator.MIRROR and not extended:
        message = "mirror does not see a sun of zero size; give --sun-angle DEG or --furnace"
        raise InputError(message)
    if estimator == Estimator.DIRECT and furnace:
        message = "direct sees lamps alone, not the world of --furnace; give --theta-i DEG, or choose mirror"
        raise InputError(message)
    if estimator == Estimator.AUTO:
        exact = Estimator.CLOSURE if preset.transparent else Estimator.DIRECT
        estimator = Estimator.MIRROR if extended else exact
    check_writable(output)
    _with_blender()
    from .. import headless
    from ..addon.blender import gonio, images

    geometry = gonio.Geometry(theta_i or 0.0, window, size, sun_angle, furnace)
    start = time.perf_counter()
    with headless.quiet():
        image = gonio.measure_preset(
            preset,
            backend,
            estimator,
            geometry,
            samples=samples,
            seed=seed,
            shading_osl=backend == Backend.OSL,
            bound=bound,
        )
    seconds = time.perf_counter() - start
    attributes = {
        "vgroove:preset": preset.id, "vgroove:parameters": json.dumps(preset.parameters),
        "vgroove:estimator": str(estimator),
        "vgroove:backend": str(backend), "vgroove:samples": samples, "vgroove:seed": seed, "vgroove:seconds": seconds,
        "vgroove:geometry": json.dumps(asdict(geometry)), "vgroove:versions": json.dumps(_versions()),
    }  # fmt: skip
    with replacing(output) as temporary:
        images.write(temporary, image, attributes)
    _say(f"wrote {output}")


@app.command()
def explain(
    name: Annotated[str, typer.Argument(metavar="PRESET")],
    *,
    settings: SetOption = None,
    in_scene: Annotated[
        Path | None, typer.Option("--scene", metavar="SCENE.blend", help="Explain for this scene, not the preview's")
    ] = None,
    backend: BackendOption = Backend.NODES,
    estimator: Annotated[Estimator, typer.Option(help="auto: by what the scene holds")] = Estimator.AUTO,
    samples: Annotated[
        int | None,
        typer.Option(parser=_whole(1, MOST_SAMPLES), metavar="N", help="Samples a pixel, if not the scene's own"),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="{material, estimator, backend, lines, size, advice} in place of tables")
    ] = False,
) -> None:
    """Say what a preset's material is built of in a scene, what was left out and why, and how much that saves."""
    preset = _changed(presets.find(name), settings, None)
    if in_scene is not None and not in_scene.is_file():
        message = f"{in_scene}: no such scene; name a .blend file"
        raise InputError(message)
    _with_blender()
    from .. import headless
    from ..addon.choose import advice
    from ..addon.choose import explain as explaining
    from ..headless import scene
    from ..lab.bench import universal

    with headless.quiet():
        shown = scene.opened(in_scene) if in_scene else scene.preview()
        shown.cycles.samples = samples or (shown.cycles.samples if in_scene else PREVIEW_SAMPLES)
        account = explaining.explain(preset, shown, str(backend), str(estimator))
        advised = [problem.text for problem in advice.problems_with(shown, preset, str(backend), account.estimator)]
        made = {"built": account.material, "universal": universal.build(account.choice)}
    size = {which: asdict(explaining.size_of(of)) for which, of in made.items()}
    if as_json:
        said = {"material": account.material.name, "estimator": account.estimator, "backend": str(backend)}
        print(json.dumps(said | {"lines": [asdict(line) for line in account.lines], "size": size, "advice": advised}))
        return
    for title, kept in ((account.material.name, True), ("left out", False)):
        table = Table(title, "why")
        for line in account.lines:
            if line.kept == kept:
                table.add_row(line.what, line.why)
        out.print(table)
    table = Table("", "as built", "universal", caption=_universal_caption(account.choice))
    for what, label in (("nodes", "nodes"), ("instructions", "OSL instructions")):
        if size["universal"][what]:
            table.add_row(label, *(str(of[what]) for of in size.values()))
    out.print(table)
    for text in advised:
        out.print(f"advice: {text}", highlight=False, markup=False)


def _universal_caption(choice: Choice) -> str:
    """What the universal material can do in place of the one that was built by ``choice``."""
    from ..lab.bench import universal

    said = "universal: one material whose inputs show any preset, but for absorption"
    if terms := universal.form_of(choice).lamps:
        said += f", with terms of {terms} lamps"
    if choice.backend == Backend.NODES and not universal.fits():
        said += "; does not fit in this Blender"
    return said + ". Times and memory: docs/report.md"


@app.command()
def batch(
    file: Annotated[Path, typer.Argument(metavar="JOB.toml", help="Tables [[render]]; see docs/batch.md")],
    output: Annotated[Path, typer.Option("-o", "--output", metavar="DIR", help="Made if it is not there")],
    *,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Say what would be rendered, and render nothing")] = False,
    part: Annotated[
        str | None, typer.Option("--tasks", metavar="A-B", help="Only these tasks, as --dry-run numbers them")
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            parser=_whole(1, MOST_WORKERS), metavar="N", help="Processes; by default one a core, as far as memory goes"
        ),
    ] = None,
    timeout: Annotated[
        float | None, typer.Option(parser=_real(1.0), metavar="S", help="Seconds that a task may take")
    ] = None,
    memory: Annotated[
        int | None,
        typer.Option(
            parser=_whole(256, MOST_MEGABYTES),
            metavar="MB",
            help="That a process may take; by default a share of what is free",
        ),
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Of a Dask scheduler, whose workers render: tcp://farm:8786")
    ] = None,
    openjd_file: Annotated[
        Path | None,
        typer.Option("--openjd", metavar="FILE", help="Write an Open Job Description template, and render nothing"),
    ] = None,
) -> None:
    """Render every task of a job file, each to a file of its own name; what is there and whole is kept."""
    from ..batch import job, openjd, results

    if openjd_file is not None and (dry_run or cluster is not None):
        message = "--openjd writes a template and renders nothing; leave --cluster and --dry-run out"
        raise InputError(message)
    first, tasks = _part(job.load(file), part)
    if openjd_file is not None:
        openjd.write(openjd_file, file, output, tasks, first)
        _say(f"wrote {openjd_file}, a template of {len(tasks)} tasks")
        return
    from ..batch import pool

    limit = pool.limits(
        len(tasks), workers, memory * 10**6 if memory else None, timeout=math.inf if timeout is None else timeout
    )
    versions, output = _versions(), output.absolute()  # other machines have other current folders
    if dry_run:
        named = {task.identity(versions): task for task in tasks}
        seconds = results.read_seconds(output)
        before = {
            name: seconds[name]
            for name, task in named.items()
            if name in seconds and all((output / f"{name}.{kind}").is_file() for kind in task.outputs)
        }
        out.print(results.plan(tasks, first))
        out.print(results.demand(tasks), highlight=False)
        out.print(results.estimate(named, before, limit.workers, limit.threads), highlight=False, soft_wrap=True)
        return
    table = output / (results.FILE if part is None else f"results-{part}.csv")  # parts may be done at once
    if cluster is None:
        _make(table)
        _batch(tasks, table, versions, pool.outcomes(tasks, output, versions, limit), f"rendering by {limit.workers}")
        return
    from ..batch import cluster as dask

    with dask.connected(cluster) as client:
        _make(table)
        if memory is None:  # that is for each machine to say
            limit = replace(limit, memory=0)
        _batch(tasks, table, versions, dask.outcomes(tasks, output, versions, limit, client), f"rendering by {cluster}")


def _make(table: Path) -> None:
    """The folder of a batch."""
    try:
        table.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{table.parent}: cannot be made: {error.strerror}; choose another with -o"
        raise InputError(message) from error
    check_writable(table)


def _part(tasks: list[Task], part: str | None) -> tuple[int, list[Task]]:
    """The tasks A to B, from 1, or the one A, of text "A-B" or "A"; the number of the first, and they."""
    if part is None:
        return 1, tasks
    found = re.fullmatch(r"([0-9]{1,7})(?:-([0-9]{1,7}))?", part)
    first, last = (int(found[1]), int(found[2] or found[1])) if found else (0, 0)
    if not 1 <= first <= last <= len(tasks):
        message = f'--tasks "{part}": write A-B, from 1-{len(tasks)}: the job has {len(tasks)} tasks'
        raise InputError(message)
    return first, tasks[first - 1 : last]


def _batch(
    tasks: Sequence[Task], table: Path, versions: dict[str, str], outcomes: Generator[Outcome], label: str
) -> None:
    """Follow a batch to its end, and say what became of it. RuntimeError if a task failed, or the folder."""
    from ..batch import results

    named = {task.identity(versions): task for task in tasks}
    found: dict[str, Outcome] = {}
    try:
        with closing(outcomes):
            for outcome in _progress(outcomes, label, len(tasks)):
                found[outcome.name] = outcome
        results.write(table, named, found)
    except OSError as error:  # the input was fine
        results.keep(table, named, found)
        raise RuntimeError(str(error)) from error
    except BaseException:
        results.keep(table, named, found)
        raise
    failed = [one for one in found.values() if one.status == "failed"]
    kept = sum(one.status == "there" for one in found.values())
    out.print(results.summary(list(found.values())))
    if failed:
        out.print(results.failures(named, failed))
    left = f", {kept} of them there already" if kept else ""
    _say(f"wrote {len(found) - len(failed)} stills to {table.parent}{left}")
    if failed:
        message = f"{len(failed)} of {len(tasks)} tasks failed: {failed[0].reason}"
        if len({one.reason for one in failed}) > 1:
            message += f"; {table} has all reasons"
        raise RuntimeError(message)


@app.command()
def gallery(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Of stills that `batch` rendered")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="If not gallery.html in the folder")
    ] = None,
) -> None:
    """Make a page of a folder of stills: thumbnails, what each shows, and a filter."""
    if not folder.is_dir():
        message = f"{folder}: no such folder; name one that `vgroove batch` rendered to"
        raise InputError(message)
    _with_blender()
    from .. import headless
    from ..batch import gallery as page

    path = output or folder / page.FILE
    check_writable(path)
    found = page.stills(folder)
    if not found:
        message = f"{folder}: holds no stills of `vgroove batch`"
        raise InputError(message)
    with headless.quiet():
        page.write_page(path, folder, _progress(found, "drawing", len(found)), len(found))
    _say(f"wrote {path} of {len(found)} stills")


@app.command()
def check(
    *,
    json_file: Annotated[Path | None, typer.Option("--json", metavar="FILE", help="Every row as JSON")] = None,
    quick: Annotated[bool, typer.Option(help="One row of a kind, to see that the instrument works")] = False,
) -> None:
    """Hold Cycles against the NumPy reference: every model x estimator x backend. Exits 1 if a row fails."""
    if json_file is not None:
        check_writable(json_file)
    _with_blender()
    from ..lab.check import plan as check_all

    plan = check_all.quick_plan() if quick else check_all.plan()
    rows = [measure_row(*arguments) for measure_row, arguments in _progress(plan, "measuring", len(plan))]
    table = Table("estimator", "run as", "Fresnel", "m", "worst", "bar", "resolves", "")
    for row in rows:
        worst, bar = (f"{row.error:.2%}", f"{row.bar:.2%}") if row.is_noisy else (f"{row.error:.1e}", f"{row.bar:.1e}")
        table.add_row(
            row.test,
            str(row.setup),
            row.fresnel,
            f"{row.m:g}",
            worst,
            bar,
            f"{row.resolves:.1e}",
            "ok" if row.passed else "FAILED",
        )
    out.print(table)
    failed = sum(not row.passed for row in rows)
    out.print(f"{len(rows) - failed} rows passed, {failed} failed; Blender {_versions()['blender']}", highlight=False)
    if json_file is not None:
        content = {"versions": _versions(), "rows": [row.as_json() for row in rows]}
        write_text(json_file, json.dumps(content, indent=1))
    if failed:
        raise typer.Exit(1)


@app.command()
def report(
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="DIR", help="Made if it is not there; what it has measured is kept"),
    ] = None,
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="A few minutes instead of an hour: less of everything")
    ] = False,
    again: Annotated[
        list[Part] | None, typer.Option("--again", help="Measure this part anew; as often as there are parts")
    ] = None,
    source: Annotated[
        Path | None, typer.Option("--from", metavar="REPORT.json", help="Draw anew, and render nothing")
    ] = None,
    documents: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="With --from: write its figures into README.md and docs/*.md of this checkout"
        ),
    ] = None,
    compare: Annotated[
        tuple[Path, Path] | None,
        typer.Option(
            metavar="A.json B.json", help="Say what is better or worse in B. Exits 1 if anything is worse or gone"
        ),
    ] = None,
) -> None:
    """Measure error against run time, stability, and what was left out; draw plots and a page. Resumes.

    Exits 1 if a full report does not show what it must.
    """
    if compare is not None:
        if output or source or quick or again:
            message = "--compare reads two reports and writes none; leave -o, --from, --quick and --again out"
            raise InputError(message)
        _compare(*compare)
        return
    if source is not None:
        if quick or again:
            message = "--from draws what is measured; --quick and --again say what to measure: leave them out"
            raise InputError(message)
        _needs("matplotlib")
        if documents:
            _document(source, documents)
        _draw(source, output or source.absolute().parent)
        return
    if documents:
        message = "--documents writes what --from names; give --from REPORT.json"
        raise InputError(message)
    if output is None:
        message = "give -o DIR to measure, --from REPORT.json to draw anew, or --compare A.json B.json"
        raise InputError(message)
    _needs("matplotlib", "flip_evaluator", "mitsuba")
    from ..lab.bench import record

    file = output / record.FILE
    _make(file)
    kept = record.open_or_create(file, _versions()["blender"], quick=quick, again=[str(part) for part in again or ()])
    failed = _measured(kept, output, quick=quick)
    _draw(file, output, failed)


def _measured(kept: Record, folder: Path, *, quick: bool) -> list[str]:
    """Measure what a report lacks; the keys of the measurements that failed."""
    _with_blender()
    from ..lab.bench import run

    failed = []
    wanted = run.cells(quick=quick, more=_cost_of_batch(quick=quick))
    missing = run.missing(kept, wanted)
    kept.run.wanted = len(wanted)
    if done := len(wanted) - len(missing):
        _say(f"{done} of {len(wanted)} measurements are there already")
    try:
        for cell, reason in _progress(run.measure(kept, missing, folder), "measuring", len(missing)):
            if reason:
                failed.append(cell.key)
                _say(f"vgroove: {cell.key}: {reason}")
    except KeyboardInterrupt:
        _say(f"{len(wanted) - len(run.missing(kept, wanted))} of {len(wanted)} measurements are kept in {kept.path}")
        raise
    return failed


def _cost_of_batch(*, quick: bool) -> list[Cell]:
    """What ``vgroove batch`` costs, for docs/batch.md: the laboratory does not know it."""
    from ..batch import cost
    from ..lab.bench.cells import Table
    from ..lab.bench.record import Cell

    cell = Cell("figures/batch", lambda _folder: {"cost": Table(["what", "value"], cost.rows())})
    return [] if quick else [cell]


def _document(source: Path, folder: Path) -> None:
    from ..lab.bench import record
    from ..lab.report import documents, draw, published

    with _reading(source):
        report = record.read(source)
        for path in documents.write(folder, published.publish(report)):
            _say(f"wrote {path}")
        draw.plot(report, folder / "docs")


def _draw(source: Path, folder: Path, failed: Sequence[str] = ()) -> None:
    """The plots, page and text of a report.json. Exits 1 if a claim does not hold, in full, not by a quick one.

    failed: measurements that failed, which is said first of all: RuntimeError, once all is drawn.
    """
    from ..lab.bench import record
    from ..lab.report import claims, draw, findings, summary

    with _reading(source):
        report = record.read(source)
        found = findings.runs(report)
    pictures = None
    if importlib.util.find_spec("bpy"):
        _with_blender()
        pictures = source.parent
    else:
        _say("bpy is not installed, so the page has no pictures")
    with _reading(source):
        broken = [(run, claim) for run in found for claim in claims.of(run) if not claim.holds]
        _make(folder / record.FILE)
        for path in draw.draw(report, pictures, folder):
            _say(f"wrote {path}")
        for run, claim in broken:
            _say(f"{summary.title(run.blender, quick=run.quick, lacks=run.lacks)}: {claim.text}")
    if failed:
        message = f"{len(failed)} measurements failed, {failed[0]} first; give the command again"
        raise RuntimeError(message)
    if not all(run.quick for run, _ in broken):
        raise typer.Exit(1)


def _compare(before: Path, after: Path) -> None:
    from ..lab.bench import record
    from ..lab.report import compare, findings

    with _reading(before, after):
        found, count = compare.changes(*(findings.runs(record.read(path)) for path in (before, after)))
    verdicts = {True: "WORSE", False: "better", None: "new"}
    table = Table("Blender", "where", "what", "figure", "before", "after", "")
    for one in found:
        words = [one.blender, one.where, one.who, one.what, one.before, one.after]
        table.add_row(*(escape(word) for word in words), verdicts[one.worse])
    if found:
        out.print(table)
    worse, better = (sum(one.worse is verdict for one in found) for verdict in (True, False))
    out.print(f"{worse} worse, {better} better, of {count} figures that both have", highlight=False)
    if worse:
        raise typer.Exit(1)


@contextmanager
def _reading(*sources: Path) -> Iterator[None]:
    """ReportError for whatever a damaged report leads to: its numbers are used in a hundred places."""
    from ..lab.bench.record import ReportError

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)  # a square root of -1, or a mean of nothing
            yield
    except (OSError, MemoryError, InputError, ReportError):
        raise
    except Exception as error:
        message = f"{' or '.join(map(str, sources))}: not as this vgroove writes it"
        message += f" ({type(error).__name__}: {error}); measure again"
        raise ReportError(message) from error


def _needs(*names: str) -> None:
    """InputError, before any work, if a module of the extra [report] is missing."""
    gone = [name for name in names if importlib.util.find_spec(name) is None]
    if gone:
        message = f"report needs {' and '.join(gone)}; install them with: pip install 'vgroove[report]'"
        raise InputError(message)


def main() -> None:
    """Entry of the ``vgroove`` command; turns every expected failure into one line and its exit code."""
    for stream in (sys.stdout, sys.stderr):  # a terminal that has no letter for something shows its number
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    sys.exit(_run(lambda: app(prog_name="vgroove", standalone_mode=False)))


def _run(command: Callable[[], Any]) -> int:
    try:
        code = command() or 0
        sys.stdout.flush()
        return _fail("interrupted", INTERRUPTED) if code == INTERRUPTED else code  # typer keeps the exception to itself
    except (typer.Abort, KeyboardInterrupt):
        return _fail("interrupted", INTERRUPTED)
    except MemoryError:
        return _fail("out of memory; choose a smaller --resolution, or fewer --workers", 3)
    except Exception as error:
        code = _exit_code(error)
        if not code:
            raise
        return _fail(error.format_message() if hasattr(error, "format_message") else str(error), code)


def _exit_code(error: Exception) -> int:
    """The exit code of a failure that is expected; 0 for others, which are faults of ours."""
    if isinstance(error, OSError):
        return 3 if error.errno in BROKEN_MACHINE else 2
    if isinstance(error, InputError) or hasattr(error, "format_message"):  # a usage error of the parser
        return 2
    if type(error).__name__ in {
        "ClusterError",
        "MaterialError",
        "AnimationError",
        "SceneError",
        "OslError",
        "ReportError",
    }:  # their modules need Blender
        return 2
    return 3 if isinstance(error, RuntimeError) else 0  # from Blender itself


def _say(text: str) -> None:
    err.print(_line(text), highlight=False, markup=False, soft_wrap=True)


def _fail(text: str, code: int) -> int:
    text = _line(text)
    _say("vgroove: " + (text if len(text) <= LONGEST_LINE else f"{text[: LONGEST_LINE - 4]} ..."))
    return code


def _line(text: str) -> str:
    """One line, without what would steer a terminal."""
    return "".join(c if c.isprintable() or "\ud800" <= c <= "\udfff" else "?" for c in " ".join(text.split()))


def _progress(items: Iterable[Any], label: str, count: int) -> Iterator[Any]:
    """The items, with a progress bar when stderr is a terminal and a plain line now and then otherwise."""
    if not err.is_terminal:
        step = max(1, min(20, count // 10))
        for index, item in enumerate(items):
            if index % step == 0:
                err.print(f"{label} {index}/{count}", highlight=False)
            yield item
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=err) as progress:
        yield from progress.track(items, total=count, description=label)


def _with_blender() -> None:
    from .. import headless

    folder = Path(tempfile.gettempdir())
    if not is_plain(folder):
        message = f"{folder}: Blender misreads the name of this temporary folder; have TMPDIR name a plainer one"
        raise InputError(message)
    try:
        headless.prepare()
    except ImportError as error:
        raise InputError(str(error)) from error
    from ..nodegroups import versions

    if text := versions.untested():
        err.print(f"vgroove: {text}", style="yellow", highlight=False, soft_wrap=True, markup=False)


def _versions() -> dict[str, str]:
    from importlib.metadata import version

    return {"vgroove": version("vgroove"), "blender": version("bpy")}


def _preset_json(preset: Preset) -> dict[str, Any]:
    return {
        "id": preset.id, "name": preset.name, "family": preset.family, "model": preset.model,
        "parameters": preset.parameters, "source": preset.source,
    } | ({"time": asdict(preset.time)} if preset.time else {})  # fmt: skip


def _plain(value: float | tuple[float, ...]) -> str:
    return " ".join(f"{part:g}" for part in value) if isinstance(value, tuple) else f"{value:g}"


def _changed(preset: Preset, settings: list[str] | None, at_time: float | None) -> Preset:
    if at_time is not None:
        if preset.time is None:
            message = f"--time: preset {preset.id} does not change over time; leave it out"
            raise InputError(message)
        preset = preset.at(at_time)
    changes: dict[str, Any] = {}
    for item in settings or []:
        name, equals, text = item.partition("=")
        try:
            values = [inputs.real(part.strip()) for part in text.split(",")]
        except InputError:
            equals = ""
        if not equals:
            message = f'--set "{item}": write NAME=NUMBER or NAME=R,G,B, as in m=0.2 or f0=0.9,0.6,0.5'
            raise InputError(message)
        changes[name] = values[0] if len(values) == 1 else values
    return preset.with_parameters(**changes)


def _assignments(items: list[str]) -> list[tuple[str, Preset]]:
    """Objects, or objects and slots, with the preset of each. A preset's id has no "=", so the last one divides."""
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


def _resolution(text: str) -> tuple[int, int]:
    try:
        return inputs.size(text)
    except InputError as error:
        message = f'resolution "{text}": {error}'
        raise InputError(message) from error


def _frames(text: str | None, output: Path) -> range:
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


def _numbered(output: Path, frame: int) -> Path:
    return output.with_name(re.sub("#+", lambda marks: f"{frame:0{len(marks[0])}d}", output.name, count=1))
