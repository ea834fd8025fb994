# SPDX-License-Identifier: GPL-3.0-or-later
"""A process with a Blender of its own, which renders one task at a time and ends with the process that began it.

Tasks go down its standard input and outcomes come up its standard output, pickled. Nothing else is shared, so that a
process that is killed at any moment takes nothing with it but the still that it was at.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import psutil

from ..addon.library.files import NODE

if TYPE_CHECKING:
    from collections.abc import Mapping

    from .job import Task
    from .outcome import Outcome

READY = "ready"
LOOK = 0.25  # seconds between looks at a process's time and memory
LAST_WORDS = 300  # characters of what a process said last
OLD = 3600.0  # seconds, after which nobody still writes a file that takes well under one
TEMPORARY = re.compile(r"\.[0-9a-f]{32}\.(\d+)-(\w*)\.\w+")  # of a task, by files.replacing
SCRATCH = re.compile(r"vgroove-(\d+)-\w+")  # a folder of a process that was begun by another


class ChildLostError(RuntimeError):
    """A process that ended before its task did, and why. signalled: from outside, or by a fault in the process."""

    def __init__(self, why: str, *, signalled: bool = True) -> None:
        super().__init__(why)
        self.signalled = signalled


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
    """The process, seen from the one that began it. Raises ChildLostError if its Blender does not start."""

    def __init__(self, folder: Path, versions: Mapping[str, str], threads: int = 0) -> None:
        self.folder, self.rendered = folder, 0
        self._why = ""  # we ended it
        self._scratch = Path(tempfile.mkdtemp(prefix=f"vgroove-{os.getpid()}-"))
        scratch = str(self._scratch)
        with (self._scratch / "stderr").open("w", encoding="utf-8") as said:
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", __name__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=said,
                env=os.environ | {"TMPDIR": scratch, "TMP": scratch, "TEMP": scratch},
            )
        try:
            self._send((folder, dict(versions), threads))
            self._receive()
        except BaseException:
            self.close()
            raise

    @property
    def pid(self) -> int:
        return self._process.pid

    def run(self, task: Task, longest: float, most: int) -> Outcome:
        """The task's outcome.

        longest, most: seconds and bytes that it may take. ChildLostError if the process ends over it, of itself or as
        it took more; OSError if the folder cannot be written.
        """
        done = threading.Event()
        watch = threading.Thread(target=self._watch, args=(done, longest, most), daemon=True)
        watch.start()
        try:
            self._send(task)
            found = self._receive()
        finally:
            done.set()
            watch.join()
        if isinstance(found, OSError):
            raise found
        self.rendered += found.status == "rendered"
        return found

    def held(self) -> int:
        """Bytes of memory that the process holds now."""
        try:
            return int(psutil.Process(self.pid).memory_info().rss)
        except psutil.Error:
            return 0

    def kill(self, why: str = "was stopped") -> None:
        """End the process at once; ``run`` then says why."""
        self._why = self._why or why
        self._process.kill()

    def close(self) -> None:
        """End the process, and remove what it left half done."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):  # what was still to be sent
                pipe.close()  # type: ignore[union-attr]
        shutil.rmtree(self._scratch, ignore_errors=True)
        sweep(self.folder, self.pid)

    def _watch(self, done: threading.Event, longest: float, most: int) -> None:
        start = time.monotonic()
        while not done.wait(LOOK):
            if time.monotonic() - start > longest:
                self.kill(f"took longer than {longest:g} s; give more with --timeout")
            elif self.held() > most:
                self.kill(f"took more memory than {most / 1e6:.0f} MB; give more with --memory or fewer --workers")

    def _send(self, what: Any) -> None:
        try:
            pickle.dump(what, self._process.stdin)  # type: ignore[arg-type]
            self._process.stdin.flush()  # type: ignore[union-attr]
        except OSError as error:
            raise self._lost() from error

    def _receive(self) -> Any:
        try:
            return pickle.load(self._process.stdout)  # type: ignore[arg-type] # noqa: S301 - from our own process
        except (EOFError, pickle.UnpicklingError, OSError) as error:
            raise self._lost() from error

    def _lost(self) -> ChildLostError:
        code = self._process.wait()
        if self._why:
            return ChildLostError(self._why)
        name = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        hint = ", as where memory runs out" if name == "SIGKILL" else ""
        said = " ".join((self._scratch / "stderr").read_text(encoding="utf-8", errors="replace").split())
        words = f": {said[-LAST_WORDS:]}" if said and code >= 0 else ""
        return ChildLostError(f"its process ended ({name}{hint}){words}", signalled=code < 0)


# In the process itself


def main() -> None:
    """Render what comes on standard input until that ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to all; who began this process ends it
    answers = os.fdopen(os.dup(1), "wb")
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)  # where Blender prints
    folder, versions, threads = pickle.load(sys.stdin.buffer)  # noqa: S301 - from our own process

    from .. import headless

    headless.prepare()
    from .task import Renderer

    renderer = Renderer(folder, versions, threads)
    tasks: queue.SimpleQueue[Task] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, tasks, renderer.writing), daemon=True).start()
    _answer(answers, READY)
    while True:
        try:
            found: Outcome | OSError = renderer.attempt(tasks.get())
        except OSError as error:
            found = OSError(" ".join(str(error).split()))  # as text: not every error can be pickled
        _answer(answers, found)


def _answer(answers: IO[bytes], what: Any) -> None:
    pickle.dump(what, answers)
    answers.flush()


def _listen(source: IO[bytes], tasks: queue.SimpleQueue[Task], writing: threading.Lock) -> None:
    """Pass tasks on. When there are no more, who began this process is gone: end it, in the midst of a render too."""
    with contextlib.suppress(EOFError, pickle.UnpicklingError):
        while True:
            tasks.put(pickle.load(source))  # noqa: S301 - from our own process
    with writing:
        shutil.rmtree(tempfile.gettempdir(), ignore_errors=True)
        os._exit(0)


if __name__ == "__main__":
    main()
