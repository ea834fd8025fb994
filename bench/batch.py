# SPDX-License-Identifier: GPL-3.0-or-later
"""What `vgroove batch` costs beside Cycles, and how it compares with a `vgroove render` process a still.

    python bench/batch.py [--stills N] [--alone N]

Three figures, of stills of the preview scene by both processes of a grid of two presets, slopes and estimators:
the time of N stills of 64 x 64 at 16 samples over that of as many processes of their own (a few of these are run, some
before and some after the batch, so that what else the machine does falls on both alike); the time outside Cycles' own
render call over that within it, at 64 x 64 and 16 samples and at 256 x 256 and 64; and by how much the memory of one
process that is never replaced grows with each of N tasks.
"""

from __future__ import annotations

import argparse
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from vgroove.addon import headless

headless.prepare()

import _cycles  # noqa: E402 - after prepare()
import numpy as np  # noqa: E402

from vgroove.addon.batch import memory, pool  # noqa: E402
from vgroove.addon.batch.job import parse  # noqa: E402
from vgroove.addon.batch.task import Renderer  # noqa: E402

if TYPE_CHECKING:
    from vgroove.addon.batch.job import Task

VGROOVE = Path(sys.executable).parent / "vgroove"
SETTLED = 0.2  # of the tasks, after which memory is looked at: by then everything was needed once
SEVERAL = 100  # tasks, below which a slope says nothing
out = Console()


def job(stills: int, side: int, samples: int) -> str:
    """A job file of so many stills: 2 presets x 2 estimators x slopes."""
    slopes = [round(0.05 + 0.55 * index / math.ceil(stills / 4), 5) for index in range(math.ceil(stills / 4))]
    return (
        f'[[render]]\npreset = ["copper", "water"]\nestimator = ["fit", "mirror"]\nset.m = {slopes}\n'
        f'samples = {samples}\nresolution = "{side}x{side}"\n'
    )


def alone(count: int, folder: Path) -> float:
    """Seconds of a still that a process of its own renders."""
    start = time.perf_counter()
    for seed in range(count):
        given = ["--resolution", "64x64", "--samples", "16", "--seed", str(seed), "--estimator", "fit"]
        command = [str(VGROOVE), "render", "copper", *given, "-o", str(folder / "alone.exr")]
        subprocess.run(command, check=True, capture_output=True)
    return (time.perf_counter() - start) / count


def together(stills: int, folder: Path) -> float:
    """Seconds of a still that `vgroove batch` renders, with everything from its start to its end."""
    (folder / "job.toml").write_text(job(stills, 64, 16), encoding="utf-8")
    start = time.perf_counter()
    subprocess.run([str(VGROOVE), "batch", "job.toml", "-o", "out"], check=True, capture_output=True, cwd=folder)
    return (time.perf_counter() - start) / stills


def one_process(tasks: list[Task], folder: Path) -> tuple[float, float]:
    """Of tasks in this process: time outside Cycles' render call over that within, and bytes that each leaves behind.

    The first task, which imports and builds what all need, is left out of the time.
    """
    within, real = [0.0], _cycles.render

    def timed(*arguments: Any) -> None:
        start = time.perf_counter()
        real(*arguments)
        within[0] += time.perf_counter() - start

    renderer, held, began = Renderer(folder, {}, pool.cores()), [], 0.0
    _cycles.render = timed
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
    settled = held[int(SETTLED * len(held)) :]
    slope = float(np.polyfit(np.arange(len(settled)), settled, 1)[0]) if len(settled) > 1 else math.nan
    return (spent - within[0]) / within[0], slope


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stills", type=int, default=1000, metavar="N")
    parser.add_argument("--alone", type=int, default=10, metavar="N", help="processes with a still of their own")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="vgroove-") as name:
        folder = Path(name)
        before = alone((arguments.alone + 1) // 2, folder)
        batch = together(arguments.stills, folder)
        after = alone((arguments.alone + 1) // 2, folder)
        single = (before + after) / 2.0
        out.print(
            f"{arguments.stills} stills of 64 x 64 at 16 samples: {single:.2f} s each by a process of its own, "
            f"{batch:.3f} s in a batch, {single / batch:.1f} times the throughput", soft_wrap=True,
        )  # fmt: skip
        for side, samples, stills in ((64, 16, arguments.stills), (256, 64, max(arguments.stills // 50, 4))):
            (folder / str(side)).mkdir()
            outside, slope = one_process(parse(job(stills, side, samples), "bench", folder), folder / str(side))
            growth = f", {slope / 1000:+.1f} kB of memory a task" if stills >= SEVERAL else ""
            out.print(f"{side} x {side} at {samples}: {outside:.1%} outside Cycles' render call{growth}")


if __name__ == "__main__":
    main()
