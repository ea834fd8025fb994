# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report keeps: nothing of other code, nothing lost to failures or to another Blender, and numbers alone."""

import json
import shutil

import pytest

from vgroove.addon import cli
from vgroove.addon.report import draw, record, run
from vgroove.addon.report.record import Cell, ReportError, begun


@pytest.fixture
def path(tmp_path):
    return tmp_path / record.FILE


def test_a_record_goes_on(path):
    begun(path, "5.2.3", quick=False).keep("a/b", {"n": 1.5})
    assert begun(path, "5.2.3", quick=False).cells == {"a/b": {"n": 1.5}}


@pytest.mark.parametrize(
    ("of", "other"), [("code", "another"), ("versions", {}), ("vgroove", "9.9.9"), ("quick", True)]
)
def test_what_else_was_measured_is_not_mixed_in(path, of, other):
    begun(path, "5.2.3", quick=False).keep("a/b", {})
    content = json.loads(path.read_text())
    content["runs"]["5.2.3"][of] = other
    path.write_text(json.dumps(content))
    with pytest.raises(ReportError, match=f"of other {of}; choose another folder"):
        begun(path, "5.2.3", quick=False)
    assert begun(path, "4.5.15", quick=False).cells == {}


def test_blenders_side_by_side_lose_nothing(path):
    """Each was begun before the other kept anything."""
    new, old = (begun(path, blender, quick=False) for blender in ("5.2.3", "4.5.15"))
    new.keep("a/b", {"n": 1})
    old.keep("a/b", {"n": 2})
    new.keep("a/c", {"n": 3})
    runs = record.read(path)["runs"]
    assert runs["5.2.3"]["cells"] == {"a/b": {"n": 1}, "a/c": {"n": 3}}
    assert runs["4.5.15"]["cells"] == {"a/b": {"n": 2}}


def test_what_is_no_number_is_null(path):
    begun(path, "5.2.3", quick=False).keep("a/b", {"n": [1.0, float("nan"), (float("inf"),)]})
    assert record.read(path)["runs"]["5.2.3"]["cells"]["a/b"] == {"n": [1.0, None, [None]]}


def test_the_digest_is_of_what_decides_numbers(tmp_path, monkeypatch):
    """A shader, a node group, a preset, the reference and a check change it; a plot and a picture do not."""
    before = record.code()
    for folder in record.MEASURED:
        shutil.copytree(record.ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(record, "ROOT", tmp_path)
    assert record.code() == before
    for name in ("addon/report/plots.py", "addon/report/page.jinja"):
        (tmp_path / name).write_text("changed")
        assert record.code() == before
    for name in (
        "osl/include/vgroove.h", "nodegroups/random_numbers.py", "presets/lecture/copper.toml",
        "addon/reference/fresnel.py", "addon/report/scenes.py",
    ):  # fmt: skip
        (tmp_path / name).write_text((tmp_path / name).read_text() + "\n")
        now = record.code()
        assert now != before
        before = now


@pytest.mark.blender
def test_what_fails_does_not_end_the_rest(tmp_path, monkeypatch, capsys):
    """One line each, exit code 3, and the next run measures that alone."""
    asked = []

    def cell(name):
        def measure(_folder):
            asked.append(name)
            if name == "bad" and asked.count("bad") == 1:
                message = "out of\nluck"
                raise RuntimeError(message)
            return {}

        return Cell(f"a/{name}", measure)

    monkeypatch.setattr(run, "cells", lambda *, quick: [cell(name) for name in ("good", "bad", "last")])
    monkeypatch.setattr(draw, "draw", lambda *_: [])
    monkeypatch.setattr("sys.argv", ["vgroove", "report", "-o", str(tmp_path)])
    for code in (3, 0):
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert (ended.value.code or 0) == code
        if code:
            said = capsys.readouterr().err
            assert "vgroove: a/bad: RuntimeError: out of luck" in said
            assert "1 measurements failed, a/bad first" in said
    assert asked == ["good", "bad", "last", "bad"]
