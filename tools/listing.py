# SPDX-License-Identifier: GPL-3.0-or-later
"""What a web server has to serve so that Blender finds the extension and its assets, by Blender's own commands.

python tools/listing.py extensions FOLDER [ZIP]     index.json beside a copy of the zip: a repository of extensions
python tools/listing.py library FOLDER [ASSETS]     a remote asset library of assets/VERSION/vgroove.blend

Static files; the addresses in them are relative, so that any server and folder will do. The library is for Blender 5.3
and later, and is written by it: 5.2 has remote libraries too, but its command does not know the marks in file names.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import package

ROOT = Path(__file__).parent.parent
EARLIEST = (5, 3)  # Blender's whose command knows from a file's name which Blender it suits
LIBRARY = "vgroove.blend"
META = {"api_versions": {}, "name": "V-Groove", "contact": {"name": "The vgroove authors"}}


def extensions(folder: Path, archive: Path) -> Path:
    """index.json, and the zip beside it; CalledProcessError if Blender's tool refuses it."""
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(archive, folder)
    subprocess.run(
        [sys.executable, str(package.blender_ext()), "server-generate", "--repo-dir", str(folder)], check=True
    )
    return folder / "index.json"


def versions(assets: Path) -> list[tuple[int, ...]]:
    """Of the Blenders that have a library in ``assets`` and can share a remote one, the earliest first."""
    found = (tuple(map(int, path.parent.name.split("."))) for path in assets.glob(f"[0-9]*.[0-9]*/{LIBRARY}"))
    return sorted(version for version in found if version >= EARLIEST)


def library(folder: Path, assets: Path) -> Path:
    """The library's first page. Empties this session.

    FileNotFoundError where ``assets`` has no library; RuntimeError in a Blender without the command, or where it fails.

    The file of the earliest Blender keeps its name; those of later ones say @bMAJOR_MINOR, from which on Blender shows
    them in its place.
    """
    found = versions(assets)
    if not found:
        message = f"{assets}: no library of Blender {'.'.join(map(str, EARLIEST))} or later; make assets writes one"
        raise FileNotFoundError(message)
    from vgroove import headless

    headless.prepare()
    import bpy

    if bpy.app.version < EARLIEST:
        message = f"Blender {bpy.app.version_string} cannot list {folder} as a remote library; make listing takes 5.3"
        raise RuntimeError(message)
    from _bpy_internal.assets import remote_library

    folder.mkdir(parents=True, exist_ok=True)
    for version in found:
        source = assets / ".".join(map(str, version))
        mark = "" if version == found[0] else "@b{}_{}".format(*version)
        shutil.copy(source / LIBRARY, folder / LIBRARY.replace(".blend", f"{mark}.blend"))
        shutil.copy(source / "blender_assets.cats.txt", folder)
    meta = folder / "_asset-library-meta.json"  # the command keeps its name and contact
    meta.write_text(json.dumps(META), encoding="utf-8")
    with headless.quiet():
        code = remote_library.asset_listing_main(["--quiet", "generate", str(folder)])
    if code:
        message = f"{folder}: Blender's asset_listing ended with {code}"
        raise RuntimeError(message)
    return meta


def main() -> None:
    what, folder, *source = sys.argv[1:]
    if what == "library":
        print(library(Path(folder), Path(source[0]) if source else ROOT / "assets"))
    else:
        made = sorted((ROOT / "dist").glob("vgroove-*.zip"), key=lambda path: path.stat().st_mtime)
        if not (source or made):
            sys.exit("dist/ has no zip: make package writes one")
        print(extensions(Path(folder), Path(source[0]) if source else made[-1]))


if __name__ == "__main__":
    main()
