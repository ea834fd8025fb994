# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks rendered by this process's Blender, which stays open between them."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
import threading
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import bpy

from ..addon.blender.images import MIN_FREE_BYTES, attribute, digest, digest_of_values, load, save
from ..addon.library.errors import InputError
from ..headless import OVERFLOWED, assignment, memory, scene, stack_overflows
from ..headless.sequence import SEED_STEP, is_done
from ..nodegroups import versions as blenders
from .job import digest_of
from .mean import Mean
from .outcome import RECORD, Outcome, read_record

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import numpy as np
    from bpy.types import Material, Scene
    from numpy.typing import NDArray

    from .job import Task

FIRST, GROWTH = 16, 4  # samples of a picture towards an error, and how much each may add to all before
LONGEST = 2**16  # samples at which the way to an error ends


class Renderer:
    """Renders tasks one after another. A scene is opened once as long as tasks want the same one.

    versions: of what renders, part of each task's name. threads: that Cycles may use; 0 for one a core.
    """

    def __init__(self, folder: Path, versions: Mapping[str, str], threads: int = 0) -> None:
        self.folder, self.versions, self.threads = folder, dict(versions), threads
        self.writing = threading.Lock()  # held while files are half written
        self._wanted: object = None  # what the open scene was opened for
        self._own = 0, 0, (0, 0)  # frame, samples and resolution that its file has
        self._frame: int | None = None  # the one that it must not leave
        self._materials: dict[str, Material] = {}  # of the tasks, by object
        self._outside: dict[str, str] = {}  # files that it reads, as from its folder, and the digest of each

    def attempt(self, task: Task) -> Outcome:
        """``render``, or why it could not be. OSError still ends the work: a full disk fails every task."""
        start = time.perf_counter()
        try:
            return self.render(task)
        except OSError:
            raise
        except Exception as error:  # noqa: BLE001 - whatever a scene may hold, the rest goes on
            self._wanted = None  # whatever state the scene is in now
            _check_disk(Path(tempfile.gettempdir()))
            reason = " ".join(str(error).split()) or type(error).__name__
            # Bad input stays bad; what Blender itself stumbled over may go well another time.
            status = "failed" if isinstance(error, InputError) else "stumbled"
            return Outcome(task.identity(self.versions), status, time.perf_counter() - start, reason=reason)

    def render(self, task: Task) -> Outcome:
        """The task's files in the folder, each whole or not at all; those that are there and whole are kept."""
        name = task.identity(self.versions)
        paths = [self.folder / f"{name}.{ending}" for ending in task.outputs]
        exact = self.folder / f"{name}.exr"
        missing = [path for path in paths if self._record(path, name, task) is None]
        record = self._record(exact if missing else paths[0], name, task)
        if record is not None:
            if missing:  # an earlier job wanted no PNG
                self._save(missing, load(exact), self._scene(task), name, attribute(exact, RECORD))
            return replace(record["outcome"], status="there")
        start = time.perf_counter()
        memory.reset_peak()
        shown = self._scene(task)
        frame, samples, resolution = self._own
        shown.frame_set(frame if task.frame is None else task.frame)
        said = assignment.assign(
            shown, sorted(task.assignments), task.backend, task.estimator, task.bound, disperses=task.dispersion,
            bounces=task.multiple_scattering, into=self._materials,
        )  # fmt: skip
        began = time.perf_counter()
        size = task.resolution or resolution
        means: list[Mean] = []
        overflowed = stack_overflows(lambda: means.append(_mean(shown, task, samples, size)))
        rendered, (mean,) = time.perf_counter(), means
        absent = ", ".join(file for file, known in self._outside.items() if not known)
        notes = [f"without files that are missing: {absent}"] if absent else []
        notes += [OVERFLOWED] if overflowed else []
        outcome = Outcome(
            name, "rendered", rendered - start, rendered - began, mean.samples, mean.error, memory.peak(),
            "; ".join(filter(None, [*notes, *said, blenders.untested()])),
        )  # fmt: skip
        picture = mean.picture
        text = json.dumps({
            "outcome": outcome.as_json(), "labels": dict(task.labels), "task": task.content(),
            "versions": self.versions, "files": self._outside, "pixels": digest_of_values(picture),
        })  # fmt: skip
        self._save(paths, picture, shown, name, text)
        return outcome

    def _save(self, paths: Iterable[Path], picture: NDArray[np.float32], shown: Scene, name: str, record: str) -> None:
        with self.writing:
            for path in paths:
                save(path, picture, shown, {"Note": _note(name), RECORD: record})

    def _record(self, path: Path, name: str, task: Task) -> dict[str, Any] | None:
        """The record of a picture if it is the task's, whole, and what its scene reads from other files is the same."""
        record = read_record(attribute(path, RECORD)) if path.is_file() else None
        if record is None or record["outcome"].name != name:
            return None
        if not (digest(path) == record.get("pixels") if path.suffix == ".exr" else is_done(path, _note(name))):
            return None
        folder = Path(task.scene).parent
        same = all(digest_of(folder / file) == known for file, known in record["files"].items())
        return record if same else None

    def _leaves_frame(self, task: Task) -> bool:
        frame = self._own[0] if task.frame is None else task.frame
        return self._frame is not None and frame != self._frame

    def _scene(self, task: Task) -> Scene:
        """The task's scene, as its file has it but for the objects that the task gives materials to."""
        wanted = task.place
        if wanted != self._wanted or self._leaves_frame(task):
            self._wanted = None  # nothing, should opening fail
            shown = _opened(task) if task.digest else scene.preview()
            _leave_out(shown)
            render = shown.render
            render.use_persistent_data = True  # only what changes from task to task is given to Cycles anew
            render.threads_mode, render.threads = ("FIXED", self.threads) if self.threads else ("AUTO", 1)
            self._wanted, self._own = wanted, (shown.frame_current, shown.cycles.samples, scene.size(shown))
            frame = shown.frame_current if task.frame is None else task.frame
            self._frame = frame if scene.remembers(shown) else None
            self._materials, self._outside = {}, _files_outside(Path(task.scene)) if task.digest else {}
        return bpy.context.scene


def _note(name: str) -> str:
    return f"vgroove {name}"


def _opened(task: Task) -> Scene:
    found = digest_of(Path(task.scene))
    if found != task.digest:
        what = "has changed since the job was read; give the same command again" if found else "cannot be read here"
        message = f"{task.scene}: {what}"
        raise scene.SceneError(message)
    return scene.open_file(Path(task.scene))


def _files_outside(blend: Path) -> dict[str, str]:
    """What the open .blend reads from other files, as textures and libraries: as from its folder, with digests.

    The digest of a file that is missing is empty.
    """
    named = {Path(bpy.path.abspath(path)) for path in bpy.utils.blend_paths(absolute=True, packed=False)}
    for image in bpy.data.images:
        if image.source in {"TILED", "SEQUENCE"} and image.filepath and not image.packed_file:
            path = Path(bpy.path.abspath(image.filepath, library=image.library))
            digits = re.compile(r"<UDIM>|<UVTILE>|\d+(?=\D*$)")
            named.discard(path)
            named |= set(path.parent.glob(digits.sub("*", path.name)))
    own = scene.blender_folders()  # whose content the version names
    found = [path for path in sorted(named) if path != blend and not any(map(path.is_relative_to, own))]
    return {os.path.relpath(path, blend.parent): digest_of(path) for path in found}


def _obstacle(shown: Scene) -> str:
    """What of a scene keeps the mean of pictures of few samples from being the picture of many; empty if nothing."""
    cycles, render = shown.cycles, shown.render
    found = {
        "denoises": cycles.use_denoising,
        "stops pixels at a noise threshold": cycles.use_adaptive_sampling,
        "renders a subset of its samples": cycles.use_sample_subset,
        "has a compositor": scene.composites(shown),
        "has strips in its sequencer": render.use_sequencer and scene.has_strips(shown),
        "guides its paths": cycles.use_guiding,
    }
    return next((what for what, is_so in found.items() if is_so), "")


def _mean(shown: Scene, task: Task, samples: int, size: tuple[int, int]) -> Mean:
    """The task's picture. samples, size: where the task has none of its own."""
    if task.error is None:
        return _of_samples(shown, task.samples or samples, task.seed, size)
    return _to_error(shown, task.error, task.seed, size)


def _of_samples(shown: Scene, samples: int, seed: int, resolution: tuple[int, int]) -> Mean:
    """A picture of so many samples, in two halves of one sequence, whose difference tells its error.

    Their mean is the whole picture but for rounding. Where there is an ``_obstacle`` it is rendered whole.
    """
    mean, cycles = Mean(), shown.cycles
    if samples == 1 or _obstacle(shown):
        mean.add(_picture(shown, samples, seed, resolution), samples)
        return mean
    cycles.use_sample_subset = True
    try:
        for start, end in ((0, samples // 2), (samples // 2, samples)):
            cycles.sample_offset, cycles.sample_subset_length = start, end - start
            mean.add(_picture(shown, samples, seed, resolution), end - start)
    finally:
        cycles.use_sample_subset = False
    return mean


def _to_error(shown: Scene, error: float, seed: int, resolution: tuple[int, int]) -> Mean:
    """Pictures of seeds of their own until noise leaves no more than ``error``, or of ``LONGEST`` samples."""
    if obstacle := _obstacle(shown):
        message = f'scene "{shown.name}" {obstacle}, so that its error cannot be told; switch that off in it'
        message += ", or give samples in place of error"
        raise scene.SceneError(message)
    mean, number, samples = Mean(), 0, FIRST
    while number < 2 or (mean.error > error and mean.samples < LONGEST):
        mean.add(_picture(shown, samples, (seed + number * SEED_STEP) % 2**31, resolution), samples)
        number += 1
        if number > 1 and mean.error > error:
            missing = mean.samples * ((mean.error / error) ** 2 - 1.0)  # the error falls with the root of samples
            samples = int(min(max(missing, FIRST), GROWTH * mean.samples, LONGEST - mean.samples)) or 1
    return mean


def _picture(shown: Scene, samples: int, seed: int, resolution: tuple[int, int]) -> NDArray[np.float32]:
    with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
        path = Path(folder) / "task.exr"
        try:
            scene.still(shown, path, samples=samples, seed=seed, resolution=resolution)
        except FileNotFoundError as error:  # not of our folder
            message = "Blender rendered no picture"
            raise RuntimeError(message) from error
        return load(path)


def _leave_out(shown: Scene) -> None:
    """What would make a picture another one each time, and passes that nothing uses beside the picture itself."""
    shown.cycles.time_limit = 0.0
    if scene.composites(shown):  # which may make something of the passes
        return
    for layer in shown.view_layers:
        for owner in (layer, layer.cycles):
            for item in owner.bl_rna.properties:
                if item.type == "BOOLEAN" and item.identifier.startswith(("use_pass_", "pass_", "denoising_store")):
                    setattr(owner, item.identifier, item.identifier == "use_pass_combined")


def _check_disk(folder: Path) -> None:
    """OSError where there is no room for a picture, which Blender's own errors do not always say."""
    if shutil.disk_usage(folder).free < MIN_FREE_BYTES:
        message = f"{folder}: the disk is full; make room and give the same command again"
        raise OSError(message)
