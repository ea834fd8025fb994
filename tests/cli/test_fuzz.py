# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line's contract against all kinds of bad input: no traceback, no hang, one line, nothing left behind.

The commands run in this process, as Blender starts slowly. Tables hold the kinds of faults that were found once;
hypothesis looks for their neighbours.
"""

import contextlib
import json
import math
import os
import re
import socket
import tempfile
import threading
import types
import typing
from datetime import date
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from vgroove import cli, headless
from vgroove.addon.blender import images
from vgroove.addon.library import files, inputs, presets
from vgroove.batch.outcome import RECORD, Outcome
from vgroove.headless import sequence

from ..commands import vgroove

REPORT = Path(__file__).parents[1] / "data" / "report.json"
FUZZ = settings(
    max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.function_scoped_fixture]
)

pytestmark = pytest.mark.blender


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


SMALL = ("--samples", "1", "--resolution", "4x4", "--estimator", "closure")


# Numbers

NOT_NUMBERS = [
    "٣", "１２", "²", "1_0", "0x10", "", " 1", "+", "nan", "inf", "-inf", "1e999", "-1e999", "1e", "1,5", "\udcff",
    "9" * 5000,
]  # fmt: skip
NOT_WHOLE = ["2147483648", "-2147483649", "99999999999999999999", "1.0", "1e3"]


def number_options():
    """Every option of every command that is a number, with whether it is a whole one."""
    for command in cli.app.registered_commands:
        hints = typing.get_type_hints(command.callback, include_extras=True)
        for name, hint in hints.items():
            if name == "return" or not hasattr(hint, "__metadata__"):
                continue
            kind = hint.__origin__
            kinds = set(kind.__args__) if isinstance(kind, types.UnionType) else {kind}
            if kinds & {int, float}:
                option = hint.__metadata__[0]
                declared = [one for one in (option.default, *(option.param_decls or ())) if isinstance(one, str)]
                yield (
                    command.name or command.callback.__name__,
                    (declared or [f"--{name.replace('_', '-')}"])[0],
                    int in kinds,
                )


OPTIONS = sorted(number_options())
NEEDED = {
    "render": ["copper", "-o", "a.png"], "measure": ["copper", "-o", "a.exr"], "explain": ["copper"],
    "batch": ["job.toml", "-o", "out"],
}  # fmt: skip


def test_options_that_are_numbers_are_found():
    """Else the next test would hold of none."""
    assert {"--samples", "--seed", "--fps", "--bound", "--shutter", "--workers", "--memory", "--timeout"} <= {
        option for _, option, _ in OPTIONS
    }
    assert {command for command, _, _ in OPTIONS} == set(NEEDED)


@pytest.mark.parametrize(("command", "option", "is_whole"), OPTIONS, ids=lambda value: str(value).strip("-"))
def test_numbers_are_ascii_and_in_range(line, command, option, is_whole):
    """By every option that is one; so they are by those to come."""
    for number in [*NOT_NUMBERS, *(NOT_WHOLE if is_whole else [])]:
        said = line.refuses(command, *NEEDED[command], f"{option}={number}")
        assert f"'{option}': must be a" in said


@given(st.text(st.sampled_from("0123456789+-_ .eE٣²x"), max_size=12) | st.integers().map(str) | st.text(max_size=4))
def test_whole_numbers_are_those_of_ascii_digits(text):
    low, high = -5, 2**31 - 1
    if re.fullmatch(r"[+-]?[0-9]+", text) and low <= int(text) <= high and len(text.lstrip("+-")) <= 10:
        assert inputs.whole(text, low, high) == int(text)
    else:
        with pytest.raises(inputs.InputError, match=r"must be a whole number from -5 to 2147483647, got"):
            inputs.whole(text, low, high)


@given(st.floats(allow_nan=False, allow_infinity=False) | st.floats(-1, 1))
def test_numbers_are_read_as_python_writes_them(value):
    assert inputs.real(repr(value)) == value
    with pytest.raises(inputs.InputError, match="from 2 to 3"):
        inputs.real(repr(value / 1e308), 2.0, 3.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--frames", "1-99999999999"], "write FIRST-LAST"),
        (["--frames", "1-1048575"], "Blender's frames are -1048574 to 1048574"),
        (["--frames=-1048575-1"], "Blender's frames are"),
        (["--frames", "١-٣"], "write FIRST-LAST"),
        (["--frames", "1–3"], "write FIRST-LAST"),  # a dash
        (["--frames", ""], "write FIRST-LAST"),
        (["--resolution", "٦٤x٦٤"], "write WIDTHxHEIGHT"),
        (["--resolution", ""], "write WIDTHxHEIGHT"),
        (["--resolution", "64x16385"], "pixels up to 16384"),
        (["--set", "m=٣"], "write NAME=NUMBER"),
        (["--set", "m=1_0"], "write NAME=NUMBER"),
        (["--set", "self=1"], 'unknown key "self"'),
        (["--set", "\udcff=1"], "unknown key"),
        (["--set", "m=1e400"], "write NAME=NUMBER"),
    ],
    ids=ascii,
)
def test_texts_with_numbers_are_refused(line, arguments, message):
    assert message in line.refuses("render", "copper", "-o", "a_##.png", *arguments)


def test_a_part_of_a_batch_is_ascii(line):
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n')
    for part in ("١", "1-١", "1-99999999999", "-1", "", "²", "\udcff"):
        assert "--tasks" in line.refuses("batch", "job.toml", "-o", "out", "--tasks", part)


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


# TOML

DEEP = {
    "dotted key": ".".join("a" * 45_000) + " = 1",
    "dotted key with spaces": " . ".join("a" * 20_000) + " = 1",
    "quoted parts": ".".join(['"a"'] * 20_000) + " = 1",
    "dotted header": "[" + ".".join("a" * 20_000) + "]\n" + "".join(f"k{k} = 1\n" for k in range(5_000)),
    "dotted key inside": "x = { " + ".".join("a" * 40_000) + " = 1 }",
    "no key at all": "a ." * 33_000,
    "lists in lists": "a = " + "[" * 90_000,
    "tables in tables": "a = " + "{a=" * 30_000,
    "quotes": "'\"" * 45_000,
    "one long word": "a" * 90_000,
    "digits": "a = " + "1" * 90_000,
}


@pytest.mark.parametrize("text", DEEP.values(), ids=DEEP)
def test_toml_is_refused_in_little_time(line, text):
    """Keys of thousands of parts took Python's parser minutes."""
    (line.folder / "job.toml").write_text(text)
    assert "job.toml: not valid TOML: " in line.refuses("batch", "job.toml", "-o", "out")


class Huge:
    """An integer that Python reads in hexadecimal, and refuses to write in decimal."""

    def __str__(self):
        return "0x" + "f" * 5000


HUGE = Huge()


def toml(value):
    """A value as TOML has it."""
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{toml(key)} = {toml(one)}" for key, one in value.items()) + "}"
    if isinstance(value, str):
        return '"' + "".join(c if c.isalnum() and c.isascii() else f"\\U{ord(c):08x}" for c in value) + '"'
    return str(value).lower() if isinstance(value, bool) else str(value)  # a float is nan, inf or a number


letters = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
words = letters | st.sampled_from(["copper", "1-3", "64x64", "preview", "Ball", "٣-٤", "a\0b", "x" * 300, "fit", "m"])
plain = (
    st.none().map(lambda _: date(1979, 5, 27)) | st.booleans() | st.integers() | st.floats() | words
    | st.sampled_from([2**31, -(2**31), 2**63, 10**30, HUGE])
)  # fmt: skip
values = st.recursive(
    plain, lambda one: st.lists(one, max_size=3) | st.dictionaries(words, one, max_size=2), max_leaves=4
)
KEYS = [
    "scene", "object", "preset", "assign", "set", "time", "frames", "backend", "estimator", "bound", "samples",
    "error", "seed", "resolution", "output",
]  # fmt: skip


@FUZZ
@given(st.dictionaries(st.sampled_from(KEYS), values, max_size=2))
@example({"samples": HUGE})
@example({"seed": [HUGE]})
@example({"set": {"self": 1}})
@example({"set": {"m": HUGE}})
@example({"frames": "1-9999999"})
@example({"frames": "١-٣"})
@example({"resolution": "٦٤x٦٤"})
@example({"time": HUGE})
@example({"object": "a\0b"})
@example({"scene": "a\0b.blend"})
@example({"scene": "x" * 300 + ".blend"})
@example({"assign": {"a\0b": "copper"}})
def test_any_value_in_a_job_is_read_or_refused_in_one_line(line, keys):
    table = {"preset": "copper"} | keys
    text = "[[render]]\n" + "".join(f"{key} = {toml(value)}\n" for key, value in table.items())
    (line.folder / "job.toml").write_text(text, encoding="utf-8")
    said = vgroove("batch", "job.toml", "-o", "out", "--dry-run")
    assert said.code in {0, 2}, said
    assert len(said.lines) == (said.code == 2), said.err


def test_the_tasks_of_all_tables_are_counted(line):
    """Two tables of 600 000 would take minutes to name."""
    table = '[[render]]\npreset = "rusting_iron"\nframes = "1-600000"\n'
    (line.folder / "job.toml").write_text(2 * table)
    assert "render 2: makes 1200000 tasks in all" in line.refuses("batch", "job.toml", "-o", "out", "--dry-run")


PRESET = {
    "name": "A", "model": "cook_torrance", "m": 0.3, "tags": ["x"], "notes": "n", "m_range": [0.1, 0.4],
    "fresnel": {"f0": [0.9, 0.6, 0.5]}, "source": {"data": "somewhere"}, "verified": {"f0": 0.5},
    "time": {
        "unit": "s", "range": [0.0, 1.0], "kind": "authored", "m": {"law": "exponential", "end": 0.4, "rate": 1.0},
    },
}  # fmt: skip
PLACES = [(key,) for key in PRESET] + [
    ("fresnel", "f0"), ("source", "data"), ("verified", "f0"), ("time", "unit"), ("time", "range"), ("time", "kind"),
    ("time", "m"), ("time", "m", "law"), ("time", "m", "end"), ("time", "m", "rate"), ("time", "m", "times"),
]  # fmt: skip


def changed(tree, place, value):
    """A copy of tables in tables with another value at a place."""
    first, *rest = place
    return tree | {first: changed(tree[first], rest, value) if rest else value}


@FUZZ
@given(st.sampled_from(PLACES), values)
@example(("time", "m", "law"), ["exponential"])
@example(("time", "m", "rate"), HUGE)
@example(("time", "range"), [0, HUGE])
@example(("m",), [HUGE])
@example(("fresnel", "f0"), [0.5, 0.5])
def test_any_value_in_a_preset_is_read_or_refused_in_one_line(line, place, value):
    text = "".join(f"{key} = {toml(one)}\n" for key, one in changed(PRESET, place, value).items())
    (line.folder / "odd.toml").write_text(text, encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(presets.USER_FOLDER, str(line.folder))
        presets.reread()
        said = vgroove("presets", "mine/odd")
    presets.reread()
    assert said.code == 0, said
    assert len(said.lines) <= 1, said.err


# Names of objects

NOT_NAMES = ["\udcff=copper", "a\udcff=copper", "=copper", "Floor=", "Floor", "Floor=\udcff", "Floor=" + "x" * 100_000]


@pytest.mark.parametrize("item", NOT_NAMES, ids=lambda item: ascii(item)[:20])
def test_what_no_object_can_be_called_is_refused(scene_line, item):
    scene_line.refuses("render", "bare.blend", "--assign", item, "-o", "a.png")


def test_an_object_gets_one_preset(scene_line):
    given = ["--assign", "Floor=copper", "--assign", "Floor=gold"]
    said = scene_line.refuses("render", "bare.blend", *given, "-o", "a.png")
    assert 'gives "Floor" a second preset' in said


@pytest.mark.parametrize(
    ("item", "name", "preset"),
    [
        ("Floor=copper", "Floor", "lecture/copper"),
        ("Floor:2=copper", "Floor:2", "lecture/copper"),
        ("Floor:Trim=metals/gold", "Floor:Trim", "metals/gold"),
        ("Grün=1:x=copper", "Grün=1:x", "lecture/copper"),
        ("a=b:c=d:1=copper", "a=b:c=d:1", "lecture/copper"),
    ],
)
def test_the_last_equals_sign_divides_an_assignment(item, name, preset):
    """No preset's id has one, and names of objects may. ``assign`` decides which part is a slot."""
    ((found, of),) = cli.render.assignments([item])
    assert (found, of.id) == (name, preset)


def test_names_are_utf8_whatever_the_locale_is(scene_line):
    """In an ASCII locale Python keeps the bytes as lone surrogates."""
    assert inputs.name("Grün") == inputs.name(os.fsdecode("Grün".encode())) == "Grün"
    said = vgroove("render", "bare.blend", "--assign", "Grün=1:x=copper", "-o", "a.png", *SMALL)
    assert said.code == 0, said.err


# Terminals


def test_an_ascii_terminal_shows_everything(line):
    for arguments in (["presets"], ["presets", "--json"], ["--help"], ["explain", "copper"]):
        said = vgroove(*arguments, encoding="ascii")
        assert said.code == 0, said
    said = vgroove("render", "\udcff\u202e\x1b[31m", "-o", "Grün.gif", encoding="ascii")
    assert said.code == 2
    assert len(said.lines) == 1
    assert "\x1b" not in said.err


def test_a_line_stays_one_line(line):
    """Whatever names hold, and however long they are."""
    for name in ("a\nb.gif", "a\x1b[31mb.gif", "\u2028.gif", "x" * 100_000 + ".gif"):
        assert len(line.refuses("render", "copper", "-o", name)) <= 1100


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


# Pictures that are read


def record(**changes):
    outcome = Outcome("a" * 32, "rendered", 1.5, samples=8, error=0.25).as_json()
    return {"labels": {"m": "1"}, "outcome": outcome, "files": {}, "task": {}, "versions": {}} | changes


def put(path, told, shape=(8, 8)):
    headless.prepare()
    images.write(path, np.full((*shape, 3), 0.5, np.float32), {RECORD: told})


@pytest.mark.parametrize("shape", [(4000, 1), (1, 4000), (1, 1), (3000, 2)], ids=str)
def test_a_gallery_takes_pictures_of_any_shape(line, shape):
    """A picture of 1 x 4000 would make a thumbnail 768 000 pixels high."""
    put(line.folder / "a.png", json.dumps(record()), shape)
    said = vgroove("gallery", ".")
    assert said.code == 0, said.err
    page = (line.folder / "gallery.html").read_text(encoding="utf-8")
    assert "data:image/webp;base64," in page
    tile = images.tile(line.folder / "a.png", 192)
    assert tile.shape[1] == 192
    assert tile.shape[0] <= 192 * images.MAX_TILE_ASPECT


@pytest.mark.parametrize(
    "name", ["javascript:alert(1)", "data:text,x", "a b#?&", "\udcff", "Grün", "<b>", '"'], ids=ascii
)
def test_links_of_a_gallery_lead_to_its_pictures(line, name):
    """And to nothing else, whatever a file is called."""
    put(line.folder / "plain.png", json.dumps(record()))
    (line.folder / "plain.png").rename(line.folder / f"{name}.png")
    said = vgroove("gallery", ".")
    assert said.code == 0, said.err
    page = (line.folder / "gallery.html").read_text(encoding="utf-8")
    links = re.findall(r'href="([^"]*)"', page)
    assert len(links) == 2
    assert all(re.fullmatch(r"\./[\w.%~-]+", link, re.ASCII) for link in links)
    assert "data:image/webp;base64," in page


def test_metadata_that_is_not_utf8_is_none_of_ours(line):
    """Such a picture is left out, and one beside it is shown."""
    put(line.folder / "a.png", json.dumps(record()))
    put(line.folder / "b.png", "@" * 64)
    path = line.folder / "b.exr"
    put(path, "@" * 64)
    path.write_bytes(path.read_bytes().replace(b"@" * 64, b"\xff" * 64))
    assert images.attribute(path, RECORD) is None
    assert vgroove("gallery", ".").code == 0
    assert (line.folder / "gallery.html").read_text(encoding="utf-8").count("<article") == 1


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5) | st.just("\ud800"),
    lambda one: st.lists(one, max_size=3) | st.dictionaries(st.text(max_size=5), one, max_size=3),
    max_leaves=4,
)
KINDS = [*record(), *(f"outcome.{key}" for key in record()["outcome"])]


@FUZZ
@given(st.sampled_from(KINDS), json_values)
@example("labels", {"m": [1]})
@example("labels", {"m": "\ud800"})
@example("outcome.seconds", "1")
@example("outcome.seconds", math.nan)
@example("outcome.error", "0.1")
@example("versions", None)
@example("task", {"x": "\ud800"})
def test_a_gallery_takes_any_metadata(line, place, value):
    """A record that is not as it must be is none."""
    told = changed(record(), place.split("."), value)
    put(line.folder / "a.exr", json.dumps(told))
    put(line.folder / "b.exr", json.dumps(record()))
    said = vgroove("gallery", ".")
    assert said.code == 0, said.err
    assert (line.folder / "gallery.html").read_text(encoding="utf-8").count("<article") in {1, 2}


# Reports


@pytest.fixture(scope="module")
def small_report():
    """A cell or two of each part of a report."""
    content = json.loads(REPORT.read_text(encoding="utf-8"))
    for run in content["runs"].values():
        kept, count = {}, {}
        for key, cell in run["cells"].items():
            part = key.partition("/")[0]
            count[part] = count.get(part, 0) + 1
            if count[part] <= 1 or part == "figures":
                kept[key] = cell
        run["cells"] = kept
    return content


def places(tree, at=()):
    """Every place in tables and lists of a report."""
    for key, value in tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ():
        yield (*at, key)
        yield from places(value, (*at, key))


def replaced(tree, place, value):
    """A copy with another value at a place."""
    copy = json.loads(json.dumps(tree))
    at = copy
    for key in place[:-1]:
        at = at[key]
    at[place[-1]] = value
    return copy


@FUZZ
@given(st.data())
def test_a_damaged_report_is_read_or_refused_in_one_line(line, small_report, data):
    place = data.draw(st.sampled_from(sorted(places(small_report), key=lambda one: (len(one), str(one)))[:4000]))
    text = json.dumps(replaced(small_report, place, data.draw(json_values)))
    (line.folder / "a.json").write_text(text, encoding="utf-8")
    (line.folder / "b.json").write_text(json.dumps(small_report), encoding="utf-8")
    for pair in (("a.json", "b.json"), ("b.json", "a.json")):
        said = vgroove("report", "--compare", *pair)
        assert said.code in {0, 1, 2}, said
        assert len(said.lines) == (said.code == 2), said.err


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("machine",), []),
        (("runs",), [1]),
        (("runs",), {"../../a": {}}),
        (("runs", "5.2.3"), None),
        (("runs", "5.2.3", "seconds"), 1),
        (("runs", "5.2.3", "cells"), {"accuracy/a/b": {}}),
        (("runs", "5.2.3", "cells"), {"stability/a": {"cases": [{"what": 1}]}}),
        (("runs", "5.2.3", "cells"), {"left_out/a": {"preset": 1, "setups": [{}]}}),
        (("format",), 1 << 60),
    ],
    ids=str,
)
def test_nothing_is_drawn_of_a_damaged_report(line, small_report, place, value):
    (line.folder / "a.json").write_text(json.dumps(replaced(small_report, place, value)), encoding="utf-8")
    assert "a.json: " in line.refuses("report", "--from", "a.json", "-o", "out")


@pytest.mark.parametrize(
    "text", ["", "[]", "{", "1", "null", '"a"', "[" * 100_000, '{"runs": {}}', "\ufeff{}"], ids=lambda t: t[:9]
)
def test_what_is_no_report_is_one_line(line, text):
    (line.folder / "a.json").write_text(text, encoding="utf-8")
    assert "a.json: " in line.refuses("report", "--compare", "a.json", REPORT)


# Clusters


@pytest.fixture
def ports():
    """One at which nobody listens, one that says nothing, and one that is another kind of server."""
    silent, chatty, closed = (socket.socket() for _ in range(3))
    for one in (silent, chatty, closed):
        one.bind(("127.0.0.1", 0))
    found = {"closed": closed.getsockname()[1], "silent": silent.getsockname()[1], "ssh": chatty.getsockname()[1]}
    silent.listen()
    chatty.listen()
    closed.close()

    def greet():
        with contextlib.suppress(OSError):
            while True:
                with chatty.accept()[0] as one:
                    one.sendall(b"SSH-2.0-OpenSSH_9.6\r\n")
                    one.recv(1)

    threading.Thread(target=greet, daemon=True).start()
    yield found
    for one in (silent, chatty):
        one.close()


@pytest.mark.parametrize("scheme", ["tcp", "tls", "ws"])
@pytest.mark.parametrize("port", ["closed", "silent", "ssh"])
def test_a_cluster_that_does_not_answer_is_one_line(line, ports, monkeypatch, scheme, port):
    from vgroove.batch import cluster

    monkeypatch.setattr(cluster, "PATIENCE", 1)
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n')
    address = f"{scheme}://127.0.0.1:{ports[port]}"
    said = line.refuses("batch", "job.toml", "-o", "out", "--cluster", address)
    assert f"{address}: no Dask scheduler answers there" in said


@pytest.mark.parametrize(
    "address",
    ["", "farm", "http://farm:1", "ucx://farm:1", "inproc://farm:1", "tcp://farm", "tcp://farm:0", "tcp://farm:65536",
     "tcp://farm:٣", "tcp://a b:1", "tcp://\udcff:x", "javascript:1", "tcp://:1/"],
    ids=ascii,
)  # fmt: skip
def test_what_is_no_address_is_refused(line, address):
    (line.folder / "job.toml").write_text('[[render]]\npreset = "copper"\n')
    said = line.refuses("batch", "job.toml", "-o", "out", "--cluster", address)
    assert "write the address of a Dask scheduler, as in tcp://farm:8786" in said


# Any words at all

anything = st.text(st.characters(exclude_characters="\0"), max_size=12) | st.sampled_from(
    [
        "copper",
        "render",
        "-o",
        "--help",
        "--",
        "-",
        "a.png",
        "--frames",
        "1-3",
        "--set",
        "m=1",
        "\udcff",
        "//",
        "{",
        "=",
    ]
)


@FUZZ
@given(
    st.sampled_from(["render", "measure", "explain", "batch", "gallery", "report", "presets"]),
    st.lists(anything, max_size=5),
)
def test_any_words_are_understood_or_refused_in_one_line(line, command, words):
    """What would be right is cut short by an output that cannot be written."""
    (line.folder / "no").write_text("")
    before = line.files()
    more = [] if command in {"presets", "explain", "report"} else ["-o", "no/a.exr"]
    said = vgroove(command, *words, *more)
    assert said.code in {0, 2}, said
    if said.code == 2:
        assert len(said.lines) == 1, said.err
    assert line.files() == before


def test_frames_that_are_there_are_read_as_regular_files(line):
    os.mkfifo(line.folder / "a.png")
    assert not sequence.is_done(line.folder / "a.png", "x")
