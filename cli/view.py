# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove view``: an interactive page of BRDFs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..addon.library.errors import InputError
from ..addon.library.files import check_writable, replacing
from .options import SetOption, TimeOption  # noqa: TC001 (typer reads annotations)
from .plot import BrdfsArgument, named
from .terminal import say

OutputOption = Annotated[Path, typer.Option("-o", "--output", metavar="PAGE.html", help="The page to write")]


def view(names: BrdfsArgument, output: OutputOption, *, settings: SetOption = None, at_time: TimeOption = None) -> None:
    """Write an interactive page: lobe, slices, albedo and spheres, with a slider for each parameter."""
    from ..viewer import page

    if len(names) > page.MOST:
        message = f"a page shows up to {page.MOST} BRDFs, got {len(names)}; write several pages"
        raise InputError(message)
    check_writable(output)
    text = page.page(list(named(names, settings, at_time).items()))
    with replacing(output) as temporary:
        temporary.write_text(text, encoding="utf-8")
    say(f"wrote {output}; open it in a browser")
