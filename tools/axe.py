# SPDX-License-Identifier: GPL-3.0-or-later
"""axe-core, which finds what keeps people who use a keyboard or a screen reader out of a page; by npm, into .cache."""

from __future__ import annotations

import shutil
import subprocess
import tarfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from browser import Browser

PACKAGE = "axe-core@4.10.2"
FOLDER = Path(__file__).parents[1] / ".cache" / "axe"
SERIOUS = {"serious", "critical"}


class UnavailableError(Exception):
    """This machine cannot have axe; one line says why."""


def script() -> str:
    """What is run in a page."""
    path = FOLDER / "package" / "axe.min.js"
    if not path.exists():
        FOLDER.mkdir(parents=True, exist_ok=True)
        try:
            command = [shutil.which("npm") or "npm", "pack", "--silent", PACKAGE]
            done = subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            said = getattr(error, "stderr", "") or str(error)
            message = f"axe cannot be fetched: npm pack {PACKAGE} failed: {said.strip().splitlines()[-1]}"
            raise UnavailableError(message) from error
        with tarfile.open(FOLDER / done.stdout.strip()) as archive:
            archive.extractall(FOLDER, filter="data")
    return path.read_text(encoding="utf-8")


def serious(chromium: Browser) -> list[Any]:
    """Serious and critical faults of the open page: rule, help and the first element of each."""
    chromium.call("Runtime.evaluate", expression=script())
    found = chromium.run(
        """const found = await axe.run();
        return found.violations.map((one) => [one.impact, one.id, one.help, one.nodes[0].html]);"""
    )
    return [one for one in found if one[0] in SERIOUS]
