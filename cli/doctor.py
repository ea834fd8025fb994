# SPDX-License-Identifier: GPL-3.0-or-later
"""``vgroove doctor``: what is out of date or missing in the materials of a .blend, and a mended copy."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from ..addon.library.errors import InputError
from ..addon.library.files import replacing
from .environment import make_folder_of, start_blender
from .terminal import one_line, say

SceneArgument = Annotated[Path, typer.Argument(metavar="SCENE.blend", help="The file to look at; it is not changed")]
OutputOption = Annotated[Path | None, typer.Option("-o", "--output", metavar="FILE", help="The mended .blend")]


def doctor(
    file: SceneArgument,
    *,
    mends: Annotated[bool, typer.Option("--mend", help="Fix what can be fixed, and write the result to -o")] = False,
    output: OutputOption = None,
    as_json: Annotated[bool, typer.Option("--json", help="{problems, mended, said} instead of lines")] = False,
) -> int:
    """List what is out of date or missing in a scene's materials. Exits 1 if something is, or is left after --mend.

    Materials of earlier versions and of another Blender, deleted node groups and tables, lights that came or went,
    images that are neither packed nor on disk, presets that have other numbers now. Fixes are those of the panel.
    """
    _check(file, output, mends=mends)
    start_blender()
    import bpy

    from .. import headless
    from ..headless import doctor as examining
    from ..headless import scene

    said: list[str] = []
    mended: list[str] = []
    with headless.quiet():
        stage = scene.open_file(file, for_saving=True)
        found = examining.examine(stage)
        if output is not None:
            said = examining.mend(found)
            before, found = found, examining.examine(stage)
            left = {problem.key for problem in found}
            mended = [problem.text for problem in before if problem.key not in left]
            with replacing(output) as temporary:
                bpy.ops.wm.save_as_mainfile(filepath=str(temporary), copy=True, compress=True)
    if as_json:
        problems = [{"key": problem.key, "text": problem.text, "fixable": problem.fix is not None} for problem in found]
        print(json.dumps({"problems": problems, "mended": mended, "said": said}))
        return int(bool(found))
    for mark, texts in (("fixed", mended), ("note", said)):
        for text in texts:
            print(one_line(f"{mark}: {text}"))
    for problem in found:
        print(one_line(f"{'can be fixed' if problem.fix else 'problem'}: {problem.text}"))
    if not found:
        say(f"{output or file}: nothing is out of date or missing")
    return int(bool(found))


def _check(file: Path, output: Path | None, *, mends: bool) -> None:
    """InputError where the files do not go together."""
    if not file.is_file():
        message = f"{file}: no such scene; name a .blend file"
        raise InputError(message)
    if mends != (output is not None):
        message = "--mend and -o FILE go together: the mended scene is a file of its own"
        raise InputError(message)
    if output is not None:
        if output.suffix != ".blend":
            message = f"{output}: a scene is a .blend"
            raise InputError(message)
        make_folder_of(output)
