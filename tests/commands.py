# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``vgroove`` command, run in this process: a process of its own spends three seconds on starting Blender."""

import contextlib
import io
import re
import signal
import sys
from dataclasses import dataclass
from functools import partial

import pytest

from vgroove import cli

LONGEST = 20  # seconds of a command; the slowest takes one on an idle machine


class Hang(BaseException):
    """A command that takes longer than ``LONGEST``."""


def hang(*_):
    raise Hang


@dataclass
class Said:
    code: int
    out: str
    err: str

    @property
    def lines(self):
        return self.err.strip().splitlines()


def vgroove(*arguments, encoding="utf-8", longest=LONGEST):
    """What the command says, in a terminal of that encoding; exceptions that it should have caught are the caller's."""
    argv, sys.argv = sys.argv, ["vgroove", *map(str, arguments)]
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding=encoding, write_through=True) for _ in range(2))
    before = signal.signal(signal.SIGALRM, hang)
    signal.alarm(longest)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            cli.main()
        pytest.fail("the command did not end with an exit code")
    except SystemExit as ended:
        code = ended.code
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
        sys.argv = argv
    out, err = (stream.buffer.getvalue().decode(encoding) for stream in (out, err))
    # Blender writes its errors to sys.stdout, which is a pipe to nowhere then when it is the process's own.
    return Said(code, re.sub(r"(?m)^Error: .*\n", "", out), err)


patient = partial(vgroove, longest=300)  # for commands that begin processes, render sequences or check rows


def read_exr(path):
    """The pixels of an image that a command wrote, and its OpenImageIO specification."""
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    return file.read_image("float"), file.spec()
