# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report keeps: nothing of other code, nothing lost to failures or to another Blender, and numbers alone."""

import ast
import json
import shutil

import pytest

from vgroove import cli
from vgroove.lab.bench import record, run
from vgroove.lab.bench.record import Cell, ReportError, begun
from vgroove.lab.report import draw


@pytest.fixture
def path(tmp_path):
    return tmp_path / record.FILE


def test_a_record_goes_on(path):
    begun(path, "5.2.3", quick=False).keep("accuracy/b", {"n": 1.5})
    assert begun(path, "5.2.3", quick=False).cells == {"accuracy/b": {"n": 1.5}}


@pytest.mark.parametrize(
    ("of", "other", "said"),
    [
        ("versions", {"numpy": "1.0"}, "measurements by numpy 1.0, which is [12]"),
        ("vgroove", "9.9.9", "measurements by vgroove 9.9.9, which is 0"),
        ("quick", True, "a quick report, not a full one"),
    ],
)
def test_what_else_was_measured_is_not_mixed_in(path, of, other, said):
    begun(path, "5.2.3", quick=False).keep("accuracy/b", {})
    content = json.loads(path.read_text())
    was = content["runs"]["5.2.3"][of]
    content["runs"]["5.2.3"][of] = was | other if isinstance(other, dict) else other
    path.write_text(json.dumps(content))
    with pytest.raises(ReportError, match=rf"holds {said}.*; choose another folder with -o$"):
        begun(path, "5.2.3", quick=False)
    assert begun(path, "4.5.15", quick=False).cells == {}


def test_what_other_code_measured_is_measured_anew_where_one_asks_for_it(path):
    """Part by part; until something new is kept, the file is as it was."""
    for key in ("accuracy/b", "picks/b", "stability/b"):
        begun(path, "5.2.3", quick=False).keep(key, {"n": 1})
    content = json.loads(path.read_text())
    content["runs"]["5.2.3"]["code"] |= {"picks": "another", "stability": "another"}
    path.write_text(json.dumps(content))
    for again, left in (([], "--again picks --again stability,"), (["picks"], "--again stability,")):
        with pytest.raises(ReportError, match=f"give {left} or another folder"):
            begun(path, "5.2.3", quick=False, again=again)
    new = begun(path, "5.2.3", quick=False, again=["picks", "stability"])
    assert json.loads(path.read_text()) == content
    assert new.cells == {"accuracy/b": {"n": 1}}
    new.keep("picks/b", {"n": 2})
    assert begun(path, "5.2.3", quick=False).cells == {"accuracy/b": {"n": 1}, "picks/b": {"n": 2}}


def test_blenders_side_by_side_lose_nothing(path):
    """Each was begun before the other kept anything."""
    new, old = (begun(path, blender, quick=False) for blender in ("5.2.3", "4.5.15"))
    new.keep("accuracy/b", {"n": 1})
    old.keep("accuracy/b", {"n": 2})
    new.keep("accuracy/c", {"n": 3})
    runs = record.read(path)["runs"]
    assert runs["5.2.3"]["cells"] == {"accuracy/b": {"n": 1}, "accuracy/c": {"n": 3}}
    assert runs["4.5.15"]["cells"] == {"accuracy/b": {"n": 2}}


def test_a_report_is_small_and_loses_nothing_but_digits(path):
    """Nine of them, and lists of numbers on a line each; text is as it was."""
    found = {"n": [1 / 3, 2.0, None], "words": ["two  spaces", "[in, brackets]"], "deep": [[1, 2], {"a": [True]}]}
    begun(path, "5.2.3", quick=False).keep("accuracy/b", found)
    kept = record.read(path)["runs"]["5.2.3"]["cells"]["accuracy/b"]
    assert kept == found | {"n": [0.333333333, 2.0, None]}
    assert '"n": [0.333333333, 2.0, null],' in path.read_text()


def test_what_is_next_to_1_is_not_1(path):
    begun(path, "5.2.3", quick=False).keep("stability/b", {"value": [1.0 - 1e-9, 1.0 + 1e-9, 1.0]})
    assert record.read(path)["runs"]["5.2.3"]["cells"]["stability/b"]["value"] == [1.0 - 1e-9, 1.0 + 1e-9, 1.0]


def test_what_a_measurement_took_is_kept_and_what_is_lacking_is_known(path):
    """Of a part that is measured anew it is forgotten."""
    one = begun(path, "5.2.3", quick=False)
    one.expect(3)
    one.keep("accuracy/b", {"n": 1}, 61.26)
    one.keep("picks/b", {"n": 1}, 0.5)
    run = record.read(path)["runs"]["5.2.3"]
    assert (run["wanted"], run["seconds"]) == (3, {"accuracy/b": 61.3, "picks/b": 0.5})
    assert begun(path, "5.2.3", quick=False, again=["picks"]).content["runs"]["5.2.3"]["seconds"] == {
        "accuracy/b": 61.3
    }


def test_what_is_no_number_is_null(path):
    begun(path, "5.2.3", quick=False).keep("accuracy/b", {"n": [1.0, float("nan"), (float("inf"),)]})
    assert record.read(path)["runs"]["5.2.3"]["cells"]["accuracy/b"] == {"n": [1.0, None, [None]]}


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("lab/report/plots.py", ()),
        ("lab/report/documents.py", ()),
        ("addon/report/page.jinja", ()),
        ("cli.py", ()),
        ("addon/choose/automatic.py", ("picks", "left_out", "everyday", "figures")),
        ("lab/bench/stability.py", ("stability",)),
        ("lab/bench/figures/keys.py", ("figures",)),
        ("lab/bench/scenes.py", ("accuracy", "picks", "everyday")),
        ("lab/bench/everyday_scenes.py", ("everyday",)),
        ("osl/include/vgroove.h", record.PARTS),
        ("nodegroups/random_numbers.py", record.PARTS),
        ("presets/lecture/copper.toml", record.PARTS),
        ("addon/reference/fresnel.py", record.PARTS),
    ],
)
def test_the_digest_of_a_part_is_of_what_decides_its_numbers(tmp_path, monkeypatch, name, parts):
    """What other parts measure and what draws changes nothing, what all go through changes all."""
    before = {part: record.code(part) for part in record.PARTS}
    for folder in record.MEASURED:
        shutil.copytree(record.ROOT / folder, tmp_path / folder, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(record, "ROOT", tmp_path)
    assert {part: record.code(part) for part in record.PARTS} == before
    (tmp_path / name).write_text((tmp_path / name).read_text() + "\n")
    changed = {part for part in record.PARTS if record.code(part) != before[part]}
    assert changed == set(parts)


def imported_by(path):
    """Modules of vgroove that a file imports anywhere in it, as paths from the root."""
    package = path.relative_to(record.ROOT).parent.parts
    for node in ast.walk(ast.parse(path.read_text())):
        if not isinstance(node, ast.ImportFrom) or not node.level:
            continue
        base = [*package[: len(package) - node.level + 1], *(node.module or "").split(".")]
        base = [part for part in base if part]
        yield "/".join(base) + ".py"
        yield from ("/".join([*base, one.name]) + ".py" for one in node.names)


def test_no_part_imports_what_is_said_to_decide_others_alone():
    """From each part's module on, over all that it imports; types are imported as well and are no exception."""
    for part in record.PARTS:
        start = record.ROOT / "addon" / "report" / f"{part}.py"
        todo = [start] if start.exists() else sorted((start.with_suffix("")).glob("*.py"))
        seen = set()
        while todo:
            path = todo.pop()
            name = path.relative_to(record.ROOT).as_posix()
            if name in seen or name == "lab/bench/record.py":
                continue
            seen.add(name)
            todo += [found for one in imported_by(path) if (found := record.ROOT / one).is_file()]
        assert len(seen) > 5
        others = [name for name in seen if not record._decides(name, part)]
        assert others == [], (part, others)


def test_the_parts_are_those_that_are_measured():
    assert [module.__name__.rpartition(".")[2] for module in run.PARTS] == list(record.PARTS)
    assert [str(part) for part in cli.report.Part] == list(record.PARTS)


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

        return Cell(f"picks/{name}", measure)

    monkeypatch.setattr(run, "cells", lambda *, quick: [cell(name) for name in ("good", "bad", "last")])
    monkeypatch.setattr(draw, "draw", lambda *_: [])
    monkeypatch.setattr("sys.argv", ["vgroove", "report", "-o", str(tmp_path)])
    for code in (3, 0):
        with pytest.raises(SystemExit) as ended:
            cli.main()
        assert (ended.value.code or 0) == code
        if code:
            said = capsys.readouterr().err
            assert "vgroove: picks/bad: RuntimeError: out of luck" in said
            assert "1 measurements failed, picks/bad first" in said
    assert asked == ["good", "bad", "last", "bad"]
