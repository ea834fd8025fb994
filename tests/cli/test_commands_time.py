# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands on presets that change over time: a moment of them, sequences, strips and movies."""

import json

import numpy as np
import pytest

from vgroove.cli import terminal

from ..commands import patient as vgroove
from ..commands import read_exr

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("blender")]


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
