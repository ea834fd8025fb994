# SPDX-License-Identifier: GPL-3.0-or-later
"""`vgroove report`: exit codes, bad input, and what a report that is interrupted keeps."""

import importlib.util
import json
import subprocess
import sys

import pytest

from vgroove import cli
from vgroove.lab.bench import record
from vgroove.lab.bench.record import Cell
from vgroove.lab.report import draw, findings

from .reports import left_out, measured, report, vgroove

pytestmark = pytest.mark.once


@pytest.fixture
def two(tmp_path):
    for name in ("a", "b"):
        (tmp_path / f"{name}.json").write_text(json.dumps(report()))
    return tmp_path / "a.json", tmp_path / "b.json"


def test_compare_exits_1_if_something_is_worse(two, capsys):
    a, b = two
    assert vgroove("--compare", a, b) == 0
    assert "0 worse, 0 better" in capsys.readouterr().out
    content = json.loads(b.read_text())
    content["runs"]["5.2.3"]["cells"]["stability/slope"][1]["passed"] = False
    b.write_text(json.dumps(content))
    assert vgroove("--compare", a, b) == 1
    assert "1 worse, 0 better" in capsys.readouterr().out
    assert vgroove("--compare", b, a) == 0
    content["runs"] = {"4.2.0": content["runs"]["5.2.3"], "4.3.0": content["runs"]["5.2.3"]}
    b.write_text(json.dumps(content))
    assert vgroove("--compare", a, b) == 2
    assert "no figure in common" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give -o DIR to measure, --from REPORT.json to redraw"),
        (["--from", "none.json"], "none.json: not there"),
        (["--from", "broken.json"], "broken.json: no report"),
        (["--from", "old.json"], "old.json: is of format 0"),
        (["--from", "empty.json"], "holds no measurements yet"),
        (["--from", "a.json", "--quick"], "leave out"),
        (["--from", "a.json", "--again", "accuracy"], "leave out"),
        (["-o", "a", "--documents", "."], "give --from"),
        (["--compare", "a.json", "none.json"], "none.json: not there"),
        (["--compare", "a.json", "a.json", "-o", "there"], "leave -o, --from, --quick and --again out"),
        (["--compare", "a.json"], "--compare"),
        (["-o", "a.json"], "cannot be made"),
        (["-o", "other"], "was measured on another machine"),
        (["-o", "bare"], "report.json: required field missing @ $.machine"),
        (["--from", "bare/report.json"], "report.json: required field missing @ $.machine"),
        (["--from", "celless.json"], "celless.json: expected a mapping @ $.runs['5.2.3'].cells"),
        (["--from", "listed.json"], "listed.json: invalid value for type"),
        (["--from", "flat.json"], "flat.json: left_out/a: "),
        (["--from", "hollow.json"], "hollow.json: left_out/a: required field missing"),
        (["--compare", "a.json", "hollow.json"], "hollow.json: left_out/a: required field missing"),
    ],
)
def test_bad_input_is_one_line(two, monkeypatch, capsys, arguments, message):
    folder = two[0].parent
    monkeypatch.chdir(folder)
    (folder / "broken.json").write_text("{")
    (folder / "old.json").write_text(json.dumps(report() | {"format": 0}))
    (folder / "empty.json").write_text(json.dumps(report() | {"runs": {}}))
    (folder / "bare").mkdir()
    (folder / "bare" / "report.json").write_text(json.dumps({"format": record.FORMAT, "runs": {}}))
    (folder / "hollow.json").write_text(json.dumps(report(cells={"left_out/a": [{}]})))
    (folder / "flat.json").write_text(json.dumps(report(cells={"left_out/a": 7})))
    run_of = report()["runs"]["5.2.3"]
    (folder / "celless.json").write_text(json.dumps(report() | {"runs": {"5.2.3": run_of | {"cells": None}}}))
    (folder / "listed.json").write_text(json.dumps(report() | {"runs": {"5.2.3": [run_of]}}))
    (folder / "other").mkdir()
    (folder / "other" / "report.json").write_text(
        json.dumps(report() | {"machine": report()["machine"] | {"cores": 0}})
    )
    assert vgroove(*arguments) == 2
    said = capsys.readouterr().err
    assert message in said
    assert said.count("\n") == 1
    assert not (folder / "there").exists()


def test_a_report_exits_1_if_a_claim_does_not_hold(tmp_path, capsys):
    """A full one; a quick one says so alone. It is drawn in any case."""
    for quick, time, code in ((False, 0.9, 1), (True, 0.9, 0), (False, 2.0, 0)):
        content = report(cells={"left_out/metal": left_out(time)})
        content["runs"]["5.2.3"]["quick"] = quick
        (tmp_path / "report.json").write_text(json.dumps(content))
        assert vgroove("--from", tmp_path / "report.json", "-o", tmp_path / "new") == code
        assert ("DOES NOT HOLD: Specialised materials" in capsys.readouterr().err) is (time < 1.0)
        assert ('class="bad"' in (tmp_path / "new" / draw.PAGE).read_text(encoding="utf-8")) is (time < 1.0)


@pytest.mark.blender
def test_what_could_not_be_measured_is_said_though_a_claim_does_not_hold(monkeypatch, capsys, tmp_path):
    def broken():
        message = "broken"
        raise RuntimeError(message)

    cells = [Cell("left_out/a", lambda: measured(0.5)), Cell("left_out/b", broken)]
    monkeypatch.setattr(record, "cells", lambda *, quick, more: cells)
    assert vgroove("-o", tmp_path) == 3
    said = capsys.readouterr().err
    assert "Blender" in said
    assert "1 measurements missing: DOES NOT HOLD: Specialised materials" in said
    assert said.splitlines()[-1] == "vgroove: 1 measurements failed, left_out/b first; give the command again"


def test_a_report_is_drawn_without_blender(tmp_path):
    (tmp_path / "report.json").write_text(json.dumps(report(cells={"left_out/metal": left_out(2.0)})))
    code = "import sys; sys.modules['bpy'] = None; from vgroove import cli; cli.main()"
    command = [sys.executable, "-P", "-c", code, "report", "--from", tmp_path / "report.json", "-o", tmp_path / "new"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "2.00 × as fast in the median of 1 cases" in (tmp_path / "new" / draw.PAGE).read_text(encoding="utf-8")


@pytest.mark.parametrize("gone", ["matplotlib", "mitsuba"])
def test_a_missing_extra_is_named_before_any_work(gone, monkeypatch, capsys, tmp_path):
    find = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *rest: None if name == gone else find(name, *rest))
    assert vgroove("-o", tmp_path / "out") == 2
    assert f"report needs {gone}; install" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.blender
def test_an_interrupted_report_goes_on(monkeypatch, capsys, tmp_path):
    """What is measured is kept and not measured again; the page is drawn at the end."""
    done = []

    def cell(name, *, fails=False):
        def measure():
            if fails and not done.count("again"):
                raise KeyboardInterrupt
            done.append(name)
            return measured(2.0)

        return Cell(f"left_out/{name}", measure)

    monkeypatch.setattr(
        record, "cells", lambda *, quick, more: [cell("first"), cell("second", fails=True), cell("third")]
    )
    out = tmp_path / "out"
    assert vgroove("-o", out) == cli.INTERRUPTED
    assert done == ["first"]
    assert "1 of 3 measurements are kept in" in capsys.readouterr().err
    assert not (out / draw.PAGE).exists()
    done.append("again")
    assert vgroove("-o", out) == 0
    assert done == ["first", "again", "second", "third"]
    assert "1 of 3 measurements are there already" in capsys.readouterr().err
    kept = findings.runs(record.read(out / record.FILE))[0].record.cells
    assert list(kept) == ["left_out/first", "left_out/second", "left_out/third"]
    before = (out / draw.PAGE).read_text()
    (out / draw.PAGE).unlink()
    assert vgroove("--from", out / record.FILE, "-o", tmp_path / "elsewhere") == 0
    assert (tmp_path / "elsewhere" / draw.PAGE).read_text() == before
    assert vgroove("-o", out, "--quick") == 2
    assert "holds a full report, where a quick one is asked for; choose another folder" in capsys.readouterr().err
