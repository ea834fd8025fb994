# SPDX-License-Identifier: GPL-3.0-or-later
"""Tasks rendered in one Blender that stays open: the same pixels in any order, whole files or none."""

import itertools
import json
import shutil

import numpy as np
import pytest

from vgroove import headless
from vgroove.addon.blender import images
from vgroove.addon.blender.material import Choice, build
from vgroove.addon.blender.roles import KEY
from vgroove.addon.library.presets import all_presets, find
from vgroove.batch import task as batch_task
from vgroove.batch.job import parse
from vgroove.batch.outcome import RECORD
from vgroove.batch.task import Renderer
from vgroove.headless import assignment, scene
from vgroove.nodegroups import versions

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("quick_sky")]

VERSIONS = {"vgroove": "test"}
SMALL = 'samples = 2\nresolution = "24x16"\n'


@pytest.fixture
def gate(blender, quick_sky, tmp_path):
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
    monkeypatch.setattr(scene, "open_file", lambda path, real=scene.open_file: opened.append(path) or real(path))
    renderer = Renderer(gate, VERSIONS)
    for task in tasks(
        SMALL + 'scene = "gate.blend"\nobject = "Ball"\npreset = ["copper", "gold"]\nset.m = [0.1, 0.2]', gate
    ):
        rendered(renderer, task)
        assert sum(KEY in one for one in blender.data.materials) == 1
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
    record = content.index(b'"outcome"')
    for broken in (
        content[: len(content) // 2],
        content[:-9] + bytes([content[-9] ^ 64]) + content[-8:],  # in a pixel
        content[:record] + b"?" + content[record + 1 :],
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


def test_a_png_is_made_of_the_exr_that_is_there(blender, tmp_path, monkeypatch):
    """Nothing is rendered again for it."""
    exr, both = (tasks(SMALL + f'preset = "copper"\noutput = {kinds}')[0] for kinds in ('"exr"', '["png", "exr"]'))
    renderer = Renderer(tmp_path, VERSIONS)
    _, picture = rendered(renderer, exr)
    monkeypatch.setattr(batch_task, "_picture", None)
    assert rendered(renderer, both)[0] == "there"
    shown = images.load(tmp_path / f"{both.identity(VERSIONS)}.png")
    np.testing.assert_allclose(shown, images.displayed(picture, blender.context.scene), atol=1.0 / 255)
    assert rendered(renderer, both)[0] == "there"


def test_materials_of_objects_are_their_own(blender, gate):
    """Though two of a task be the same at first, and the scene have such a one of its own."""
    with headless.quiet():
        shown = blender.context.scene
        assignment.assign(shown, [("Floor", find("metals/gold"))], "nodes", "fit", 0.005)
        blender.ops.wm.save_mainfile()
    text = (
        SMALL + 'scene = "gate.blend"\nestimator = "fit"\nobject = "Ball"\npreset = ["metals/gold", "metals/copper"]\n'
    )
    for more in ("", 'assign = {Floor = "metals/gold"}'):
        renderer = Renderer(gate / f"out{len(more)}", VERSIONS)
        renderer.folder.mkdir()
        warm = [rendered(renderer, task)[1] for task in tasks(text + more, gate)]
        (gate / f"fresh{len(more)}").mkdir()
        fresh = rendered(Renderer(gate / f"fresh{len(more)}", VERSIONS), tasks(text + more, gate)[1])[1]
        np.testing.assert_array_equal(warm[1], fresh)


def test_frames_of_a_scene_that_remembers_are_each_as_if_alone(blender, gate):
    """What comes and goes stays in what Cycles keeps, and physics follow from the frames before."""
    with headless.quiet():
        floor = blender.context.scene.objects["Floor"]
        for frame, hidden in ((1, False), (2, True), (3, False)):
            floor.hide_render = hidden
            floor.keyframe_insert("hide_render", frame=frame)
        blender.ops.wm.save_mainfile()
    found = tasks(SMALL + 'scene = "gate.blend"\nframes = "1-3"', gate)
    renderer = Renderer(gate, VERSIONS)
    warm = [rendered(renderer, task)[1] for task in found]
    for task, picture in zip(found, warm, strict=True):
        fresh = Renderer(gate / f"frame{task.frame}", VERSIONS)
        fresh.folder.mkdir()
        np.testing.assert_array_equal(rendered(fresh, task)[1], picture)
    assert not np.array_equal(warm[0], warm[1])


def test_kinds_of_material_do_not_stay_in_what_cycles_keeps(blender, tmp_path, monkeypatch):
    """That a material scattered light below its surface stays now and then, so the scene is opened anew."""
    opened = []
    monkeypatch.setattr(scene, "preview", lambda real=scene.preview: opened.append(1) or real())
    names = "translucent/marble", "translucent/skin1", "metals/copper", "glass/window", "metals/gold"
    found = [tasks(SMALL + f'preset = "{name}"')[0] for name in names if name in all_presets()]
    pictures = []
    for order in (found, found[::-1]):
        renderer = Renderer(tmp_path / str(len(pictures)), VERSIONS)
        renderer.folder.mkdir()
        pictures.append([rendered(renderer, task)[1] for task in order])
    for one, other in zip(pictures[0], pictures[1][::-1], strict=True):
        np.testing.assert_array_equal(one, other)
    changes = sum(
        one.assignments[0][1].model != other.assignments[0][1].model for one, other in itertools.pairwise(found)
    )
    assert changes >= 1
    assert len(opened) == 2 * (1 + changes)


def test_a_texture_that_is_missing_is_told_and_missed(blender, gate):
    """The still is rendered, as Blender does, and anew once the texture is there; tiles of one are all looked at."""
    with headless.quiet():
        image = blender.data.images.new("Tiles", 4, 4)
        image.source, image.filepath = "TILED", "//tile.<UDIM>.png"
        image.use_fake_user = True
        images.write(gate / "sky.exr", np.full((4, 8, 3), 1.0, np.float32), {})
        scene.light_by(blender.context.scene, gate / "sky.exr")
        blender.ops.wm.save_mainfile(relative_remap=True)
    (gate / "sky.exr").unlink()
    for number in (1001, 1002):
        images.write(gate / f"tile.{number}.png", np.zeros((4, 4, 3), np.float32), {})
    (task,) = tasks(SMALL + 'scene = "gate.blend"', gate)
    renderer = Renderer(gate, VERSIONS)
    with headless.quiet():
        outcome = renderer.attempt(task)
    assert (outcome.status, outcome.reason) == ("rendered", "without files that are missing: sky.exr")
    record = json.loads(images.attribute(gate / f"{outcome.name}.exr", RECORD))
    assert sorted(record["files"]) == ["sky.exr", "tile.1001.png", "tile.1002.png"]
    assert rendered(renderer, task)[0] == "there"
    images.write(gate / "sky.exr", np.full((4, 8, 3), 1.0, np.float32), {})
    assert rendered(Renderer(gate, VERSIONS), task)[0] == "rendered"
    images.write(gate / "tile.1002.png", np.ones((4, 4, 3), np.float32), {})
    assert rendered(Renderer(gate, VERSIONS), task)[0] == "rendered"


def test_what_is_to_be_known_of_a_task_is_told(blender, gate, monkeypatch):
    """Which slot got the material; what spoils a material that the file brings; and a shader that is too large."""
    with headless.quiet():
        shown = blender.context.scene
        ball = shown.objects["Ball"]
        for name in ("body", "trim"):
            ball.data.materials.append(blender.data.materials.new(name))
        shown.cycles.sample_clamp_direct = 1.0
        shown.objects["Floor"].active_material = build(find("copper"), Choice("nodes", "hybrid"))
        blender.ops.wm.save_mainfile()
        renderer = Renderer(gate, VERSIONS)
        named = renderer.attempt(tasks(SMALL + 'scene = "gate.blend"\nobject = "Ball"\npreset = "gold"', gate)[0])
        monkeypatch.setattr(batch_task, "stack_overflows", lambda render: render() or True)
        alone = renderer.attempt(tasks(SMALL + 'scene = "gate.blend"', gate)[0])
    assert (named.status, alone.status) == ("rendered", "rendered")
    assert "slots" in named.reason
    assert all("Copper: Clamp Direct" in one.reason for one in (named, alone))
    assert headless.OVERFLOWED in alone.reason
    assert headless.OVERFLOWED not in named.reason


def test_scenes_made_for_films_and_stereo_are_rendered_as_stills(blender, gate):
    """Whatever output they were saved with."""
    with headless.quiet():
        shown = blender.context.scene
        if versions.since(5, 0):
            shown.render.image_settings.media_type = "VIDEO"
        shown.render.image_settings.file_format = "FFMPEG"
        shown.render.use_multiview = shown.render.use_stamp = True
        blender.ops.wm.save_mainfile()
        outcome = Renderer(gate, VERSIONS).attempt(tasks(SMALL + 'scene = "gate.blend"', gate)[0])
    assert outcome.status == "rendered", outcome.reason


def test_a_texture_that_changed_is_seen(blender, gate):
    """Outside the .blend, which does not change with it: the still is rendered anew, and else kept."""
    images.write(gate / "sky.exr", np.full((4, 8, 3), 1.0, np.float32), {})
    with headless.quiet():
        scene.light_by(blender.context.scene, gate / "sky.exr")
        blender.ops.wm.save_mainfile(relative_remap=True)
    (task,) = tasks(SMALL + 'scene = "gate.blend"', gate)
    renderer = Renderer(gate, VERSIONS)
    status, bright = rendered(renderer, task)
    record = json.loads(images.attribute(gate / f"{task.identity(VERSIONS)}.exr", RECORD))
    assert list(record["files"]) == ["sky.exr"]
    assert (status, rendered(renderer, task)[0]) == ("rendered", "there")
    images.write(gate / "sky.exr", np.full((4, 8, 3), 0.1, np.float32), {})
    status, dark = rendered(Renderer(gate, VERSIONS), task)
    assert status == "rendered"
    assert dark.mean() < 0.5 * bright.mean()
    assert rendered(renderer, task)[0] == "there"


def test_halves_make_the_whole_and_tell_its_error(blender, tmp_path):
    """The whole picture but for float32's rounding of a sum, a unit in the last place a sample; twice the same.

    The error is that of the formula for two pictures, half their difference; a scene that could not be put together
    from halves is rendered whole, and has none.
    """
    shown = scene.preview()
    drawn = []

    def kept(picture, *arguments, real=batch_task._picture):
        drawn.append(real(picture, *arguments))
        return drawn[-1]

    with headless.quiet(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(batch_task, "_picture", kept)
        mean = batch_task._of_samples(shown, 9, 3, (24, 16))
        whole = kept(shown, 9, 3, (24, 16))
        shown.cycles.use_denoising = True
        assert np.isnan(batch_task._of_samples(shown, 9, 3, (24, 16)).error)
    assert len(drawn) == 4
    np.testing.assert_allclose(mean.picture, whole, rtol=9 * np.finfo(np.float32).eps)
    first, second = (picture.astype(float) for picture in drawn[:2])
    assert not np.array_equal(first, second)
    variance = (first - second) ** 2 * (4 * 5 / 9) / 9
    assert mean.error == pytest.approx(np.sqrt(variance.mean()) / whole.mean(), rel=1e-5)


def test_an_error_is_reached_and_true(blender, tmp_path):
    """Against a picture of 16 times the samples, whose own noise adds 3 %; the rest is how well noise is known."""
    renderer = Renderer(tmp_path, VERSIONS)
    table = 'preset = "copper"\nset.m = 0.6\nestimator = "closure"\nresolution = "32x32"\n'
    (task,) = tasks(table + "error = 0.2")
    with headless.quiet():
        outcome = renderer.render(task)
        assert renderer.render(task).status == "there"
    assert outcome.status == "rendered"
    assert outcome.error <= 0.2
    assert outcome.samples > 2 * batch_task.FIRST  # it took more than the first look
    (fine,) = tasks(table + f"seed = 7\nsamples = {16 * outcome.samples}")
    picture, truth = images.load(tmp_path / f"{outcome.name}.exr"), rendered(renderer, fine)[1]
    assert np.sqrt(np.mean((picture - truth) ** 2)) / truth.mean() < 0.2 * 1.2


@pytest.mark.parametrize("what", ["use_denoising", "use_adaptive_sampling"])
def test_an_error_that_cannot_be_told_is_refused(blender, gate, what):
    """Of a scene that denoises or stops pixels early."""
    setattr(blender.context.scene.cycles, what, True)
    with headless.quiet():
        blender.ops.wm.save_mainfile()
        outcome = Renderer(gate, VERSIONS).attempt(tasks('scene = "gate.blend"\nerror = 0.1', gate)[0])
    assert outcome.status == "failed"
    assert "so that its error cannot be told; switch that off in it" in outcome.reason


def test_a_picture_says_what_it_shows(blender, tmp_path):
    """In its metadata: the task, what rendered it and what that took; as EXR and as PNG."""
    (task,) = tasks(SMALL + 'preset = "copper"\nset.m = 0.25\noutput = ["exr", "png"]')
    with headless.quiet():
        outcome = Renderer(tmp_path, VERSIONS).render(task)
    for ending in ("exr", "png"):
        record = json.loads(images.attribute(tmp_path / f"{outcome.name}.{ending}", RECORD))
        assert record["versions"] == VERSIONS
        assert record["labels"] == {"preset": "lecture/copper"}
        assert record["task"]["materials"][0][-1][-1] == ["m", 0.25]
        assert record["outcome"]["name"] == outcome.name
    assert images.attribute(tmp_path / "none.exr", RECORD) is None
    assert 10**8 < outcome.memory < 10**11


def test_passes_that_nothing_uses_are_left_out(blender, gate):
    """But not where a compositor may use them."""
    shown = blender.context.scene
    shown.view_layers[0].use_pass_z = shown.view_layers[0].cycles.use_pass_volume_direct = True
    shown.cycles.time_limit = 0.5
    batch_task._leave_out(shown)
    assert shown.cycles.time_limit == 0.0
    assert not shown.view_layers[0].use_pass_z
    assert not shown.view_layers[0].cycles.use_pass_volume_direct
    assert shown.view_layers[0].use_pass_combined


def test_a_full_disk_is_called_one(blender, tmp_path, monkeypatch):
    """Of files that cannot be written, and of what Blender stumbles over for that reason; it ends the work."""
    (task,) = tasks(SMALL + 'preset = "copper"')
    renderer = Renderer(tmp_path, VERSIONS)
    free = shutil.disk_usage(tmp_path)
    with headless.quiet(), monkeypatch.context() as patch:
        patch.setattr(shutil, "disk_usage", lambda folder: free._replace(free=1000))
        patch.setattr(scene, "still", lambda *a, **k: blender.ops.wm.open_mainfile(filepath="none.blend"))
        with pytest.raises(OSError, match="the disk is full; make room"):
            renderer.attempt(task)
        with pytest.raises(OSError, match=r"gone\.exr: cannot be written: "):
            images.write(tmp_path / "none" / "gone.exr", np.zeros((2, 2, 3), np.float32), {})
        (tmp_path / "folder.exr").mkdir()
        with pytest.raises(OSError, match=r"folder\.exr: the disk is full; make room"):
            images.write(tmp_path / "folder.exr", np.zeros((2, 2, 3), np.float32), {})
    with headless.quiet(), monkeypatch.context() as patch:
        patch.setattr(scene, "still", lambda *a, **k: blender.ops.wm.open_mainfile(filepath="none.blend"))
        assert renderer.attempt(task).status == "stumbled"
    assert rendered(renderer, task)[0] == "rendered"
