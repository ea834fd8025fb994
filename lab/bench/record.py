# SPDX-License-Identifier: GPL-3.0-or-later
"""report.json: every number of a report, by Blender and by what was measured. Imports no bpy.

    {"format": 2, "machine": {...}, "runs": {"5.2.3": {
        "vgroove": "0.1.0", "versions": {...}, "quick": false, "code": {"accuracy": "9f3a...", ...},
        "wanted": 80, "seconds": {KEY: 71.3, ...}, "cells": {KEY: {...}}}}}

A key is PART/WHAT, as in "accuracy/softbox/copper"; what a cell holds is said where it is measured. ``code`` is, for
each part, a digest of all that decides its numbers; ``wanted`` is how many cells there are to be, and ``seconds`` how
long each took, by the clock.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import platform
import re
import sys
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil

from ...addon.library.errors import InputError
from ...addon.library.files import FileError, read_text, write_text
from ...addon.library.inputs import shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

PARTS = ("accuracy", "picks", "stability", "left_out", "everyday", "figures")
FILE = "report.json"
LONGEST_FILE = 200_000_000  # bytes
FORMAT = 2
DIGITS = 9
ROOT = Path(__file__).parent.parent.parent
PACKAGES = ("numpy", "scipy", "mitsuba", "flip-evaluator")
MEASURED = ("addon", "nodegroups", "osl", "presets")
# Which parts' numbers a file decides, where not all: none, or those that import it.
DECIDES: dict[str, set[str]] = {
    f"addon/{name}.py": parts
    for parts, names in (
        (set(), "cli gallery report/run report/record"),
        (set(), "report/claims report/compare report/draw report/findings report/page report/plots report/summary"),
        (set(), "report/documents report/words"),
        ({"accuracy"}, "report/accuracy report/flip report/mitsuba_peer report/statistics"),
        ({"accuracy", "picks", "everyday"}, "report/contenders report/scenes"),
        ({"stability"}, "report/stability report/stability_pictures report/stability_reference"),
        ({"left_out"}, "report/left_out report/universal explain"),
        ({"left_out", "picks", "everyday", "figures"}, "automatic"),
        ({"left_out", "picks", "stability", "everyday", "figures"}, "advice facts"),
        ({"picks"}, "report/picks"),
        ({"everyday"}, "report/everyday report/everyday_scenes report/everyday_stage"),
    )
    for name in names.split()
}


FIELDS = (
    ("vgroove", str, "text"), ("quick", bool, "true or false"), ("code", dict, "table"), ("cells", dict, "table"),
)  # fmt: skip

OPTIONAL = (("versions", dict, "table"), ("seconds", dict, "table"), ("wanted", int, "number"))


class ReportError(InputError):
    """A report.json that cannot be used."""


@dataclass(frozen=True)
class Cell:
    """One thing to measure: where its numbers go, and what measures them.

    measure: given the report's folder, where it may keep pictures, returns what JSON can hold.
    """

    key: str
    measure: Callable[[Path], dict[str, Any]]


@dataclass
class Record:
    """The numbers of a report. ``cells`` are those of one Blender."""

    path: Path
    blender: str
    content: dict[str, Any]
    digests: dict[str, str]  # of the code that now measures, by part

    @property
    def cells(self) -> dict[str, dict[str, Any]]:
        return self.content["runs"][self.blender]["cells"]

    def expect(self, wanted: int) -> None:
        """How many cells it is to have."""
        self.content["runs"][self.blender]["wanted"] = wanted

    def keep(self, key: str, found: dict[str, Any], seconds: float = 0.0) -> None:
        """Add a cell that took so long, and write the file, with what another Blender's process put there meanwhile."""
        if self.path.exists():
            others = read(self.path)["runs"]
            self.content["runs"] |= {blender: run for blender, run in others.items() if blender != self.blender}
        self.cells[key] = _plain(found)
        self.content["runs"][self.blender].setdefault("seconds", {})[key] = round(seconds, 1)
        self.content["runs"][self.blender]["code"][part_of(key)] = self.digests[part_of(key)]
        write_text(self.path, text(self.content))


def begun(path: Path, blender: str, *, quick: bool, again: Sequence[str] = ()) -> Record:
    """The record at ``path``, gone on with if there is one; what other code measured there is not mixed in.

    again: parts to be measured anew.
    """
    empty: dict[str, Any] = {"format": FORMAT, "machine": machine(), "runs": {}}
    content = read(path) if path.exists() else empty
    if content["machine"] != machine():
        message = f"{path}: was measured on another machine; choose another folder with -o"
        raise ReportError(message)
    new = {"vgroove": version("vgroove"), "versions": versions(), "quick": quick}
    run = content["runs"].setdefault(blender, new | {"code": {}, "seconds": {}, "cells": {}})
    if differ := list(_differences(run, new)):
        message = f"{path}: holds {' and '.join(differ)}; choose another folder with -o"
        raise ReportError(message)
    for kept in ("cells", "seconds"):
        run[kept] = {key: of for key, of in run.get(kept, {}).items() if part_of(key) not in again}
    digests = {part: code(part) for part in PARTS}
    held = {*map(part_of, run["cells"])}
    stale = [part for part in PARTS if part in held and run["code"].get(part) != digests[part]]
    if stale:
        options = " ".join(f"--again {part}" for part in stale)
        message = f"{path}: other code measured {' and '.join(stale)}; give {options}, or another folder with -o"
        raise ReportError(message)
    return Record(path, blender, content, digests)


def _differences(old: dict[str, Any], new: dict[str, Any]) -> Iterator[str]:
    """What a report was measured by and how, where that is not what would go on with it."""
    if old["quick"] != new["quick"]:
        yield "a full report, where a quick one is asked for" if new["quick"] else "a quick report, not a full one"
    had, has = ({"vgroove": run["vgroove"]} | run.get("versions", {}) for run in (old, new))
    for name in sorted({*had, *has}):
        if had.get(name) != has.get(name):
            yield f"measurements by {name} {had.get(name, 'none')}, which is {has.get(name, 'gone')} here"


def part_of(key: str) -> str:
    return key.partition("/")[0]


def versions() -> dict[str, str]:
    """Of what the numbers are measured with, beside Blender."""
    return {"python": platform.python_version()} | {name: version(name) for name in PACKAGES}


def code(part: str) -> str:
    """A digest of every file of vgroove that decides a number of this part."""
    found = hashlib.sha256()
    for folder in MEASURED:
        for path in sorted((ROOT / folder).rglob("*")):
            name = path.relative_to(ROOT).as_posix()
            if path.suffix in {".py", ".toml", ".osl", ".h"} and _decides(name, part):
                found.update(name.encode() + b"\0" + path.read_bytes())
    return found.hexdigest()[:16]


def _decides(name: str, part: str) -> bool:
    if name.startswith("addon/report/figures/"):
        return part == "figures"
    return part in DECIDES.get(name, {part})


def text(content: dict[str, Any]) -> str:
    """JSON in which a list or a table of plain values is one line. No line ends within a value."""
    spread = json.dumps(content, indent=1, allow_nan=False)
    return (
        re.sub(r"(?<=[\[{])\n[^\[\]{}]*(?=[\]}])", lambda found: re.sub(r"\n *", " ", found[0]).strip(), spread) + "\n"
    )


def _plain(value: Any) -> Any:
    """As JSON can hold it: a number that is not finite is null. Of others ``DIGITS`` are kept, or all near 1."""
    if isinstance(value, dict):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float):
        kept = float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
        return value if kept in {0.0, 1.0} else kept
    return value


def read(path: Path) -> dict[str, Any]:
    """What a report.json holds. ReportError if it is none."""
    try:
        content = json.loads(read_text(path, LONGEST_FILE))
    except (ValueError, RecursionError) as error:
        what = str(error) if isinstance(error, FileError) else "no report"
        what = "not there" if isinstance(error.__cause__, FileNotFoundError) else what
        message = f"{path}: {what}; name a report.json that `vgroove report -o DIR` wrote"
        raise ReportError(message) from error
    if not isinstance(content, dict) or not isinstance(content.get("runs"), dict):
        message = f"{path}: no report; name a report.json that `vgroove report -o DIR` wrote"
        raise ReportError(message)
    if content.get("format") != FORMAT:
        message = f"{path}: is of format {content.get('format')}, this vgroove reads {FORMAT}; measure again"
        raise ReportError(message)
    if flaw := next(_flaws(content), ""):
        message = f"{path}: {flaw}; name a report.json as `vgroove report -o DIR` wrote it"
        raise ReportError(message)
    return content


def _flaws(content: dict[str, Any]) -> Iterator[str]:
    """What is not as ``begun`` and ``Record.keep`` leave it, but for what a cell holds."""
    known = machine()
    if not isinstance(of := content.get("machine"), dict) or not known.keys() <= of.keys():
        yield f"machine is no table of {', '.join(known)}"
    for blender, run in content["runs"].items():
        if not re.fullmatch(r"[0-9]{1,4}(\.[0-9]{1,4}){0,3}", blender):
            yield f"{shown(blender)} is no version of Blender"
            continue
        if not isinstance(run, dict):
            yield f"the run of Blender {blender} is no table"
            continue
        for key, kind, called in (*FIELDS, *(field for field in OPTIONAL if field[0] in run)):
            if not isinstance(run.get(key), kind):
                yield f"{key} in the run of Blender {blender} is no {called}"
        if isinstance(cells := run.get("cells"), dict):
            for key, cell in cells.items():
                if not isinstance(cell, dict):
                    yield f"{key} in the run of Blender {blender} is no table"


def machine() -> dict[str, Any]:
    """The class of the machine, by which run times can be judged; nothing that names it."""
    return {
        "system": sys.platform,
        "processor": platform.machine(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory_gb": round(psutil.virtual_memory().total / 2**30),
    }
