# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged contents (``fuzz.py`` says what holds): jobs, presets, metadata of pictures, and reports."""

import json
import math
import re
from datetime import date

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from vgroove import headless
from vgroove.addon.blender import images
from vgroove.addon.library import presets
from vgroove.batch.outcome import RECORD, Outcome

from ..commands import vgroove
from .fuzz import FUZZ, REPORT

pytestmark = pytest.mark.blender


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
