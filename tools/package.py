# SPDX-License-Identifier: GPL-3.0-or-later
"""Build and validate the extension's zip with the tool that comes inside the bpy wheel.

python tools/package.py FOLDER

The same files give the same bytes: names in order, and one time for all, SOURCE_DATE_EPOCH or the first of 1980.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
# All that goes in, whatever else lies in the folder; previews and assets where they were made.
PARTS = "__init__.py", "blender_manifest.toml", "LICENSE", "addon", "nodegroups", "osl", "presets", "previews", "assets"
FIRST_OF_ZIP = 315532800  # seconds to 1980-01-01, before which a zip has no dates


def blender_ext() -> Path:
    """Blender's command line tool for extensions, found without importing Blender."""
    found = importlib.util.find_spec("bpy")
    assert found is not None
    assert found.origin is not None
    return next(Path(found.origin).parent.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))


def package(folder: Path) -> Path:
    """The zip, made in ``folder``; CalledProcessError if Blender's tool refuses it."""
    folder.mkdir(parents=True, exist_ok=True)
    tool = [sys.executable, str(blender_ext())]
    with tempfile.TemporaryDirectory() as source:
        for part in filter(Path.exists, (ROOT / name for name in PARTS)):
            copy = shutil.copytree if part.is_dir() else shutil.copy
            copy(part, Path(source) / part.name)
        subprocess.run([*tool, "build", "--source-dir", source, "--output-dir", str(folder)], check=True)
    newest = max(folder.glob("vgroove-*.zip"), key=lambda path: path.stat().st_mtime)
    repack_zip(newest)
    subprocess.run([*tool, "validate", str(newest)], check=True)
    return newest


def moment() -> int:
    """The time that all files in an archive get, in seconds since 1970."""
    return max(int(os.environ.get("SOURCE_DATE_EPOCH", "0")), FIRST_OF_ZIP)


def repack_zip(path: Path) -> None:
    """Rewrite a zip or a wheel so that its bytes depend on its files alone; a wheel's .dist-info stays last."""
    part, when = path.with_suffix(".part"), time.gmtime(moment())[:6]
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(part, "w") as new:
        for name in sorted(old.namelist(), key=lambda name: (".dist-info/" in name, name)):
            info = zipfile.ZipInfo(name, when)
            info.external_attr = 0o100644 << 16  # else executable or not as the umask of whoever built it
            new.writestr(info, old.read(name), zipfile.ZIP_DEFLATED, 9)
    part.replace(path)


if __name__ == "__main__":
    print(package(Path(sys.argv[1])))
