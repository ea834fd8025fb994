# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``vgroove`` command. Exit codes: 0 done, 1 a check failed, 2 bad input (one line), 3 the work failed."""

from __future__ import annotations

import errno
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from typer.exceptions import TyperException

from ..addon.library.errors import InputError
from . import batch, check, doctor, explain, fit, gallery, info, measure, plot, presets, render, report, view
from .terminal import fail

if TYPE_CHECKING:
    from collections.abc import Callable

INTERRUPTED, CLOSED_PIPE = 130, 141  # exit codes, as shells have them
BROKEN_MACHINE = {errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.ENOMEM, errno.EMFILE}  # no fault of the input

app = typer.Typer(add_completion=False, no_args_is_help=True, help=__doc__, rich_markup_mode=None)
app.command("presets")(presets.list_presets)
app.command("render")(render.render)
app.command("measure")(measure.measure)
app.command("info")(info.info)
app.command("plot")(plot.plot)
app.command("fit")(fit.fit)
app.command("explain")(explain.explain)
app.command("doctor")(doctor.doctor)
app.command("batch")(batch.batch)
app.command("gallery")(gallery.gallery)
app.command("check")(check.check)
app.command("report")(report.report)
app.command("view")(view.view)


def main() -> None:
    """Entry of the ``vgroove`` command; turns every expected failure into one line and its exit code."""
    for stream in (sys.stdout, sys.stderr):  # a terminal that has no letter for something shows its number
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    try:
        code = run(lambda: app(prog_name="vgroove", standalone_mode=False))
    except (SystemExit, BrokenPipeError):  # so typer and rich end when nobody reads their output any more
        _discard_output()
        code = CLOSED_PIPE
    sys.exit(code)


def run(command: Callable[[], Any]) -> int:
    """Call a command; returns its exit code and prints an expected failure as one line."""
    try:
        code = command() or 0
        sys.stdout.flush()
    except BrokenPipeError:  # no failure: ``main`` ends quietly
        raise
    except (typer.Abort, KeyboardInterrupt):
        code = INTERRUPTED
    except MemoryError:
        return fail("out of memory; choose a smaller --resolution, or fewer --workers", 3)
    except TyperException as error:
        return fail(error.format_message(), 2)
    except (InputError, OSError) as error:
        return fail(str(error), 3 if getattr(error, "errno", None) in BROKEN_MACHINE else 2)
    except RuntimeError as error:  # from Blender itself
        return fail(str(error), 3)
    return fail("interrupted", INTERRUPTED) if code == INTERRUPTED else code  # typer keeps the exception to itself


def _discard_output() -> None:
    """Let what is still buffered go nowhere, or Python would complain about the closed pipe as it exits."""
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        for stream in (sys.stdout, sys.stderr):
            os.dup2(nowhere.fileno(), stream.fileno())
