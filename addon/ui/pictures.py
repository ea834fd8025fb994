# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the user's own presets: rendered one at a time by a Blender in the background, so the window goes on.

They lie in the folder that Blender gives the extension, as FAMILY/MATERIAL.webp, wherever the presets themselves lie.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path
from typing import IO

import bpy

from ..library import presets
from . import thumbnails

ROOT = Path(__file__).parents[2]
PAUSE = 0.5  # seconds between looks at the other Blender
# Loads this folder as a package of any name: the other Blender starts with factory settings, without extensions.
SCRIPT = """
import importlib, importlib.util, sys, bpy
root = {root!r}
spec = importlib.util.spec_from_file_location({name!r}, root + "/__init__.py", submodule_search_locations=[root])
sys.modules[spec.name] = importlib.util.module_from_spec(spec)
importlib.import_module(spec.name + ".addon." + {module!r}).main()
"""
_waiting: list[str] = []  # ids, the next one first
_running: dict[str, tuple[subprocess.Popen[bytes], IO[bytes]]] = {}  # at most one, by id: it, and what it complains of


def request(identity: str) -> None:
    """Have one of the user's presets rendered. Does nothing where there is no Blender to run or no folder."""
    if path_of(identity) is None or not command(identity):
        return
    cancel(identity)
    _waiting.append(identity)
    if not bpy.app.timers.is_registered(_look):
        bpy.app.timers.register(_look, first_interval=PAUSE, persistent=True)


def rename(before: str, now: str) -> None:
    """A preset's picture follows it to another id; one that is not ready is rendered by the new one."""
    old, new = path_of(before), path_of(now)
    if before == now or old is None or new is None:
        return
    unfinished = cancel(before)
    if old.is_file():
        new.parent.mkdir(parents=True, exist_ok=True)
        old.replace(new)
        thumbnails.forget(before)
        thumbnails.forget(now)
    if unfinished:
        request(now)


def delete(identity: str) -> None:
    """A preset's picture goes with it."""
    cancel(identity)
    path = path_of(identity)
    if path is not None:
        path.unlink(missing_ok=True)
        thumbnails.forget(identity)


def cancel(identity: str) -> bool:
    """Whether a picture was asked for and is not there yet; it is no longer made."""
    asked = identity in _waiting or identity in _running
    _waiting[:] = [one for one in _waiting if one != identity]
    if identity in _running:
        process, errors = _running.pop(identity)
        process.kill()
        process.wait()
        errors.close()
    return asked


def unregister() -> None:
    """No more pictures; Blender ends or the extension is switched off."""
    for identity in [*_waiting, *_running]:
        cancel(identity)
    if bpy.app.timers.is_registered(_look):
        bpy.app.timers.unregister(_look)


def path_of(identity: str) -> Path | None:
    """Where the picture of a user's preset is, or will be."""
    folder = thumbnails.own_folder()
    return folder / f"{identity}.webp" if folder else None


def command(identity: str) -> list[str]:
    """The other Blender's command line; empty where Blender is a module of Python and has no program."""
    return background("choose.picture", identity, str(path_of(identity)))


def background(module: str, *arguments: str) -> list[str]:
    """The command line of another Blender that runs ``main`` of a module of addon/; empty as above."""
    if not bpy.app.binary_path:
        return []
    script = SCRIPT.format(name="vgroove_background", root=str(ROOT), module=module)
    threads = max(1, (os.cpu_count() or 1) // 2)  # the rest is for whoever works in the window
    options = ["--background", "--factory-startup", "--offline-mode", "--threads", str(threads)]
    options += ["--python-exit-code", "1", "--python-expr", script]
    return [bpy.app.binary_path, *options, "--", *arguments]


def _look() -> float | None:
    """Called by Blender until nothing waits: shows what is ready and starts the next one."""
    for identity, (process, errors) in list(_running.items()):
        if process.poll() is None:
            return PAUSE
        del _running[identity]
        with errors:
            errors.seek(0)
            lines = errors.read().decode(errors="replace").split("\n")
        if process.returncode:
            why = next((line for line in reversed(lines) if line.strip()), "it gave no reason")
            how = f"Blender in the background ended with {process.returncode}: {why.strip()}"
            print(f"V-Groove: no picture of {identity}: {how}")
        thumbnails.forget(identity)
    if not _waiting:
        return None
    identity = _waiting.pop(0)
    try:
        _running[identity] = _start(identity)
    except OSError as error:
        print(f"V-Groove: no picture of {identity}: {bpy.app.binary_path} cannot be started: {error.strerror}")
    return PAUSE


def _start(identity: str) -> tuple[subprocess.Popen[bytes], IO[bytes]]:
    errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed when it has ended
    process = subprocess.Popen(
        command(identity),
        env=os.environ | {presets.USER_FOLDER: str(presets.user_folder())},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=errors,
        creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),  # Windows would open a console
    )
    return process, errors
