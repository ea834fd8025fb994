# SPDX-License-Identifier: GPL-3.0-or-later
"""The house keeps its rules: imports point one way, a model is known by its own files alone, nothing grows too long."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
_spec = importlib.util.spec_from_file_location("house", ROOT / "tools" / "house.py")
house = sys.modules["house"] = importlib.util.module_from_spec(_spec)  # dataclasses look their module up
_spec.loader.exec_module(house)
ASKS = re.compile(r"\bsince\(\d|app\.version\b(?!_string)|hasattr\(bpy")
# Loaded by nothing that an artist sees yet; scripts in Blender import them.
FOR_SCRIPTS = {"addon/choose/explain.py", "addon/measured/csv_file.py"}


@pytest.fixture(scope="module")
def count():
    return house.count()


def test_every_file_has_a_room(count):
    """But for the extension's own __init__.py files."""
    assert set(count[1]) <= {*house.LEVEL, "(none)"}
    assert count[1]["(none)"] == 1


@pytest.mark.parametrize("rule", house.RULES)
def test_the_rule_holds(rule, count):
    """`python tools/house.py --each` lists the places."""
    assert count[0].places[rule] == []


@pytest.mark.parametrize(
    ("importer", "imported", "wrong"),
    [
        ("reference", "models", True), ("models", "reference", False), ("blender", "lab", True),
        ("ui", "headless", True), ("lab", "batch", True), ("cli", "lab", False), ("nodegroups", "nodegroups", False),
    ],
)  # fmt: skip
def test_an_import_that_climbs_is_seen(importer, imported, wrong):
    """The rule itself: rooms of one level do not know each other either."""
    assert house.climbs(importer, imported) == wrong


def test_a_decision_on_a_model_is_seen(tmp_path, monkeypatch):
    """In a comparison, wherever the name stands."""
    path = tmp_path / "addon" / "choose" / "wrong.py"
    path.parent.mkdir(parents=True)
    path.write_text('def f(preset):\n    return preset.model in {"glass", "sum"}\n', encoding="utf-8")
    monkeypatch.setattr(house, "ROOT", tmp_path)
    found, _, _ = house.count()
    assert found.places[house.DECISIONS] == ["addon/choose/wrong.py:2 glass, sum"]


@pytest.mark.parametrize("folder", ["addon/choose", "tests/blender", "tools"])
def test_a_file_or_a_function_that_grows_too_long_is_seen(tmp_path, monkeypatch, folder):
    """In code, tests and tools alike, from the first line over the limit."""
    monkeypatch.setattr(house, "ROOT", tmp_path)
    path = tmp_path / folder / "long.py"
    path.parent.mkdir(parents=True)
    for more, rules in ((0, []), (1, [house.LONG_FILES, house.LONG_FUNCTIONS])):
        body = "    pass\n" * (house.LONGEST_FUNCTION - 1 + more)
        path.write_text("def f():\n" + body + "\n" * (house.LONGEST_FILE - house.LONGEST_FUNCTION), encoding="utf-8")
        assert sorted(house.count()[0].places) == rules


def test_what_differs_between_blenders_stands_in_one_file():
    """Of what is rendered with; tests and the report may ask for a version."""
    rooms = ("addon", "nodegroups", "headless", "batch", "cli")
    asking = [path for room in rooms for path in (ROOT / room).rglob("*.py") if ASKS.search(path.read_text("utf-8"))]
    assert asking == [ROOT / "nodegroups" / "versions.py"]


def test_the_extension_holds_what_it_loads_and_nothing_else():
    """Of our Python files: those that register() and its operators can import, and what scripts in Blender use."""
    reached, waiting = set(), [ROOT / "__init__.py", ROOT / "addon" / "ui" / "__init__.py"]
    waiting.append(ROOT / "addon" / "choose" / "picture.py")  # what addon/ui/pictures.py starts another Blender with
    waiting += (ROOT / "nodegroups").glob("*.py")  # found by their models' names
    waiting += (ROOT / "addon" / "models").glob("*.py")
    while waiting:
        path = waiting.pop()
        if path not in reached:
            reached.add(path)
            waiting += house.imported_by(path)
    shipped = {path for path in house.sources() if house.room(path) in house.SHIPPED}
    unused = {path.relative_to(ROOT).as_posix() for path in shipped - reached if path.stem != "__init__"}
    assert unused == FOR_SCRIPTS
    assert {path for path in reached if house.room(path) not in {*house.SHIPPED, ""}} == set()


def test_the_count_prints_a_table():
    """Rooms with their files and lines, and what is counted."""
    done = subprocess.run([sys.executable, "tools/house.py"], cwd=ROOT, capture_output=True, text=True, check=True)
    assert "blender" in done.stdout


def test_what_is_called_slow_is_there():
    """data/slow.txt names tests by file and function; one renamed would come back into `make test`."""
    names = (ROOT / "tests" / "data" / "slow.txt").read_text(encoding="utf-8").split("\n")[:-1]
    for file, function in sorted({tuple(re.split(r"::|\[", name)[:2]) for name in names}):
        assert f"def {function}(" in (ROOT / file).read_text(encoding="utf-8"), f"{file}::{function}"
