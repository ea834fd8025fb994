# SPDX-License-Identifier: GPL-3.0-or-later
"""What ``vgroove batch`` costs beside Cycles, and against a process for each still, for docs/batch.md.

Stills of the preview scene, by a grid of two presets, slopes and estimators. A few single processes run before the
batch and a few after it, so other work on the machine slows both alike. One process, which is never replaced, gives the
time outside Cycles' own render call over that within it, and how much its memory grows with each task.
"""

from __future__ import annotations

import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from .job import Task

VGROOVE = Path(sys.executable).parent / "vgroove"
STILLS, LARGER_STILLS, ALONE = 120, 4, 6
WARM_UP = 0.2  # share of the tasks after which memory is measured: by then everything was loaded once


def rows() -> list[list[Any]]:
    """What is measured, and its value."""
    from .job import parse

    with tempfile.TemporaryDirectory(prefix="vgroove-") as name:
        folder = Path(name)
        before = single_render_seconds(ALONE // 2, folder)
        batch = batch_seconds(STILLS, folder)
        single = (before + single_render_seconds(ALONE // 2, folder)) / 2.0
        outside, growth = {}, 0.0
        for side, samples, stills in ((64, 16, STILLS), (256, 64, LARGER_STILLS)):
            (folder / str(side)).mkdir()
            outside[side], slope = one_process(parse(job(stills, side, samples), "job", folder), folder / str(side))
            growth = slope if stills == STILLS else growth
    return [
        ["stills", STILLS],
        ["seconds by a process a still", single],
        ["seconds in a batch", batch],
        ["outside Cycles at 64 x 64 and 16 samples", outside[64]],
        ["outside Cycles at 256 x 256 and 64 samples", outside[256]],
        ["bytes a task", growth],
    ]


def job(stills: int, side: int, samples: int) -> str:
    """A job file of so many stills: 2 presets x 2 estimators x slopes."""
    slopes = [round(0.05 + 0.55 * index / math.ceil(stills / 4), 5) for index in range(math.ceil(stills / 4))]
    return (
        f'[[render]]\npreset = ["copper", "water"]\nestimator = ["fit", "mirror"]\nset.m = {slopes}\n'
        f'samples = {samples}\nresolution = "{side}x{side}"\n'
    )


def single_render_seconds(count: int, folder: Path) -> float:
    """Seconds per still, each rendered by its own process."""
    start = time.perf_counter()
    for seed in range(count):
        options = ["--resolution", "64x64", "--samples", "16", "--seed", str(seed), "--estimator", "fit"]
        command = [str(VGROOVE), "render", "copper", *options, "-o", str(folder / "alone.exr")]
        subprocess.run(command, check=True, capture_output=True)
    return (time.perf_counter() - start) / count


def batch_seconds(stills: int, folder: Path) -> float:
    """Seconds per still of ``vgroove batch``, start-up and all."""
    (folder / "job.toml").write_text(job(stills, 64, 16), encoding="utf-8")
    start = time.perf_counter()
    subprocess.run([str(VGROOVE), "batch", "job.toml", "-o", "out"], check=True, capture_output=True, cwd=folder)
    return (time.perf_counter() - start) / stills


def one_process(tasks: list[Task], folder: Path) -> tuple[float, float]:
    """Of tasks in this process: time outside Cycles' render call over that within, and bytes that each leaves behind.

    The first task, which imports and builds what all need, is left out of the time.
    """
    import _cycles

    from .. import headless
    from ..headless import memory
    from . import pool
    from .task import Renderer

    within, real = [0.0], _cycles.render

    def time_call(*arguments: Any) -> None:
        start = time.perf_counter()
        real(*arguments)
        within[0] += time.perf_counter() - start

    renderer, held, began = Renderer(folder, {}, pool.cores()), [], 0.0
    _cycles.render = time_call
    try:
        for index, task in enumerate(tasks):
            if index == 1:
                within[0], began = 0.0, time.perf_counter()
            with headless.quiet():
                outcome = renderer.attempt(task)
            if outcome.status != "rendered":
                raise RuntimeError(outcome.reason)
            held.append(memory.held())
        spent = time.perf_counter() - began
    finally:
        _cycles.render = real
    settled = held[int(WARM_UP * len(held)) :]
    slope = float(np.polyfit(np.arange(len(settled)), settled, 1)[0]) if len(settled) > 1 else math.nan
    return (spent - within[0]) / within[0], slope
