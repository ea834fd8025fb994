# SPDX-License-Identifier: GPL-3.0-or-later
"""Wheel and sdist: whole, the same each time, and enough by themselves, where there is no source, git or make."""

import json
import os
import subprocess
import sys
import tarfile
import zipfile

import pytest
from PIL import Image

from ..scripts import ROOT, load

pytestmark = pytest.mark.once
release = load("release")
MINUTE = 60


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Wheel and sdist of this tree, and the wheel again, made of the unpacked sdist."""
    folder = tmp_path_factory.mktemp("release")
    wheel, sdist = release.build(release.export(folder / "tree"), folder / "dist")
    with tarfile.open(sdist) as file:
        file.extractall(folder / "unpacked", filter="data")
    again, _ = release.build(next((folder / "unpacked").iterdir()), folder / "again")
    return wheel, sdist, again


def test_the_sdist_holds_all_of_the_wheel_and_builds_are_the_same_each_time(built):
    """The wheel made of the sdist, at another time in another folder, has the bytes of the one made of the tree."""
    wheel, sdist, again = built
    assert wheel.read_bytes() == again.read_bytes()
    with tarfile.open(sdist) as file:
        assert f"vgroove-{release.VERSION}/LICENSE" in file.getnames()


def test_the_wheel_holds_what_git_knows_of_its_folders_and_nothing_else(built):
    """Every preset, shader and page; no tests, tools or docs."""
    names = {name for name in zipfile.ZipFile(built[0]).namelist() if ".dist-info/" not in name}
    rooms = ("addon", "batch", "cli", "headless", "lab", "nodegroups", "osl", "presets", "viewer")
    known = release.git("ls-files", *rooms, "__init__.py", "blender_manifest.toml").splitlines()
    assert names == {f"vgroove/{name}" for name in known}


@pytest.fixture(scope="module")
def plain(built, tmp_path_factory):
    """A virtual environment with the wheel and what it needs, which uv has; no pip, git, make or source."""
    folder = tmp_path_factory.mktemp("plain") / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    # What the wheel needs, from uv's lock and cache: no 350 MB are downloaded again.
    groups = ["--no-default-groups", "--group", "blender-5-2"]
    there = os.environ | {"UV_PROJECT_ENVIRONMENT": str(folder), "UV_PYTHON_DOWNLOADS": "never"}
    there.pop("VIRTUAL_ENV", None)
    subprocess.run(
        [release.uv(), "sync", "--quiet", "--frozen", "--no-install-project", *groups], cwd=ROOT, env=there, check=True
    )
    pip = [release.uv(), "pip"]
    python = ["--python", folder / "bin" / "python"]
    subprocess.run([*pip, "install", "--quiet", *python, "--no-deps", built[0]], check=True)
    subprocess.run([*pip, "check", "--quiet", *python], check=True)  # all that the wheel names is there
    return folder


@pytest.mark.blender
@pytest.mark.parametrize("backend", ["nodes", "osl"])
def test_the_wheel_renders_in_a_plain_environment(plain, tmp_path, backend):
    """With no other program on the path, from a folder of its own; red over blue, as copper is."""
    arguments = "render", "copper", "--samples", "4", "--resolution", "64x64", "--backend", backend, "-o", "x.png"
    subprocess.run(
        [plain / "bin" / "vgroove", *arguments], cwd=tmp_path, env={"PATH": "", "HOME": str(tmp_path)},
        check=True, timeout=10 * MINUTE, capture_output=True,
    )  # fmt: skip
    picture = Image.open(tmp_path / "x.png").convert("RGB")
    assert picture.size == (64, 64)
    red, _, blue = picture.crop((24, 24, 40, 40)).resize((1, 1), Image.Resampling.BOX).getpixel((0, 0))
    assert red > blue + 10


def test_the_wheel_finds_its_presets(plain, tmp_path):
    """All of them, without the tree."""
    command = [plain / "bin" / "vgroove", "presets", "--json"]
    done = subprocess.run(command, cwd=tmp_path, env={"PATH": ""}, check=True, capture_output=True)
    assert len(json.loads(done.stdout)) == len(list((ROOT / "presets").rglob("*.toml")))
