# SPDX-License-Identifier: GPL-3.0-or-later
"""The listings of extension and assets: written by Blender's commands, served, and read by Blender itself."""

import json
import os
import subprocess
import sys

import pytest

from vgroove import headless
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.library import presets
from vgroove.nodegroups import versions

from ..scripts import load
from ..serving import served

pytestmark = pytest.mark.blender
listing, package = load("listing"), load("package")
CATALOG = "a5fc2f08-a3a4-5c52-a5b2-8bb2ea57ab0b"

INSTALL = """
import json, sys
import bpy, addon_utils
addon_utils.enable("bl_pkg", default_set=True)
preferences = bpy.context.preferences
preferences.system.use_online_access = True
repos = preferences.extensions.repos
for repo in list(repos):
    repos.remove(repo)
repos.new(name="Ours", module="ours", remote_url=sys.argv[1] + "/index.json")
said = [bpy.ops.extensions.repo_sync_all(), bpy.ops.extensions.package_install(repo_index=0, pkg_id="vgroove")]
module = "bl_ext.ours.vgroove"
print("RESULT", json.dumps({"said": [list(one) for one in said], "on": addon_utils.check(module)[1],
    "file": sys.modules[module].__file__}))
"""

READ = """
import json, sys, time
from pathlib import Path

def read(address, folder):
    from vgroove import headless
    headless.prepare()
    import bpy
    from _bpy_internal.assets.remote_library import asset_downloader, listing_downloader

    ended = []
    reader = listing_downloader.RemoteAssetListingDownloader(
        remote_url=address, local_path=folder, auth_token="",
        on_update_callback=lambda *_: None, on_done_callback=ended.append)
    reader.download_and_process()
    while not ended:
        reader.on_timer_event()
        time.sleep(0.05)
    if reader.status != listing_downloader.DownloadStatus.FINISHED_SUCCESSFULLY:
        sys.exit(f"{reader.status} {reader.error_message}")
    (page,) = (json.loads(path.read_text()) for path in sorted(folder.glob("_v1/assets-*.json")))
    here = bpy.app.version[:2]
    def suits(asset):
        least, until = (asset["bl_versions"].get(name) for name in ("min", "until"))
        bounds = [tuple(map(int, text.split("."))) if text else None for text in (least, until)]
        return bounds[0] <= here and (bounds[1] is None or here < bounds[1])
    (asset,) = filter(suits, page["assets"])
    (file,) = (one for one in page["files"] if one["path"] == asset["files"][0])
    asset_downloader.download_asset_file(
        address, "", folder, file.get("url", ""), file["hash"], folder / file["path"])
    loader = asset_downloader._asset_downloaders[address]
    until = time.monotonic() + 60
    while not (folder / file["path"]).exists() and time.monotonic() < until:
        loader.on_timer_event()
        time.sleep(0.05)
    with bpy.data.libraries.load(str(folder / file["path"]), link=False, assets_only=True) as (there, here):
        here.materials = there.materials
    from vgroove.addon.blender.material import origin_of
    print("RESULT", json.dumps({"asset": asset, "built": [origin_of(one).preset.id for one in here.materials]}))
    sys.stdout.flush()

if __name__ == "__main__":  # the reader begins processes, which import this file again
    read(sys.argv[1], Path(sys.argv[2]))
"""


def result(script, user, *arguments):
    """What a script prints as its result in a Blender with no settings."""
    keep = {"BLENDER_USER_RESOURCES": str(user), "no_proxy": "127.0.0.1"}
    done = subprocess.run(
        [sys.executable, script, *map(str, arguments)], env=os.environ | keep,
        capture_output=True, text=True, check=False, timeout=300,
    )  # fmt: skip
    line = next((line for line in done.stdout.splitlines() if line.startswith("RESULT ")), None)
    assert line, done.stdout + done.stderr
    return json.loads(line.removeprefix("RESULT "))


def test_the_extension_installs_from_its_listing(tmp_path):
    """By the operators behind *Get Extensions*, from a repository that holds nothing but ours; it is switched on."""
    index = listing.extensions(tmp_path / "served", package.package(tmp_path / "dist"))
    (entry,) = json.loads(index.read_text(encoding="utf-8"))["data"]
    assert entry["id"] == "vgroove"
    assert entry["archive_url"].startswith("./")  # moves with the folder
    script = tmp_path / "install.py"
    script.write_text("import sys; sys.modules['vgroove'] = None\n" + INSTALL, encoding="utf-8")
    with served(tmp_path / "served") as (address, asked):
        found = result(script, tmp_path / "user", address)
    assert found["said"] == [["FINISHED"], ["FINISHED"]]
    assert found["on"]
    assert found["file"].startswith(str(tmp_path / "user"))
    assert [path.partition("?")[0] for path in asked] == ["/index.json", f"/{entry['archive_url'][2:]}"]


@pytest.fixture
def assets(blender, tmp_path):
    """A library of one preset for 4.5, 5.3 and 5.4; each has another preset."""
    blender.context.scene.render.engine = "CYCLES"
    for version, name in (("4.5", "iron"), ("5.3", "copper"), ("5.4", "gold")):
        folder = tmp_path / "assets" / version
        folder.mkdir(parents=True)
        with headless.quiet():
            blender.ops.wm.read_homefile(use_empty=True, use_factory_startup=True)
            made = build(presets.find(f"metals/{name}"), Choice("nodes", "closure"))
            made.asset_mark()
            made.asset_data.catalog_id = CATALOG
            blender.ops.wm.save_as_mainfile(filepath=str(folder / "vgroove.blend"), copy=True)
        (folder / "blender_assets.cats.txt").write_text(f"VERSION 1\n\n{CATALOG}:V-Groove/Metals:M\n", "utf-8")
    return tmp_path / "assets"


def test_the_remote_library_is_read_by_blender(assets, tmp_path):
    """Its own reader checks each page, and finds of two files the one for this Blender, whose material is ours.

    Blenders before 5.3 refuse to list anything, in one line.
    """
    if not versions.since(*listing.EARLIEST):
        with pytest.raises(RuntimeError, match=r"make listing takes 5\.3$"):
            listing.library(tmp_path / "served", assets)
        assert not (tmp_path / "served").exists()
        return
    meta = listing.library(tmp_path / "served", assets)
    assert json.loads(meta.read_text(encoding="utf-8"))["name"] == "V-Groove"
    script = tmp_path / "read.py"
    script.write_text(READ, encoding="utf-8")
    with served(tmp_path / "served") as (address, asked):
        found = result(script, tmp_path / "user", address, tmp_path / "here")
    assert found["built"] == ["metals/copper"]
    assert found["asset"]["meta"]["catalog_id"] == CATALOG
    assert found["asset"]["files"] == ["vgroove.blend"]
    assert any(path.startswith("/vgroove.blend") for path in asked)
    assert not any("iron" in path.read_text(encoding="utf-8") for path in (tmp_path / "served").rglob("*.json"))


def test_without_a_library_nothing_is_listed(tmp_path):
    """Nor of a Blender that has no remote ones."""
    (tmp_path / "assets" / "4.5").mkdir(parents=True)
    (tmp_path / "assets" / "4.5" / "vgroove.blend").touch()
    with pytest.raises(FileNotFoundError, match=r"no library of Blender 5\.3 or later"):
        listing.library(tmp_path / "served", tmp_path / "assets")
    assert not (tmp_path / "served").exists()
