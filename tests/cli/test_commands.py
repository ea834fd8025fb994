# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line's contract: exit codes, one line for bad input, whole files or none.

A kind of command is run as a process of its own once (``process``), and otherwise in this one.
"""

import csv
import json
import os
import re
import subprocess
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from vgroove import cli
from vgroove.addon.blender import lamps
from vgroove.addon.models import MODELS
from vgroove.addon.reference import CookTorrance, Schlick, albedo
from vgroove.cli import terminal

from .. import commands

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("blender")]

vgroove = partial(commands.vgroove, longest=300)  # batches begin processes


def process(*arguments):
    """Run the command as a user does."""
    command = [str(Path(sys.executable).parent / "vgroove"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return commands.Said(done.returncode, done.stdout, done.stderr)


def test_presets_as_json_hold_the_contract():
    """A list of {id, name, family, model, parameters, source}."""
    done = vgroove("presets", "copper", "--json")
    assert done.code == 0
    found = {preset["id"]: preset for preset in json.loads(done.out)}
    assert {"lecture/copper", "metals/copper", "finished_metals/copper_satin"} < set(found)
    preset = found["lecture/copper"]
    assert set(preset) == {"id", "name", "family", "model", "parameters", "source"}
    assert preset["parameters"]["f0"] == [0.95, 0.64, 0.54]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["render", "coper", "-o", "a.png"], 'unknown preset "coper"; did you mean "copper"?'),
        (["render", "copper", "-o", "a.gif"], "a.gif: unknown ending; use .exr"),
        (["render", "copper", "-o", "no/a.png"], "no/a.png: the folder"),
        (["render", "copper"], "Missing option"),
        (["render", "copper", "-o", "a.png", "--resolution", "64"], 'resolution "64": write WIDTHxHEIGHT'),
        (["render", "copper", "-o", "a.png", "--resolution", "0x5"], 'resolution "0x5"'),
        (["render", "copper", "-o", "a.png", "--set", "m"], '--set "m": write NAME=NUMBER'),
        (["render", "copper", "-o", "a.png", "--set", "m=-1"], "m must be between"),
        (["render", "copper", "-o", "a.png", "--set", "m=nan"], '--set "m=nan": write NAME=NUMBER'),
        (["render", "copper", "-o", "a.png", "--set", "q=1"], 'unknown key "q"'),
        (["render", "copper", "-o", "a.png", "--bound", "0.5"], "Invalid value for '--bound'"),
        (["render", "copper", "-o", "a.png", "--time", "1"], "does not change over time"),
        (["render", "copper", "-o", "a.png", "--frames", "1-3"], "needs #### in the file name"),
        (["render", "copper", "-o", "a_##.png", "--frames", "3-1"], "write FIRST-LAST"),
        (["render", "copper", "-o", "a.png", "--assign", "Ball=copper"], "--assign goes with a SCENE.blend"),
        (["render", "copper", "-o", "a.png", "--estimator", "magic"], "--estimator"),
        (["render", "none.blend", "-o", "a.png"], "none.blend: no such scene"),
        (["measure", "copper", "-o", "a.exr"], "give either --theta-i DEG or --furnace"),
        (["measure", "copper", "--theta-i", "95", "-o", "a.exr"], "--theta-i"),
        (["measure", "copper", "--theta-i", "5", "-o", "a.png"], "measurements are EXR files"),
        (["measure", "copper", "--theta-i", "5", "--estimator", "mirror", "-o", "a.exr"], "sun of zero size"),
        (["measure", "copper", "--furnace", "--estimator", "direct", "-o", "a.exr"], "direct sees only lights"),
        (["measure", "copper", "--furnace", "--window", "5", "-o", "a.exr"], "--furnace has no sun"),
        (["measure", "copper", "--furnace", "--phi-i", "5", "-o", "a.exr"], "--furnace has no sun"),
        (["measure", "copper", "--theta-i", "5", "--phi-i", "361", "-o", "a.exr"], "--phi-i"),
        (["frobnicate"], "No such command"),
        (["render", "rusting_iron", "-o", "a.png", "--time", "nan"], "'--time': must be a number, got 'nan'"),
        (["render", "rusting_iron", "-o", "a_#.png", "--frames", "1-3", "--time", "1"], "give one of them"),
        (["render", "rusting_iron", "-o", "a.png", "--strip", "s.png"], "--strip s.png: goes with --frames"),
        (["render", "rusting_iron", "-o", "a.png", "--shutter", "0.5"], "--shutter 0.5: goes with --frames"),
        (["batch", "none.toml", "-o", "out"], "none.toml: cannot be read"),
        (["batch", "a.toml", "-o", "out", "--openjd", "a.json", "--dry-run"], "leave --cluster and --dry-run out"),
        (["gallery", "none"], "none: no such folder; name one that `vgroove batch` rendered to"),
        (["gallery", "."], ".: holds no stills of `vgroove batch`"),
        (
            ["render", "rusting_iron", "-o", "a_#.png", "--frames", "1-3", "--strip", "s.exr"],
            "a strip is a PNG",
        ),
        (
            ["render", "rusting_iron", "-o", "a_#.png", "--frames", "1-3", "--movie", "s.avi"],
            "movies are .mp4",
        ),
        (["render", "rusting_iron", "-o", "a_#.png", "--frames", "1-3", "--movie", "no/s.mp4"], "no/s.mp4: the folder"),
        (
            ["render", "rusting_iron", "-o", "a_#.png", "--frames", "1-3", "--tolerance", "9"],
            "tolerance must be",
        ),
    ],
    ids=lambda value: "_".join(value)[:40] if isinstance(value, list) else "",
)
def test_bad_input_is_one_line_and_exit_2(tmp_path, monkeypatch, capfd, arguments, message):
    """What, where, how to mend it; nothing on standard output, nothing written.

    In this process, as Blender starts slowly; the command itself is run below.
    """
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["vgroove", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    said = capfd.readouterr()
    assert said.out == ""
    lines = said.err.strip().splitlines()
    assert len(lines) == 1
    assert lines[0].startswith("vgroove: ")
    assert message in lines[0]
    assert not list(tmp_path.iterdir())


def test_a_broken_scene_is_one_line_and_exit_2(tmp_path):
    """What Blender itself says of it is not heard."""
    path = tmp_path / "broken.blend"
    path.write_bytes(b"this is no blend file")
    done = process("render", path, "-o", tmp_path / "a.png")
    assert (done.code, done.out) == (2, "")
    assert len(done.err.strip().splitlines()) == 1
    assert done.err.startswith(f"vgroove: {path}: cannot be opened as a .blend")
    assert list(tmp_path.iterdir()) == [path]


def read_exr(path):
    import OpenImageIO as oiio

    file = oiio.ImageInput.open(str(path))
    return file.read_image("float"), file.spec()


def test_measure_writes_the_brdf_with_its_story(tmp_path):
    """Pixel (x, y) is phi_o = 2 pi (x + .5)/W, theta_o = (pi/2)(y + .5)/H; parameters are in the attributes."""
    path = tmp_path / "f.exr"
    light = "--theta-i", "45", "--phi-i", "30"
    done = vgroove("measure", "copper", *light, "--set", "m=0.2", "--resolution", "32x16", "-o", path)
    assert done.code == 0, done.err
    assert done.out == ""
    image, spec = read_exr(path)
    assert image.shape == (16, 32, 3)
    assert spec.channelnames == ("R", "G", "B")
    assert str(spec.format) == "float"
    theta, phi = np.pi / 2 * (np.arange(16) + 0.5)[:, None] / 16, 2 * np.pi * (np.arange(32) + 0.5) / 32
    wo = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), axis=-1)
    wi = [np.cos(np.pi / 6) * np.sin(np.pi / 4), np.sin(np.pi / 6) * np.sin(np.pi / 4), np.cos(np.pi / 4)]
    expected = CookTorrance(0.2, Schlick((0.95, 0.64, 0.54))).evaluate(wi, wo)
    np.testing.assert_allclose(image, expected, atol=2e-5 * expected.max())
    assert spec.get_string_attribute("vgroove:preset") == "lecture/copper"
    assert json.loads(spec.get_string_attribute("vgroove:parameters"))["m"] == 0.2
    assert json.loads(spec.get_string_attribute("vgroove:geometry"))["phi_i"] == 30.0
    assert spec.get_string_attribute("vgroove:estimator") == "direct"
    assert spec.get_string_attribute("vgroove:backend") == "nodes"
    assert spec.get_int_attribute("vgroove:samples") == 1
    assert spec.get_float_attribute("vgroove:seconds") > 0
    assert "blender" in json.loads(spec.get_string_attribute("vgroove:versions"))


def test_measure_furnace_gives_the_albedo(tmp_path):
    """The mean over the image agrees with quadrature within 4 standard errors."""
    path = tmp_path / "e.exr"
    done = process(
        "measure", "copper", "--furnace", "--samples", "256", "--resolution", "16x16", "--backend", "osl", "-o", path
    )
    assert done.code == 0, done.err
    image, _ = read_exr(path)
    theta = np.pi / 2 * (np.arange(16) + 0.5) / 16
    column = np.stack([np.sin(theta), 0 * theta, np.cos(theta)], axis=-1)
    expected = albedo(CookTorrance(0.3, Schlick((0.95, 0.64, 0.54))), column)
    # A weight in [0, 1] of mean E has a variance of at most E (1 - E).
    error = np.sqrt((expected * (1 - expected)).mean() / (256 * 256))
    assert abs(image.mean() - expected.mean()) < 4 * error


def test_render_a_preset_to_exr_and_the_same_again(tmp_path):
    """Same task, same pixels, in another process too; another seed, other pixels."""
    paths = [tmp_path / f"{name}.exr" for name in "abc"]
    for run, path, seed in zip((process, vgroove, vgroove), paths, (7, 7, 8), strict=True):
        done = run("render", "copper", "--samples", "2", "--resolution", "48x32", "--seed", seed, "-o", path)
        assert done.code == 0, done.err
        assert done.err.strip() == f"wrote {path}"
    first, again, other = (read_exr(path)[0] for path in paths)
    assert first.shape == (32, 48, 3)
    assert first.max() > 0.1
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    assert sorted(tmp_path.iterdir()) == paths  # nothing temporary is left


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


@pytest.mark.parametrize("backend", ["nodes", "osl"])
@pytest.mark.parametrize("estimator", ["fit", "closure", "mirror", "direct", "auto"])
def test_render_a_scene_with_an_assigned_preset(scene_file, tmp_path, backend, estimator):
    """The assigned floor shines head-on; the scene's own size is kept."""
    path = tmp_path / "a.exr"
    done = vgroove(
        "render", scene_file, "--assign", "Floor=copper", "--backend", backend, "--estimator", estimator, "-o", path
    )
    assert done.code == 0, done.err
    image, _ = read_exr(path)
    assert image.shape == (24, 32, 3)
    assert image[12, 16, 0] > 0.2
    assert image[12, 16, 0] > image[12, 16, 2]  # copper


def test_an_unknown_object_is_named_with_what_there_is(scene_file, tmp_path):
    done = process("render", scene_file, "--assign", "Flor=copper", "-o", tmp_path / "a.png")
    assert done.code == 2
    assert done.err.strip() == (
        'vgroove: --assign "Flor=lecture/copper": the scene has no object of that name; it has Floor'
    )


def test_frames_are_numbered(scene_file, tmp_path):
    done = vgroove("render", scene_file, "--assign", "Floor=copper", "--frames", "2-3", "-o", tmp_path / "f_####.png")
    assert done.code == 0, done.err
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["f_0002.png", "f_0003.png"]


@pytest.mark.once
def test_check_exits_0_and_writes_json(blender, monkeypatch, tmp_path):
    """--quick measures one slope a kind; each sixth of these here, as the suite measures them all."""
    from vgroove.lab.check import plan as check_all

    path, plan = tmp_path / "check.json", check_all.quick_plan()
    assert len({row.func.__module__ for row in plan}) == len(MODELS)
    monkeypatch.setattr(check_all, "quick_plan", lambda: plan[::6])
    done = vgroove("check", "--quick", "--json", path)
    assert done.code == 0, done.err
    content = json.loads(path.read_text())
    assert len(content["rows"]) == len(plan[::6]) > 3
    assert all(row["passed"] for row in content["rows"])
    assert f"{len(content['rows'])} rows passed, 0 failed" in done.out


def test_check_exits_1_when_a_row_fails(blender, monkeypatch, tmp_path):
    """A reference that is 1 % off ends in exit code 1."""
    from vgroove.lab.check import plan as check_all
    from vgroove.lab.check.cook_torrance import direct_row
    from vgroove.lab.check.rows import SETUPS

    row = direct_row(SETUPS[0], "schlick", 0.3)
    for factor, code in ((1.0, 0), (1.01, 1)):
        monkeypatch.setattr(check_all, "plan", lambda factor=factor: [partial(row.scaled, factor)])
        assert vgroove("check").code == code


def test_explain_says_what_is_built_and_what_is_not():
    """The estimator and its reason, what was left out, and the same in one line for what cannot be."""
    result = vgroove("explain", "copper")
    assert result.code == 0
    text = " ".join(result.out.split())
    for part in ("estimator", "Fresnel term: schlick", "left out", "transmission", "random numbers"):
        assert part in text
    assert "smooth interface" in " ".join(vgroove("explain", "liquids/water").out.split())
    plastic = " ".join(vgroove("explain", "red_plastic").out.split())
    for part in ("diffuse part: oren_nayar", "specular part: cook_torrance", "Fresnel term: dielectric"):
        assert part in plastic
    refused = vgroove("explain", "liquids/water", "--estimator", "fit")
    assert refused.code == 2
    assert 'which has no estimator "fit"; use one of closure, mirror' in refused.err


# Over time


def test_presets_as_json_say_how_they_change(monkeypatch):
    """What is static has no "time"; the table says so too."""
    (preset,) = json.loads(vgroove("presets", "rusting", "--json").out)
    assert preset["time"]["unit"] == "share"
    assert (preset["time"]["start"], preset["time"]["end"]) == (0.0, 1.0)
    assert set(preset["time"]["laws"]) == {"albedo", "s", "m"}
    monkeypatch.setattr(terminal.out, "_width", 500)  # wide enough for the row to stay on one line
    assert "changes from 0 to 1 share: albedo, s, m" in " ".join(vgroove("presets", "rusting").out.split())


def test_measure_at_a_time_measures_the_preset_as_it_is_then(tmp_path):
    """Its parameters are in the attributes; the law itself, not keys of it."""
    from vgroove.addon.library.presets import find

    path = tmp_path / "f.exr"
    done = vgroove("measure", "rusting_iron", "--time", "0.4", "--theta-i", "45", "--resolution", "32x16", "-o", path)
    assert done.code == 0, done.err
    image, spec = read_exr(path)
    model = find("rusting_iron").at(0.4).reference()
    theta, phi = np.pi / 2 * (np.arange(16) + 0.5)[:, None] / 16, 2 * np.pi * (np.arange(32) + 0.5) / 32
    wo = np.stack(np.broadcast_arrays(np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), axis=-1)
    expected = model.evaluate([np.sin(np.pi / 4), 0.0, np.cos(np.pi / 4)], wo)
    np.testing.assert_allclose(image, expected, atol=2e-5 * expected.max())
    assert json.loads(spec.get_string_attribute("vgroove:parameters"))["m"] == pytest.approx(0.18001)


@pytest.mark.once
@pytest.mark.usefixtures("quick_sky")
def test_a_sequence_plays_the_course_and_is_taken_up_again(tmp_path):
    """From start to end over the frames; what is there already is kept, what is broken or of other settings is not."""
    base = ["render", "rusting_iron", "--samples", "2", "--resolution", "32x24", "--estimator", "fit"]
    frames = [*base, "--frames", "1-4", "-o", tmp_path / "r_##.exr"]
    first = vgroove(*frames)
    assert first.code == 0, first.err
    paths = [tmp_path / f"r_0{k}.exr" for k in (1, 2, 3, 4)]
    assert sorted(tmp_path.iterdir()) == paths
    for path, time in ((paths[0], "0"), (paths[3], "1")):
        still = tmp_path / "still.exr"
        vgroove(*base, "--time", time, "-o", still)
        np.testing.assert_allclose(read_exr(path)[0], read_exr(still)[0], rtol=1e-4, atol=1e-5)
    stamps = {path: path.stat().st_mtime_ns for path in paths}
    paths[1].unlink()
    paths[2].write_bytes(paths[2].read_bytes()[:200])
    again = vgroove(*frames)
    assert "wrote 4 frames" in again.err
    assert "2 of them there already" in again.err
    assert {path for path in paths if path.stat().st_mtime_ns == stamps[path]} == {paths[0], paths[3]}
    assert "there already" not in vgroove(*frames, "--seed", "1").err


@pytest.mark.parametrize("driving", ["curves", "age"])
def test_a_sequence_of_a_scene_has_a_strip_and_a_movie(scene_file, tmp_path, driving):
    """The assigned preset plays over the frames; strip and movie hold them."""
    import bpy

    done = vgroove(
        "render", scene_file, "--assign", "Floor=rusting_iron", "--frames", "3-7", "--driving", driving,
        "--strip", tmp_path / "strip.png", "--movie", tmp_path / "movie.mp4", "-o", tmp_path / "f_#.png",
    )  # fmt: skip
    assert done.code == 0, done.err
    image, _ = read_exr(tmp_path / "strip.png")
    assert image.shape[1] == 5 * 240 + 4 * 4
    tiles = [image[20:100, 244 * k + 60 : 244 * k + 180].mean(axis=(0, 1)) for k in range(5)]
    assert len({tuple(tile.round(3)) for tile in tiles}) == 5
    movie = bpy.data.movieclips.load(str(tmp_path / "movie.mp4"))
    assert movie.frame_duration == 5
    bpy.data.movieclips.remove(movie)
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


@pytest.mark.once
@pytest.mark.usefixtures("quick_sky")
def test_outputs_may_be_names_alone(tmp_path, monkeypatch):
    """Then they come to where the command was called."""
    monkeypatch.chdir(tmp_path)
    base = ["render", "rusting_iron", "--samples", "1", "--resolution", "32x24", "--estimator", "closure"]
    for more in (
        ["-o", "still.png"],
        ["--frames", "1-2", "-o", "r_#.png", "--strip", "strip.png", "--movie", "movie.mp4"],
        ["--frames", "1-1", "--shutter", "0.5", "-o", "exposed_#.exr"],
        ["--frames", "1-1", "--shutter", "0.25", "-o", "exposed_#.exr"],  # of other settings: rendered anew
    ):
        done = vgroove(*base, *more)
        assert done.code == 0, done.err
        assert "there already" not in done.err
    names = ["exposed_1.exr", "movie.mp4", "r_1.png", "r_2.png", "still.png", "strip.png"]
    assert sorted(path.name for path in tmp_path.iterdir()) == names


def test_time_in_a_scene_goes_to_those_that_change(scene_file, tmp_path):
    """And is refused where none does."""
    done = vgroove("render", scene_file, "--assign", "Floor=rusting_iron", "--time", "0.5", "-o", tmp_path / "a.png")
    assert done.code == 0, done.err
    refused = vgroove("render", scene_file, "--assign", "Floor=copper", "--time", "0.5", "-o", tmp_path / "b.png")
    assert refused.code == 2
    assert "does not change over time" in refused.err


def test_a_task_that_fails_does_not_keep_the_rest_from_being_rendered(scene_file, tmp_path):
    """An object that is not there: exit 3, one line with the reason, which the table has too."""
    job = tmp_path / "job.toml"
    job.write_text(
        f'[[render]]\nscene = "{scene_file}"\nobject = "Flour"\npreset = "gold"\n'
        f'[[render]]\nscene = "{scene_file}"\nobject = "Floor"\npreset = "gold"\n'
    )
    done = vgroove("batch", job, "-o", tmp_path / "out")
    assert done.code == 3
    assert '1 of 2 tasks failed: "Flour=metals/gold": the scene has no object of that name; it has' in done.err
    with (tmp_path / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["failed", "rendered"]
    assert "no object of that name" in rows[0]["reason"]
    assert len(list((tmp_path / "out").glob("*.exr"))) == 1


@pytest.mark.once
def test_a_still_of_a_batch_is_what_render_makes(tmp_path):
    """The same pixels, but for the rounding of a sum in halves: a unit in the last place of float32 a sample."""
    given = ["--set", "m=0.2", "--samples", "2", "--resolution", "24x16", "--seed", "3"]
    assert vgroove("render", "copper", *given, "-o", tmp_path / "still.exr").code == 0
    job = tmp_path / "job.toml"
    job.write_text('[[render]]\npreset = "copper"\nset.m = 0.2\nsamples = 2\nresolution = "24x16"\nseed = 3\n')
    assert vgroove("batch", job, "-o", tmp_path / "out").code == 0
    (path,) = (tmp_path / "out").glob("*.exr")
    still = read_exr(tmp_path / "still.exr")[0]
    np.testing.assert_allclose(read_exr(path)[0], still, rtol=2 * np.finfo(np.float32).eps)


@pytest.mark.once
def test_a_batch_is_planned_rendered_and_taken_up_again(tmp_path):
    """--dry-run writes nothing; the second run keeps all, and the table of results keeps its seconds."""
    job = tmp_path / "job.toml"
    job.write_text('[[render]]\npreset = ["copper", "gold"]\nseed = [0, 1]\nsamples = 2\nresolution = "24x16"\n')
    planned = vgroove("batch", job, "-o", tmp_path / "out", "--dry-run")
    assert planned.code == 0, planned.err
    assert "4 tasks" in planned.out
    assert re.search(r"about \d+ s by \d processes for 4 tasks, by the speed of the preview scene", planned.out)
    assert not (tmp_path / "out").exists()
    first, again = (vgroove("batch", job, "-o", tmp_path / "out", "--workers", 1) for _ in range(2))
    assert first.code == 0, first.err
    assert "wrote 4 stills" in first.err
    assert "4 of them there already" in again.err
    with (tmp_path / "out" / "results.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["label"] for row in rows][:2] == ["lecture/copper, seed 0", "lecture/copper, seed 1"]
    assert all(row["status"] == "there" and float(row["seconds"]) > 0 for row in rows)
    planned = vgroove("batch", job, "-o", tmp_path / "out", "--dry-run").out
    assert "about 0 s by" in planned
    assert "for 0 tasks, by the speed of 4 that are there" in planned
    part = vgroove("batch", job, "-o", tmp_path / "a [/b] part", "--tasks", "2-3", "--workers", 1)
    assert "wrote 2 stills to" in part.err
    assert "a [/b] part" in part.err
    made = {path.name for path in (tmp_path / "a [/b] part").iterdir()}
    assert made == {"results-2-3.csv", *(f"{row['task']}.exr" for row in rows[1:3])}
    (tmp_path / "file").touch()
    within = vgroove("batch", job, "-o", tmp_path / "file" / "out")
    assert within.code == 2
    assert "file/out: cannot be made: Not a directory; choose another with -o" in within.err
    beyond = vgroove("batch", job, "-o", tmp_path / "part", "--tasks", "2-5")
    assert beyond.code == 2
    assert '--tasks "2-5": write A-B, from 1-4: the job has 4 tasks' in beyond.err
    page = vgroove("gallery", tmp_path / "out", "-o", tmp_path / "page.html")
    assert page.code == 0, page.err
    assert (tmp_path / "page.html").read_text(encoding="utf-8").count("<article") == 4
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"results.csv", *(f"{row['task']}.exr" for row in rows)}


# Closed pipes


@pytest.mark.parametrize("arguments", [["presets", "--json"], ["presets"], ["presets", "copper", "--json"]])
def test_output_that_nobody_reads_ends_the_command_quietly(arguments):
    """As ``vgroove presets --json | head`` does: exit code 141, as shells have it, and nothing on standard error."""
    command = [str(Path(sys.executable).parent / "vgroove"), *arguments]
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(command, stdout=writing, stderr=subprocess.PIPE, text=True, check=False)
    os.close(writing)
    assert (done.returncode, done.stderr) == (cli.CLOSED_PIPE, "")


def test_an_error_that_nobody_reads_ends_the_command_quietly():
    command = [str(Path(sys.executable).parent / "vgroove"), "render", "copper", "-o", "a.gif"]
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=writing, text=True, check=False)
    os.close(writing)
    assert (done.returncode, done.stdout) == (cli.CLOSED_PIPE, "")


@pytest.mark.parametrize("estimator", ["auto", "corrected"])
def test_one_copper_looks_at_the_scenes_lights_once(blender, tmp_path, monkeypatch, estimator):
    """Automatic, builder, advice and render share what was read; Standard needs no light at all."""
    asked, look = [], lamps._found
    monkeypatch.setattr(lamps, "_found", lambda scene: asked.append(scene) or look(scene))
    done = vgroove("render", "copper", "--estimator", estimator, "--samples", 1, "--resolution", "16x16", "-o",
                   tmp_path / "copper.exr")  # fmt: skip
    assert done.code == 0, done.err
    assert len(asked) == (1 if estimator == "corrected" else 0)
