# SPDX-License-Identifier: GPL-3.0-or-later
"""A process of ours that answers requests: pickled to its standard input, and back from its standard output.

Nothing else is shared, so that a process that is killed at any moment takes nothing with it but what it was at.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

STDERR_TAIL = 300  # last characters of a process's standard error, for messages


class LostError(RuntimeError):
    """A process that ended before it answered, and why. signalled: from outside, or by a fault in the process."""

    def __init__(self, why: str, *, signalled: bool = True) -> None:
        super().__init__(why)
        self.signalled = signalled


class Process:
    """A module that runs in a Python of its own, seen from the process that started it.

    name: what errors call it. environment: variables that differ from ours.
    """

    def __init__(
        self, module: str, *arguments: str, name: str = "its process", environment: Mapping[str, str] | None = None
    ) -> None:
        self.name, self._why = name, ""
        self._stderr = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the process
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._stderr,
            env=os.environ | (environment or {}),
        )

    @property
    def pid(self) -> int:
        return self._process.pid

    def ask(self, request: Any) -> Any:
        """The answer to a request. LostError if the process ends before it."""
        try:
            pickle.dump(request, self._process.stdin)  # type: ignore[arg-type]
            self._process.stdin.flush()  # type: ignore[union-attr]
            return pickle.load(self._process.stdout)  # type: ignore[arg-type] # noqa: S301 - from our own process
        except (EOFError, pickle.UnpicklingError, OSError) as error:
            raise self._lost() from error

    def kill(self, why: str = "") -> None:
        """End the process at once; ``ask`` then says why."""
        self._why = self._why or why
        self._process.kill()

    def close(self) -> None:
        """End the process and forget it."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout, self._stderr):
            with contextlib.suppress(OSError):  # what was still to be sent
                pipe.close()  # type: ignore[union-attr]

    def _lost(self) -> LostError:
        code = self._process.wait()
        if self._why:
            return LostError(self._why)
        signal_name = signal.Signals(-code).name if code < 0 else ""
        hint = ", as where memory runs out" if signal_name == "SIGKILL" else ""
        self._stderr.seek(0)
        words = " ".join(self._stderr.read().decode(errors="replace").split())[-STDERR_TAIL:]
        said = f": {words}" if words else ""
        return LostError(f"{self.name} ended ({signal_name or f'exit code {code}'}{hint}){said}", signalled=code < 0)


# In the process itself


def open_answers() -> IO[bytes]:
    """Standard output, for ``answer`` alone: all other prints are discarded from now on.

    Ctrl-C goes to every process of a terminal; here it is ignored, as the process that asks ends this one.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    return answers


def next_request() -> Any:
    """Wait for a request. EOFError or UnpicklingError if the process that asks is gone."""
    return pickle.load(sys.stdin.buffer)  # noqa: S301 - from our own process


def answer(answers: IO[bytes], content: Any) -> None:
    """Send an answer."""
    pickle.dump(content, answers)
    answers.flush()
