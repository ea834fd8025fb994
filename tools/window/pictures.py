# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of README.md and docs/ that show Blender's window: docs/images/*.webp.

python tools/window/pictures.py              all
python tools/window/pictures.py panel nodes  those scenarios of steps_pictures.py alone

Needs previews/ (tools/previews.py), and what machine.py needs. Look at each picture before it is committed.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tools" / "window")]

import machine  # noqa: E402 - beside this file
import package  # noqa: E402
from session import Session  # noqa: E402

STEPS = Path(__file__).with_name("steps_pictures.py")
SCENARIOS = {
    "panel": ("panel", "grid"),
    "nodes": ("nodes",),
    "assets": ("assets",),
    "viewer": ("viewer",),
}  # and the pictures of each
LARGEST = 200_000  # bytes


def main() -> None:
    try:
        session = Session("pictures")
    except machine.UnavailableError as error:
        sys.exit(f"vgroove: {error}")
    with tempfile.TemporaryDirectory() as folder:
        session.install(package.package(Path(folder)))
    chosen = sys.argv[1:] or list(SCENARIOS)
    if "assets" in chosen and not (session.extension / "assets").exists():
        subprocess.run([sys.executable, ROOT / "tools" / "assets.py", session.extension / "assets"], check=True)
    for scenario in chosen:
        session.run(STEPS, scenario)
        for name in SCENARIOS[scenario]:
            made = session.folder / f"{name}.webp"
            if made.stat().st_size > LARGEST:
                sys.exit(f"vgroove: {made} has more than {LARGEST} bytes; show less, or lower its quality")
            print(shutil.copy(made, ROOT / "docs" / "images"))


if __name__ == "__main__":
    main()
