# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove view``: an interactive page of BRDFs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..addon.library import presets
from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, replacing
from .terminal import say

if TYPE_CHECKING:
    from ..addon.library.preset import Preset
    from ..addon.measured import Table

ENDINGS = {".binary", ".bsdf", ".astm", ".bin"}  # of measured files

NamesArgument = Annotated[
    list[str],
    typer.Argument(metavar="PRESET|FILE...", help="Presets' ids, or files of measured BRDFs; up to eight"),
]
OutputOption = Annotated[Path, typer.Option("--output", "-o", metavar="PAGE.html", help="The page to write")]


def view(names: NamesArgument, *, output: OutputOption) -> None:
    """Write an interactive page: lobe, slices, albedo and spheres, with a slider for each parameter."""
    from ..viewer import page

    if len(names) > page.MOST:
        message = f"a page shows up to {page.MOST} BRDFs, got {len(names)}; write several pages"
        raise InputError(message)
    check_writable(output)
    text = page.page([_named(name) for name in names])
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    say(f"wrote {output}; open it in a browser")


def _named(name: str) -> tuple[str, Preset | Table]:
    path = Path(name)
    if path.suffix.lower() in ENDINGS or path.is_file():
        from ..addon.measured import read

        return path.stem, read(path)
    preset = presets.find(name)
    return preset.name, preset
