# SPDX-License-Identifier: GPL-3.0-or-later
"""Build and validate the extension's zip with the tool that comes inside the bpy wheel.

python tools/package.py FOLDER
"""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
# All that goes in, whatever else lies in the folder; previews and assets where they were made.
PARTS = "__init__.py", "blender_manifest.toml", "LICENSE", "addon", "nodegroups", "osl", "presets", "previews", "assets"


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
    subprocess.run([*tool, "validate", str(newest)], check=True)
    return newest


if __name__ == "__main__":
    print(package(Path(sys.argv[1])))
