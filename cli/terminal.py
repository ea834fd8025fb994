# SPDX-License-Identifier: GPL-3.0-or-later
"""What the command prints: results on standard output; messages and progress on standard error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

LONGEST_LINE = 1000  # characters of an error message
out, err = Console(), Console(stderr=True)


def say(text: str) -> None:
    """Print one line on standard error."""
    err.print(one_line(text), highlight=False, markup=False, soft_wrap=True)


def warn(text: str) -> None:
    """Print what deserves attention but stops nothing."""
    err.print(f"vgroove: {text}", style="yellow", highlight=False, soft_wrap=True, markup=False)


def fail(text: str, code: int) -> int:
    """Print an error as one line, cut short; returns the exit code."""
    text = one_line(text)
    say("vgroove: " + (text if len(text) <= LONGEST_LINE else f"{text[: LONGEST_LINE - 4]} ..."))
    return code


def one_line(text: str) -> str:
    """The text without line breaks and control characters, which would steer a terminal."""
    return "".join(c if c.isprintable() or "\ud800" <= c <= "\udfff" else "?" for c in " ".join(text.split()))


def progress(items: Iterable[Any], label: str, count: int) -> Iterator[Any]:
    """Yield the items, with a progress bar if standard error is a terminal and at most 20 plain lines otherwise."""
    if not err.is_terminal:
        step = max(1, min(20, count // 10))
        for index, item in enumerate(items):
            if index % step == 0:
                err.print(f"{label} {index}/{count}", highlight=False)
            yield item
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=err) as bar:
        yield from bar.track(items, total=count, description=label)
