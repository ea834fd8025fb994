# SPDX-License-Identifier: GPL-3.0-or-later
"""What `pip install .` copies: every module, and every file that a module reads."""

import ast
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).parent.parent
ROOMS = ("addon", "batch", "cli", "headless", "lab", "nodegroups", "osl", "presets", "viewer")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
UNDER_OTHER_NAMES = {"PIL": "pillow"}
WITH_BLENDER = {"bpy", "bpy_extras", "mathutils", "addon_utils", "blf", "cycles", "_cycles", "imbuf", "oslquery"}
WITH_BLENDER |= {"OpenImageIO", "bmesh", "gpu", "gpu_extras", "io_scene_gltf2", "pxr"}


def files():
    found = (path for room in ROOMS for path in (ROOT / room).rglob("*") if path.is_file())
    return [path for path in found if path.parent.name != "__pycache__"]


def test_every_folder_of_modules_is_a_package():
    """With package-dir = the root, setuptools finds none by itself."""
    folders = {path.parent.relative_to(ROOT).as_posix() for path in files() if path.suffix == ".py"}
    listed = {name.replace(".", "/").removeprefix("vgroove/") for name in PROJECT["tool"]["setuptools"]["packages"]}
    assert listed == folders | {"vgroove"}


def test_every_other_file_is_package_data():
    patterns = PROJECT["tool"]["setuptools"]["package-data"]["vgroove"]
    copied = {path for pattern in patterns for path in ROOT.glob(pattern)}
    others = {path for path in files() if path.suffix != ".py"}
    assert others - copied == set()


def test_every_package_that_is_imported_is_named():
    """As a dependency, or of an extra."""
    extras = PROJECT["project"]["optional-dependencies"].values()
    needed = [*PROJECT["project"]["dependencies"], *(text for extra in extras for text in extra)]
    named = {re.match(r"[\w-]+", text)[0] for text in needed}
    imported = set()
    for path in files():
        if path.suffix == ".py":
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Import):
                    imported |= {one.name.split(".")[0] for one in node.names}
                elif isinstance(node, ast.ImportFrom) and not node.level:
                    imported.add(node.module.split(".")[0])
    foreign = imported - sys.stdlib_module_names - WITH_BLENDER
    assert {UNDER_OTHER_NAMES.get(name, name) for name in foreign} <= named


def test_the_command_is_installed():
    """By the name that README gives."""
    assert PROJECT["project"]["scripts"] == {"vgroove": "vgroove.cli:main"}
    vgroove = Path(sys.executable).with_name("vgroove")
    done = subprocess.run([vgroove, "presets", "copper", "--json"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
