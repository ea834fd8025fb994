# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the user's own presets: rendered one at a time by a Blender in the background, so the window goes on.

They lie in the folder that Blender gives the extension, as FAMILY/MATERIAL.webp, wherever the presets themselves lie.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from . import background, thumbnails
from .background import PAUSE

if TYPE_CHECKING:
    from pathlib import Path

MODULE = ".addon.choose.picture"
_waiting: list[str] = []  # ids, the next one first
_running: dict[str, background.Job] = {}  # at most one, by id


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
        _running.pop(identity).stop()
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
    return background.command(MODULE, identity, str(path_of(identity)))


def _look() -> float | None:
    """Called by Blender until nothing waits: shows what is ready and starts the next one."""
    for identity, job in list(_running.items()):
        if job.is_running:
            return PAUSE
        del _running[identity]
        if why := job.failure():
            how = f"Blender in the background ended with {job.process.returncode}: {why}"
            print(f"V-Groove: no picture of {identity}: {how}")
        thumbnails.forget(identity)
    if not _waiting:
        return None
    identity = _waiting.pop(0)
    try:
        _running[identity] = background.Job(command(identity))
    except OSError as error:
        print(f"V-Groove: no picture of {identity}: {bpy.app.binary_path} cannot be started: {error.strerror}")
    return PAUSE
