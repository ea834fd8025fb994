# SPDX-License-Identifier: GPL-3.0-or-later
"""Outputs appear whole or not at all: written beside their place under another name, then renamed."""

from __future__ import annotations

import os
import platform
import re
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

NODE = re.sub(r"\W", "", platform.node())[:16]  # of this machine: others may write to the same folder


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A temporary path in the folder of ``path``, renamed to it when the block ends well, removed when it does not.

    Raises FileNotFoundError if the block wrote nothing there.
    """
    path = path.absolute()  # Blender finds no folder for a name alone
    temporary = path.with_name(f".{path.stem}.{os.getpid()}-{NODE}{path.suffix}")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def check_writable(path: Path) -> None:
    """OSError, before any work, if ``path`` could not be written: its folder is missing or read-only."""
    folder = path.absolute().parent
    if not folder.is_dir():
        message = f"{path}: the folder {folder} does not exist; make it first"
        raise FileNotFoundError(message)
    if path.is_dir():
        message = f"{path}: is a folder; name a file"
        raise IsADirectoryError(message)
    if not os.access(folder, os.W_OK):
        message = f"{path}: the folder {folder} cannot be written; choose another with -o"
        raise PermissionError(message)
