# SPDX-License-Identifier: GPL-3.0-or-later
"""report.json: every number of a report, by Blender and by what was measured. Imports no bpy.

    {"format": 1, "machine": {...}, "runs": {"5.2.3": {
        "vgroove": "0.1.0", "versions": {...}, "code": "9f3a...", "quick": false, "cells": {KEY: {...}}}}}

``code`` is a digest of all that decides the numbers. A key is PART/WHAT, as in "accuracy/softbox/copper"; what a cell
holds is said where it is measured.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
import platform
import sys
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Any

import psutil

from ..files import replacing

if TYPE_CHECKING:
    from collections.abc import Callable

FILE = "report.json"
FORMAT = 1
ROOT = Path(__file__).parent.parent.parent
PACKAGES = ("numpy", "scipy", "mitsuba", "flip-evaluator")
MEASURED = ("addon", "nodegroups", "osl", "presets")
DRAWN = {"cli.py", "compare.py", "draw.py", "findings.py", "page.py", "plots.py", "summary.py", "gallery.py"}


class ReportError(ValueError):
    """Bad input in one line: what, where, how to mend it."""


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

    @property
    def cells(self) -> dict[str, dict[str, Any]]:
        return self.content["runs"][self.blender]["cells"]

    def keep(self, key: str, found: dict[str, Any]) -> None:
        """Add a cell, and write the file, with what another Blender's process put there meanwhile.

        JSON has no number that is not finite: such become null.
        """
        if self.path.exists():
            others = read(self.path)["runs"]
            self.content["runs"] |= {blender: run for blender, run in others.items() if blender != self.blender}
        self.cells[key] = _finite(found)
        with replacing(self.path) as temporary:
            temporary.write_text(json.dumps(self.content, indent=1, allow_nan=False), encoding="utf-8")


def begun(path: Path, blender: str, *, quick: bool) -> Record:
    """The record at ``path``, gone on with if there is one; what other code measured there is not mixed in."""
    empty: dict[str, Any] = {"format": FORMAT, "machine": machine(), "runs": {}}
    content = read(path) if path.exists() else empty
    if content["machine"] != machine():
        message = f"{path}: was measured on another machine; choose another folder with -o"
        raise ReportError(message)
    new = {"vgroove": version("vgroove"), "versions": versions(), "code": code(), "quick": quick}
    run = content["runs"].setdefault(blender, new | {"cells": {}})
    differ = [name for name, value in new.items() if run.get(name) != value]
    if differ:
        held = "a quick report" if run.get("quick") else "a full report"
        message = f"{path}: holds {held} of other {' and '.join(differ)}; choose another folder with -o"
        raise ReportError(message)
    return Record(path, blender, content)


def versions() -> dict[str, str]:
    """Of what the numbers are measured with, beside Blender."""
    return {"python": platform.python_version()} | {name: version(name) for name in PACKAGES}


def code() -> str:
    """A digest of every file of vgroove that decides a number; not of what draws them."""
    found = hashlib.sha256()
    for folder in MEASURED:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in {".py", ".toml", ".osl", ".h"} and path.name not in DRAWN:
                found.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes())
    return found.hexdigest()[:16]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def read(path: Path) -> dict[str, Any]:
    """What a report.json holds. ReportError if it is none."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, OSError) as error:
        what = "not there" if isinstance(error, FileNotFoundError) else "no report"
        message = f"{path}: {what}; name a report.json that `vgroove report -o DIR` wrote"
        raise ReportError(message) from error
    if not isinstance(content, dict) or not isinstance(content.get("runs"), dict):
        message = f"{path}: no report; name a report.json that `vgroove report -o DIR` wrote"
        raise ReportError(message)
    if content.get("format") != FORMAT:
        message = f"{path}: is of format {content.get('format')}, this vgroove reads {FORMAT}; measure it anew"
        raise ReportError(message)
    return content


def machine() -> dict[str, Any]:
    """The class of the machine, by which run times can be judged; nothing that names it."""
    return {
        "system": sys.platform,
        "processor": platform.machine(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory_gb": round(psutil.virtual_memory().total / 2**30),
    }
