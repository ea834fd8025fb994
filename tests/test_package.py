# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's zip: built and validated by Blender's tool, installed and enabled in a fresh Blender."""

import importlib.util
import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.blender
ROOT = Path(__file__).parent.parent

INSTALL = """
import json, pathlib, sys
import bpy, addon_utils
addon_utils.enable("bl_pkg", default_set=True)
bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
name = "bl_ext.user_default.vgroove"
states = [bool(addon_utils.check(name)[1])]
module = sys.modules[name]
scene = bpy.context.scene
mesh = bpy.data.objects.new("Ball", bpy.data.meshes.new("Ball"))
scene.collection.objects.link(mesh)
mesh.select_set(True)
scene.vgroove.preset, scene.vgroove.estimator = "lecture/copper", "mirror"
done = bpy.ops.vgroove.apply()
bpy.context.view_layer.objects.active = mesh
kept = bpy.context.preferences.addons[name].preferences
liked = []
for _ in range(3):
    bpy.ops.vgroove.favourite()
    liked.append(kept.favourites)
bpy.ops.vgroove.save_preset(name="My Copper")
own = {"liked": liked, "recent": kept.recent, "chosen": scene.vgroove.shown}
own["files"] = [str(path) for path in pathlib.Path(bpy.utils.resource_path("USER")).rglob("my_copper.toml")]
for state in (False, True):
    addon_utils.enable(name) if state else addon_utils.disable(name)
    states.append(hasattr(bpy.types.Scene, "vgroove"))
warnings = addon_utils._extensions_warnings_get()
print("RESULT", json.dumps({"states": states, "material": mesh.active_material.name, "done": list(done), "own": own,
    "warnings": {key: list(value) for key, value in warnings.items()}, "path": module.__file__,
    "root": sys.modules[name + ".addon.ui.preferences"].ROOT}))
"""


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    spec = importlib.util.spec_from_file_location("package", ROOT / "tools" / "package.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.package(tmp_path_factory.mktemp("dist"))


def test_the_zip_holds_what_blender_needs_and_nothing_else(archive):
    """Models, shaders, groups and presets; no tests, tools, command line or caches."""
    names = zipfile.ZipFile(archive).namelist()
    for needed in ("blender_manifest.toml", "__init__.py", "LICENSE", "osl/include/vgroove.h", "nodegroups/_tree.py"):
        assert needed in names
    assert sum(name.startswith("presets/") for name in names) >= 6
    for name in names:
        assert not name.startswith(("tests/", "tools/", "bench/", "docs/", "build/", ".")), name
        assert "__pycache__" not in name
        assert name not in {"addon/cli.py", "addon/headless.py", "addon/check.py", "pyproject.toml", "Makefile"}


def test_no_module_of_the_extension_touches_what_blender_refuses(archive):
    """No sys.path changes, no network, no absolute imports of ourselves."""
    file = zipfile.ZipFile(archive)
    for name in file.namelist():
        if name.endswith(".py"):
            text = file.read(name).decode()
            for word in (
                "sys.path",
                "import socket",
                "urllib",
                "requests",
                "from vgroove",
                "import vgroove",
                "subprocess",
            ):
                assert word not in text.replace("from vgroove.addon.reference import Lambert", ""), (name, word)


def test_the_zip_installs_enables_and_applies_without_a_warning(archive, tmp_path):
    """In a Blender with no settings: enabled, applied, marked and kept, off and on again, no policy warning."""
    done = subprocess.run(
        [sys.executable, "-c", "import sys; sys.modules['vgroove'] = None\n" + INSTALL, str(archive)],
        env={**os.environ, "BLENDER_USER_RESOURCES": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    line = next((line for line in done.stdout.splitlines() if line.startswith("RESULT ")), None)
    assert line, done.stdout + done.stderr
    result = json.loads(line.removeprefix("RESULT "))
    assert result["states"] == [True, False, True]
    assert result["done"] == ["FINISHED"]
    assert result["material"] == "Copper (Mirror)"
    assert result["warnings"] == {}
    own = result["own"]
    assert own["liked"] == ["lecture/copper", "", "lecture/copper"]
    assert own["recent"] == "lecture/copper"
    assert own["chosen"] == "mine/my_copper"
    (kept,) = own["files"]  # in the folder that Blender gives an extension, not in the extension
    assert ".user/user_default/vgroove/presets/" in kept
    assert result["path"].startswith(str(tmp_path))
    assert result["root"] == "bl_ext.user_default.vgroove"
    assert "Traceback" not in done.stderr
