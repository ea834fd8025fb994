# SPDX-License-Identifier: GPL-3.0-or-later
"""What commands need around them: Blender, optional packages, the output folder."""

from __future__ import annotations

import importlib.util
import tempfile
from importlib.metadata import version
from pathlib import Path

from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, is_plain
from .terminal import warn


def start_blender() -> None:
    """Load Blender. InputError if it is missing or would misread the temporary folder's name."""
    from .. import headless

    folder = Path(tempfile.gettempdir())
    if not is_plain(folder):
        message = f"{folder}: Blender misreads the name of this temporary folder; have TMPDIR name a plainer one"
        raise InputError(message)
    try:
        headless.prepare()
    except ImportError as error:
        raise InputError(str(error)) from error
    from ..nodegroups import versions as blenders

    if text := blenders.untested():
        warn(text)


def versions() -> dict[str, str]:
    """Versions of vgroove and Blender, without loading Blender."""
    return {"vgroove": version("vgroove"), "blender": version("bpy")}


def require_packages(*names: str, what: str = "report") -> None:
    """InputError if a package of the extra [report] is missing, which ``what`` needs."""
    missing = [name for name in names if importlib.util.find_spec(name) is None]
    if missing:
        message = f"{what} needs {' and '.join(missing)}; install them with: pip install 'vgroove[report]'"
        raise InputError(message)


def make_folder_of(file: Path) -> None:
    """Make the folder of an output file. InputError or OSError if the file could not be written there."""
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"{file.parent}: cannot be made: {error.strerror}; choose another with -o"
        raise InputError(message) from error
    check_writable(file)
