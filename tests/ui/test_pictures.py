# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets of one's own get a picture, from another process, and take it along."""

import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

from vgroove import headless

pytestmark = pytest.mark.blender
# In place of Blender: writes the id into the picture.
WRITE = "import pathlib, sys; p = pathlib.Path(sys.argv[2]); p.parent.mkdir(exist_ok=True); p.write_text(sys.argv[1])"


@pytest.fixture
def folder(own_folder, tmp_path_factory, monkeypatch):
    """Where pictures go, and a process that makes them at once."""
    from vgroove.addon.ui import pictures, thumbnails

    made = tmp_path_factory.mktemp("extension") / "previews"
    monkeypatch.setattr(thumbnails, "own_folder", lambda: made)
    monkeypatch.setattr(pictures, "command", lambda one: [sys.executable, "-c", WRITE, one, str(pictures.path_of(one))])
    made.mkdir()
    return made


def save(extension, name, **options):
    settings = extension.context.scene.vgroove
    settings.preset = "metals/gold"
    with headless.quiet():
        extension.ops.vgroove.apply()
        assert extension.ops.vgroove.save_preset(name=name, **options) == {"FINISHED"}


def work():
    """Calls the timer's function as Blender does, until there is nothing left to do."""
    from vgroove.addon.ui import pictures

    end = time.monotonic() + 60.0
    while pictures._look() is not None:
        assert time.monotonic() < end
        time.sleep(0.01)


def files(folder):
    return {str(path.relative_to(folder)): path.read_text() for path in folder.rglob("*.*")}


def test_a_saved_preset_gets_a_picture_and_takes_it_along(extension, own_folder, folder):
    """Saving asks for it and does not wait; renaming moves it, overwriting makes it anew, deleting removes it."""
    from vgroove.addon.ui import pictures

    save(extension, "Old Gold")
    assert pictures._waiting == ["mine/old_gold"]
    assert extension.app.timers.is_registered(pictures._look)
    assert files(folder) == {}
    work()
    assert files(folder) == {"mine/old_gold.webp": "mine/old_gold"}
    with headless.quiet():
        assert extension.ops.vgroove.rename_preset(name="Older Gold") == {"FINISHED"}
    assert files(folder) == {"mine/older_gold.webp": "mine/old_gold"}
    save(extension, "Older Gold", overwrite=True)
    work()
    assert files(folder) == {"mine/older_gold.webp": "mine/older_gold"}
    with headless.quiet():
        assert extension.ops.vgroove.delete_preset() == {"FINISHED"}
    assert files(folder) == {}
    assert [path.name for path in own_folder.iterdir()] == []


def test_a_picture_that_is_not_ready_follows_its_preset(extension, folder):
    """Renamed or deleted while the picture is made, a preset leaves no process and no file of its former name."""
    from vgroove.addon.ui import pictures

    save(extension, "Old Gold")
    pictures._look()
    (job,) = pictures._running.values()
    with headless.quiet():
        extension.ops.vgroove.rename_preset(name="Older Gold")
    assert not job.is_running
    assert pictures._waiting == ["mine/older_gold"]
    with headless.quiet():
        extension.ops.vgroove.delete_preset()
    assert pictures._look() is None
    assert not (folder / "mine" / "older_gold.webp").exists()


def test_the_thumbnail_appears_once_the_picture_is_there(extension, folder):
    """One that was read before is read again."""
    from vgroove.addon.library.presets import find
    from vgroove.addon.ui import thumbnails

    (read,) = thumbnails._pictures
    save(extension, "Old Gold")
    thumbnails.icon(find("mine/old_gold"))
    assert "mine/old_gold" not in read
    work()
    thumbnails.icon(find("mine/old_gold"))
    first = read["mine/old_gold"]
    save(extension, "Old Gold", overwrite=True)
    work()
    assert "mine/old_gold" not in read
    thumbnails.icon(find("mine/old_gold"))
    assert read["mine/old_gold"] is not first


def test_switched_off_it_leaves_no_process_behind(extension, folder, monkeypatch, capfd):
    """And one that fails says so, and no more."""
    from vgroove.addon.ui import pictures

    save(extension, "Old Gold")
    save(extension, "Bad Gold")
    monkeypatch.setattr(pictures, "command", lambda _one: [sys.executable, "-c", "raise OSError('disk full')"])
    work()
    told = capfd.readouterr().out
    assert "no picture of mine/bad_gold: Blender in the background ended with 1: OSError: disk full" in told
    monkeypatch.setattr(pictures, "command", lambda _one: [sys.executable, "-c", "import time; time.sleep(60)"])
    pictures.request("mine/old_gold")
    pictures._look()
    (job,) = pictures._running.values()
    pictures.unregister()
    assert not job.is_running
    assert not extension.app.timers.is_registered(pictures._look)


def test_blender_as_a_module_renders_none(extension, own_folder):
    """There is no program that could be run, and no folder of the extension's."""
    from vgroove.addon.ui import pictures

    assert extension.app.binary_path == ""
    save(extension, "Old Gold")
    assert pictures.command("mine/old_gold") == []
    assert not pictures._waiting
    assert [path.name for path in own_folder.iterdir()] == ["old_gold.toml"]


@pytest.mark.once
def test_the_other_blender_renders_the_picture(extension, own_folder, tmp_path):
    """By its script alone, with no vgroove to import: gold is yellow, as its shipped picture."""
    from vgroove.addon.ui import background, pictures

    save(extension, "Old Gold")
    path = tmp_path / "pictures" / "mine" / "old_gold.webp"
    script = "import sys; sys.modules['vgroove'] = None\n" + background.script(pictures.MODULE)
    subprocess.run([sys.executable, "-c", script, "--", "mine/old_gold", str(path)], check=True, capture_output=True)
    picture = np.asarray(Image.open(path).convert("RGB"), float)
    assert np.all(np.diff(picture[60:110, 100:150].mean(axis=(0, 1))) < -20.0)
