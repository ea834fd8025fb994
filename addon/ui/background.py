# SPDX-License-Identifier: GPL-3.0-or-later
"""Another Blender in the background, which runs one function of this extension, so the window stays responsive."""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

import bpy

from ..library import presets

ROOT = Path(__file__).parents[2]
PAUSE = 0.5  # seconds between looks at the other Blender
# Loads this folder as a package of any name: the other Blender starts with factory settings, without extensions.
SCRIPT = """
import importlib, importlib.util, sys, bpy
root = {root!r}
spec = importlib.util.spec_from_file_location({name!r}, root + "/__init__.py", submodule_search_locations=[root])
sys.modules[spec.name] = importlib.util.module_from_spec(spec)
importlib.import_module(spec.name + {module!r}).main()
"""


def script(module: str) -> str:
    """What the other Blender runs: ``main()`` of a module, ".addon.choose.picture" for example."""
    return SCRIPT.format(name="vgroove_background", root=str(ROOT), module=module)


def command(module: str, *arguments: str) -> list[str]:
    """The other Blender's command line; empty where Blender is a module of Python and has no program."""
    if not bpy.app.binary_path:
        return []
    threads = max(1, (os.cpu_count() or 1) // 2)  # the rest is for whoever works in the window
    options = ["--background", "--factory-startup", "--offline-mode", "--threads", str(threads)]
    options += ["--python-exit-code", "1", "--python-expr", script(module)]
    return [bpy.app.binary_path, *options, "--", *arguments]


class Job:
    """One run of such a command. OSError if it cannot be started."""

    def __init__(self, line: list[str]) -> None:
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed when it has ended
        self.process = subprocess.Popen(
            line,
            env=os.environ | {presets.USER_FOLDER: str(presets.user_folder())},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=self._errors,
            creationflags=getattr(subprocess, "CREATE_NO_WINDOW", 0),  # Windows would open a console
        )

    @property
    def is_running(self) -> bool:
        return self.process.poll() is None

    def failure(self) -> str:
        """Of a job that has ended: its last line of complaint; empty if it went well. Ask once."""
        with self._errors:
            self._errors.seek(0)
            lines = self._errors.read().decode(errors="replace").split("\n")
        if not self.process.returncode:
            return ""
        return next((line.strip() for line in reversed(lines) if line.strip()), "it gave no reason")

    def stop(self) -> None:
        """End it now."""
        self.process.kill()
        self.process.wait()
        self._errors.close()
