# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks rendered by several processes of this machine. One that is killed costs a try, and nothing else."""

from __future__ import annotations

import math
import os
import queue
import threading
from collections import defaultdict, deque
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ..headless import memory as memory_of
from ..headless.pipe import LostError
from .child import Child, sweep, sweep_scratch
from .outcome import Outcome

if TYPE_CHECKING:
    from collections.abc import Generator, Mapping, Sequence
    from pathlib import Path

    from .job import Task

TRIES = 3  # of a task before it counts as failed
STARTS = 8  # of a process that is killed during start-up
TYPICAL = 1.5e9  # bytes that a process typically needs, with its own scene
FULL = 0.8  # share of a process's memory limit above which it is replaced
RECYCLE = 2000  # tasks after which a process is replaced


@dataclass(frozen=True)
class Limits:
    """How many processes, and what each may take.

    timeout: seconds for a task. memory: bytes of a process; one that holds more than ``FULL`` of it between tasks is
    replaced. recycle: tasks after which it is.
    """

    workers: int
    memory: int
    timeout: float = math.inf
    recycle: int = RECYCLE

    @property
    def threads(self) -> int:
        """Of each process, so that all together keep every core busy."""
        return -(-cores() // self.workers)

    def is_used_up(self, child: Child) -> bool:
        """Whether to replace the process by a new one."""
        return child.rendered >= self.recycle or child.held() > FULL * self.memory


def cores() -> int:
    """Number of CPU cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def limits(tasks: int, workers: int | None = None, memory: int | None = None, **others: Any) -> Limits:
    """By the machine where None: a process a core, as far as memory goes, and an even share of what memory is free."""
    free = memory_of.free()
    most = min(cores(), int(free // (memory or TYPICAL)))
    workers = max(1, min(workers or most, tasks))
    return Limits(workers, memory or free // workers, **others)


def outcomes(tasks: Sequence[Task], folder: Path, versions: Mapping[str, str], limit: Limits) -> Generator[Outcome]:
    """The outcome of each task, once, as they come.

    A task that stumbles is tried again after the others, ``TRIES`` times in all. Closing this iterator ends all
    processes. OSError if the folder cannot be written, RuntimeError if Blender does not start.
    """
    sweep(folder)
    sweep_scratch()
    pool = _Pool(tasks, folder, versions, limit)
    threads = [threading.Thread(target=pool.work, daemon=True) for _ in range(limit.workers)]
    try:
        for thread in threads:
            thread.start()
        for _ in tasks:
            found = pool.results.get()
            if isinstance(found, BaseException):
                raise found
            yield found
    finally:
        pool.stop()
        for thread in threads:
            thread.join()


class Tries:
    """Counts the tries of tasks and keeps why each went wrong."""

    def __init__(self) -> None:
        self._reasons: defaultdict[str, list[str]] = defaultdict(list)

    def settle(self, outcome: Outcome) -> Outcome | None:
        """The outcome with its number of tries; None to try the task again."""
        reasons = self._reasons[outcome.name]
        tries = len(reasons) + 1
        if outcome.status != "stumbled":
            return replace(outcome, tries=tries) if outcome.status == "rendered" else outcome
        reasons.append(outcome.reason)
        if tries < TRIES:
            return None
        return replace(outcome, status="failed", tries=tries, reason="; then ".join(dict.fromkeys(reasons)))


class _Pool:
    """What the threads share, each of which has a process of its own."""

    def __init__(self, tasks: Sequence[Task], folder: Path, versions: Mapping[str, str], limit: Limits) -> None:
        self.folder, self.versions, self.limit = folder, versions, limit
        self.results: queue.SimpleQueue[Outcome | BaseException] = queue.SimpleQueue()
        self._lock = threading.Lock()  # of what follows
        self._left: dict[tuple[Any, ...], deque[Task]] = defaultdict(deque)
        for task in tasks:
            self._left[task.place].append(task)
        self._at: dict[int, Any] = {}  # the place that each thread's process has open
        self._tries, self._children, self._stopped = Tries(), set[Child](), False

    def work(self) -> None:
        """One thread: take tasks until there are none."""
        child: Child | None = None
        try:
            while (task := self._take()) is not None:
                if child is not None and self.limit.is_used_up(child):
                    self._end(child)
                    child = None
                try:
                    child = child or self._begin()
                    found = child.run(task, self.limit.timeout, self.limit.memory)
                except LostError as error:
                    if child is None or self._stopped:  # none could be begun
                        raise
                    self._end(child)
                    child = None
                    found = Outcome(task.identity(dict(self.versions)), "stumbled", reason=str(error))
                self._settle(task, found)
        except BaseException as error:  # noqa: BLE001 - for the thread that waits
            self.results.put(error)
        finally:
            if child is not None:
                self._end(child)

    def stop(self) -> None:
        """Have all threads end, in the midst of their tasks."""
        with self._lock:
            self._stopped = True
            for child in self._children:
                child.kill()

    def _take(self) -> Task | None:
        """A task at the place where this thread's process is, else at one where none is, else where most are left."""
        me = threading.get_ident()
        with self._lock:
            left = {place: tasks for place, tasks in self._left.items() if tasks}
            if self._stopped or not left:
                return None
            taken = {place for other, place in self._at.items() if other != me}
            here = self._at.get(me)
            place = here if here in left else max(left, key=lambda one: (one not in taken, len(left[one])))
            self._at[me] = place
            return left[place].popleft()

    def _settle(self, task: Task, found: Outcome) -> None:
        with self._lock:
            outcome = self._tries.settle(found)
            if outcome is None:
                self._left[task.place].append(task)
        if outcome is not None:
            self.results.put(outcome)

    def _begin(self) -> Child:
        """A new process, though some be killed while they start."""
        for number in range(STARTS):
            try:
                child = Child(self.folder, self.versions, self.limit.threads)
            except LostError as error:
                if error.signalled and number < STARTS - 1 and not self._stopped:
                    continue
                message = f"Blender does not start: {error}"
                raise LostError(message, signalled=error.signalled) from error
            break
        with self._lock:
            self._children.add(child)
            if self._stopped:
                child.kill()
        return child

    def _end(self, child: Child) -> None:
        with self._lock:
            self._children.discard(child)
        child.close()
