# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders and scenes in which commands run."""

import os
import tempfile

import pytest

from vgroove import headless
from vgroove.addon.library import presets

from ..commands import vgroove


class Line:
    """A command line in a folder of its own."""

    def __init__(self, folder):
        self.folder, self.scratch = folder / "work", folder / "scratch"
        self.folder.mkdir()
        self.scratch.mkdir()

    def files(self):
        return sorted(os.fsencode(path) for root in (self.folder, self.scratch) for path in root.rglob("*"))

    def refuses(self, *arguments, code=2):
        """The one line in which the command refuses its input; it writes nothing."""
        before = self.files()
        said = vgroove(*arguments)
        assert said.code == code, said
        assert said.out == ""
        assert len(said.lines) == 1, said.err
        assert said.lines[0].startswith("vgroove: ")
        assert self.files() == before
        return said.lines[0]


@pytest.fixture
def line(tmp_path, monkeypatch):
    found = Line(tmp_path)
    monkeypatch.chdir(found.folder)
    monkeypatch.setattr(tempfile, "tempdir", str(found.scratch))
    monkeypatch.delenv(presets.USER_FOLDER, raising=False)
    return found


@pytest.fixture
def scene_line(line, blender):
    """A command line beside bare.blend, a camera and two objects, one of which has a name to be careful with."""
    stage = blender.context.scene
    stage.render.engine = "CYCLES"
    mesh = blender.data.meshes.new("Floor")
    mesh.from_pydata([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [], [(0, 1, 2, 3)])
    for name in ("Floor", "Grün=1:x"):
        stage.collection.objects.link(blender.data.objects.new(name, mesh.copy()))
    stage.camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
    stage.collection.objects.link(stage.camera)
    with headless.quiet():
        blender.ops.wm.save_as_mainfile(filepath=str(line.folder / "bare.blend"))
    return line


@pytest.fixture
def scene_file(blender, tmp_path):
    """A .blend with a plane "Floor" in view, a sun of zero size and a lamp-free second frame."""
    stage = blender.context.scene
    stage.render.engine = "CYCLES"
    stage.render.resolution_x, stage.render.resolution_y = 32, 24
    stage.cycles.samples = 1
    mesh = blender.data.meshes.new("Floor")
    mesh.from_pydata([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], [], [(0, 1, 2, 3)])
    stage.collection.objects.link(blender.data.objects.new("Floor", mesh))
    camera = blender.data.objects.new("Camera", blender.data.cameras.new("Camera"))
    camera.location = (0, 0, 4)
    sun = blender.data.lights.new("Sun", "SUN")
    sun.angle = 0.0
    stage.collection.objects.link(blender.data.objects.new("Sun", sun))
    stage.collection.objects.link(camera)
    stage.camera = camera
    path = tmp_path / "scene.blend"
    blender.ops.wm.save_as_mainfile(filepath=str(path))
    return path
