# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a batch: the plan before it, a table and ``results.csv`` after it. Imports no bpy."""

from __future__ import annotations

import csv
import io
import math
from collections import Counter
from contextlib import suppress
from statistics import median
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table

from ..addon.library.files import read_bytes, replacing
from ..addon.library.inputs import real

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from .job import Task
    from .outcome import Outcome

FILE = "results.csv"
LONGEST_FILE = 2**30  # bytes
HEAD = ("task", "status", "seconds", "render_seconds", "samples", "error", "memory_mb", "tries", "label", "reason")
MOST_ROWS = 20  # of a table for people
# Of a plan, as the report's figures/batch has them of the preview scene: seconds that a process takes to begin, and for
# a task beside its samples; camera rays a second on one core; how many samples leave noise as large as the picture.
START, EACH, RAYS, NOISE = 4.0, 0.05, 2.5e5, 4.0
BYTES = {"exr": 12, "png": 3}  # a pixel, before compression


def write(path: Path, tasks: Mapping[str, Task], outcomes: Mapping[str, Outcome]) -> None:
    """A row a task, in the order of the job. A task by its name.

    One without an outcome was not come to: it keeps the row that the table has of it, else it is "left".
    """
    before = {row.get("task"): row for row in _rows(path)}
    escaped = "backslashreplace"  # of names from the command line that are not UTF-8
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8", errors=escaped) as file:
        rows = csv.writer(file)
        rows.writerow(HEAD)
        for name, task in tasks.items():
            one = outcomes.get(name)
            if one is None:
                kept = before.get(name, {"task": name, "status": "left", "label": task.label})
                rows.writerow([kept.get(head, "") for head in HEAD])
                continue
            numbers = [f"{one.seconds:.3f}", f"{one.render_seconds:.3f}", one.samples or ""]
            numbers += ["" if math.isnan(one.error) else f"{one.error:.4g}", f"{one.memory / 1e6:.0f}", one.tries]
            rows.writerow([name, one.status, *numbers, task.label, one.reason])


def try_to_write(path: Path, tasks: Mapping[str, Task], outcomes: Mapping[str, Outcome]) -> None:
    """``write``, ignoring OSError: for work that ended early, perhaps because the disk is full."""
    if outcomes:
        with suppress(OSError):
            write(path, tasks, outcomes)


def summary(outcomes: Sequence[Outcome]) -> Table:
    """What the tasks took, by status."""
    made = Table("status", "stills", "seconds each", "in Blender's render", "most memory", "median error", "tries")
    for status, count in Counter(one.status for one in outcomes).items():
        these = [one for one in outcomes if one.status == status]
        errors = [one.error for one in these if not math.isnan(one.error)]
        seconds = median(one.seconds for one in these), median(one.render_seconds for one in these)
        error = f"{median(errors):.2%}" if errors else ""
        memory = f"{max(one.memory for one in these) / 1e6:.0f} MB"
        tries = sum(one.tries for one in these)
        made.add_row(status, str(count), f"{seconds[0]:.3g}", f"{seconds[1]:.3g}", memory, error, str(tries))
    return made


def failures(tasks: Mapping[str, Task], outcomes: Sequence[Outcome]) -> Table:
    """The first tasks that failed, and why."""
    made = Table("task", "why it failed")
    failed = [one for one in outcomes if one.status == "failed"]
    for one in failed[:MOST_ROWS]:
        made.add_row(escape(tasks[one.name].label or one.name), escape(one.reason))
    if len(failed) > MOST_ROWS:
        made.add_row("...", f"and {len(failed) - MOST_ROWS} more, all in {FILE}")
    return made


def plan(tasks: Sequence[Task], first: int = 1) -> Table:
    """The tasks in words, the first and last of many, numbered from ``first``."""
    made = Table("", "task", "samples", "resolution")
    for index, task in enumerate(tasks, 1):
        if index <= MOST_ROWS or index == len(tasks):
            size = "x".join(map(str, task.resolution)) if task.resolution else "the scene's"
            samples = f"to {task.error:.2g}" if task.error else str(task.samples or "the scene's")
            made.add_row(str(first + index - 1), escape(task.label), samples, size)
        elif index == MOST_ROWS + 1:
            made.add_row("...")
    return made


def demand(tasks: Sequence[Task]) -> str:
    """What the tasks add up to."""
    known = [task for task in tasks if task.resolution]
    pixels = sum(math.prod(task.resolution or ()) for task in known)
    disk = sum(math.prod(task.resolution or ()) * sum(BYTES[kind] for kind in task.outputs) for task in known)
    more = "" if len(known) == len(tasks) else f", and {len(tasks) - len(known)} of the size of their scene"
    return f"{len(tasks)} tasks, {pixels / 1e6:.3g} megapixels, up to {disk / 1e6:.3g} MB{more}"


def rays(task: Task) -> float:
    """Camera rays of a task, nan where its scene decides how many. Those towards an error are a guess."""
    if task.resolution is None or (task.samples is None and task.error is None):
        return math.nan
    samples = task.samples if task.error is None else NOISE / task.error**2
    return math.prod(task.resolution) * float(samples or 0)


def estimate(tasks: Mapping[str, Task], before: Mapping[str, float], workers: int, threads: int = 1) -> str:
    """Time for the remaining tasks. before: seconds of the tasks already rendered, by name.

    They say how fast this scene and machine are; without them it is the speed of the preview scene, by processes of so
    many threads.
    """
    told = {name: rays(task) for name, task in tasks.items()}
    left = [told[name] for name in tasks if name not in before and not math.isnan(told[name])]
    done = [name for name in before if not math.isnan(told.get(name, math.nan))]
    cast = sum(told[name] for name in done)
    speed = cast / max(sum(before[name] for name in done) - EACH * len(done), 1e-9) if cast else RAYS * threads
    seconds = START * bool(left) + sum(EACH + one / speed for one in left) / workers
    unknown = len(tasks) - len(before) - len(left)
    source = f"by the speed of {len(done)} that are there" if cast else "by the speed of the preview scene"
    more = f", and {unknown} whose scene decides" if unknown > 0 else ""
    return f"about {duration(seconds)} by {workers} processes for {len(left)} tasks, {source}{more}"


def duration(seconds: float) -> str:
    """For people: 40 s, 12 min, 3.5 h."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def read_seconds(folder: Path) -> dict[str, float]:
    """Of each task that the tables in a folder say was rendered, by its name."""
    found = {}
    for path in folder.glob("results*.csv"):
        for row in _rows(path):
            with suppress(KeyError, TypeError, ValueError):  # someone has edited it
                if row["status"] in {"rendered", "there"}:
                    found[row["task"]] = real(row["seconds"], 0.0)
    return found


def _rows(path: Path) -> list[dict[str, str]]:
    """Of a table, which a spreadsheet may have saved."""
    try:
        text = read_bytes(path, LONGEST_FILE).decode("utf-8-sig")
        return list(csv.DictReader(io.StringIO(text, newline="")))
    except (OSError, UnicodeDecodeError, csv.Error):
        return []
