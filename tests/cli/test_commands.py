# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line's contract: exit codes, one line for bad input, whole files or none.

A kind of command is run as a process of its own once (``process``), and otherwise in this one.
"""

import json
import os
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

from ..commands import Said, read_exr
from ..commands import patient as vgroove

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("blender")]


def process(*arguments):
    """Run the command as a user does."""
    command = [str(Path(sys.executable).parent / "vgroove"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return Said(done.returncode, done.stdout, done.stderr)


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
    assert {check_all.model_of(row) for row in plan} == set(MODELS)
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
