# SPDX-License-Identifier: GPL-3.0-or-later
"""A digest of the code that decides a part's numbers: of what files contain, wherever they lie.

A part is decided by its module in this folder, by all that this imports of vgroove, and by the data files that ship
with these. Comments, docstrings, blank lines and the import statements between our own modules decide nothing, so a
file that moves or is reworded leaves what was measured valid.
"""

from __future__ import annotations

import ast
import hashlib
import io
import tokenize
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parent.parent.parent
HERE = "lab/bench"
BY_NAME = {"groups.py": "nodegroups"}  # what a module of this name imports by name, if not its own folder
HANDED_OVER = {"figures": ("batch/cost.py",)}  # what the command line measures for a part
# They register the extension, or keep numbers, and decide none.
SILENT = {"__init__.py", "addon/__init__.py", *(f"{HERE}/{name}.py" for name in ("record", "digest"))}
DATA = ("osl/**/*.osl", "osl/**/*.h", "presets/**/*.toml")  # and TOML files beside modules of their names


def code(part: str) -> str:
    """The digest of a part, 16 hexadecimal digits."""
    files = [ROOT / name for name in modules(part)]
    contents = sorted(hashlib.sha256(source(path).encode()).digest() for path in files)
    data = [path for pattern in DATA for path in ROOT.glob(pattern)]
    data += [table for path in files if (table := path.with_suffix(".toml")).is_file()]
    contents += sorted(hashlib.sha256(path.read_bytes()).digest() for path in data)
    return hashlib.sha256(b"".join(contents)).hexdigest()[:16]


def modules(part: str) -> set[str]:
    """The files that a part's module imports, directly or through others, as paths from the root."""
    start = ROOT / HERE / part
    todo = [start / "__init__.py" if start.is_dir() else start.with_suffix(".py")]
    todo += [path for name in HANDED_OVER.get(part, ()) if (path := ROOT / name).is_file()]
    found: set[str] = set()
    while todo:
        path = todo.pop()
        name = path.relative_to(ROOT).as_posix()
        if name not in found | SILENT:
            found.add(name)
            todo += imported(path, path.read_text(encoding="utf-8"))
    return found


@cache
def imported(path: Path, text: str) -> tuple[Path, ...]:
    """The files of vgroove that one imports; all of its folder, if it imports modules by name."""
    found: list[Path] = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
            for target in (base, *(base / one.name for one in node.names)):
                found += (target.with_suffix(".py"), target / "__init__.py")
        elif isinstance(node, ast.Name) and node.id == "import_module":
            folder = ROOT / BY_NAME[path.name] if path.name in BY_NAME else path.parent
            found += sorted(folder.glob("*.py"))
    return tuple(one for one in found if one.is_file() and ROOT in one.parents)


def source(path: Path) -> str:
    """A module without what decides no number. The same text in every Python."""
    return _source(path.read_text(encoding="utf-8"))


@cache
def _source(text: str) -> str:
    lines = text.splitlines()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT:
            row, column = token.start
            lines[row - 1] = lines[row - 1][:column]
    for first, last in _silent(ast.parse(text)):
        lines[first - 1 : last] = [""] * (last - first + 1)
    return "\n".join(line.rstrip() for line in lines if line.strip())


def _silent(tree: ast.Module) -> Iterator[tuple[int, int]]:
    """First and last lines of docstrings and of imports of our own modules."""
    for node in ast.walk(tree):
        own = isinstance(node, ast.ImportFrom) and node.level
        text = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)
        if isinstance(node, ast.stmt) and (own or text):
            yield node.lineno, node.end_lineno or node.lineno
