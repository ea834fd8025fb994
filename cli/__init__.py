# SPDX-License-Identifier: GPL-3.0-or-later
"""The ``vgroove`` command. Exit codes: 0 done, 1 a check failed, 2 bad input (one line), 3 the work failed."""

from __future__ import annotations

import errno
import sys
from typing import TYPE_CHECKING, Any

import typer

from ..addon.library.inputs import InputError
from . import batch, check, explain, gallery, measure, presets, render, report
from .terminal import fail

if TYPE_CHECKING:
    from collections.abc import Callable

INTERRUPTED = 130  # exit code, as shells have it
BROKEN_MACHINE = {errno.ENOSPC, errno.EDQUOT, errno.EIO, errno.ENOMEM, errno.EMFILE}  # no fault of the input

app = typer.Typer(add_completion=False, no_args_is_help=True, help=__doc__, rich_markup_mode=None)
app.command("presets")(presets.list_presets)
app.command("render")(render.render)
app.command("measure")(measure.measure)
app.command("explain")(explain.explain)
app.command("batch")(batch.batch)
app.command("gallery")(gallery.gallery)
app.command("check")(check.check)
app.command("report")(report.report)


def main() -> None:
    """Entry of the ``vgroove`` command; turns every expected failure into one line and its exit code."""
    for stream in (sys.stdout, sys.stderr):  # a terminal that has no letter for something shows its number
        stream.reconfigure(errors="backslashreplace")  # type: ignore[union-attr]
    sys.exit(run(lambda: app(prog_name="vgroove", standalone_mode=False)))


def run(command: Callable[[], Any]) -> int:
    """Call a command; returns its exit code and prints an expected failure as one line."""
    try:
        code = command() or 0
        sys.stdout.flush()
        return fail("interrupted", INTERRUPTED) if code == INTERRUPTED else code  # typer keeps the exception to itself
    except (typer.Abort, KeyboardInterrupt):
        return fail("interrupted", INTERRUPTED)
    except MemoryError:
        return fail("out of memory; choose a smaller --resolution, or fewer --workers", 3)
    except Exception as error:
        code = _exit_code(error)
        if not code:
            raise
        return fail(error.format_message() if hasattr(error, "format_message") else str(error), code)


def _exit_code(error: Exception) -> int:
    """The exit code of a failure that is expected; 0 for others, which are faults of ours."""
    if isinstance(error, OSError):
        return 3 if error.errno in BROKEN_MACHINE else 2
    if isinstance(error, InputError) or hasattr(error, "format_message"):  # a usage error of the parser
        return 2
    if type(error).__name__ in {
        "ClusterError",
        "MaterialError",
        "AnimationError",
        "SceneError",
        "OslError",
        "ReportError",
    }:  # their modules need Blender
        return 2
    return 3 if isinstance(error, RuntimeError) else 0  # from Blender itself
