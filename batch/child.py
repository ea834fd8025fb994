# SPDX-License-Identifier: GPL-3.0-or-later
"""A process with a Blender of its own, which renders one task at a time and ends with the process that began it.

A process that is killed at any moment takes nothing with it but the still that it was at (``headless.pipe``).
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import re
import shutil
import tempfile
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING

import psutil

from ..addon.library.files import NODE
from ..headless import pipe

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .job import Task
    from .outcome import Outcome

READY = "ready"
POLL_INTERVAL = 0.25  # seconds between checks of a process's time and memory
OLD = 3600.0  # seconds after which a temporary file is abandoned; writing one takes well under a second
TEMPORARY = re.compile(r"\.[0-9a-f]{32}\.(\d+)-(\w*)\.\w+")  # of a task, by files.replacing
SCRATCH = re.compile(r"vgroove-(\d+)-\w+")  # the folder of a child process


def sweep(folder: Path, pid: int | None = None) -> None:
    """Remove what killed processes left half written in a folder of stills: of one process, or all that is old."""
    with contextlib.suppress(OSError):  # someone else was quicker
        for path in list(folder.iterdir()):
            found = TEMPORARY.fullmatch(path.name)
            if found and (_is_of(found, pid) if pid else time.time() - path.stat().st_mtime > OLD):
                path.unlink()


def _is_of(found: re.Match[str], pid: int) -> bool:
    return int(found[1]) == pid and found[2] == NODE


def sweep_scratch() -> None:
    """Remove what processes left that were killed together with those that had begun them."""
    for path in Path(tempfile.gettempdir()).glob("vgroove-*"):
        if (found := SCRATCH.fullmatch(path.name)) and not psutil.pid_exists(int(found[1])):
            shutil.rmtree(path, ignore_errors=True)


class Child:
    """The process, seen from the one that began it. Raises LostError if its Blender does not start."""

    def __init__(self, folder: Path, versions: Mapping[str, str], threads: int = 0) -> None:
        self.folder, self.rendered = folder, 0
        self._scratch = Path(tempfile.mkdtemp(prefix=f"vgroove-{os.getpid()}-"))
        self._process = pipe.Process(__name__, environment=dict.fromkeys(("TMPDIR", "TMP", "TEMP"), str(self._scratch)))
        try:
            self._process.ask((folder, dict(versions), threads))
        except BaseException:
            self.close()
            raise

    @property
    def pid(self) -> int:
        return self._process.pid

    def run(self, task: Task, longest: float, most: int) -> Outcome:
        """The task's outcome.

        longest, most: seconds and bytes that it may take. LostError if the process ends over it, of itself or as it
        took more; OSError if the folder cannot be written.
        """
        done = threading.Event()
        watch = threading.Thread(target=self._watch, args=(done, longest, most), daemon=True)
        watch.start()
        try:
            found = self._process.ask(task)
        finally:
            done.set()
            watch.join()
        if isinstance(found, OSError):
            raise found
        self.rendered += found.status == "rendered"
        return found

    def held(self) -> int:
        """Bytes of memory that the process uses now."""
        try:
            return int(psutil.Process(self.pid).memory_info().rss)
        except psutil.Error:
            return 0

    def kill(self, why: str = "was stopped") -> None:
        """End the process at once; ``run`` then says why."""
        self._process.kill(why)

    def close(self) -> None:
        """End the process, and remove what it left half done."""
        self._process.close()
        shutil.rmtree(self._scratch, ignore_errors=True)
        sweep(self.folder, self.pid)

    def _watch(self, done: threading.Event, longest: float, most: int) -> None:
        start = time.monotonic()
        while not done.wait(POLL_INTERVAL):
            if time.monotonic() - start > longest:
                self.kill(f"took longer than {longest:g} s; give more with --timeout")
            elif self.held() > most:
                self.kill(f"took more memory than {most / 1e6:.0f} MB; give more with --memory or fewer --workers")


# In the process itself


def main() -> None:
    """Render what comes on standard input until that ends."""
    answers = pipe.open_answers()
    folder, versions, threads = pipe.next_request()

    from .. import headless

    headless.prepare()
    from .task import Renderer

    renderer = Renderer(folder, versions, threads)
    tasks: queue.SimpleQueue[Task] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(tasks, renderer.writing), daemon=True).start()
    pipe.answer(answers, READY)
    while True:
        try:
            found: Outcome | OSError = renderer.attempt(tasks.get())
        except OSError as error:
            found = OSError(" ".join(str(error).split()))  # as text: not every error can be pickled
        pipe.answer(answers, found)


def _listen(tasks: queue.SimpleQueue[Task], writing: threading.Lock) -> None:
    """Pass tasks on. When there are no more, who began this process is gone: end it, in the midst of a render too."""
    with contextlib.suppress(EOFError, pickle.UnpicklingError):
        while True:
            tasks.put(pipe.next_request())
    with writing:
        shutil.rmtree(tempfile.gettempdir(), ignore_errors=True)
        os._exit(0)


if __name__ == "__main__":
    main()
