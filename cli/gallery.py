# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove gallery``: a page of the stills of a batch."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..addon.library.errors import InputError
from ..addon.library.files import check_writable
from .environment import start_blender
from .terminal import progress, say

FolderArgument = Annotated[Path, typer.Argument(metavar="DIR", help="The folder that `vgroove batch` rendered to")]
OutputOption = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="FILE", help="The page; default: gallery.html in that folder"),
]


def gallery(folder: FolderArgument, output: OutputOption = None) -> None:
    """Make a web page from a folder of stills: labelled thumbnails, and a filter."""
    if not folder.is_dir():
        message = f"{folder}: no such folder; name one that `vgroove batch` rendered to"
        raise InputError(message)
    start_blender()
    from .. import headless
    from ..batch import gallery as page

    path = output or folder / page.FILE
    check_writable(path)
    found = page.stills(folder)
    if not found:
        message = f"{folder}: holds no stills of `vgroove batch`"
        raise InputError(message)
    with headless.quiet():
        page.write_page(path, folder, progress(found, "drawing", len(found)), len(found))
    say(f"wrote {path} of {len(found)} stills")
