# SPDX-License-Identifier: GPL-3.0-or-later
"""A picture of every preset, for the panel and the asset library: previews/FAMILY/MATERIAL.webp.

python tools/previews.py                      all that are missing, or made of another preset file or another studio
python tools/previews.py --all                all, anew
python tools/previews.py metals/gold water    those alone, anew

python tools/previews.py --pixels 80 --folder build/look      small ones, in a tenth of the time, to look at

``addon/blender/studio.py`` is the scene. FOLDER/digests.json says what each picture was made of: a run that was
interrupted resumes.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import time
from pathlib import Path
from typing import TYPE_CHECKING

from rich.progress import Progress

from vgroove import headless

headless.prepare()

from vgroove.addon.blender import shapes, studio  # noqa: E402 - after prepare()
from vgroove.addon.choose import picture  # noqa: E402
from vgroove.addon.library import presets  # noqa: E402
from vgroove.addon.library.files import write_text  # noqa: E402
from vgroove.lab.bench.digest import source  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Sequence

FOLDER = Path(__file__).parent.parent / "previews"
DIGESTS = "digests.json"
STUDIO = "".join(source(Path(module.__file__ or "")) for module in (shapes, studio, picture))
UNSEEN = {"abbe"}  # parameters that a picture does not show: dispersion is off unless asked for


def digest(preset: presets.Preset) -> str:
    """Of what a picture shows: the preset's shape, model and numbers, and the code of the studio."""
    numbers = sorted((name, value) for name, value in preset.parameters.items() if name not in UNSEEN)
    shown = studio.shape_of(preset), preset.model, preset.kind, preset.flags, numbers, preset.time
    return hashlib.sha256(f"{STUDIO}{shown}".encode()).hexdigest()[:16]


def read_digests(folder: Path) -> dict[str, str]:
    """Of the pictures in ``folder``, by preset."""
    path = folder / DIGESTS
    return json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}


def wanted(names: Sequence[str], folder: Path, *, everything: bool = False) -> list[presets.Preset]:
    """The presets named, else those whose picture is missing or was made of something else."""
    if names:
        return [presets.find(name) for name in names]
    known = read_digests(folder)

    def is_old(preset: presets.Preset) -> bool:
        return known.get(preset.id) != digest(preset) or not (folder / f"{preset.id}.webp").is_file()

    return [preset for preset in presets.shipped().values() if everything or is_old(preset)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="PRESET")
    parser.add_argument("--all", action="store_true", help="every preset, also where the picture is new enough")
    parser.add_argument("--folder", type=Path, default=FOLDER)
    parser.add_argument("--pixels", type=int, default=studio.PIXELS, help="width and height")
    arguments = parser.parse_args()
    folder, start, cpu = arguments.folder, time.perf_counter(), time.process_time()
    chosen = wanted(arguments.names, folder, everything=arguments.all)
    known = read_digests(folder)
    with headless.quiet():
        shown = studio.scene()
    shown.render.resolution_x = shown.render.resolution_y = arguments.pixels
    with Progress() as progress:
        for preset in progress.track(chosen, description="previews"):
            with headless.quiet():
                picture.render(shown, preset, folder / f"{preset.id}.webp")
            known[preset.id] = digest(preset)
            write_text(folder / DIGESTS, json.dumps(known, indent=0))
    size = sum(path.stat().st_size for path in folder.glob("*/*.webp"))
    taken = f"{time.perf_counter() - start:.0f} s ({time.process_time() - cpu:.0f} s of CPU time)"
    print(f"{len(chosen)} pictures in {taken}; all together {size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
