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
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

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
    "film": ("film",),
}  # and the pictures of each
LARGEST = 200_000  # bytes
FILM = 2_000_000
POINTER = np.array([(0, 0), (0, 17), (4, 13), (7, 19), (10, 18), (7, 12), (12, 12)])


def write_film(folder: Path, notes: dict[str, Any]) -> Path:
    """Frames and a pointer as one moving WebP of half the width."""
    left, top, width, height = notes["part"]
    images = []
    for path, (_, x, y) in zip(sorted(folder.glob("film_*.png")), notes["frames"], strict=True):
        image = Image.open(path).convert("RGB")
        ImageDraw.Draw(image).polygon([tuple(map(int, at)) for at in np.add(POINTER, (x, y))], "white", "black")
        images.append(image.crop((left, top, left + width, top + height)).resize((width * 2 // 3, height * 2 // 3)))
    made = folder / "film.webp"
    times = [milliseconds for milliseconds, *_ in notes["frames"]]
    images[0].save(made, save_all=True, append_images=images[1:], duration=times, loop=0, quality=75, method=6)
    return made


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
        notes = session.run(STEPS, scenario)
        if scenario == "film":
            write_film(session.folder, notes)
        for name in SCENARIOS[scenario]:
            made = session.folder / f"{name}.webp"
            largest = FILM if name == "film" else LARGEST
            if made.stat().st_size > largest:
                sys.exit(f"vgroove: {made} has more than {largest} bytes; show less, or lower its quality")
            print(shutil.copy(made, ROOT / "docs" / "images"))


if __name__ == "__main__":
    main()
