# SPDX-License-Identifier: GPL-3.0-or-later
"""What the bpy wheel needs and a real Blender does not. Used by the command line and the tests, never the extension."""

from __future__ import annotations

import importlib.util
import os
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

OVERFLOW = b"out of SVM stack space"  # what Cycles says of a shader that is too big; it then renders it black


def prepare() -> None:
    """Put the wheel's own site-packages first: oslquery lies there, and the OpenImageIO that it was built with.

    Must run before anything imports OpenImageIO; another build of it in the same process breaks script nodes.
    """
    found = importlib.util.find_spec("bpy")
    if found is None or found.origin is None:
        message = "the module bpy is not installed; install vgroove with Python 3.13 (Blender 5) or 3.11 (Blender 4.5)"
        raise ImportError(message)
    folder = next(Path(found.origin).parent.glob("*/python/lib/python*/site-packages"))
    if str(folder) not in sys.path:
        sys.path.insert(0, str(folder))
    with quiet():  # it prints where it found its colour management
        import bpy

    bpy.context.preferences.filepaths.use_scripts_auto_execute = False


@contextmanager
def quiet() -> Iterator[None]:
    """Keep Blender's own lines ("Saved: ...") off standard output, down to the C level."""
    sys.stdout.flush()
    kept = os.dup(1)
    with Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        os.dup2(nowhere.fileno(), 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)


OVERFLOWED = (
    "a material has more nodes than Cycles has stack for and is black: "
    "remove nodes or textures from it, or choose Standard"
)


def stack_overflows(render: Callable[[], object]) -> bool:
    """Whether Cycles ran out of stack in ``render()``: it says so on the standard streams, at the C level, alone.

    What else it says on standard output is left out; standard error gets its own back.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    kept = {stream: os.dup(stream) for stream in (1, 2)}
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        try:
            for stream, heard in ((1, out), (2, err)):
                os.dup2(heard.fileno(), stream)
            render()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            for stream, before in kept.items():
                os.dup2(before, stream)
                os.close(before)
            for heard in (out, err):
                heard.seek(0)
            said = out.read(), err.read()
            with os.fdopen(os.dup(2), "wb") as given:  # also where the render failed
                given.write(said[1])
        return OVERFLOW in b"".join(said)
