# SPDX-License-Identifier: GPL-3.0-or-later
"""The structure of the code in figures: how large each room is, who knows which model, and which imports climb.

python tools/house.py            prints them
python tools/house.py --each     and every place that is counted

Rooms, in the order in which imports may go: what stands further down may import what stands further up. Rooms of one
line do not import each other's.
"""

from __future__ import annotations

import ast
import sys
from collections import Counter, defaultdict
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parent.parent
LEVELS = (
    ("reference",), ("models",), ("library",), ("measured",), ("nodegroups",), ("blender",), ("choose",),
    ("ui", "headless"), ("lab", "batch", "viewer"), ("cli",),
)  # fmt: skip
LEVEL = {room: level for level, rooms in enumerate(LEVELS) for room in rooms}
SHIPPED = ("reference", "models", "library", "measured", "nodegroups", "blender", "choose", "ui")  # what Blender loads
MODELS = tuple(path.stem for path in (ROOT / "addon" / "models").glob("*.py") if "MODEL = Model(" in path.read_text())
ESTIMATORS = {"closure", "fit", "mirror", "direct", "corrected", "hybrid"}
LONGEST_FUNCTION, LONGEST_FILE = 60, 450
CLIMBS = "imports that climb"
DECISIONS = "decisions on a model's name outside its own files"
LISTS = "lists of most estimators outside addon/models"
LONG_FILES, LONG_FUNCTIONS = f"files over {LONGEST_FILE} lines", f"functions over {LONGEST_FUNCTION} lines"
RULES = (CLIMBS, DECISIONS, LISTS, LONG_FILES, LONG_FUNCTIONS)  # of which there is none
NAMES = "lines that name cook_torrance outside its own files"


@dataclass
class Count:
    """What is counted, with the places where it is."""

    places: dict[str, list[str]] = field(default_factory=lambda: defaultdict(list))

    def add(self, what: str, path: Path, line: int, text: str = "") -> None:
        self.places[what].append(f"{path.relative_to(ROOT)}:{line} {text}".rstrip())


def sources() -> list[Path]:
    """Every Python file of the package."""
    return sorted(
        path
        for folder in ("addon", "nodegroups", "headless", "lab", "batch", "viewer", "cli")
        for path in (ROOT / folder).rglob("*.py")
    )


def everything() -> list[Path]:
    """Every Python file, those of the tests and tools too, which stand outside the rooms."""
    return [*sources(), *sorted(path for folder in ("tests", "tools") for path in (ROOT / folder).rglob("*.py"))]


def room(path: Path) -> str:
    """The room of a file; "" for what belongs to none."""
    folders = path.relative_to(ROOT).parts[:-1]
    return next((folder for folder in reversed(folders[:2]) if folder in LEVEL), "")


def is_own(path: Path, model: str) -> bool:
    """Whether a file is a model's own: its name begins with the model's."""
    return path.stem.startswith(model)


def imports(path: Path, tree: ast.Module) -> Iterator[tuple[Path, int]]:
    """Files of the package that one imports, with the line."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom) or not node.level:
            continue
        base = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
        if base.with_suffix(".py").exists():
            yield base.with_suffix(".py"), node.lineno
            continue
        for one in node.names:
            file = base / f"{one.name}.py"
            yield (file if file.exists() else base / one.name / "__init__.py" if (base / one.name).is_dir()
                   else base / "__init__.py"), node.lineno  # fmt: skip


def imported_by(path: Path) -> list[Path]:
    """Files of the package that one imports, inside functions too."""
    return [file for file, _ in imports(path, ast.parse(path.read_text(encoding="utf-8")))]


def climbs(importer: str, imported: str) -> bool:
    """Whether an import goes against the order of rooms."""
    return importer != imported and LEVEL[imported] >= LEVEL[importer]


def count() -> tuple[Count, Counter[str], Counter[str]]:
    """All that is counted, and files and lines of each room."""
    found, files, lines = Count(), Counter(), Counter()
    for path in sources():
        text, here = path.read_text(encoding="utf-8"), room(path)
        tree = ast.parse(text)
        files[here or "(none)"] += 1
        lines[here or "(none)"] += text.count("\n")
        for imported, line in imports(path, tree):
            there = room(imported)
            if here and there and climbs(here, there):
                found.add(CLIMBS, path, line, f"{here} imports {there}")
        _names(path, tree, text, found)
    for path in everything():
        _lengths(path, path.read_text(encoding="utf-8"), found)
    return found, files, lines


def _lengths(path: Path, text: str, found: Count) -> None:
    if (size := text.count("\n")) > LONGEST_FILE:
        found.add(LONG_FILES, path, size)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno + 1 > LONGEST_FUNCTION:
            found.add(LONG_FUNCTIONS, path, node.lineno, node.name)


def _names(path: Path, tree: ast.Module, text: str, found: Count) -> None:
    for number, line in enumerate(text.splitlines(), 1):
        if "cook_torrance" in line and not is_own(path, "cook_torrance"):
            found.add(NAMES, path, number)
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            told = {one for one in _texts(node) if one in MODELS and not is_own(path, one)}
            if told:
                found.add(DECISIONS, path, node.lineno, ", ".join(sorted(told)))
        if isinstance(node, ast.List | ast.Tuple | ast.Set | ast.Dict) and room(path) != "models":
            keys = node.keys if isinstance(node, ast.Dict) else node.elts
            listed = {one.value for one in keys if isinstance(one, ast.Constant)} & ESTIMATORS
            if len(listed) > (5 if isinstance(node, ast.Dict) else 3):  # fewer are a choice
                found.add(LISTS, path, node.lineno, ", ".join(sorted(listed)))


def _texts(node: ast.AST) -> Iterator[str]:
    return (one.value for one in ast.walk(node) if isinstance(one, ast.Constant) and isinstance(one.value, str))


def main() -> None:
    found, files, lines = count()
    print(f"{'room':<12}{'files':>6}{'lines':>7}")
    for name in (*LEVEL, "(none)"):
        print(f"{name:<12}{files[name]:>6}{lines[name]:>7}")
    print()
    for what, places in sorted(found.places.items()):
        print(f"{len(places):>5}  {what}")
        if "--each" in sys.argv:
            print(*(f"       {place}" for place in places), sep="\n")


if __name__ == "__main__":
    main()
