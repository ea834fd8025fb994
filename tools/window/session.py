# SPDX-License-Identifier: GPL-3.0-or-later
"""Run a scenario in Blender's window: the extension is installed from its zip by Blender's own command."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import machine

HANDS = Path(__file__).parent / "hands.py"
SECONDS = 1200  # after which a Blender that hangs is ended; hands.py ends scenarios that work too long
SETTINGS = "with", "without"  # the extension
SESSIONS = "sessions"  # folder of all sessions, at the root of Blender's system
ERRORS = "Traceback", "Error", "ERROR"  # in what Blender prints
PREPARE = """
import bpy
view = bpy.context.preferences.view
view.show_splash = view.show_tooltips = False
view.smooth_view = 0
bpy.ops.wm.save_userpref()
"""


class Session:
    """A folder in Blender's system, with settings of its own."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.folder = machine.set_up() / SESSIONS / name
        shutil.rmtree(self.folder, ignore_errors=True)
        for settings in SETTINGS:  # Blender takes others where the folder is not there
            (self.folder / settings).mkdir(parents=True)

    @property
    def place(self) -> str:
        """The folder as Blender sees it."""
        return f"/{SESSIONS}/{self.name}"

    @property
    def extension(self) -> Path:
        """The installed extension."""
        return self.folder / "with" / "extensions" / "user_default" / "vgroove"

    def install(self, archive: Path) -> None:
        """The zip, by the command that Blender has for it; in the settings ``with``, but not in ``without``."""
        shutil.copy(archive, self.folder / archive.name)
        where = f"{self.place}/{archive.name}"
        self.blender("with", "--command", "extension", "install-file", "-r", "user_default", "-e", where)
        for settings in SETTINGS:
            self.blender(settings, "--background", "--python-expr", PREPARE)

    def run(self, script: Path, name: str, settings: str = "with") -> dict[str, Any]:
        """What a scenario noted; AssertionError with its traceback where it failed or Blender printed an error."""
        shutil.copy(HANDS, self.folder)
        shutil.copy(script, self.folder)
        outcome = self.folder / "outcome.json"
        outcome.unlink(missing_ok=True)
        said = self.blender(
            settings, "--gpu-backend", "opengl", "--window-geometry", "0", "0", *map(str, machine.PIXELS),
            "--enable-event-simulate", "--python-exit-code", "1",
            "--python", f"{self.place}/{HANDS.name}", "--", f"{self.place}/{script.name}", name,
            screen=True,
        )  # fmt: skip
        found = json.loads(outcome.read_text(encoding="utf-8")) if outcome.exists() else {"failed": "Blender ended"}
        assert not found["failed"], f"{found['failed']}\n{said}"
        assert not any(word in said for word in ERRORS), said
        return found["notes"]

    def blender(self, settings: str, *arguments: str, screen: bool = False, network: bool = False) -> str:
        """What Blender prints."""
        size = "x".join(map(str, machine.PIXELS))
        on = ["xvfb-run", "--auto-servernum", "--server-args", f"-screen 0 {size}x24"] if screen else []
        user = f"BLENDER_USER_RESOURCES={self.place}/{settings}"
        command = machine.inside(
            "env", "LIBGL_ALWAYS_SOFTWARE=1", user, *on, "blender", *arguments, alone=True, network=network
        )
        done = subprocess.run(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, stdin=subprocess.DEVNULL,
            timeout=SECONDS, check=False,
        )  # fmt: skip
        assert screen or not done.returncode, done.stdout
        return done.stdout
