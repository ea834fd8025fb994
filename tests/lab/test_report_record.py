# SPDX-License-Identifier: GPL-3.0-or-later
"""What a report keeps: nothing measured by other code, nothing lost to failures or to another Blender, only numbers."""

import json
import re
import shutil

import numpy as np
import pytest

from vgroove import cli
from vgroove.lab.bench import digest, record
from vgroove.lab.bench.cells import PARTS, Case, Picks, Table
from vgroove.lab.bench.record import Cell, ReportError, open_or_create
from vgroove.lab.report import draw


@pytest.fixture
def path(tmp_path):
    return tmp_path / record.FILE


def picks(*names):
    return Picks(estimators=names)


def test_a_record_is_resumed(path):
    open_or_create(path, "5.2.3", quick=False).add("picks/b", picks("fit"))
    assert open_or_create(path, "5.2.3", quick=False).run.cells == {"picks/b": picks("fit")}


@pytest.mark.parametrize(
    ("of", "other", "said"),
    [
        ("versions", {"numpy": "1.0"}, "measurements by numpy 1.0, which is [12]"),
        ("vgroove", "9.9.9", "measurements by vgroove 9.9.9, which is 0"),
        ("quick", True, "a quick report, not a full one"),
    ],
)
def test_what_else_was_measured_is_not_mixed_in(path, of, other, said):
    open_or_create(path, "5.2.3", quick=False).add("picks/b", picks())
    content = json.loads(path.read_text())
    was = content["runs"]["5.2.3"][of]
    content["runs"]["5.2.3"][of] = was | other if isinstance(other, dict) else other
    path.write_text(json.dumps(content))
    with pytest.raises(ReportError, match=rf"holds {said}.*; choose another folder with -o$"):
        open_or_create(path, "5.2.3", quick=False)
    assert open_or_create(path, "4.5.15", quick=False).run.cells == {}


def test_what_other_code_measured_is_measured_again_where_one_asks_for_it(path):
    """Part by part; until something new is added, the file is as it was."""
    for key, cell in (("figures/b", {}), ("picks/b", picks()), ("stability/b", ())):
        open_or_create(path, "5.2.3", quick=False).add(key, cell)
    content = json.loads(path.read_text())
    content["runs"]["5.2.3"]["code"] |= {"picks": "another", "stability": "another"}
    path.write_text(json.dumps(content))
    for again, left in (([], "--again picks --again stability,"), (["picks"], "--again stability,")):
        with pytest.raises(ReportError, match=f"give {left} or another folder"):
            open_or_create(path, "5.2.3", quick=False, again=again)
    new = open_or_create(path, "5.2.3", quick=False, again=["picks", "stability"])
    assert json.loads(path.read_text()) == content
    assert new.run.cells == {"figures/b": {}}
    new.add("picks/b", picks("fit"))
    assert open_or_create(path, "5.2.3", quick=False).run.cells == {"figures/b": {}, "picks/b": picks("fit")}


def test_blenders_side_by_side_lose_nothing(path):
    """Each was opened before the other added anything."""
    new, old = (open_or_create(path, blender, quick=False) for blender in ("5.2.3", "4.5.15"))
    new.add("picks/b", picks("fit"))
    old.add("picks/b", picks("closure"))
    new.add("picks/c", picks())
    runs = record.read(path).runs
    assert runs["5.2.3"].cells == {"picks/b": picks("fit"), "picks/c": picks()}
    assert runs["4.5.15"].cells == {"picks/b": picks("closure")}


def kept(path, key, cell):
    open_or_create(path, "5.2.3", quick=False).add(key, cell)
    return record.read(path).runs["5.2.3"].cells[key]


def test_a_report_is_small_and_loses_nothing_but_digits(path):
    """Nine of them, and lists of numbers on a line each; text is as it was."""
    rows = [[1 / 3, 2.0, None], ["two  spaces", "[in, brackets]", True]]
    assert kept(path, "figures/b", {"t": Table(["a"], rows)}) == {
        "t": Table(["a"], [[0.333333333, 2.0, None], rows[1]])
    }
    assert "[0.333333333, 2.0, null]," in path.read_text()


def case(**more):
    return Case(**{"group": "b", "what": "", "value": 0.0, "setup": "", "passed": True} | more)


def test_what_is_next_to_1_is_not_1_and_what_is_no_number_is_null(path):
    cases = kept(path, "stability/b", tuple(case(value=value) for value in (1.0 - 1e-9, 1.0 + 1e-9, 1.0)))
    assert [one.value for one in cases] == [1.0 - 1e-9, 1.0 + 1e-9, 1.0]
    (one,) = kept(path, "stability/b", (case(lowest=float("nan"), highest=float("inf"), z=1.0),))
    assert (one.lowest, one.highest, one.z) == (None, None, 1.0)


@pytest.mark.parametrize("part", PARTS)
def test_a_cell_of_another_type_is_refused_by_its_name(part):
    machine = {"system": "", "processor": "", "cores": 1, "memory_gb": 1}
    for wrong in (7, {"x": {"y": 1}}, [[1]]):
        run = {"vgroove": "", "versions": {}, "quick": True, "cells": {f"{part}/b": wrong}}
        with pytest.raises(ReportError, match=f"^{part}/b: "):
            record.structured({"format": record.FORMAT, "machine": machine, "runs": {"5.2": run}})


def test_numbers_are_numbers():
    """No text or truth value stands in for one, and null for none but in a list, where it is nan."""
    for value in ("1.0", True, None, [1.0]):
        for kind in (float, int, record.Flags):
            with pytest.raises((ReportError, TypeError)):
                record._structured(value, kind, "")
    for kind, wrong in (
        (int, 1.5),
        (bool, 1),
        (str, 1),
        (record.Numbers, ["1.0"]),
        (record.Numbers, [True]),
        (record.Flags, [1]),
    ):
        with pytest.raises((ReportError, TypeError)):
            record._structured(wrong, kind, "")
    kept = record._structured([1, 2.5, None], record.Numbers, "")
    np.testing.assert_array_equal(kept, [1.0, 2.5, np.nan])
    assert kept.dtype == np.float64


def test_what_a_measurement_took_is_kept_and_what_is_lacking_is_known(path):
    """Of a part that is measured again it is forgotten."""
    one = open_or_create(path, "5.2.3", quick=False)
    one.run.wanted = 3
    one.add("figures/b", {}, 61.26)
    one.add("picks/b", picks(), 0.5)
    run = record.read(path).runs["5.2.3"]
    assert (run.wanted, run.seconds) == (3, {"figures/b": 61.3, "picks/b": 0.5})
    assert open_or_create(path, "5.2.3", quick=False, again=["picks"]).run.seconds == {"figures/b": 61.3}


# The digest


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    """The checkout's code in a folder that may be changed, and its digests."""
    folder = tmp_path_factory.mktemp("code")
    with pytest.MonkeyPatch.context() as patch:
        for room in ("addon", "nodegroups", "osl", "presets", "lab", "batch", "headless", "cli"):
            shutil.copytree(digest.ROOT / room, folder / room, ignore=shutil.ignore_patterns("__pycache__"))
        patch.setattr(digest, "ROOT", folder)
        yield folder, {part: digest.code(part) for part in PARTS}


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("lab/report/plots.py", ()),
        ("lab/report/documents.py", ()),
        ("lab/bench/record.py", ()),
        ("cli/__init__.py", ()),
        ("addon/ui/panels.py", ()),
        ("addon/choose/automatic.py", ("picks", "left_out", "everyday")),
        ("addon/choose/automatic.toml", ("picks", "left_out", "everyday")),
        ("lab/bench/stability.py", ("stability",)),
        ("lab/bench/figures/keys.py", ("figures",)),
        ("batch/cost.py", ("figures",)),
        ("lab/bench/peers/glass.py", ("accuracy", "picks", "everyday")),
        ("lab/bench/everyday_scenes.py", ("everyday",)),
        ("osl/include/vgroove.h", tuple(PARTS)),
        ("nodegroups/random_numbers.py", tuple(PARTS)),
        ("presets/lecture/copper.toml", tuple(PARTS)),
        ("addon/reference/fresnel.py", tuple(PARTS)),
    ],
)
def test_the_digest_of_a_part_is_of_what_decides_its_numbers(copied, name, parts):
    """What other parts measure and what draws changes nothing; what all parts go through changes all."""
    folder, before = copied
    text = (folder / name).read_text()
    (folder / name).write_text(text + ("\n# another\n" if name.endswith(".toml") else "\nx = 1\n"))
    changed = {part for part in PARTS if digest.code(part) != before[part]}
    (folder / name).write_text(text)
    assert changed >= set(parts)
    assert bool(changed) is bool(parts)
    if name.startswith(("lab/bench/stability", "lab/bench/figures", "batch/", "lab/bench/everyday")):
        assert changed == set(parts)


def test_a_file_that_moves_or_is_reworded_keeps_the_digest(copied):
    """Its imports are others then, and so are those of who imports it; one number that changes is seen."""
    folder, before = copied
    old, new = folder / "addon/reference/distributions.py", folder / "addon/reference/facets/distributions.py"
    new.parent.mkdir()
    (new.parent / "__init__.py").write_text("")
    text = old.read_text()
    old.unlink()
    moved = re.sub(r"^from \.(\w)", r"from ..\1", text, flags=re.MULTILINE)
    new.write_text(moved.replace('"""', '"""Reworded. ', 1) + "\n# a comment\n")
    for path in folder.rglob("*.py"):
        path.write_text(path.read_text().replace(".distributions import", ".facets.distributions import"))
    assert {part: digest.code(part) for part in PARTS} == before
    new.write_text(moved.replace("1e-8", "2e-8"))
    assert all(digest.code(part) != before[part] for part in PARTS)


def test_each_part_is_decided_by_its_module_and_by_none_that_draws(copied):
    for part in PARTS:
        found = digest.modules(part)
        assert {f"lab/bench/{part}.py", f"lab/bench/{part}/__init__.py"} & found
        assert "nodegroups/cook_torrance.py" in found
        assert not [name for name in found if name.startswith(("lab/report/", "cli/", "addon/ui/"))]


@pytest.mark.blender
def test_the_parts_are_those_that_are_measured(blender):
    assert {cell.key.partition("/")[0] for cell in record.cells(quick=False)} == set(PARTS)
    assert [str(part) for part in cli.report.Part] == list(PARTS)


@pytest.mark.blender
def test_what_fails_does_not_end_the_rest(tmp_path, monkeypatch, capsys):
    """One line each, exit code 3, and the next run measures that alone."""
    asked = []

    def cell(name):
        def measure():
            asked.append(name)
            if name == "bad" and asked.count("bad") == 1:
                message = "out of\nluck"
                raise RuntimeError(message)
            return picks()

        return Cell(f"picks/{name}", measure)

    monkeypatch.setattr(record, "cells", lambda *, quick, more: [cell(name) for name in ("good", "bad", "last")])
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
