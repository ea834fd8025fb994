# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that cannot be read or written (``fuzz.py`` says what holds): pipes, devices, folders, and odd names."""

import contextlib
import os
import tempfile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from vgroove.addon.blender import images
from vgroove.addon.library import files, presets
from vgroove.headless import sequence

from ..commands import vgroove
from .fuzz import FUZZ, REPORT, SMALL

pytestmark = pytest.mark.blender


# Files that are read

NOT_FILES = {
    "pipe": os.mkfifo,
    "folder": os.mkdir,
    "zero": lambda path: path.symlink_to("/dev/zero"),
    "full": lambda path: path.symlink_to("/dev/full"),
    "tty": lambda path: path.symlink_to("/dev/tty"),
    "loop": lambda path: path.symlink_to(path),
    "dangling": lambda path: path.symlink_to(f"{path}.none"),
    "large": lambda path: (path.touch(), os.truncate(path, 2**22)),
    "bytes": lambda path: path.write_bytes(b"\xff\xfe\x00"),
}


@pytest.fixture
def not_a_file(request, line):
    """A function that makes a file of a kind that cannot be read."""

    def make(name):
        path = line.folder / name
        NOT_FILES[request.param](path)
        return path

    return make


every_kind = pytest.mark.parametrize("not_a_file", NOT_FILES, indirect=True)


@every_kind
def test_jobs_are_read_as_regular_files(line, not_a_file):
    not_a_file("job.toml")
    assert "job.toml: cannot be read: " in line.refuses("batch", "job.toml", "-o", "out")


@every_kind
def test_presets_are_read_as_regular_files(line, not_a_file, monkeypatch):
    """What cannot be read is left out, with a line that says so."""
    not_a_file("odd.toml")
    monkeypatch.setenv(presets.USER_FOLDER, str(line.folder))
    presets.reread()
    assert "odd.toml: cannot be read: " in line.refuses("render", "mine/odd", "-o", "a.png")
    said = vgroove("presets", "odd")
    presets.reread()
    assert said.code == 0
    assert len(said.lines) == 1


@every_kind
def test_reports_are_read_as_regular_files(line, not_a_file):
    is_there = not_a_file("report.json").exists()  # else a report begins
    for arguments in (["--from", "report.json"], ["--compare", "report.json", REPORT], *[["-o", "."]] * is_there):
        assert "report.json: " in line.refuses("report", *arguments)


@every_kind
def test_scenes_and_pictures_are_read_as_regular_files(line, not_a_file):
    not_a_file("a.blend")
    not_a_file("a.png")
    for arguments in (["render", "a.blend", "-o", "b.png"], ["explain", "copper", "--scene", "a.blend"]):
        assert "a.blend: " in line.refuses(*arguments)
    assert "holds no stills" in line.refuses("gallery", ".")


@every_kind
def test_a_batch_reads_what_is_there_as_regular_files(line, not_a_file):
    """Tables of an earlier batch, and files that a scene names."""
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n[[render]]\nscene = "a.blend"\n')
    not_a_file("a.blend")
    not_a_file("results.csv")
    said = vgroove("batch", "job.toml", "-o", ".", "--dry-run")
    assert said.code in {0, 2}
    assert len(said.lines) <= 1


def test_presets_in_nobodys_home_are_named(line, monkeypatch):
    monkeypatch.setenv(presets.USER_FOLDER, "~nobody-of-that-name/x")
    said = vgroove("presets", "copper")
    assert said.code == 0
    assert "~nobody-of-that-name/x is no folder" in said.err


# Files that are written

ODD_NAMES = [
    "{blend_name}.png", "{x}.png", "{{x}}.png", "{.png", "a\\b.png", "//a.png", "a#.png", "####.png", "a?b=1.png",
    "<UDIM>.png", "a\nb.png", "\udcff.png", "Grün.png", "a:b.png", "%04d.png", "$HOME.png", "~.png", "-.png", " .png",
    "x" * 251 + ".png", "ü" * 125 + ".png", "a*b.exr", "{x}.exr", "\udcff.exr",
]  # fmt: skip


@pytest.mark.parametrize("name", ODD_NAMES, ids=ascii)
def test_a_picture_gets_the_name_that_was_asked_for(scene_line, name):
    """Blender has its own ideas of braces, slashes and number signs."""
    if name.startswith("//"):
        name = f"/{scene_line.folder}/a.png"
        assert name.startswith("//")
    before = scene_line.files()
    said = vgroove("render", "bare.blend", "-o", name, *SMALL)
    assert said.code == 0, said.err
    path = scene_line.folder / name.lstrip("/") if not name.startswith("//") else scene_line.folder / "a.png"
    assert set(scene_line.files()) - set(before) == {os.fsencode(path)}
    assert images.load(path).shape == (4, 4, 3)


@pytest.mark.parametrize("name", ["{x}", "a\\b", "a#", "\udcff", "<UDIM>", "Grün", "a?b"], ids=ascii)
def test_folders_may_have_any_name(scene_line, name):
    """For a still, and for what is made of frames that lie there."""
    (scene_line.folder / name).mkdir()
    base = ["render", "bare.blend", *SMALL]
    more = ["--frames", "1-2", "--resolution", "16x16", "--strip", f"{name}/strip.png", "--movie", f"{name}/movie.mp4"]
    for _ in range(2):
        said = vgroove(*base, "-o", f"{name}/r_#.png", *more)
        assert said.code == 0, said.err
    assert "2 of them there already" in said.err
    found = {os.fsdecode(path.name) for path in (scene_line.folder / name).iterdir()}
    assert found == {"r_1.png", "r_2.png", "strip.png", "movie.mp4"}
    assert not list(scene_line.scratch.iterdir())


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("x" * 252 + ".png", "File name too long"),
        ("ü" * 126 + ".png", "File name too long"),
        ("r_" + "#" * 250 + ".png", "File name too long"),
        ("a/" * 2100 + "b.png", ""),
        ("pipe.png", "is a pipe or a device"),
        ("null.png", "is a pipe or a device"),
        ("folder.png", "is a folder"),
        ("no/a.png", "the folder"),
    ],
    ids=lambda value: value[:12],
)
def test_what_cannot_be_written_is_refused_before_any_work(line, name, message):
    os.mkfifo(line.folder / "pipe.png")
    (line.folder / "null.png").symlink_to("/dev/null")
    (line.folder / "folder.png").mkdir()
    assert message in line.refuses("render", "copper", "-o", name, *(["--frames", "1-2"] if "#" in name else []))
    for option in (["check", "--quick", "--json"], ["gallery", ".", "-o"]):
        line.refuses(*option, name.replace("#", "a"))


def test_a_temporary_folder_that_blender_misreads_is_named(line, monkeypatch):
    odd = line.scratch / "{x}"
    odd.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(odd))
    assert "have TMPDIR name a plainer one" in line.refuses("render", "copper", "-o", "a.png")


def test_a_write_that_fails_leaves_nothing(line):
    for name in ("a.txt", "{x}.txt"):
        path = line.folder / name
        with contextlib.suppress(ZeroDivisionError), files.replacing(path) as temporary:
            temporary.write_text("half")
            temporary.write_text(str(1 / 0))
        with pytest.raises(FileNotFoundError, match="nothing was written"), files.replacing(path):
            pass
        assert line.files() == []


@FUZZ
@given(st.text(st.characters(exclude_characters="/\0", exclude_categories=["Cs"]), min_size=1, max_size=40))
def test_text_gets_any_name_that_the_system_takes(line, name):
    path = line.folder / f"{name}.txt"
    try:
        files.check_writable(path)
    except OSError as error:
        assert "too long" in str(error)  # noqa: PT017 - most names are fine
        return
    files.write_text(path, "x\udcff")
    assert path.read_text(encoding="utf-8") == "x\\udcff"
    path.unlink()
    assert line.files() == []


def test_frames_that_are_there_are_read_as_regular_files(line):
    os.mkfifo(line.folder / "a.png")
    assert not sequence.is_done(line.folder / "a.png", "x")
