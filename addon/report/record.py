# SPDX-License-Identifier: GPL-3.0-or-later
"""report.json: every number of a report, by Blender and by what was measured. Imports no bpy.

    {"format": 1, "machine": {...}, "runs": {"5.2.3": {"vgroove": "0.1.0", "quick": false, "cells": {KEY: {...}}}}}

A key is PART/WHAT, as in "accuracy/softbox/copper"; what a cell holds is said where it is measured.
"""

from __future__ import annotations

import json
import os
import platform
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import psutil

from ..files import replacing

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

FILE = "report.json"
FORMAT = 1


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
        """Add a cell, and write the file."""
        self.cells[key] = found
        with replacing(self.path) as temporary:
            temporary.write_text(json.dumps(self.content, indent=1, allow_nan=False), encoding="utf-8")


def begun(path: Path, versions: dict[str, str], *, quick: bool) -> Record:
    """The record at ``path``, gone on with if there is one; what another vgroove measured there is not mixed in."""
    blender = versions["blender"]
    new: dict[str, Any] = {"format": FORMAT, "machine": machine(), "runs": {}}
    content = read(path) if path.exists() else new
    if content["machine"] != machine():
        message = f"{path}: was measured on another machine; choose another folder with -o"
        raise ReportError(message)
    run = content["runs"].setdefault(blender, {"vgroove": versions["vgroove"], "quick": quick, "cells": {}})
    if (run["vgroove"], run["quick"]) != (versions["vgroove"], quick):
        how = "--quick" if run["quick"] else "in full"
        message = f"{path}: holds a report of vgroove {run['vgroove']}, {how}; choose another folder with -o"
        raise ReportError(message)
    return Record(path, blender, content)


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
        if not isinstance(run, dict):
            yield f"the run of Blender {blender} is no table"
            continue
        for key, kind, called in (("vgroove", str, "text"), ("quick", bool, "true or false"), ("cells", dict, "table")):
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
