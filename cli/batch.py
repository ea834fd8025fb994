# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove batch``: every task of a job file, by local processes, a Dask cluster or a farm."""

from __future__ import annotations

import math
import re
from collections import Counter
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..addon.library.errors import InputError
from ..addon.library.inputs import MOST_MEGABYTES, MOST_WORKERS
from .environment import make_folder_of, versions
from .options import real, whole
from .terminal import out, progress, say

if TYPE_CHECKING:
    from collections.abc import Generator, Sequence

    from ..batch.job import Task
    from ..batch.outcome import Outcome
    from ..batch.pool import Limits

JobArgument = Annotated[
    Path, typer.Argument(metavar="JOB.toml", help="A file with tables [[render]]; see docs/batch.md")
]
OutputOption = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder of the stills; created if missing")
]
DryRunOption = Annotated[bool, typer.Option("--dry-run", help="Print what would be rendered; render nothing")]
TasksOption = Annotated[
    str | None, typer.Option("--tasks", metavar="A-B", help="Only these tasks, as --dry-run numbers them")
]
WorkersOption = Annotated[
    int | None,
    typer.Option(parser=whole(1, MOST_WORKERS), metavar="N", help="Processes; default: one per core, if memory allows"),
]
TimeoutOption = Annotated[
    float | None, typer.Option(parser=real(1.0), metavar="S", help="Time limit per task, in seconds")
]
MemoryOption = Annotated[
    int | None,
    typer.Option(
        parser=whole(256, MOST_MEGABYTES),
        metavar="MB",
        help="Memory limit per process; default: its share of the free memory",
    ),
]
ClusterOption = Annotated[
    str | None,
    typer.Option(metavar="ADDRESS", help="Render on the workers of this Dask scheduler: tls://farm:8786"),
]
InsecureOption = Annotated[
    bool, typer.Option("--insecure", help="With --cluster: also tcp:// and ws:// to another machine, unencrypted")
]
OpenJdOption = Annotated[
    Path | None,
    typer.Option("--openjd", metavar="FILE", help="Write an Open Job Description template; render nothing"),
]


MOST_NOTES = 10  # lines of warnings after a batch


def batch(
    file: JobArgument,
    output: OutputOption,
    *,
    dry_run: DryRunOption = False,
    part: TasksOption = None,
    workers: WorkersOption = None,
    timeout: TimeoutOption = None,
    memory: MemoryOption = None,
    cluster: ClusterOption = None,
    insecure: InsecureOption = False,
    openjd_file: OpenJdOption = None,
) -> None:
    """Render every task of a job file to a still. Existing complete stills are kept."""
    from ..batch import job, openjd, pool

    if openjd_file is not None and (dry_run or cluster is not None):
        message = "--openjd writes a template and renders nothing; leave --cluster and --dry-run out"
        raise InputError(message)
    first, tasks = _selected(job.load(file), part)
    if openjd_file is not None:
        openjd.write(openjd_file, file, output, tasks, first)
        say(f"wrote {openjd_file}, a template of {len(tasks)} tasks")
        return
    limit = pool.limits(
        len(tasks), workers, memory * 10**6 if memory else None, timeout=math.inf if timeout is None else timeout
    )
    output = output.absolute()  # other machines have other current folders
    if dry_run:
        _print_plan(tasks, first, output, limit)
    elif cluster is None:
        table = _results_file(output, part)
        _render(tasks, table, pool.outcomes(tasks, output, versions(), limit), f"rendering by {limit.workers}")
    else:
        from ..batch import cluster as dask

        with dask.connect_client(cluster, insecure=insecure) as client:
            if memory is None:  # that is for each machine to say
                limit = replace(limit, memory=0)
            table = _results_file(output, part)
            _render(tasks, table, dask.outcomes(tasks, output, versions(), limit, client), f"rendering by {cluster}")


def _selected(tasks: list[Task], part: str | None) -> tuple[int, list[Task]]:
    """Parse "A-B" or "A", counted from 1: the number of the first task, and the tasks A to B."""
    if part is None:
        return 1, tasks
    found = re.fullmatch(r"([0-9]{1,7})(?:-([0-9]{1,7}))?", part)
    first, last = (int(found[1]), int(found[2] or found[1])) if found else (0, 0)
    if not 1 <= first <= last <= len(tasks):
        message = f'--tasks "{part}": write A-B, from 1-{len(tasks)}: the job has {len(tasks)} tasks'
        raise InputError(message)
    return first, tasks[first - 1 : last]


def _print_plan(tasks: Sequence[Task], first: int, output: Path, limit: Limits) -> None:
    """What would be rendered, what that needs, and about how long it takes."""
    from ..batch import results

    named = {task.identity(versions()): task for task in tasks}
    seconds = results.read_seconds(output)
    before = {
        name: seconds[name]
        for name, task in named.items()
        if name in seconds and all((output / f"{name}.{kind}").is_file() for kind in task.outputs)
    }
    out.print(results.plan(tasks, first))
    out.print(results.demand(tasks), highlight=False)
    out.print(results.estimate(named, before, limit.workers, limit.threads), highlight=False, soft_wrap=True)


def _results_file(output: Path, part: str | None) -> Path:
    """The table of results in the folder, which is made. Parts have tables of their own: they may run at once."""
    from ..batch import results

    table = output / (results.FILE if part is None else f"results-{part}.csv")
    make_folder_of(table)
    return table


def _render(tasks: Sequence[Task], table: Path, outcomes: Generator[Outcome], label: str) -> None:
    """Follow a batch to its end and report its outcomes. RuntimeError if a task failed or the folder cannot be used."""
    from ..batch import results

    named = {task.identity(versions()): task for task in tasks}
    found: dict[str, Outcome] = {}
    try:
        with closing(outcomes):
            for outcome in progress(outcomes, label, len(tasks)):
                found[outcome.name] = outcome
        results.write(table, named, found)
    except OSError as error:  # the input was fine
        results.try_to_write(table, named, found)
        raise RuntimeError(str(error)) from error
    except BaseException:
        results.try_to_write(table, named, found)
        raise
    failed = [one for one in found.values() if one.status == "failed"]
    kept = sum(one.status == "there" for one in found.values())
    out.print(results.summary(list(found.values())))
    if failed:
        out.print(results.failures(named, failed))
    notes = Counter(one.reason for one in found.values() if one.status != "failed" and one.reason)
    for note, count in notes.most_common(MOST_NOTES):
        say(f"warning: {count} of {len(tasks)} tasks: {note}")
    if len(notes) > MOST_NOTES:
        say(f"warning: {table} has {len(notes) - MOST_NOTES} more")
    before = f", {kept} of them there already" if kept else ""
    say(f"wrote {len(found) - len(failed)} stills to {table.parent}{before}")
    if failed:
        message = f"{len(failed)} of {len(tasks)} tasks failed: {failed[0].reason}"
        if len({one.reason for one in failed}) > 1:
            message += f"; {table} has all reasons"
        raise RuntimeError(message)
