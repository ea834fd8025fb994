# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a batch: the plan before it, a table and ``results.csv`` after it. Imports no bpy."""

from __future__ import annotations

import csv
import math
from collections import Counter
from statistics import median
from typing import TYPE_CHECKING

from rich.markup import escape
from rich.table import Table

from ..files import replacing

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from .job import Task
    from .outcome import Outcome

FILE = "results.csv"
HEAD = ("task", "status", "seconds", "render_seconds", "samples", "error", "memory_mb", "tries", "label", "reason")
MOST_ROWS = 20  # of a table for people
BYTES = {"exr": 12, "png": 3}  # a pixel, before compression


def write(path: Path, tasks: Mapping[str, Task], outcomes: Mapping[str, Outcome]) -> None:
    """A row a task, in the order of the job. A task by its name; one without an outcome was not come to."""
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        rows.writerow(HEAD)
        for name, task in tasks.items():
            one = outcomes.get(name)
            if one is None:
                rows.writerow([name, "left", "", "", "", "", "", "", task.label, ""])
                continue
            numbers = [f"{one.seconds:.3f}", f"{one.render_seconds:.3f}", one.samples or ""]
            numbers += ["" if math.isnan(one.error) else f"{one.error:.4g}", f"{one.memory / 1e6:.0f}", one.tries]
            rows.writerow([name, one.status, *numbers, task.label, one.reason])


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


def plan(tasks: Sequence[Task]) -> Table:
    """The tasks in words, the first and last of many."""
    made = Table("", "task", "samples", "resolution")
    for index, task in enumerate(tasks, 1):
        if index <= MOST_ROWS or index == len(tasks):
            size = "x".join(map(str, task.resolution)) if task.resolution else "the scene's"
            samples = f"to {task.error:.2g}" if task.error else str(task.samples or "the scene's")
            made.add_row(str(index), escape(task.label), samples, size)
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
