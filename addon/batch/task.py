# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks rendered by this process's Blender, which stays open between them."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import bpy

from ...nodegroups.osl_script import OslError
from .. import scene
from ..images import load, save
from ..material import KEY, MaterialError
from ..scene import SceneError
from ..sequence import is_done
from .job import PREVIEW

if TYPE_CHECKING:
    from collections.abc import Mapping

    from bpy.types import Scene

    from .job import Task


@dataclass(frozen=True)
class Outcome:
    """What became of a task. seconds: of all of it, and of Cycles alone; 0 for one that was there already."""

    name: str
    status: str  # "rendered", "there" or "failed"
    seconds: float = 0.0
    render_seconds: float = 0.0
    reason: str = ""


class Renderer:
    """Renders tasks one after another. A scene is opened once as long as tasks want the same one.

    versions: of what renders, part of each task's name.
    """

    def __init__(self, folder: Path, versions: Mapping[str, str]) -> None:
        self.folder, self.versions = folder, dict(versions)
        self._wanted: object = None  # what the open scene was opened for
        self._own = 0, 0, (0, 0)  # frame, samples and resolution that its file has

    def attempt(self, task: Task) -> Outcome:
        """``render``, or why it could not be. OSError still ends the work: a full disk fails every task."""
        start = time.perf_counter()
        try:
            return self.render(task)
        except (SceneError, MaterialError, OslError, RuntimeError) as error:
            self._wanted = None  # whatever state the scene is in now
            reason = " ".join(str(error).split())
            return Outcome(task.identity(self.versions), "failed", time.perf_counter() - start, reason=reason)

    def render(self, task: Task) -> Outcome:
        """The task's files in the folder, each whole or not at all; those that are there and whole are kept."""
        name = task.identity(self.versions)
        paths = [self.folder / f"{name}.{ending}" for ending in task.outputs]
        note = f"vgroove {name}"
        if all(is_done(path, note) for path in paths):
            return Outcome(name, "there")
        start = time.perf_counter()
        shown = self._scene(task)
        frame, samples, resolution = self._own
        shown.frame_set(frame if task.frame is None else task.frame)
        scene.assign(shown, task.given, task.backend, task.estimator, task.bound)
        _forget_materials()
        with tempfile.TemporaryDirectory(prefix="vgroove-") as folder:
            picture = Path(folder) / "task.exr"
            began = time.perf_counter()
            scene.still(
                shown,
                picture,
                samples=task.samples or samples,
                seed=task.seed,
                resolution=task.resolution or resolution,
            )
            render_seconds = time.perf_counter() - began
            pixels = load(picture)
        for path in paths:
            save(path, pixels, shown, {"Note": note})
        return Outcome(name, "rendered", time.perf_counter() - start, render_seconds)

    def _scene(self, task: Task) -> Scene:
        """The task's scene, as its file has it but for the objects that the task gives materials to."""
        wanted = task.digest or PREVIEW, task.backend, tuple(sorted(name for name, _ in task.given))
        if wanted != self._wanted:
            self._wanted = None  # nothing, should opening fail
            shown = scene.opened(Path(task.scene)) if task.digest else scene.preview()
            render = shown.render
            size = (side * render.resolution_percentage // 100 for side in (render.resolution_x, render.resolution_y))
            self._wanted, self._own = wanted, (shown.frame_current, shown.cycles.samples, tuple(size))
        return bpy.context.scene


def _forget_materials() -> None:
    """Remove our materials that no object has any more: those of the task before."""
    unused = [one for one in bpy.data.materials if KEY in one and one.users == 0]
    bpy.data.batch_remove(unused)
