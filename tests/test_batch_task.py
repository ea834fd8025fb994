# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks rendered in one Blender that stays open: the same pixels in any order, whole files or none."""

import numpy as np
import pytest

from vgroove.addon import headless, images, scene
from vgroove.addon.batch import task as batch_task
from vgroove.addon.batch.job import parse
from vgroove.addon.batch.task import Renderer

pytestmark = pytest.mark.blender

VERSIONS = {"vgroove": "test"}
SMALL = 'samples = 2\nresolution = "24x16"\n'


@pytest.fixture
def gate(blender, tmp_path):
    """A folder with a .blend: the preview scene at 20x10 and 3 samples, whose ball sinks from frame 1 on."""
    with headless.quiet():
        shown = scene.preview()
        shown.render.resolution_x, shown.render.resolution_y, shown.render.resolution_percentage = 40, 20, 50
        shown.cycles.samples = 3
        ball = shown.objects["Ball"]
        for frame, place in ((1, 1.0), (5, -50.0)):
            ball.location.z = place
            ball.keyframe_insert("location", frame=frame)
        shown.frame_set(1)
        blender.ops.wm.save_as_mainfile(filepath=str(tmp_path / "gate.blend"))
    return tmp_path


def tasks(text, folder=None):
    return parse("[[render]]\n" + text, "job.toml", folder)


def rendered(renderer, task):
    """The status and the picture of a task."""
    with headless.quiet():
        outcome = renderer.render(task)
    return outcome.status, images.load(renderer.folder / f"{outcome.name}.exr")


def test_pixels_do_not_depend_on_what_was_rendered_before(blender, gate):
    """Scenes, backends, objects and frames mixed: forwards, backwards and each alone give the same."""
    grid = tasks(SMALL + 'preset = "copper"\nbackend = ["nodes", "osl"]\nestimator = ["fit", "mirror"]')
    grid += tasks(SMALL + 'scene = "gate.blend"\nobject = "Ball"\npreset = "gold"\nframes = "1-2"', gate)
    grid += tasks(SMALL + 'scene = "gate.blend"\nassign = {Floor = "gold"}', gate)
    grid += tasks('scene = "gate.blend"', gate)
    pictures = []
    for name, order in (("forwards", grid), ("backwards", grid[::-1])):
        (gate / name).mkdir()
        renderer = Renderer(gate / name, VERSIONS)
        found = {task.identity(VERSIONS): rendered(renderer, task) for task in order}
        assert all(status == "rendered" for status, _ in found.values())
        pictures.append({key: picture for key, (_, picture) in found.items()})
    (gate / "alone").mkdir()
    for task in grid[-4:]:
        _, pictures[0][task.identity(VERSIONS)] = rendered(Renderer(gate / "alone", VERSIONS), task)
    for key, picture in pictures[1].items():
        np.testing.assert_array_equal(picture, pictures[0][key])
    assert len({picture.tobytes() for picture in pictures[1].values()}) == len(grid)


def test_a_scene_keeps_its_own_size_and_samples(blender, gate):
    """Also after a task that had others."""
    renderer = Renderer(gate, VERSIONS)
    own, given = tasks('scene = "gate.blend"', gate)[0], tasks(SMALL + 'scene = "gate.blend"', gate)[0]
    assert rendered(renderer, given)[1].shape == (16, 24, 3)
    assert rendered(renderer, own)[1].shape == (10, 20, 3)
    assert blender.context.scene.cycles.samples == 3


def test_a_scene_is_opened_once_and_materials_do_not_pile_up(blender, gate, monkeypatch):
    """Over tasks that want the same of it."""
    opened = []
    monkeypatch.setattr(scene, "opened", lambda path, real=scene.opened: opened.append(path) or real(path))
    renderer = Renderer(gate, VERSIONS)
    for task in tasks(
        SMALL + 'scene = "gate.blend"\nobject = "Ball"\npreset = ["copper", "gold"]\nset.m = [0.1, 0.2]', gate
    ):
        rendered(renderer, task)
        assert sum(batch_task.KEY in one for one in blender.data.materials) == 1
    assert len(opened) == 1


def test_what_is_there_is_kept_and_what_is_damaged_is_not(blender, tmp_path):
    """Cut short, empty, of another task, or not there; the rest is not touched. A PNG is the EXR as it looks."""
    task = tasks(SMALL + 'preset = "copper"\noutput = ["exr", "png"]')[0]
    renderer = Renderer(tmp_path, VERSIONS)
    status, picture = rendered(renderer, task)
    exr, png = (tmp_path / f"{task.identity(VERSIONS)}.{ending}" for ending in task.outputs)
    shown = images.load(png)
    np.testing.assert_allclose(shown, images.displayed(picture, blender.context.scene), atol=1.0 / 255)
    assert status == "rendered"
    assert rendered(renderer, task)[0] == "there"
    other = tasks(SMALL + 'preset = "gold"')[0]
    rendered(renderer, other)
    content = exr.read_bytes()
    for broken in (
        content[: len(content) // 2],
        b"",
        (tmp_path / f"{other.identity(VERSIONS)}.exr").read_bytes(),
        None,
    ):
        exr.unlink()
        if broken is not None:
            exr.write_bytes(broken)
        status, again = rendered(renderer, task)
        assert status == "rendered"
        np.testing.assert_array_equal(again, picture)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]
